"""The bounds that a slide states of its own error hold against extended precision and exact arithmetic."""

import math
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
import pytest

from bodycheck.reference.errors import OutOfReach, WouldTip
from bodycheck.reference.inertia import principal_moments
from bodycheck.reference.scene import Body, Brick, Cylinder, Plane, Scene, State
from bodycheck.reference.sliding.motion import slide
from bodycheck.reference.trajectory import Array
from tests.support.wide_slides import friction_of, wide_slide

KINDS = ("position", "yaw", "velocity", "yaw rate")
PLANES = (
    ("brick", "area", "uniform"),
    ("brick", "area", "balanced"),
    ("brick", "corners", "uniform"),
    ("brick", "corners", "balanced"),
    ("disk", "area", "uniform"),
    ("disk", "area", "balanced"),
)


@dataclass(frozen=True, eq=False)
class Held:
    """Errors and bounds (n, 4) of position, yaw, velocity and yaw rate at n instants."""

    errors: Array
    bounds: Array

    @property
    def broken(self) -> Array:
        return np.asarray((self.errors > self.bounds).sum(axis=0))

    def ratios(self) -> Array:
        """Bound over max(error, 2^-52)."""
        return np.asarray(self.bounds / np.maximum(self.errors, 2.0**-52))


def lying(kind: str, rng: np.random.Generator, law: str, pressure: str) -> Scene:
    """A random body that slides and spins: speeds from 1 cm/s to 30 m/s, spins whose rim is as fast within a factor of 1000."""
    size, speed = 10 ** rng.uniform(-2, 0.5), 10 ** rng.uniform(-2, 1.5)
    height = size * 10 ** rng.uniform(-2, -0.5)
    shape = Cylinder(size, height) if kind == "disk" else Brick((size, size * 10 ** rng.uniform(-1, 0), height))
    spin = speed / size * 10 ** rng.uniform(-1.5, 1.5) * rng.choice([-1, 1])
    heading, yaw = rng.uniform(0, 2 * np.pi, 2)
    state = State(
        (*rng.normal(size=2).tolist(), height),
        (math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2)),
        (speed * math.cos(heading), speed * math.sin(heading), 0.0),
        (0.0, 0.0, float(spin)),
    )
    plane = Plane(float(rng.uniform(0.05, 0.8)), law, pressure)  # type: ignore[arg-type]
    return Scene(Body(2.0, principal_moments(shape, 2.0), shape), state, 9.81, plane)


def against_extended_precision(scene: Scene, count: int = 40) -> Held:
    """Errors and bounds of a slide while it moves, next to the stop, and at rest."""
    exact = wide_slide(scene)
    accelerations, k = friction_of(scene)
    stop = float(exact.stop[0])
    # Down to a distance from the stop at which an instant, rounded to a double, still has four digits.
    moving = exact.times < stop * (1 - 1e-12)
    chosen = np.unique(np.linspace(0, moving.sum() - 1, count).astype(int))
    near = stop * (1 + np.array([0.0, 2e-16, 1e-15, 1e-14, 1e-9, 1.0]))
    times = np.concatenate([exact.times[chosen].astype(float), near])
    found = slide(scene, times)
    # From the nearest instant of the exact slide to the instant as a double: a rounding away.
    rows, late = exact.rows[chosen], (times[: len(chosen)] - exact.times[chosen])[:, None]
    metric = np.array([1, 1, k])
    braking = accelerations(rows[:, 2], rows[:, 3:] * metric) / metric
    rows = np.concatenate([rows[:, :3] + late * rows[:, 3:], rows[:, 3:] + late * braking], axis=1)
    # A rounding away from the stop, the body slows down along the last direction of the exact slide.
    last = exact.rows[-1, 3:] / (exact.stop[0] - exact.times[-1])
    left = np.maximum(exact.stop[0] - near.astype(np.longdouble), 0)[:, None]
    ends = np.concatenate([exact.stop[1:] - left * left * last / 2, left * last], axis=1)
    rows = np.concatenate([rows, ends])
    q = found.trajectory.quaternion.astype(np.longdouble)
    w, _, _, z = map(np.longdouble, scene.initial.quaternion)
    half = (rows[:, 2] - 2 * np.arctan2(z, w)) / 2
    expected = np.stack([np.cos(half) * w - np.sin(half) * z, np.cos(half) * z + np.sin(half) * w])
    got = q[:, [0, 3]].T
    turned = 2 * np.abs(np.arctan2(expected[0] * got[1] - expected[1] * got[0], (expected * got).sum(axis=0)))
    turned = np.minimum(turned, 2 * np.pi - turned)
    trajectory = found.trajectory
    errors = np.stack(
        [
            np.hypot(*(trajectory.position[:, :2] - rows[:, :2]).T),
            turned,
            np.hypot(*(trajectory.velocity[:, :2] - rows[:, 3:5]).T),
            np.abs(trajectory.angular_velocity[:, 2] - rows[:, 5]),
        ],
        axis=1,
    )
    bounds = [found.position_error, found.error, found.velocity_error, found.angular_velocity_error]
    return Held(errors.astype(float), np.stack(bounds, axis=1))


