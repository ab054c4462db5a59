"""Growth of an error: what two neighbouring motions in 80-bit arithmetic do."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck import load
from bodycheck.reference.kinematics import conjugate, multiply
from bodycheck.reference.scene import Body, Scene, State

pytest.importorskip("heyoka")

from bodycheck.reference.integration.sensitivity import ERROR_INSTANTS, growth
from bodycheck.reference.integration.taylor import euler_lagrange
from tests.support.euler_motion import quasi_coordinates

TIMES = np.linspace(0, 10, 101)
FLIP = load("intermediate-axis-flip").scene
TUMBLE = Scene(Body(1.0, (0.3, 0.45, 0.6)), State(angular_velocity=(2.0, 3.0, -4.0)))


def from_state(scene: Scene, quaternion: np.ndarray, angular_velocity: np.ndarray) -> Scene:
    w, x, y, z = quaternion.astype(float).tolist()
    p, q, r = angular_velocity.astype(float).tolist()
    return replace(scene, initial=State(quaternion=(w, x, y, z), angular_velocity=(p, q, r)))


@pytest.mark.parametrize("scene", [FLIP, TUMBLE], ids=["flip", "tumble"])
def test_growth_of_an_initial_error_is_that_between_neighbours(scene: Scene) -> None:
    rates = np.array(scene.initial.angular_velocity)
    speed, nudge = np.linalg.norm(rates), 1e-8
    columns = []
    for axis in np.eye(3):
        there, back = (
            quasi_coordinates(from_state(scene, np.array(scene.initial.quaternion), rates + step * speed * axis), TIMES)
            for step in (nudge, -nudge)
        )
        relative = multiply(there.quaternion, conjugate(back.quaternion))
        columns.append((2 * relative[:, 1:] * np.sign(relative[:, :1]) / (2 * nudge)).astype(float))
    expected = np.hypot(1, np.linalg.norm(np.stack(columns, axis=-1), ord=2, axis=(1, 2)))
    # Central differences: their error is the square of the nudge times what grows as the cube of the growth.
    np.testing.assert_allclose(growth(scene, TIMES).of_initial, expected, rtol=1e-6)


def test_growth_of_any_error_is_that_of_the_worst_restart() -> None:
    found = growth(FLIP, TIMES)
    starts = np.linspace(0, TIMES[-1], ERROR_INSTANTS)[::4]
    motion = euler_lagrange(FLIP, starts)
    worst = np.ones_like(TIMES)
    for start, quaternion, angular_velocity in zip(starts, motion.quaternion, motion.angular_velocity, strict=True):
        later = start <= TIMES
        restarted = growth(from_state(FLIP, quaternion, angular_velocity), TIMES[later] - start).of_initial
        worst[later] = np.maximum(worst[later], restarted)
    # A quarter of the origins misses part of what is found; the Frobenius norm adds at most a factor of sqrt(3).
    assert (found.of_any >= worst * (1 - 1e-6)).all()
    assert (found.of_any <= 2 * np.sqrt(3) * worst).all()


def test_a_sphere_turns_away_by_the_angle_turned() -> None:
    scene = Scene(Body(1.0, (0.4, 0.4, 0.4)), State(angular_velocity=(1.0, -2.0, 2.0)))
    # A turn at a constant rate, integrated in double precision: some tens of roundings.
    np.testing.assert_allclose(growth(scene, TIMES).of_initial, np.hypot(1, 3 * TIMES), rtol=1e-12)


def test_a_body_at_rest_keeps_its_error() -> None:
    scene = Scene(Body(1.0, (0.3, 0.45, 0.6)), State())
    assert (growth(scene, TIMES).of_initial == 1).all()
    assert (growth(scene, TIMES).of_any == 1).all()


def test_a_flip_amplifies_what_a_spin_does_not() -> None:
    spin = load("short-axis-spin").scene
    assert growth(spin, TIMES).of_any.max() < 200
    assert growth(FLIP, TIMES).of_any.max() > 1e4


def test_the_unstable_spin_grows_exponentially() -> None:
    a, b, c = 1.0, 2.0, 2.5
    scene = Scene(Body(1.0, (a, b, c)), State(angular_velocity=(0.0, 3.0, 0.0)))
    rate = 3 * np.sqrt((c - b) * (b - a) / (a * c))
    found = growth(scene, TIMES).of_initial
    # By t = 5 the growing direction is a thousand times the others.
    assert np.log(found[100] / found[50]) / (TIMES[100] - TIMES[50]) == pytest.approx(rate, rel=1e-3)


@pytest.mark.parametrize("times", [[], [0.0], [3.0, 1.0]])
def test_few_instants(times: list[float]) -> None:
    found = growth(TUMBLE, np.array(times))
    assert found.of_initial.shape == found.of_any.shape == (len(times),)
    assert (found.of_any >= found.of_initial * (1 - 1e-12)).all()


def test_beyond_every_digit_of_double_precision_it_is_still_a_number() -> None:
    scene = Scene(Body(1.0, (1.0, 2.0, 2.25)), State(angular_velocity=(1e-12, 3.0, -3e-13)))
    found = growth(scene, np.array([60.0]))
    assert np.isfinite(found.of_any).all()
    assert found.of_any > 1e16
