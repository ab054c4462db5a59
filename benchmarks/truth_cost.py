"""Measure the cost of a truth: SciPy's DOP853, heyoka's 80-bit Taylor series and the closed form on ten seconds of the flip.

All are timed in one process, alternately, after a first turn that warms up, each for a tenth of a second per turn and at least
once. The simpler closed forms of motions that are simpler than a flip are timed in the same way. The cost of the first truth is
measured in a new process with an empty cache of compiled code and in one with a full cache. Finally, ten thousand closed forms
of random bodies are computed. Run: python benchmarks/truth_cost.py
"""

import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from bodycheck import load
from bodycheck.reference import truth, witnesses
from bodycheck.reference.flight import closed_form
from bodycheck.reference.independent import closed_form as second_closed_form
from bodycheck.reference.integration import lagrangian, taylor
from bodycheck.reference.scene import Body, Scene, State

TURNS = 11

#: Time of each way in a turn.
SHARE_S = 0.1

#: Random bodies whose closed form is computed.
MANY = 10_000

#: Program that prints the cost (s) of the first truth in a process.
FIRST = """
import time
from bodycheck import load
from bodycheck.reference.integration import taylor
case = load("intermediate-axis-flip")
start = time.perf_counter()
taylor.euler_lagrange(case.scene, case.instants)
print(time.perf_counter() - start)
"""


def drag_costs() -> None:
    """Print the cost of the truth of a thrown ball with drag for three durations, with 1001 samples, warm."""
    thrown = Scene(Body(0.4, (1.0, 1.0, 1.0)), State(velocity=(10.0, 0.0, 10.0)), 9.81, drag=0.01)
    relaxing = (thrown.body.mass / (thrown.drag * thrown.gravity)) ** 0.5
    for duration in (1.0, 100.0, 1e4):
        times = np.linspace(0, duration * relaxing, 1001)
        costs = []
        for _ in range(TURNS + 1):
            start = time.perf_counter()
            truth.truth(thrown, times)
            costs.append(time.perf_counter() - start)
        print(f"drag, sqrt(g c / m) T = {duration:g}: {statistics.median(costs[1:]) * 1e3:.2f} ms, median of {TURNS} turns")


def main() -> None:
    case = load("intermediate-axis-flip")
    scene, times = case.scene, case.instants
    ways: dict[str, Callable[[], object]] = {
        "DOP853, Euler-Lagrange": lambda: lagrangian.integrate(scene, times),
        "80-bit, Euler-Lagrange": lambda: taylor.euler_lagrange(scene, times),
        "closed form": lambda: closed_form.flight(scene, times).motion,
        "DOP853, with its bound": lambda: truth.truth(scene, times, witnesses.dop853()),
        "80-bit, with its bound": lambda: truth.truth(scene, times),
        "no rotation": lambda: closed_form.flight(replace(scene, initial=State()), times).motion,
        "steady turn": lambda: closed_form.flight(replace(scene, body=Body(1.0, (0.1, 0.1, 0.1))), times).motion,
        "symmetric top": lambda: closed_form.flight(replace(scene, body=Body(1.0, (0.1, 0.1, 0.15))), times).motion,
        "second closed form": lambda: second_closed_form.witness(scene, times),
    }
    compared = ["DOP853, Euler-Lagrange"] * 3 + ["DOP853, with its bound"] * 2 + ["closed form"] * 4
    costs: dict[str, list[float]] = {name: [] for name in ways}
    for turn in range(TURNS + 1):
        for name, way in ways.items():
            calls, start = 0, time.perf_counter()
            while calls == 0 or time.perf_counter() - start < SHARE_S:
                way()
                calls += 1
            if turn:  # the first turn warms up
                costs[name].append((time.perf_counter() - start) / calls)

    print(f"{case.name}, {len(times)} samples, warm, median of {TURNS} turns")
    for name, reference in zip(ways, compared, strict=True):
        ratio = statistics.median(b / a for a, b in zip(costs[name], costs[reference], strict=True))
        print(f"{name:24} {statistics.median(costs[name]) * 1e3:8.2f} ms, 1/{ratio:.1f} of {reference}")

    exact = taylor.euler_lagrange(scene, times, "quadruple").quaternion
    for name in (*list(ways)[:3], "second closed form"):
        error = taylor.attitude_difference(ways[name]().quaternion, exact).max()  # type: ignore[attr-defined]
        print(f"{name:24} {error:8.1e} rad from the 128-bit run")

    with tempfile.TemporaryDirectory() as cache:
        for state in ("empty", "full"):
            done = subprocess.run(
                [sys.executable, "-c", FIRST],
                env=os.environ | {"HEYOKA_CACHE_DIR": cache},
                capture_output=True,
                text=True,
                check=True,
            )
            print(f"first 80-bit truth of a process, cache of compiled code {state}: {float(done.stdout) * 1e3:.0f} ms")

    drag_costs()

    rng = np.random.default_rng(1)
    start = time.perf_counter()
    for _ in range(MANY):
        x, y, z = rng.uniform(0.05, 1, 3)
        body = Body(1.0, (y * y + z * z, x * x + z * z, x * x + y * y))
        p, q, r = rng.normal(0, 5, 3)
        tumble = Scene(body, State(angular_velocity=(p, q, r)))
        closed_form.flight(tumble, times)
    print(f"{MANY} closed forms of random bodies, {len(times)} samples each, with bounds: {time.perf_counter() - start:.1f} s")


if __name__ == "__main__":
    main()
