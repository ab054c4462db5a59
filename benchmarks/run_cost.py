"""Measure what `bodycheck run` costs per run beyond the engine and the truth: files, judging, report and processes.

    python benchmarks/run_cost.py [CASES]

Without a number, with 200 cases. They are copies of one case that differ in their angular velocities, run with one method and
one time step. `whole` is the processor time of the command and of all its processes, report included, per run; `start` is that
of the command with one case. Of a few of the cases the truth and the run are also made alone in this process. What is left is
the cost of everything else. The elapsed time of the command depends on the machine and on what else it does.
"""

import os
import random
import resource
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from bodycheck import load
from bodycheck.adapters.contract import Method
from bodycheck.casefile.case import Case
from bodycheck.running.plan import Task
from bodycheck.running.tasks import TruthTask, perform

#: Cases of the command if no number is given, and cases whose truth and run are also made alone.
CASES, ALONE = 200, 25

CASE, ENGINE, INTEGRATOR, TIMESTEP = "free-brick", "mujoco", "Euler", 0.002

#: The largest component of an angular velocity (rad/s).
FASTEST = 10.0


@dataclass(frozen=True)
class Used:
    """The elapsed time (s) of a command, and the processor time (s) of it and of all its processes."""

    elapsed: float
    processor: float


def case_files(folder: Path, count: int) -> list[Path]:
    """Write copies of the case, without its expectations and each with an angular velocity of its own, and return the files."""
    text, _, _ = load(CASE).text.partition("[[expect]]")
    (rates,) = [line for line in text.splitlines() if line.startswith("euler_rates")]
    numbers, files = random.Random(1), []
    for place in range(count):
        spin = [numbers.uniform(-FASTEST, FASTEST) for _ in range(3)]
        own = text.replace(f'name = "{CASE}"', f'name = "brick-{place:04}"').replace(rates, f"angular_velocity = {spin}")
        files.append(folder / f"brick-{place:04}.case.toml")
        files[-1].write_text(own, "utf-8")
    return files


def used(files: Path, out: Path) -> Used:
    """Run the cases of a folder, or one case file, with a report, and return what that took."""
    method = ("--engine", ENGINE, "--integrator", INTEGRATOR, "--timestep", str(TIMESTEP))
    command = [sys.executable, "-m", "bodycheck", "run", str(files), *method, "--out", str(out), "--quiet"]
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run(command, check=True)
    elapsed, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    return Used(elapsed, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)


def alone(cases: list[Case]) -> tuple[float, float]:
    """Return the processor times (s) of a truth and of a run, without anything else; the first of each is not measured."""
    method, times = Method.parse(INTEGRATOR, TIMESTEP), [0.0, 0.0]
    for place, case in enumerate(cases):
        for kind, task in enumerate((TruthTask(case, (TIMESTEP,)), Task(case, ENGINE, method))):
            start = time.process_time()
            perform(task)
            times[kind] += (time.process_time() - start) if place else 0.0
    return times[0] / (len(cases) - 1), times[1] / (len(cases) - 1)


def main() -> None:
    count = int(sys.argv[1]) if len(sys.argv) > 1 else CASES
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place, "cases")
        folder.mkdir()
        files = case_files(folder, count)
        start = used(files[0], Path(place, "one"))
        whole = used(folder, Path(place, "all"))
        page = Path(place, "all", "report.html").stat().st_size
        truth, engine = alone([load(file) for file in files[: 1 + ALONE]])
    per_run = 1e3 * (whole.processor - start.processor) / (count - 1)
    print(f"{count} cases with {ENGINE} {INTEGRATOR} on {os.cpu_count()} processors: {whole.elapsed:.1f} s elapsed")
    print(f"start {start.processor:.1f} s of the processor, {start.elapsed:.1f} s elapsed; report.html {page / 1e6:.1f} MB")
    print(f"whole {per_run:.1f} ms a run; engine {1e3 * engine:.1f} ms, truth {1e3 * truth:.1f} ms")
    beyond = per_run - 1e3 * (engine + truth)
    print(f"beyond engine and truth {beyond:.1f} ms a run, {per_run / (1e3 * (engine + truth)):.2f} times their cost in all")


if __name__ == "__main__":
    main()
