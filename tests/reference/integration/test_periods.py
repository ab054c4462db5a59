"""One period of a rotation without torque gives any number of turns, whatever the guess of the period."""

import numpy as np
import pytest

from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.exact.start import start
from bodycheck.reference.flight.torque_free import half_period, polhode
from bodycheck.reference.integration.periods import inverse, periodic, product, searched_period
from bodycheck.reference.kinematics import conjugate, multiply
from bodycheck.reference.scene import Body, Scene, State, Vector
from bodycheck.reference.witness import angle_between

taylor = pytest.importorskip("bodycheck.reference.integration.taylor", reason="needs heyoka")

WIDE = np.longdouble
ROUNDING = float(np.finfo(WIDE).eps)

#: Allowed difference of the angular velocity after a period: far above rounding, far below a wrong period.
ALLOWED = 1e-14

TUMBLE = Scene(Body(1.0, (0.3, 0.45, 0.6)), State(angular_velocity=(2.0, 3.0, -4.0)))
FLIP = Scene(Body(1.0, (0.13, 0.05, 0.1)), State(angular_velocity=(0.1, 0.0, 10.0)))


def prepared(scene: Scene) -> tuple[taylor.Tumbling, np.ndarray, np.longdouble]:
    """The motion of a scene, the direction of its angular momentum, and its period."""
    begin = start(scene)
    motion = polhode(begin.moments, begin.rates)
    assert motion is not None
    return taylor.tumbling(begin, WIDE), taylor.momentum_axis(begin, WIDE), 2 * half_period(motion)


@pytest.mark.parametrize("scene", [TUMBLE, FLIP], ids=["tumble", "flip"])
def test_it_is_the_motion_that_is_followed_without_periods(scene: Scene) -> None:
    motion, axis, period = prepared(scene)
    times = np.sort(np.random.default_rng(1).uniform(0, 20 * float(period), 50))
    found, followed = periodic(motion, axis, period, times, ALLOWED), motion.follow(times)
    # Rounding in 200 rad of turning, which a flip amplifies some 1e4 times in a passage.
    assert angle_between(found.quaternion, followed.quaternion).max() < 1e-11
    assert np.abs(found.angular_velocity - followed.angular_velocity).max() < 1e-10


@pytest.mark.parametrize("wrong", [1e-15, 1e-9, 1e-3, -0.02])
@pytest.mark.parametrize("scene", [TUMBLE, FLIP], ids=["tumble", "flip"])
def test_a_wrong_guess_is_not_inherited(scene: Scene, wrong: float) -> None:
    motion, axis, period = prepared(scene)
    times = np.linspace(0, 1000 * float(period), 201)
    right = periodic(motion, axis, period, times, ALLOWED)
    found = periodic(motion, axis, period * WIDE(1 + wrong), times, ALLOWED)
    # Some roundings a period, which a flip amplifies some 1e4 times; the phase of a wrong guess of 1e-9 would be 1e-5 off.
    assert angle_between(found.quaternion, right.quaternion).max() < 1000 * 1e6 * ROUNDING


def test_a_whole_number_of_periods_is_a_turn_about_the_angular_momentum() -> None:
    motion, axis, period = prepared(TUMBLE)
    times = float(period) * np.array([0.3, 1000.3])
    found = periodic(motion, axis, period, times, ALLOWED)
    # The times are doubles, so that the phases differ by a rounding of 2000 s at 5 rad/s.
    assert np.abs(found.angular_velocity[1] - found.angular_velocity[0]).max() < 1e-11
    turn = multiply(found.quaternion[1], conjugate(found.quaternion[0]))[1:]
    assert np.abs(np.cross(turn, axis)).max() < 1e-11
    assert np.abs(turn).max() > 0.01


@pytest.mark.parametrize("rates", [(0.0, 0.0, 4.0), (0.0, 3.0, 0.0)], ids=["stable", "unstable"])
def test_of_a_steady_spin_any_time_is_a_period(rates: Vector) -> None:
    """Also about the axis of the middle moment, where rounding would grow by e in 0.8 s if it were followed."""
    begin = start(Scene(Body(1.0, (0.3, 0.45, 0.6)), State(angular_velocity=rates)))
    times, speed = np.array([500.0, 2000.0]), float(np.linalg.norm(rates))
    motion, axis = taylor.tumbling(begin, WIDE), taylor.momentum_axis(begin, WIDE)
    found = periodic(motion, axis, 0.7, times, 1e-12)
    expected = np.stack([np.cos(speed * times / 2), *(np.sin(speed * times / 2) * axis[:, None].astype(float))], axis=1)
    # The angles of some 1e4 rad are rounded to double.
    assert angle_between(found.quaternion, expected).max() < 1e-11


def test_the_period_is_found_without_a_guess_or_not_at_all() -> None:
    motion, axis, period = prepared(TUMBLE)
    assert searched_period(motion, 3.5 * float(period), WIDE) == pytest.approx(float(period), rel=0.01)
    with pytest.raises(OutOfReach, match="does not return"):
        searched_period(motion, 0.9 * float(period), WIDE)
    with pytest.raises(OutOfReach, match="no period near"):
        periodic(motion, axis, 0.3 * float(period), np.array([100.0]), ALLOWED)


def test_products_and_inverses_are_those_of_kinematics() -> None:
    p, q = np.random.default_rng(3).normal(size=(2, 10, 4))
    np.testing.assert_array_equal(product(p, q), multiply(p, q))
    np.testing.assert_array_equal(inverse(q), conjugate(q))
