"""Trials of kills: a command that is killed at a random instant, with its processes, and made again comes to the same."""

import csv
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping
from functools import cache
from pathlib import Path

from filelock import FileLock

from tests.support import MINIATURES, ROOT, wheels
from tests.support.campaigns import TIMINGS
from tests.support.ensemble_texts import normal
from tests.support.saved_results import SPIN

#: Each command with the tables that it writes.
COMMANDS: dict[str, tuple[tuple[object, ...], tuple[str, ...]]] = {
    "run": (
        ("--engine", "dawdling", "--engine", "segfaulting", "--engine", "mujoco", "--timestep", 0.01, "--timestep", 0.02),
        ("results.csv",),
    ),
    "tradeoff": (
        ("--engine", "exact", "--engine", "drifting", *(word for h in (0.1, 0.05, 0.02) for word in ("--timestep", h))),
        ("tradeoff.csv", "orders.csv"),
    ),
    "recommend": (("--engine", "exact", "--engine", "drifting", "--quantity", "position", "--error", 1e-2), ("steps.csv",)),
    "extremes": (("--engine", "exact", "--engine", "raising"), ("extremes.csv", "limits.csv")),
    "ensemble": (("--engine", "batching", "--engine", "mujoco", "--timestep", 0.05), ("ensemble.csv", "sensitivity.csv")),
    "releases": (("--integrator", "closed-form", "--timestep", 0.002), ("releases.csv", "changes.csv")),
}

#: What is drawn in an ensemble. With its engines a chunk has some blocks, so that kills find it in the middle of its files.
ENSEMBLE = f"[ensemble]\nmembers = 1200\n[[ensemble.vary]]\n{normal('initial.angular_velocity', 0.0, 3.0)}\n"

#: Columns that are different whenever something is run again.
CHANGING = {
    *(*TIMINGS, "time_per_step_low", "time_per_step_high", "cost", "evaluations"),
    *("processor_time_per_step", "setup_time", "engine_share"),
}

#: What a process that is to end with its parent has for it (s); a busy machine takes a while.
ENDING_S = 60.0


def killed_command(seed: int, folder: Path) -> str:
    """What is wrong after a command was killed at an instant that follows from the seed, and was made again."""
    chance = random.Random(seed)
    name = chance.choice(list(COMMANDS))
    duration, codes, expected = _undisturbed(name)
    work = _Work(name, folder)
    with work.begun() as process:
        try:
            process.wait(chance.uniform(0.0, duration))
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGKILL)
    if left := work.processes():
        return f"{name}: these processes outlive the command: {left}"
    before = work.tables() if process.returncode in codes else {}
    code, told = work.ended()
    if code not in codes:
        return f"{name}: exit {code} after a kill, {codes} without: {told[-2000:]}"
    for table, text in work.tables().items():
        if text != expected[table]:
            return f"{name}: {table} is another after a kill:\n{text}\ninstead of\n{expected[table]}"
    return "" if not before or before == expected else f"{name}: two commands disagree"


#: The variable with a folder in which processes of one test run tell each other what commands do that are not disturbed.
TOLD = "BODYCHECK_UNDISTURBED"


@cache
def _undisturbed(name: str) -> tuple[float, tuple[int, ...], Mapping[str, str]]:
    """How long a command takes (s), with which exit code it ends, and its tables."""
    if TOLD not in os.environ:
        return _measured(name)
    file = Path(os.environ[TOLD], f"{name}.json")
    with FileLock(f"{file}.lock"):
        if not file.exists():
            file.write_text(json.dumps(_measured(name)))
        duration, codes, tables = json.loads(file.read_text())
    return duration, tuple(codes), tables


def _measured(name: str) -> tuple[float, tuple[int, ...], Mapping[str, str]]:
    work = _Work(name, Path(tempfile.mkdtemp(prefix="undisturbed-")))
    start = time.monotonic()
    code, told = work.ended()
    assert code in (0, 1), told
    return time.monotonic() - start, (code,), work.tables()


class _Work:
    """A command on one case, in a folder of its own."""

    def __init__(self, name: str, folder: Path) -> None:
        self.folder, self.out = folder, folder / "out"
        options, self.names = COMMANDS[name]
        case = folder / "spin.case.toml"
        case.write_text(SPIN.partition("[extremes]")[0] + ENSEMBLE if name == "ensemble" else SPIN.partition("[[expect]]")[0])
        self.environment = {"TMPDIR": str(folder), "PYTHONPATH": os.pathsep.join(map(str, (ROOT, MINIATURES)))}
        given: tuple[object, ...] = (case,)
        if name == "releases":
            given = ("toy", "1.0", "2.0", "--case", case)
            self._make_releases()
        words = (name, *given, *options, "--jobs", 2, "--out", self.out)
        self.command = [sys.executable, "-m", "bodycheck", *map(str, words)]

    def _make_releases(self) -> None:
        """Two releases of a miniature engine, of which the second drifts, and nowhere else to install from."""
        wheels.plugin(self.folder / "plugin")
        wheels.wheel(self.folder / "wheels", "1.0")
        wheels.wheel(self.folder / "wheels", "2.0", 'KIND = "drifting"')
        self.environment["PYTHONPATH"] += os.pathsep + str(self.folder / "plugin")
        self.environment |= {"BODYCHECK_CACHE": str(self.folder / "cache"), "UV_CACHE_DIR": str(self.folder / "uv")}
        self.environment |= {"PIP_NO_INDEX": "1", "PIP_FIND_LINKS": str(self.folder / "wheels")}

    def begun(self) -> subprocess.Popen[bytes]:
        """The process of the command."""
        nowhere = subprocess.DEVNULL
        return subprocess.Popen(self.command, env=os.environ | self.environment, cwd=ROOT, stdout=nowhere, stderr=nowhere)

    def ended(self) -> tuple[int, str]:
        """The exit code of the command and what it told, when it has ended."""
        done = subprocess.run(self.command, env=os.environ | self.environment, cwd=ROOT, capture_output=True, text=True)
        return done.returncode, done.stderr

    def tables(self) -> dict[str, str]:
        """The tables by name, without what is different each time."""
        found = {}
        for name in self.names:
            with (self.out / name).open(newline="") as stream:
                rows = [{key: value for key, value in row.items() if key not in CHANGING} for row in csv.DictReader(stream)]
            found[name] = "\n".join(map(str, rows))
        return found

    def processes(self) -> list[str]:
        """The processes of the command that are still there when all of them had time to end."""
        deadline = time.monotonic() + ENDING_S
        while (found := _with_environment(f"TMPDIR={self.folder}")) and time.monotonic() < deadline:
            time.sleep(0.02)
        return found


def _with_environment(entry: str) -> list[str]:
    """The command lines of the processes, but those that have ended, with an entry in their environment."""
    found = []
    for process in Path("/proc").iterdir():
        try:
            if process.name.isdigit() and f"{entry}\0".encode() in (process / "environ").read_bytes():
                found.append((process / "cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace"))
        except OSError:  # of another user, or gone meanwhile
            continue
    return found
