"""Measure the cost of judging members of an ensemble together, beside that of judging each run alone.

A thousand members of the case mujoco-free-body, each with its own mass, size and start, run for two seconds with 101 samples.
The runs are the exact motions with a small error. Both ways are timed in one process, alternately, after a turn that warms up;
times are those of the processor.
Run: python benchmarks/ensemble_judging.py
"""

import statistics
import time
from dataclasses import replace
from datetime import date

import numpy as np

from bodycheck import Truth, load
from bodycheck.adapters.contract import Method
from bodycheck.casefile.expectation import Expectation, Limit
from bodycheck.judging.judgement import verdict
from bodycheck.judging.members import judged
from bodycheck.reference.bounds import NAMES, Bounds
from bodycheck.reference.flight.flights import Flights, flights
from bodycheck.reference.scenes import Scenes, vary
from bodycheck.reference.trajectory import Trajectory
from bodycheck.results.outcome import Completed, Run
from bodycheck.running.members.blocks import Flown
from bodycheck.running.states import trajectory_of

COUNT, SAMPLES, DURATION_S, TIMESTEP_S = 1000, 101, 2.0, 0.002

#: Runs that are judged alone, in each turn.
ALONE = 50

TURNS = 5

METHOD = Method.parse("Euler", TIMESTEP_S)
TODAY = date(2030, 1, 1)


def drawn() -> Scenes:
    """The members."""
    random = np.random.default_rng(1)
    values = {
        "mass": random.uniform(0.5, 2, COUNT),
        "semi_axes": random.uniform(0.05, 0.5, (COUNT, 3)),
        "quaternion": random.normal(0, 1, (COUNT, 4)),
        "velocity": random.normal(0, 2, (COUNT, 3)),
        "angular_velocity": random.normal(0, 3, (COUNT, 3)),
        "gravity": random.uniform(1, 10, COUNT),
    }
    return vary(load("mujoco-free-body").scene, values)


def flown(exact: Flights, steps: np.ndarray) -> Flown:
    """Runs of all members that differ from the exact motions a little."""
    motion = exact.trajectory
    states = np.concatenate([motion.position, motion.quaternion, motion.velocity, motion.angular_velocity], axis=-1)
    states[..., :3] += 1e-6 * motion.t[:, None]
    names = tuple(f"mujoco-free-body-{place}" for place in range(COUNT))
    return Flown("mujoco", "1.0", names, METHOD, steps, states, np.zeros(COUNT), 1.0, {})


def alone(scenes: Scenes, exact: Flights, runs: Flown, expectations: tuple[Expectation, ...], count: int) -> None:
    """Judge the first members one by one."""
    base, t = load("mujoco-free-body"), exact.trajectory.t
    for place in range(count):
        scene, whole = scenes.scene(place), exact.trajectory
        states = (whole.position, whole.quaternion, whole.velocity, whole.angular_velocity)
        bounds = Bounds(*(getattr(exact.bounds, name)[place] for name in NAMES))
        truth = Truth(scene, Trajectory(t, *(part[place] for part in states)), bounds, "", "", "")
        outcome = Completed(trajectory_of(runs.steps, METHOD, runs.states[place]), int(runs.steps[-1]), 1.0, None, 0.0)
        run = Run(runs.names[place], "mujoco", "1.0", METHOD, outcome, scene=scene)
        verdict(replace(base, scene=scene, expectations=expectations), truth, run, today=TODAY).row()


def main() -> None:
    scenes = drawn()
    steps = np.rint(np.linspace(0, DURATION_S, SAMPLES) / TIMESTEP_S).astype(np.int64)
    exact = flights(scenes, steps * TIMESTEP_S)
    runs = flown(exact, steps)
    for words, limit in (("no expectation", None), ("an expectation that all meet", 1.0), ("one that none meets", 1e-9)):
        expectations = () if limit is None else (Expectation("mujoco", METHOD, (Limit("position_error", None, limit),)),)
        together, single = [], []
        for _ in range(TURNS + 1):
            start = time.process_time()
            judged(scenes, exact, runs, METHOD, expectations, TODAY)
            middle = time.process_time()
            alone(scenes, exact, runs, expectations, ALONE)
            together.append((middle - start) / COUNT)
            single.append((time.process_time() - middle) / ALONE)
        cost, ratio = (
            statistics.median(together[1:]),
            statistics.median(a / b for a, b in zip(single[1:], together[1:], strict=True)),
        )
        print(
            f"{words}: {1e3 * cost:.3f} ms a member together, 1/{ratio:.0f} of that alone; {COUNT} members, {SAMPLES} samples"
        )


if __name__ == "__main__":
    main()