def test_a_coupled_slide_keeps_its_bounds() -> None:
    rng = np.random.default_rng(3)
    held = against_extended_precision(lying("brick", rng, "corners", "uniform"))
    np.testing.assert_array_equal(held.broken, 0)
    assert (held.errors.max(axis=0) > 0).all()


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "law", "pressure"), PLANES)
def test_no_random_slide_breaks_a_bound(kind: str, law: str, pressure: str) -> None:
    """Eleven slides of every face, law and pressure; the collocation in 80 bits agrees with itself to 1e-18."""
    rng = np.random.default_rng([2, PLANES.index((kind, law, pressure))])
    ratios = []
    for _ in range(11):
        held = against_extended_precision(possible(kind, rng, law, pressure))
        np.testing.assert_array_equal(held.broken, 0)
        ratios.append(held.ratios())
    print("bound over max(error, 2^-52), quantiles 0, 1, 10, 50, 90, 99, 100 %:", *KINDS)
    print(np.quantile(np.concatenate(ratios), [0, 0.01, 0.1, 0.5, 0.9, 0.99, 1], axis=0))


def possible(kind: str, rng: np.random.Generator, law: str, pressure: str) -> Scene:
    """A random slide in which the body does not tip and no corner comes to rest before the others."""
    while True:
        scene = lying(kind, rng, law, pressure)
        try:
            slide(scene, np.array([0.0, 1e9]))
        except (WouldTip, OutOfReach):
            continue
        return scene


@pytest.mark.parametrize("pressure", ["uniform", "balanced"])
@pytest.mark.parametrize("law", ["area", "corners", "decoupled"])
def test_straight_slides_keep_their_bounds_against_exact_arithmetic(law: str, pressure: str) -> None:
    """v0 = 5 w in the direction (3, 4)/5, with w a double: every quantity of the exact slide is rational."""
    if (law, pressure) == ("decoupled", "balanced"):
        pytest.skip("this pressure has no meaning under this law")
    rng = np.random.default_rng(5)
    for _ in range(20):
        unit, mu = float(rng.uniform(0.1, 3)), float(rng.uniform(0.05, 0.5))
        # 3 and 4 times a double of 50 digits are doubles.
        unit = float(np.round(unit * 2**40)) / 2**40
        shape = Brick((0.3, 0.2, 0.01))
        state = State((1.0, -2.0, 0.01), (1.0, 0.0, 0.0, 0.0), (3 * unit, 4 * unit, 0.0))
        scene = Scene(Body(1.5, principal_moments(shape, 1.5), shape), state, 9.81, Plane(mu, law, pressure))  # type: ignore[arg-type]
        speed, braking = 5 * Fraction(unit), Fraction(mu) * Fraction(9.81)
        stop = float(speed / braking)
        times = np.array([0.0, *(stop * rng.uniform(0, 1, 20)), stop * (1 - 1e-15), stop, stop * (1 + 1e-15), 2 * stop])
        times.sort()
        found = slide(scene, times)
        for i, time in enumerate(times.tolist()):
            now = min(Fraction(time), speed / braking)
            way, left = speed * now - braking * now * now / 2, speed - braking * now
            position, velocity = found.trajectory.position[i], found.trajectory.velocity[i]
            off = [Fraction(float(position[0])) - 1 - way * 3 / 5, Fraction(float(position[1])) + 2 - way * 4 / 5]
            slower = [Fraction(float(velocity[0])) - left * 3 / 5, Fraction(float(velocity[1])) - left * 4 / 5]
            assert math.hypot(*map(float, off)) <= found.position_error[i]
            assert math.hypot(*map(float, slower)) <= found.velocity_error[i]
        assert found.velocity_error[-1] == found.angular_velocity_error[-1] == 0


def test_the_pure_spin_on_corners_keeps_its_bounds_against_exact_arithmetic() -> None:
    """Half-lengths 0.75 and 1: the corners are at 5/4, and C/m is 25/48, so that the deceleration is mu g 12/5."""
    shape = Brick((0.75, 1.0, 0.125))
    state = State((0.0, 0.0, 0.125), (1.0, 0.0, 0.0, 0.0), angular_velocity=(0.0, 0.0, 7.0))
    scene = Scene(Body(1.0, principal_moments(shape, 1.0), shape), state, 9.81, Plane(0.3, "corners"))
    braking = Fraction(0.3) * Fraction(9.81) * Fraction(12, 5)
    stop = 7 / braking
    times = np.array([*np.linspace(0, float(stop), 30), 1.5 * float(stop)])
    found = slide(scene, times)
    for i, time in enumerate(times.tolist()):
        now = min(Fraction(time), stop)
        turn, left = float(7 * now - braking * now * now / 2), float(7 - braking * now)
        q = found.trajectory.quaternion[i]
        # The turn as a double is 1e-15 rad off, a tenth of the bound, and stays below pi times 2 only modulo a full turn.
        apart = 2 * math.atan2(q[3], q[0]) - turn
        assert abs(apart - 2 * math.pi * round(apart / (2 * math.pi))) <= found.error[i]
        assert abs(found.trajectory.angular_velocity[i, 2] - left) <= found.angular_velocity_error[i]
