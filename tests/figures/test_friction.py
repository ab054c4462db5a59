"""The speed below which friction is viscous, of planted motions whose friction is known by hand."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bodycheck.adapters.method import Method
from bodycheck.casefile.case import load
from bodycheck.casefile.content import Case
from bodycheck.figures.friction import VISCOUS, viscous_below
from bodycheck.judging.discrepancy import compare
from bodycheck.reference.trajectory import Trajectory
from bodycheck.reference.truth import truth
from bodycheck.results.outcome import Completed, Run


def measured(start: float, deceleration: float, viscous: float, samples: int) -> tuple[float | None, float]:
    """The figure of a run whose friction is viscous below a speed, and the change of speed in a sampling interval (m/s)."""
    stop = start / deceleration
    t = np.linspace(0, 2 * stop, samples)
    reaches = (start - viscous) / deceleration
    slow = viscous * np.exp(-deceleration / viscous * np.maximum(t - reaches, 0)) if viscous else 0 * t
    seen = np.where(t < reaches, start - deceleration * t, slow)
    exact = np.maximum(start - deceleration * t, 0)
    return viscous_below(t, seen, exact, 0.0, stop), deceleration * float(t[1])


@given(st.floats(0.1, 10), st.floats(0.1, 10), st.integers(200, 2000))
def test_friction_of_coulomb_is_nowhere_viscous(start: float, deceleration: float, samples: int) -> None:
    seen, _ = measured(start, deceleration, 0.0, samples)
    assert seen == 0


@given(st.floats(0.1, 10), st.floats(0.1, 10), st.floats(0.1, 0.9), st.integers(200, 2000))
def test_viscous_friction_is_measured_to_the_sampling(start: float, deceleration: float, part: float, samples: int) -> None:
    """Below the speed v1, the deceleration is a v/v1, so that its part is `VISCOUS` at the speed `VISCOUS` v1."""
    seen, change = measured(start, deceleration, part * start, samples)
    assert seen is not None
    # The mean over an interval is that of its middle, and the first speed of an interval is the one that counts.
    assert VISCOUS * part * start - change <= seen <= VISCOUS * part * start + 2 * change


def test_a_body_that_friction_does_not_brake_is_viscous_from_its_first_speed() -> None:
    t = np.linspace(0, 2, 101)
    assert viscous_below(t, np.full(101, 2.0), np.maximum(1 - t, 0), 0.0, 1.0) == 2.0


def test_a_deceleration_that_changes_has_no_figure() -> None:
    t = np.linspace(0, 2, 101)
    assert viscous_below(t, np.maximum(1 - t, 0), np.maximum(1 - t, 0) ** 2, 0.0, 1.0) is None


def figure(case: Case, factor: float = 1.0) -> float | None:
    """The figure of a run whose velocities are those of the truth, multiplied by a factor."""
    exact = truth(case.scene, case.instants)
    motion = exact.trajectory
    turned = Trajectory(motion.t, motion.position, motion.quaternion, factor * motion.velocity, motion.angular_velocity)
    run = Run(case.name, "engine", "1", Method("step", 1e-3), Completed(turned, len(motion), 1.0))
    return compare(exact, run).maxima().get("viscous_speed")


@pytest.mark.parametrize("name", ["sliding-brick", "ball-rolls-to-rest", "ball-slips-rolls-rests"])
def test_the_truth_of_constant_friction_is_not_viscous(name: str) -> None:
    assert figure(load(name)) == 0
    planted = figure(load(name), 0.8)  # eight tenths of the deceleration at all speeds
    assert planted is not None
    assert planted > 0.1


@pytest.mark.parametrize("name", ["curling-disk", "rolling-ball", "ball-on-ramp", "dropped-ball"])
def test_only_a_constant_friction_on_a_level_plane_that_stops_a_body_has_the_figure(name: str) -> None:
    assert figure(load(name)) is None


def test_the_deceleration_of_rolling_friction_is_that_of_the_last_motion() -> None:
    """The ball slips first, rolls then, and is braked by rolling friction alone at last, at mu_r g / (1.4 r)."""
    case = load("ball-slips-rolls-rests")
    exact = truth(case.scene, case.instants)
    (roll, rest) = (event for event in exact.events if event.kind in ("roll", "rest"))
    assert case.scene.plane is not None
    expected = case.scene.plane.rolling_friction * case.scene.gravity / (1.4 * case.scene.body.shape.radius)  # type: ignore[union-attr]
    assert math.isclose(math.hypot(*roll.velocity) / (rest.time - roll.time), expected, rel_tol=1e-9)
