"""The bounds of a flight with drag hold for random flights, against fifty digits, and show faults."""

import math
import sys
from collections.abc import Iterator
from dataclasses import replace
from importlib import import_module
from importlib.util import find_spec

import numpy as np
import pytest
from mpmath import mp, mpf

from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.flight.drag import translation as translation_module
from bodycheck.reference.flight.drag import witness as witness_module
from bodycheck.reference.flight.drag.translation import Translation, translation
from bodycheck.reference.flight.drag.witness import Witness, witness
from bodycheck.reference.scene import Body, Scene, State
from bodycheck.reference.trajectory import Array
from tests.support.exact_drag import DIGITS, exact

#: Size of a rounding to double precision, below which no error is expected to be.
ROUNDING = 2.0**-52


def random_flights(count: int, seed: int) -> Iterator[tuple[Scene, Array]]:
    """Scenes and instants: 1e-9 to 1e6 terminal speeds, sqrt(g c / m) T from 1e-9 to 1e4, one in four near the vertical."""
    rng = np.random.default_rng(seed)

    def size(low: float, high: float) -> float:
        return float(10 ** rng.uniform(low, high))

    for _ in range(count):
        mass, drag, gravity = size(-3, 3), size(-6, 2), size(-3, 3)
        terminal, relaxing = math.sqrt(mass * gravity / drag), math.sqrt(mass / (drag * gravity))
        speed, steepness = terminal * size(-9, 6) * (rng.random() > 0.05), rng.choice([1.0, 1.0, 1.0, size(-20, 0)])
        across = rng.normal(size=3) * [steepness, steepness, 1.0] * [1.0, rng.random() > 0.1, 1.0]
        if rng.random() < 0.05:
            across[:2] = 0.0
        velocity = tuple(float(part) for part in speed * across / np.linalg.norm(across))
        position = tuple(float(part) for part in rng.normal(size=3) * rng.choice([0.0, size(-3, 3)]))
        initial = State(position, velocity=velocity)  # type: ignore[arg-type]
        weight, end = gravity * (rng.random() > 0.05), relaxing * size(-9, 4)
        yield Scene(Body(mass, (1.0, 1.0, 1.0)), initial, weight, drag=drag), end * np.linspace(0, 1, 6)


def checked(found: Translation, scene: Scene, times: Array) -> tuple[Array, Array, bool]:
    """Ratios (n,) of bound to error or rounding, for position and velocity, and whether no bound is broken."""
    ratios, held = np.empty((2, len(times))), True
    for row, (position, velocity) in enumerate(exact(scene, times.tolist())):
        pairs = (found.position, found.position_error, position), (found.velocity, found.velocity_error, velocity)
        for kind, (values, bounds, truth) in enumerate(pairs):
            with mp.workdps(DIGITS):
                error = mp.norm([mpf(one) - other for one, other in zip(values[row].tolist(), truth, strict=True)])
                held &= error <= bounds[row]
                floor = max(float(error), ROUNDING * float(mp.norm(truth)))
            ratios[kind, row] = bounds[row] / floor if floor else 1.0
    return ratios[0], ratios[1], held


def extreme_flights(count: int, decades: int, seed: int) -> Iterator[tuple[Scene, Array]]:
    """Scenes and instants whose numbers are zero or of any size between so many decades below and above 1."""
    rng = np.random.default_rng(seed)

    def size() -> float:
        return float(10 ** rng.uniform(-decades, decades))

    for _ in range(count):
        velocity = [size() * float(rng.choice([-1.0, 0.0, 1.0])) for _ in range(3)]
        body, initial = Body(size(), (1.0, 1.0, 1.0)), State(velocity=(velocity[0], velocity[1], velocity[2]))
        gravity = size() * float(rng.choice([0.0, 1.0, 1.0, 1.0]))
        yield Scene(body, initial, gravity, drag=size()), size() * np.linspace(0, 1, 4)


def test_the_bounds_of_random_flights_hold() -> None:
    for scene, times in random_flights(10, seed=16):
        assert checked(translation(scene, times), scene, times)[2], scene


@pytest.mark.parametrize(("count", "decades"), [(5, 20), pytest.param(60, 100, marks=pytest.mark.slow)])
def test_the_bounds_hold_for_numbers_of_any_size(count: int, decades: int) -> None:
    for scene, times in extreme_flights(count, decades, seed=16):
        found = translation(scene, times)
        assert np.isfinite(found.position_error).all()
        assert np.isfinite(found.velocity_error).all()
        assert checked(found, scene, times)[2], scene


