"""A results folder with motions, made without an engine: the truths of scenes, and runs that leave them slowly."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from bodycheck import load
from bodycheck.adapters.method import Method
from bodycheck.casefile.content import Case
from bodycheck.reference.kinematics import multiply
from bodycheck.reference.trajectory import Trajectory
from bodycheck.reference.truth import truth
from bodycheck.reference.truths import Truth
from bodycheck.results.outcome import Completed, Run
from bodycheck.results.store import Writer
from tests.site import submissions as made

TIMESTEP = 0.002

#: By which the same work is recognised.
IDENTITY = "made by a test"

#: A scene of each kind of animation: a body in flight, one that lies on a plane, bodies on joints, and bodies that touch.
SCENES = ("intermediate-axis-flip", "sliding-brick", "double-pendulum", "dropped-ball")


def write_folder(
    folder: Path,
    scenes: Sequence[str] = SCENES,
    engine: str = "mujoco",
    version: str = "4.0.0",
    angle: float = 0.5,
    **told: Any,
) -> Path:
    """Write a results folder in which an engine turns all bodies too far, by an angle (rad) at the end; return it.

    told: entries of the header.
    """
    cases = [load(name) for name in scenes]
    rows = []
    header: Any = made.header(**{"engines": {engine: version}, **told})
    for case in cases:
        errors = {"attitude_error": angle, "position_error": 0.01, "angular_velocity_error": 0.3}
        rows.append(made.run(case=case.name, engine=engine, version=version, **errors))
        rows.append(made.run(case=case.name, engine=engine, version=version, integrator="RK4"))
    made.write_folder(folder, {"results.csv": rows}, header)
    with Writer(folder, header, IDENTITY, tuple(cases)) as writer:
        for place, case in enumerate(cases):
            known = exact(case.name)
            writer.add_truth(case, TIMESTEP, known)
            writer.add_run(_run(case, known, engine, version, angle), place)
    return folder


@cache
def exact(name: str) -> Truth:
    """The truth of a shipped case, which is computed once for all tests of a process."""
    case = load(name)
    return truth(case.scene, case.instants)


def _run(case: Case, known: Truth, engine: str, version: str, angle: float) -> Run:
    done = Completed(turned(known.trajectory, angle), 1000, 0.1)
    return Run(case.name, engine, version, Method.parse("Euler", TIMESTEP), done, None, case.scene)


def turned(motion: Trajectory, angle: float) -> Trajectory:
    """A motion whose bodies are turned about the vertical by an angle (rad) that grows from zero, and are shifted by 1 cm."""
    share = motion.t / motion.t[-1]
    half = angle * share / 2
    turn = np.column_stack([np.cos(half), 0 * half, 0 * half, np.sin(half)])
    quaternion = np.broadcast_to(turn, motion.quaternion.shape)
    shift = 0.01 * share[:, None] * np.array([1.0, 0.0, 0.0])
    return replace(motion, quaternion=multiply(quaternion, motion.quaternion), position=motion.position + shift)
