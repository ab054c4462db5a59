"""Compare what `bodycheck run` of robots costs in several checkouts of bodycheck, side by side.

    python benchmarks/robot_cost.py CASE [CASE ...] [--with EXECUTABLE ...] [--turns 1]

Each case is run with nine methods of MuJoCo, with an empty cache of compiled code, by this checkout and then by the executables
`bodycheck` of others, in turn. Printed are the processor time (s) of the command with all its processes, its elapsed time (s),
and the ratio of both to those of this checkout. The elapsed time depends on what else the machine does.
"""

import argparse
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

#: The nine methods: integrators and time steps (s).
INTEGRATORS, TIMESTEPS = ("Euler", "implicitfast", "RK4"), (0.002, 0.001, 0.0005)


def used(command: list[str], case: str) -> tuple[float, float]:
    """Return the processor time and the elapsed time (s) of a run of a case."""
    options = [word for name in INTEGRATORS for word in ("--integrator", name)]
    options += [word for step in TIMESTEPS for word in ("--timestep", str(step))]
    with tempfile.TemporaryDirectory() as folder:
        out, cache = Path(folder, "out"), Path(folder, "cache")
        cache.mkdir(mode=0o700)
        before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
        done = subprocess.run(
            [*command, "run", case, "--engine", "mujoco", *options, "--out", str(out), "--quiet"],
            env=os.environ | {"HEYOKA_CACHE_DIR": str(cache)},
            capture_output=True,
            check=False,
        )
        elapsed, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode not in (0, 1):  # 1: a method diverges in the motion
        raise SystemExit(done.stderr.decode())
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, elapsed


def main() -> None:
    """Print a line for each case and checkout."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", nargs="+", metavar="CASE")
    parser.add_argument("--with", dest="others", action="append", default=[], metavar="EXECUTABLE")
    parser.add_argument("--turns", type=int, default=1)
    arguments = parser.parse_args()
    checkouts = {"this checkout": [sys.executable, "-m", "bodycheck"], **{each: [each] for each in arguments.others}}
    for case in arguments.cases:
        costs: dict[str, list[tuple[float, float]]] = {name: [] for name in checkouts}
        for _ in range(arguments.turns):
            for name, command in checkouts.items():
                costs[name].append(used(command, case))
        medians = {name: [statistics.median(each) for each in zip(*pairs, strict=True)] for name, pairs in costs.items()}
        processor, elapsed = medians["this checkout"]
        for name, (theirs, lasted) in medians.items():
            print(
                f"{case} by {name}: {theirs:.1f} s of the processor, {lasted:.1f} s elapsed; "
                f"ratios {theirs / processor:.2f} and {lasted / elapsed:.2f}",
                flush=True,
            )


if __name__ == "__main__":
    main()
