"""Rapier's scheme, its own settings, its two models of friction, and what it does with a state that is not finite."""

import math
from dataclasses import replace

import numpy as np
import pytest

from bodycheck import load
from bodycheck.adapters import registry
from bodycheck.adapters.contract import EngineReset, Method
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.scene import Body, Scene, State
from bodycheck.reference.trajectory import Array
from tests.support.orders import observed_order

RAPIER = registry.load("rapier")
PLAIN, COULOMB, OWN = "symplectic-euler", "symplectic-euler:friction=coulomb", "symplectic-euler:settings=engine"
TUMBLING = Scene(Body(2.0, (0.3, 0.4, 0.6)), State(angular_velocity=(3.0, 1.0, 2.0), velocity=(0.0, 2.0, 0.0)))

#: The distance between neighbouring numbers of single precision at 1.
EPSILON = float(np.finfo(np.float32).eps)


def rows(scene: Scene, spelling: str, timestep: float, strides: list[int]) -> Array:
    """The states (n, 13) of a scene after each of n strides."""
    return RAPIER.prepare([scene], Method.parse(spelling, timestep)).advance(np.array(strides))[0, :, 0]


@pytest.mark.parametrize("case", ["intermediate-axis-flip", "football-drag"])
def test_the_scheme_is_of_first_order(case: str) -> None:
    orders = observed_order(RAPIER, load(case).scene, PLAIN, (8e-3, 4e-3, 2e-3), 1.0)
    # Smaller steps would leave the error to single precision. At these the next term of the error, of second order, is up to an
    # eighth of the first, and a difference of 1e-4 rad in 1e-2 rad is rounding. A scheme of second order would be at 2.
    np.testing.assert_allclose(list(orders.values()), 1, atol=0.25)


def test_a_step_is_that_which_the_adapter_says() -> None:
    """The angular momentum in the body frame keeps its length, and the attitude turns by 2 atan(h |w| / 2)."""
    h, moments = 0.01, np.array(TUMBLING.body.moments)
    spin = np.array(TUMBLING.initial.angular_velocity)
    momentum = moments * spin
    after = momentum - h * np.cross(spin, momentum)
    world = after * np.linalg.norm(momentum) / np.linalg.norm(after) / moments
    row = rows(TUMBLING, PLAIN, h, [1])[0]
    np.testing.assert_allclose(rotate(row[3:7], row[10:]), world, rtol=0, atol=20 * EPSILON)
    turned = np.array([1.0, *(h * world / 2)])
    np.testing.assert_allclose(row[3:7], turned / np.linalg.norm(turned), rtol=0, atol=4 * EPSILON)
    # Without the scaling the momentum would grow by a relative h^2 / 2 = 5e-5 or so, which is 400 roundings.
    length = np.linalg.norm(moments * row[10:])
    assert length == pytest.approx(np.linalg.norm(momentum), rel=20 * EPSILON)


def test_rapiers_own_settings_are_substeps_and_limits() -> None:
    h = 0.01
    falling = Scene(Body(2.0, (0.3, 0.3, 0.3)), State(), gravity=10.0)
    for spelling, substeps in ((PLAIN, 1), (OWN, 4)):
        last = rows(falling, spelling, h, [100])[0]
        # Symplectic Euler falls g T h / 2 too far, h being the substep; a hundred positions of some metres are rounded.
        assert last[2] == pytest.approx(-5 - 10 * h / 2 / substeps, abs=100 * 5 * EPSILON)
    fast = replace(falling, gravity=0.0, initial=State(velocity=(500.0, 0.0, 0.0), angular_velocity=(0.0, 0.0, 100.0)))
    # Each of the 40 substeps rounds once or twice.
    free, limited = rows(fast, PLAIN, h, [10])[0], rows(fast, OWN, h, [10])[0]
    np.testing.assert_allclose(free[[7, 12]], [500, 100], rtol=20 * EPSILON)
    np.testing.assert_allclose(limited[[7, 12]], [400, math.pi / 4 / h], rtol=40 * EPSILON)


def test_a_straight_slide_ends_where_it_must_with_rapiers_default_friction_alone() -> None:
    scene, h = load("sliding-brick").scene, 1e-3
    exact = 2.0**2 / (2 * 0.5 * 9.81)
    last = rows(scene, PLAIN, h, [700])[0]
    # Symplectic Euler misses v0 h / 2; while the brick sinks into the soft contact, its load is up to 0.1 % off.
    assert last[0] == pytest.approx(exact - 2.0 * h / 2, abs=1e-4)
    assert 0.0498 < last[2] < 0.05
    # The friction cones of Rapier's corners brake this brick by a sixth less, as the adapter says.
    assert rows(scene, COULOMB, h, [700])[0, 0] > 1.1 * exact


@pytest.mark.parametrize("spelling", [PLAIN, COULOMB, OWN])
def test_a_pure_spin_stops_as_with_four_corners(spelling: str) -> None:
    case, h = load("spinning-brick-corners"), 1e-3
    exact = 0.05 / 3 / (0.5 * 9.81 * math.hypot(0.1, 0.2)) * 10.0  # C w0 / (mu m g r), with C = m (a^2 + b^2) / 3
    states = rows(case.scene, spelling, h, [1] * 200)
    moving = np.flatnonzero(np.abs(states[:, 12]) > 0.05)
    # A step and a half at the start, where the soft contact begins to bear, and the step within which the spin ends.
    assert (moving[-1] + 1) * h == pytest.approx(exact, abs=2.5 * h)


def test_a_cylinder_lies_on_its_face() -> None:
    """The axis of Rapier's own cylinders is y; the disk would stand on its edge, 0.13 m too low, and be thrown up."""
    scene = load("curling-disk").scene
    states = rows(scene, PLAIN, 1e-3, [10] * 20)
    # It sinks by a tenth of a millimetre into the soft contact.
    np.testing.assert_allclose(states[:, 2], scene.initial.position[2], atol=2e-4)
    np.testing.assert_allclose(states[:, 4:6], 0, atol=1e-4)


def test_a_body_that_rapier_quarantines_was_reset() -> None:
    """The largest number of single precision is 3.4e38, which the position exceeds in the second step of a second."""
    scene = replace(TUMBLING, initial=State(velocity=(3e38, 0.0, 0.0)))
    with pytest.raises(EngineReset, match="quarantined") as signal:
        rows(scene, PLAIN, 1.0, [1, 1, 1])
    assert 1 <= signal.value.states.shape[1] <= 3
