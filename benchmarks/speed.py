"""Measure what bodycheck itself costs, add a line to `speed.jsonl`, and compare it with the last one of this machine.

    python benchmarks/speed.py

Each cost is processor time, children included, and the least of several turns, so that other processes disturb little. A line
has the day, the versions of packages and of the system, the machine and the costs (s). Lines are compared as ratios, and only
between equal processors, numbers of cores and versions of Python: nothing fails because a machine is slow. The page
`docs/development/speed.md` shows all lines.
"""

import json
import resource
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from datetime import UTC, datetime
from functools import partial
from importlib.metadata import version
from pathlib import Path
from subprocess import DEVNULL, run
from typing import Any

from bodycheck import load
from bodycheck.adapters.contract import Method
from bodycheck.results import versions
from bodycheck.running.plan import Task
from bodycheck.running.tasks import TruthTask, perform

FILE = Path(__file__).with_name("speed.jsonl")

#: Turns of each measurement; the least cost counts.
TURNS = 5

#: The run that is measured as a command.
RUN = ("free-brick", "--engine", "mujoco", "--integrator", "Euler", "--quiet")

#: Ratios of a cost to the one before that are printed as no change: the scatter of the least of five turns.
SCATTER = (0.9, 1.1)

#: What is measured, by the names in the lines.
MEANINGS = {
    "start": "a process of Python that does nothing, for comparison",
    "import": "`import bodycheck`, with the process",
    "ready": "`import bodycheck; bodycheck.run`, with the process",
    "help": "`bodycheck --help`",
    "run": "`bodycheck run free-brick` with MuJoCo's Euler and all files, by one process a kind",
    "truth_flip": "the truth of the flip with its bound, warm",
    "truth_double_pendulum": "the truth of a double pendulum with its bound, warm",
    "mujoco_flip": "ten seconds of the flip in MuJoCo at 2 ms, through the adapter",
}


def main() -> None:
    machine = versions.fingerprint()
    line: dict[str, Any] = {
        "day": datetime.now(UTC).date().isoformat(),
        "versions": versions.here() | {"mujoco": version("mujoco"), "system": machine.pop("system")},
        "machine": machine,
        "seconds": {name: float(f"{cost:.3g}") for name, cost in measured()},
    }
    before = last_of(lines(FILE), line["machine"])
    with FILE.open("a", encoding="utf-8", newline="\n") as stream:
        stream.write(json.dumps(line, ensure_ascii=False) + "\n")
    print("\n".join(compared(line, before)))


def measured() -> Iterator[tuple[str, float]]:
    """Yield the name and the cost (s) of everything that is measured."""
    python = [sys.executable, "-c"]
    with tempfile.TemporaryDirectory() as folder:
        commands = {
            "start": [*python, "pass"],
            "import": [*python, "import bodycheck"],
            "ready": [*python, "import bodycheck; bodycheck.run"],
            "help": [sys.executable, "-m", "bodycheck", "--help"],
            "run": [sys.executable, "-m", "bodycheck", "run", *RUN, "--out", folder],
        }
        for name, command in commands.items():
            yield name, least(partial(run, command, check=True, stdout=DEVNULL, stderr=DEVNULL, cwd=folder))
    flip, pendulum = load("intermediate-axis-flip"), load("double-pendulum")
    tasks = {
        "truth_flip": TruthTask(flip, (0.002,)),
        "truth_double_pendulum": TruthTask(pendulum, (0.002,)),
        "mujoco_flip": Task(flip, "mujoco", Method.parse("Euler", 0.002)),
    }
    for name, task in tasks.items():
        perform(task)
        yield name, least(partial(perform, task))


def least(call: Callable[[], object]) -> float:
    """Return the least processor time (s) of a call, children included."""
    costs = []
    for _ in range(TURNS):
        before = _spent()
        call()
        costs.append(_spent() - before)
    return min(costs)


def _spent() -> float:
    """Return the processor time (s) of this process and of its children that have ended, to a microsecond."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in used)


def lines(file: Path) -> list[dict[str, Any]]:
    """Return the lines of a file, the oldest first; none if there is no file."""
    return [json.loads(line) for line in file.read_text("utf-8").splitlines()] if file.exists() else []


def last_of(earlier: Sequence[Mapping[str, Any]], machine: Mapping[str, str]) -> Mapping[str, Any] | None:
    """Return the last line of a machine; None if there is none."""
    return next((line for line in reversed(earlier) if line["machine"] == machine), None)


def compared(line: Mapping[str, Any], before: Mapping[str, Any] | None) -> Iterator[str]:
    """Yield what differs between the versions of two lines, and each cost with its ratio to the earlier one."""
    if before is None:
        yield "the first line of this machine"
    else:
        changed = [
            f"{name} {before['versions'].get(name, 'none')} -> {line['versions'].get(name, 'none')}"
            for name in sorted(line["versions"].keys() | before["versions"].keys())
            if line["versions"].get(name) != before["versions"].get(name)
        ]
        yield f"compared with {before['day']}: {', '.join(changed) or 'the same versions'}"
    for name, cost in line["seconds"].items():
        was = None if before is None else before["seconds"].get(name)
        yield f"{name:24} {1e3 * cost:9.1f} ms  {_ratio(cost, was)}".rstrip()


def _ratio(cost: float, before: float | None) -> str:
    if not before:
        return ""
    ratio = cost / before
    return "unchanged" if SCATTER[0] <= ratio <= SCATTER[1] else f"{ratio:.2f} times"


def page() -> str:
    """Return the tables of all lines, one a machine, the newest line first, as Markdown."""
    by_machine: dict[str, list[dict[str, Any]]] = {}
    for line in lines(FILE):
        by_machine.setdefault(json.dumps(line["machine"], sort_keys=True), []).append(line)
    parts = []
    for own in by_machine.values():
        machine = own[-1]["machine"]
        names = list(own[-1]["seconds"])
        rows = [f"| day | bodycheck | {' | '.join(names)} |", f"| {'--- | ' * (2 + len(names))}"]
        for line, before in reversed([*zip(own, [None, *own[:-1]], strict=True)]):
            costs = []
            for name in names:
                cost, was = line["seconds"].get(name), None if before is None else before["seconds"].get(name)
                costs.append("" if cost is None else f"{1e3 * cost:.3g} {_ratio(cost, was).replace('unchanged', '=')}".strip())
            rows.append(f"| {line['day']} | {line['versions']['bodycheck']} | {' | '.join(costs)} |")
        parts.append(
            f"{machine['processor']}, {machine['cores']} cores, Python {machine['python']} (ms):\n\n" + "\n".join(rows)
        )
    meanings = "\n".join(f"| `{name}` | {meaning} |" for name, meaning in MEANINGS.items())
    return "\n\n".join([f"| cost | what |\n| --- | --- |\n{meanings}", *parts])


if __name__ == "__main__":
    main()
