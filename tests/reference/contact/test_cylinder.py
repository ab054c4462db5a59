"""A cylinder on its side against event-driven integration, its closed forms, and what it does not cover."""

import math
from dataclasses import replace

import numpy as np
import pytest

from bodycheck.reference.contact.problem import problem
from bodycheck.reference.contact.ways import contact_motion
from bodycheck.reference.errors import NotModelled
from bodycheck.reference.kinematics import geodesic_angle, normalise, rotate
from bodycheck.reference.scene import Plane, Quaternion, State
from tests.support.round_bodies import integrated, roller_on

#: K along y, so that the cylinder rolls downhill.
ACROSS: Quaternion = (math.sqrt(0.5), -math.sqrt(0.5), 0.0, 0.0)

#: DOP853 at its least tolerance leaves some hundred roundings of each of these numbers, of size 1 to 10.
TOLERANCE = 1e-12


def start(speed: float, spin: float, height: float = 0.1, rise: float = 0.0) -> State:
    return State((0.0, 0.0, height), ACROSS, (speed, 0.0, rise), (0.0, 0.0, spin))


@pytest.mark.parametrize(
    ("plane", "state"),
    [
        (Plane(0.3), start(2.0, -30.0)),
        (Plane(0.3, incline=0.4), start(-1.0, 5.0)),
        (Plane(0.1, incline=0.6), start(-1.0, 5.0)),
        (Plane(0.2, restitution=0.6), start(2.0, -30.0, 0.4)),
        (Plane(0.2, incline=0.3, restitution=0.6), start(1.0, 30.0, 0.4, 1.0)),
    ],
)
def test_a_motion_is_that_of_an_integration_with_events(plane: Plane, state: State) -> None:
    times = np.linspace(0.0, 0.9, 31)
    known = integrated(plane, state, times, ratio=0.5)
    found = contact_motion(problem(roller_on(plane, state)), times)
    here = ~np.isnan(known.position[:, 0])
    assert here.sum() > 20
    assert found.position[0, here] == pytest.approx(known.position[here], abs=TOLERANCE)
    assert found.velocity[0, here] == pytest.approx(known.velocity[here], abs=10 * TOLERANCE)
    assert rotate(found.quaternion[0], found.spin[0])[here] == pytest.approx(known.spin[here], abs=100 * TOLERANCE)
    assert geodesic_angle(found.quaternion[0, here].astype(float), normalise(known.quaternion[here])).max() < 10 * TOLERANCE


def test_it_slips_at_three_times_the_friction_and_then_rolls_at_two_thirds_of_the_speed() -> None:
    (roll,) = contact_motion(problem(roller_on(Plane(0.25), start(3.0, 0.0))), np.array([0.0, 1.0])).events
    assert roll.kind == "roll"
    assert roll.time == pytest.approx(3.0 / (3 * 0.25 * 9.81), rel=1e-15)
    assert roll.velocity == pytest.approx((2.0, 0.0, 0.0), rel=1e-15)


@pytest.mark.parametrize(
    ("friction", "acceleration"), [(0.2, 2 / 3 * math.sin(0.5)), (0.1, math.sin(0.5) - 0.1 * math.cos(0.5))]
)
def test_it_rolls_down_an_incline_up_to_three_times_the_friction(friction: float, acceleration: float) -> None:
    found = contact_motion(problem(roller_on(Plane(friction, incline=0.5), start(0.0, 0.0))), np.array([0.0, 2.0]))
    assert float(found.velocity[0, 1, 0]) == pytest.approx(2 * 9.81 * acceleration, rel=1e-15)


@pytest.mark.parametrize(
    ("incline", "state", "reason"),
    [
        (0.0, replace(start(1.0, 0.0), velocity=(1.0, 0.1, 0.0)), "moves along its axis"),
        (0.0, replace(start(1.0, 0.0), angular_velocity=(0.0, 1.0, 0.0)), "turns about another axis"),
        (0.3, State((0.0, 0.0, 0.1), (math.sqrt(0.5), 0.0, math.sqrt(0.5), 0.0)), "not perpendicular to the fall line"),
    ],
)
def test_what_does_not_move_across_the_axis_has_no_truth(incline: float, state: State, reason: str) -> None:
    with pytest.raises(NotModelled, match=reason):
        contact_motion(problem(roller_on(Plane(0.3, incline=incline), state)), np.zeros(1))
