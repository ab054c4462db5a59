"""Symptoms of bodies that touch: a push that gives energy is none, and a bounce that gives energy is one."""

from dataclasses import replace

import numpy as np

from bodycheck.reference.bounds import Bounds
from bodycheck.reference.scene import Body, Plane, Push, Scene, Sphere, State
from bodycheck.reference.trajectory import Trajectory
from bodycheck.reference.truths import Truth
from bodycheck.results.outcome import Completed
from bodycheck.studies.extremes.diagnosis import diagnose

T = np.linspace(0, 2, 41)
PUSHED = Scene(
    Body(1.0, (0.004, 0.004, 0.004), Sphere(0.1)), State((0.0, 0.0, 0.1)), 9.81, Plane(0.0), pushes=(Push((2.0, 0.0, 0.0)),)
)


def moved(pull: float, sunk: float = 0.0) -> Trajectory:
    """A ball that a force moves along x without friction, at 2 m/s^2 times a factor, and below its place."""
    zero, rest = np.zeros((41, 3)), np.tile([1.0, 0.0, 0.0, 0.0], (41, 1))
    position = np.column_stack([pull * T**2, 0 * T, 0.1 - sunk + 0 * T])
    return Trajectory(T, position, rest, np.column_stack([2 * pull * T, 0 * T, 0 * T]), zero)


def found(seen: Trajectory, exact: Trajectory) -> tuple[str, str]:
    bounds = Bounds(*[np.where(np.isnan(exact.position[:, 0]), np.nan, 0.0)] * 6)
    told = diagnose(PUSHED, Completed(seen, 40, 1.0), Truth(PUSHED, exact, bounds, "", "", ""))
    return told.status, told.detail


def test_a_push_gives_energy_and_what_is_more_is_gained() -> None:
    assert found(moved(1.0), moved(1.0))[0] == "ok"
    # Work 2 N x, energy 1.05^2 (2 t)^2 / 2 J: 0.42 J more in the end than work, of 0.98 J.
    status, text = found(moved(1.05), moved(1.05))
    assert status == "energy-gain"
    assert "energy up by 0.428" in text


def test_depth_and_distance_are_symptoms() -> None:
    assert found(moved(1.0, 0.0005), moved(1.0))[0] == "ok"
    status, text = found(moved(1.0, 0.005), moved(1.0))
    assert status == "inaccurate"
    assert "sinks 0.005 m into the plane" in text
    assert "a body is 0.4 m off after a path of 4 m" in found(moved(0.9), moved(1.0))[1]


def test_without_a_motion_of_truth_the_rest_is_judged() -> None:
    exact = moved(1.0)
    none = replace(exact, position=exact.position * np.nan, quaternion=exact.quaternion * np.nan)
    status, text = found(exact, none)
    assert status == "ok"
    assert "mechanics gives no motion to compare with" in text
