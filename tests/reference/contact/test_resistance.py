"""Spheres with rolling and torsional friction: known numbers, two ways that agree, and faults that must be found."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from bodycheck.reference.certificate import certify
from bodycheck.reference.contact.motion import ContactMotion
from bodycheck.reference.contact.problem import problem
from bodycheck.reference.contact.resistance import motion as way
from bodycheck.reference.contact.ways import contact_motion
from bodycheck.reference.errors import NotModelled
from bodycheck.reference.scene import Body, Brick, Plane, Scene, State
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truth import computed
from tests.support.round_bodies import ball_on

Patch = pytest.MonkeyPatch
G, RADIUS = 9.81, 0.1
LYING = (0.0, 0.0, RADIUS)
ROLLING = State(LYING, velocity=(1.0, 0.0, 0.0), angular_velocity=(0.0, 10.0, 0.0))
FREE = State(LYING, velocity=(1.0, 0.3, 0.0), angular_velocity=(3.0, -20.0, 9.0))


def moved(plane: Plane, state: State, *times: float) -> ContactMotion:
    return contact_motion(problem(ball_on(plane, state)), np.array(times))


def speeds(motion: ContactMotion) -> Array:
    return np.linalg.norm(motion.velocity[0].astype(float), axis=1)


def test_a_ball_that_rolls_decelerates_by_its_rolling_friction() -> None:
    motion = moved(Plane(0.5, rolling_friction=2e-3), ROLLING, 1.0)
    assert 1 - speeds(motion)[0] == pytest.approx(2e-3 * G / (1.4 * RADIUS), rel=1e-14)
    assert 1 - speeds(motion)[0] == pytest.approx(0.140142857, rel=1e-8)


def test_one_cone_leaves_a_part_of_its_limit_to_the_slip() -> None:
    friction, rolling = 0.5, 2e-3
    motion = moved(Plane(friction, rolling_friction=rolling, cone="one"), ROLLING, 1.0, 1.5)
    fast = speeds(motion)
    deceleration = 2 * (fast[0] - fast[1])
    assert deceleration == pytest.approx(0.1401314, rel=1e-6)
    turning = motion.spin[0, 1, 1] * RADIUS
    slip = float(abs(motion.velocity[0, 1, 0] - turning) / turning)
    # The steady slip is (mu_r / mu)^2 (f / M) / r, with M = f r + I dw/dt, dw/dt = -deceleration (1 - slip) / r.
    share = 1 / (RADIUS * (1 + 0.4))
    assert slip == pytest.approx((rolling / friction) ** 2 * share / RADIUS, rel=1e-2)


@pytest.mark.parametrize(("cone", "factor"), [("product", 1.0), ("one", 1 / math.sqrt(1 + (0.05 / 0.5) ** 2))])
def test_rolling_friction_holds_up_to_its_slope(cone: Any, factor: float) -> None:
    steepest = math.atan(0.05 * factor)
    held, free = (Plane(0.5, rolling_friction=0.005, incline=steepest * part, cone=cone) for part in (1 - 1e-12, 1 + 1e-12))
    assert not speeds(moved(held, State(LYING), 10.0))[0]
    assert moved(held, State(LYING), 10.0).interfaces
    assert speeds(moved(free, State(LYING), 10.0))[0] > 0


@pytest.mark.parametrize("cone", ["product", "one"])
def test_torsional_friction_stops_a_spin(cone: Any) -> None:
    plane = Plane(0.5, rolling_friction=1e-3, torsional_friction=0.003, cone=cone)
    (rest,) = moved(plane, State(LYING, angular_velocity=(0.0, 0.0, 10.0)), 0.0, 5.0).events
    assert (rest.kind, rest.time) == ("rest", pytest.approx(10.0 * 0.4 * RADIUS**2 / (0.003 * G), rel=1e-14))


def test_a_ball_slips_and_rolls_and_rests() -> None:
    plane = Plane(0.2, rolling_friction=0.01)
    roll, rest = moved(plane, State(LYING, velocity=(1.0, 0.0, 0.0)), 0.0, 5.0).events
    # The moment of rolling friction brakes the rotation that friction drives.
    slowing = 0.2 * G + 2.5 * (0.2 - 0.1) * G
    assert (roll.kind, roll.time) == ("roll", pytest.approx(1 / slowing, rel=1e-14))
    assert rest.time - roll.time == pytest.approx((1 - 0.2 * G / slowing) * 1.4 / (0.1 * G), rel=1e-13)


def test_friction_keeps_a_ball_with_more_rolling_friction_from_rolling() -> None:
    motion = moved(Plane(0.2, rolling_friction=0.03), State(LYING, velocity=(1.0, 0.0, 0.0)), 0.2)
    assert speeds(motion)[0] == pytest.approx(1 - 0.2 * 0.2 * G, rel=1e-14)
    assert not motion.spin.any()


def test_without_slip_friction_needs_what_the_forces_are() -> None:
    motion = moved(Plane(math.inf, rolling_friction=2e-3), ROLLING, 1.0)
    assert motion.friction == pytest.approx(0.02 / 1.4, rel=1e-14)


#: One of each kind of motion.
KINDS = {
    "rolls": (Plane(0.5, rolling_friction=2e-3, torsional_friction=1e-3), ROLLING, 2.0),
    "across": (Plane(0.5, rolling_friction=0.03, torsional_friction=0.02), FREE, 0.3),
    "one cone": (Plane(0.5, rolling_friction=0.04, torsional_friction=0.02, cone="one"), FREE, 0.1),
    "one cone on an incline": (Plane(0.5, rolling_friction=0.04, incline=0.3, cone="one"), FREE, 0.1),
    "released": (Plane(0.5, rolling_friction=2e-3, incline=0.3, cone="one"), State(LYING), 2.0),
}


@pytest.mark.parametrize("kind", KINDS)
def test_both_ways_agree_within_their_bounds(kind: str) -> None:
    plane, state, last = KINDS[kind]
    found = certify(ball_on(plane, state), np.linspace(0.0, last, 5))
    assert found.faults == ()
    assert found.truth.bounds.position_error[-1] < 1e-13


def wrong_moment(patch: Patch) -> None:
    right = way.resisted
    patch.setattr(way, "resisted", lambda *given: replace(right(*given), ratio=right(*given).ratio * 5 / 3))


def product_for_one(patch: Patch) -> None:
    right = way.resisted
    patch.setattr(way, "resisted", lambda *given: replace(right(*given), one=False))


def no_rolling_friction(patch: Patch) -> None:
    right = way.resisted
    patch.setattr(way, "resisted", lambda *given: replace(right(*given), rolling=right(*given).rolling * 0))


@pytest.mark.parametrize(
    ("fault", "kind"),
    [(wrong_moment, "rolls"), (product_for_one, "released"), (no_rolling_friction, "rolls")],
    ids=["2/3 for 2/5", "product for one cone", "without rolling friction"],
)
def test_a_planted_fault_shows_in_full(fault: Any, kind: str, monkeypatch: Patch) -> None:
    plane, state, last = KINDS[kind]
    scene, times = ball_on(plane, state), np.linspace(0.0, last, 5)
    right = computed(scene, times).truth
    fault(monkeypatch)
    wrong = certify(scene, times)
    error = np.linalg.norm(wrong.truth.trajectory.position - right.trajectory.position, axis=-1)
    assert wrong.faults
    assert error[-1] > 1e-6
    assert (error <= 1.01 * wrong.truth.bounds.position_error).all()


@pytest.mark.parametrize(
    ("scene", "reason"),
    [
        (ball_on(Plane(0.5, rolling_friction=0.01), State((0.0, 0.0, 0.5))), "not on the plane at the start"),
        (ball_on(Plane(0.0, torsional_friction=0.01, cone="one"), State(LYING)), "one cone of friction without"),
        (
            Scene(Body(1.0, (0.1, 0.1, 0.1), Brick((0.1, 0.1, 0.1))), State(LYING), G, Plane(0.5, rolling_friction=0.01)),
            "of anything but one sphere",
        ),
    ],
)
def test_a_motion_without_a_known_law_is_refused(scene: Scene, reason: str) -> None:
    with pytest.raises(NotModelled, match=reason):
        contact_motion(problem(scene), np.array([0.0, 1.0]))