@pytest.mark.slow
def test_the_bounds_of_500_random_flights_hold_and_are_close() -> None:
    ratios, broken = [], []
    for scene, times in random_flights(500, seed=17):
        *both, held = checked(translation(scene, times), scene, times)
        ratios.append(both)
        broken += [] if held else [scene]
    points = [0.0, 0.01, 0.1, 0.5, 0.9, 0.99, 1.0]
    table = np.quantile(np.concatenate(ratios, axis=1), points, axis=1)
    for point, (position, velocity) in zip(points, table, strict=True):
        print(f"quantile {point:4}: bound over error {position:9.3g} (position) {velocity:9.3g} (velocity)")
    assert broken == []
    assert (table[points.index(0.5)] <= 100).all()


def ball(velocity: tuple[float, float, float] = (5.0, 0.0, 5.0)) -> Scene:
    """A ball of 4 g, which reaches its terminal velocity of 2 m/s within a second."""
    return Scene(Body(0.004, (1e-6, 1e-6, 1e-6)), State(velocity=velocity), 9.81, drag=0.0094)


def test_a_light_ball_falls_for_two_minutes() -> None:
    scene, times = ball(), np.linspace(0, 120, 1001)
    found = translation(scene, times)
    some = np.array([0, 1, 2, 5, 50, 1000])
    position, velocity = found.position[some], found.velocity[some]
    part = Translation(position, velocity, found.position_error[some], found.velocity_error[some], found.witnesses)
    assert checked(part, scene, times[some])[2]
    # Half a rounding to double precision, and a little for the wide type.
    assert (found.position_error <= 1e-15 * np.abs(found.position[-1]).max()).all()


#: Faults of a scene: factors of gravity and of drag.
FAULTS = {"gravity upwards": (-1.0, 1.0), "more gravity": (1 + 1e-9, 1.0), "more drag": (1.0, 1 + 1e-9)}


@pytest.mark.parametrize("velocity", [(5.0, 0.0, 5.0), (0.0, 0.0, 30.0), (1e-9, 0.0, 20.0), (0.0, 0.0, 0.0), (3e9, 1.0, 2e9)])
@pytest.mark.parametrize("fault", FAULTS)
@pytest.mark.parametrize("backend", ["heyoka", "scipy"])
def test_a_fault_in_one_of_the_two_ways_is_in_the_bounds(
    velocity: tuple[float, float, float], fault: str, backend: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A fault in either way is a difference between the two; it is planted in the witness."""
    if find_spec("heyoka") is None and backend == "heyoka":
        pytest.skip("heyoka is not installed")
    if find_spec("heyoka") is not None and backend == "scipy":
        without_heyoka(monkeypatch)
    scene, times = ball(velocity), np.linspace(0, 20, 41)
    sound = translation(scene, times)
    monkeypatch.setattr(translation_module, "witness", lambda scene, times: faulty(scene, times, fault))
    found = translation(scene, times)
    assert found.witnesses == sound.witnesses
    assert backend in found.witnesses[0]
    # The two agree within the error that the witness claims, so that the bounds are a rounding of 40 m and of 2 m/s.
    assert sound.position_error[-1] < 1e-14
    assert sound.velocity_error[-1] < 1e-15
    # Upwards, the ball is some 80 m off; 1e-9 of gravity or drag moves it by half of 1e-9 of its way down.
    least = 10.0 if fault == "gravity upwards" else 1e-9
    assert found.position_error[-1] > least
    assert found.velocity_error[-1] > least / 10


def without_heyoka(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the witness find no heyoka."""
    name = "bodycheck.reference.flight.drag.taylor_flight"
    import_module(name)  # so that there is an attribute to remove
    monkeypatch.delattr(name)
    monkeypatch.setitem(sys.modules, name, None)


def faulty(scene: Scene, times: Array, fault: str) -> Witness | None:
    """The witness of a scene with a fault."""
    gravity, drag = FAULTS[fault]
    if gravity > 0:
        return witness(replace(scene, gravity=scene.gravity * gravity, drag=scene.drag * drag), times)
    # Gravity upwards is gravity downwards in the scene upside down, turned back.
    x, y, z = scene.initial.velocity
    found = witness(replace(scene, initial=replace(scene.initial, velocity=(x, y, -z))), times)
    if found is None:
        return None
    over = np.array([1.0, 1.0, -1.0])
    turned = replace(found.motion, position=found.motion.position * over, velocity=found.motion.velocity * over)
    return replace(found, motion=turned)


def test_where_no_witness_can_follow_none_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise OutOfReach("too many steps")

    monkeypatch.setattr(witness_module, "cartesian", refuse)
    scene, times = ball(), np.linspace(0, 20, 41)
    found = translation(scene, times)
    assert found.witnesses == ()
    assert checked(found, scene, times)[2]


@pytest.mark.parametrize("times", [np.zeros(0), np.zeros(1), np.zeros(3)])
def test_no_duration_is_no_motion(times: Array) -> None:
    found = translation(ball(), times)
    assert found.position.shape == (len(times), 3)
    assert not found.position.any()
    np.testing.assert_array_equal(found.velocity, np.tile([5.0, 0.0, 5.0], (len(times), 1)))
