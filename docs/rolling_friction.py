"""Print the table of docs/contacts.md on rolling friction, in each engine that has it and by its settings.

Run: python docs/rolling_friction.py [ENGINE ...]
"""

import argparse
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import bodycheck
from bodycheck.judging.judgement import Verdict
from bodycheck.reference.trajectory import Trajectory
from bodycheck.results.outcome import Completed

RADIUS, GRAVITY, TIMESTEP_S = 0.1, 9.81, 0.001

#: The methods of each engine that has rolling friction.
METHODS = {
    "mujoco": (
        "Euler",
        "Euler:impratio=100",
        "Euler:cone=elliptic",
        "Euler:cone=elliptic,impratio=10",
        "Euler:cone=elliptic,impratio=100",
    ),
    "mjx": ("Euler", "Euler:cone=elliptic,impratio=100"),
    "mujoco_warp": ("Euler", "Euler:cone=elliptic,impratio=100"),
    "newton": ("MuJoCo-implicitfast", "MuJoCo-implicitfast:cone=elliptic,impratio=100", "XPBD:iterations=10"),
    "pybullet": ("multibody", "multibody:settings=engine"),
}

#: The span in which the deceleration is measured (s), after the ball has sunk into the contact.
BEGIN, END = 0.3, 0.5

#: The part of the rolling friction below which friction is called viscous, and the span of a mean deceleration (s).
VISCOUS, MEAN = 0.9, 0.1


@dataclass(frozen=True)
class Rolling:
    """A ball that rolls: its rolling friction (m), its first speed (m/s), and the duration of the run (s)."""

    coefficient: float
    speed: float
    duration: float

    @property
    def name(self) -> str:
        """The name of the case."""
        return f"rolling-{round(self.coefficient * 1e6)}-{round(self.speed * 1e3)}-{round(self.duration * 1e3)}"

    @property
    def exact(self) -> float:
        """The deceleration of rolling friction (m/s^2)."""
        return self.coefficient * GRAVITY / (1.4 * RADIUS)

    def text(self) -> str:
        """Return the text of the case."""
        return f"""format = 1
name = "{self.name}"
title = "Ball that rolls"
source = "rolling friction"
[body]
shape = "sphere"
radius = {RADIUS}
mass = 1.0
[initial]
velocity = [{self.speed}, 0.0, 0.0]
angular_velocity = [0.0, {self.speed / RADIUS!r}, 0.0]
[scene]
gravity = {GRAVITY}
[scene.plane]
friction = 0.5
rolling_friction = {self.coefficient!r}
[run]
duration = {self.duration}
samples = {round(self.duration / MEAN) + 1}
"""


#: The balls whose deceleration is measured, and the one that rolls until it stops.
MEASURED = tuple(Rolling(coefficient, speed, END) for coefficient in (2e-3, 1e-4) for speed in (1.0, 0.1))
STOPPING = Rolling(2e-3, 1.0, 8.6)


def part(ball: Rolling, motion: Trajectory) -> float:
    """Return the deceleration over that of rolling friction."""
    first, last = (int(np.argmin(abs(motion.t - time))) for time in (BEGIN, END))
    speeds = motion.velocity[..., 0].ravel()
    return float((speeds[first] - speeds[last]) / (motion.t[last] - motion.t[first]) / ball.exact)


def viscous_speed(ball: Rolling, motion: Trajectory) -> float:
    """Return the speed (m/s) below which the ball decelerates by less than a part of its rolling friction."""
    speeds = motion.velocity[..., 0].ravel()
    slowing = -np.diff(speeds) / np.diff(motion.t) / ball.exact
    late = np.flatnonzero((slowing < VISCOUS) & (motion.t[:-1] > BEGIN))
    return float(speeds[late[0]]) if len(late) else 0.0


def verdicts(engine: str) -> Iterator[tuple[str, str, Verdict]]:
    """Yield the methods, the names of the cases and the verdicts of an engine."""
    with tempfile.TemporaryDirectory() as folder:
        paths = []
        for ball in (*MEASURED, STOPPING):
            paths.append(Path(folder) / f"{ball.name}.case.toml")
            paths[-1].write_text(ball.text())
        results = bodycheck.run(
            list(map(str, paths)),
            engine=engine,
            integrator=METHODS[engine],
            timestep=TIMESTEP_S,
            out=Path(folder) / "results",
            allow_missing=True,
        )
        for verdict in results.verdicts:
            yield verdict.run.method.name, verdict.run.case, verdict


def motion(verdict: Verdict) -> Trajectory:
    """Return the motion of a run."""
    outcome = verdict.run.outcome
    assert isinstance(outcome, Completed), outcome.reason
    return outcome.states if isinstance(outcome.states, Trajectory) else outcome.states.read()


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("engines", nargs="*", metavar="ENGINE", help="engines; all with rolling friction, without any")
    engines = parser.parse_args().engines or list(METHODS)
    heads = [f"μ_r = {ball.coefficient:g} m at {ball.speed:g} m/s" for ball in MEASURED]
    columns = ["engine", "method", *heads, f"viscous below, m/s, μ_r = {STOPPING.coefficient:g} m"]
    print(f"| {' | '.join(columns)} |\n|{' --- |' * len(columns)}")
    for engine in engines:
        motions = {(method, case): motion(verdict) for method, case, verdict in verdicts(engine)}
        for method in METHODS[engine]:
            parts = [f"{part(ball, motions[method, ball.name]):.3f}" for ball in MEASURED]
            viscous = viscous_speed(STOPPING, motions[method, STOPPING.name])
            print(f"| {engine} | {method} | {' | '.join(parts)} | {viscous:.2g} |", flush=True)


if __name__ == "__main__":
    main()
