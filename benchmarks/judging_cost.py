"""Measure the cost per run of reading, looking up and judging stored results, and the memory that they take.

    python benchmarks/judging_cost.py [RUNS ...]

Without numbers, with 100, 1,000 and 10,000 runs. One real run of MuJoCo and its truth are copied under the names of many cases,
`RUNS_PER_CASE` runs in each: methods at one time step, and two finer steps of the first method, whose order is expected. Each
number of runs is measured in a process of its own, so that the peak memory is its own; times are those of the processor.

Reading: the journal, the case files and the runs, without trajectories. Look-up: each run by its key. Judging:
`judgement.judge`, which reads every trajectory. Rows: `judgement.records`. The cost is linear in the number of runs where a
column stays the same from row to row.
"""

import json
import multiprocessing
import os
import resource
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

from bodycheck import load
from bodycheck.adapters import registry
from bodycheck.adapters.method import Method
from bodycheck.judging import judgement
from bodycheck.results import store
from bodycheck.running import campaign
from bodycheck.running.plan import Task

#: Numbers of runs that are measured if none are given.
NUMBERS = (100, 1_000, 10_000)

#: Runs of each case: methods at one time step, and the first method at its half and its quarter.
RUNS_PER_CASE = 20

CASE, TIMESTEP = "free-brick", 0.01

ORDERED = f'\n[[expect]]\nengine = "mujoco"\nintegrator = "RK4"\ntimestep = {TIMESTEP}\norder = 0.5\n'


@dataclass(frozen=True)
class Cost:
    """Seconds that each part took for all runs, and the peak memory of the process (MiB)."""

    runs: int
    reading: float
    looking_up: float
    judging: float
    rows: float
    memory: float

    @property
    def text(self) -> str:
        """A row of the table."""
        micro = (1e6 * part / self.runs for part in (self.reading, self.looking_up, self.judging, self.rows))
        return f"{self.runs:>8}" + "".join(f"{part:>12.1f}" for part in micro) + f"{self.memory:>10.0f}"


def original(folder: Path) -> None:
    """Write a results folder of one run."""
    engine = registry.load("mujoco").engine
    head = campaign.header(("benchmark",), {"mujoco": engine}, {})
    case = load(CASE)
    case = replace(case, expectations=())
    with campaign.results((Task(case, "mujoco", Method.parse("RK4", TIMESTEP)),), folder, head):
        pass


def copies(source: Path, folder: Path, runs: int) -> None:
    """Write a results folder of copies of the run in another."""
    header, *records = map(json.loads, (source / store.RECORDS).read_text("utf-8").splitlines())
    truth, run = ({record["record"]: record for record in records}[kind] for kind in ("truth", "run"))
    text = header["cases"][0]["text"].partition("[[expect]]")[0] + ORDERED
    names = [f"{CASE}-{place}" for place in range(runs // RUNS_PER_CASE)]
    header["cases"] = [{"name": name, "text": text.replace(f'name = "{CASE}"', f'name = "{name}"')} for name in names]
    methods = [("RK4", TIMESTEP / by) for by in (1, 2, 4)]
    methods += [(f"RK4:copy={copy}", TIMESTEP) for copy in range(RUNS_PER_CASE - len(methods))]
    made: list[dict[str, Any]] = [header]
    for name in names:
        made += [{**truth, "case": name, "timestep": timestep} for timestep in (TIMESTEP, TIMESTEP / 2, TIMESTEP / 4)]
        made += [
            {**run, "case": name, "integrator": spelling, "timestep": timestep, "place": len(made)}
            for spelling, timestep in methods
        ]
    for record in made[1:]:
        file = folder / store._path_of(record)
        file.parent.mkdir(parents=True, exist_ok=True)
        os.link(source / store._path_of({**record, "case": CASE, "integrator": "RK4", "timestep": TIMESTEP}), file)
    made.append({"record": "footer", "records": len(made) - 1})
    (folder / store.RECORDS).write_text("".join(f"{json.dumps(record)}\n" for record in made), "utf-8")


def measure(folder: Path) -> Cost:
    """Measure the cost of the results in a folder."""
    instants = [time.process_time()]
    results = store.read(folder)
    runs = results.runs()
    assert len(results.cases) == len(runs) // RUNS_PER_CASE
    instants.append(time.process_time())
    assert all(results.run(run.key) is run for run in runs)
    instants.append(time.process_time())
    verdicts = judgement.judge(results)
    instants.append(time.process_time())
    judgement.records(verdicts)
    instants.append(time.process_time())
    reading, looking_up, judging, rows = (end - start for start, end in pairwise(instants))
    return Cost(len(runs), reading, looking_up, judging, rows, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)


def main() -> None:
    numbers = tuple(map(int, sys.argv[1:])) or NUMBERS
    print("µs a run, and MiB at the peak")
    print(
        "".join(
            f"{name:>{width}}"
            for name, width in zip(
                ("runs", "reading", "look-up", "judging", "rows", "memory"), (8, 12, 12, 12, 12, 10), strict=True
            )
        )
    )
    spawn = multiprocessing.get_context("spawn")
    with (
        tempfile.TemporaryDirectory() as place,
        ProcessPoolExecutor(1, mp_context=spawn, max_tasks_per_child=1) as processes,
    ):
        source = Path(place, "original")
        original(source)
        for number in numbers:
            folder = Path(place, str(number))
            copies(source, folder, number)
            print(processes.submit(measure, folder).result().text, flush=True)


if __name__ == "__main__":
    main()
