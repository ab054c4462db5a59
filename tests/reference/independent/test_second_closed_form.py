"""The second closed form: against integration, multiprecision and the laws of conservation, and faults that it sees."""

import json
import math
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from bodycheck.casefile.case import parse
from bodycheck.reference.bounds import STATES, Bounds
from bodycheck.reference.flight import closed_form as truth
from bodycheck.reference.independent.arithmetic import WIDE_EPS, WideArray
from bodycheck.reference.independent.closed_form import NAME, witness
from bodycheck.reference.independent.directions import quaternion_of
from bodycheck.reference.integration import quasi_coordinates
from bodycheck.reference.kinematics import conjugate, multiply, normalise, rotate
from bodycheck.reference.scene import Body, Quaternion, Scene, State, Vector
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.witness import Witness, angle_between, excess
from bodycheck.reference.witnesses import backend, witnesses
from tests.reference.flight import integer_series
from tests.reference.flight.integer_series import ONE, fixed
from tests.support.multiprecision.arithmetic import MP, cross, dot, norm, vector
from tests.support.multiprecision.flight import read
from tests.support.random_cases import REGIMES, drawn

EPS = float(np.finfo(float).eps)
UPRIGHT = (1.0, 0.0, 0.0, 0.0)


def spinning(moments: Vector, rates: Vector, quaternion: Quaternion = UPRIGHT, axes: Quaternion = UPRIGHT) -> Scene:
    return Scene(Body(1.0, moments, axes=axes), State(quaternion=quaternion, angular_velocity=rates))


#: Motions of every kind, along principal axes, and instants at which integers of 200 bits can follow them.
DECADE = np.array([0.0, 0.7, 10.0])
CASES = {
    "about the least moment": (spinning((1.0, 1.5, 1.7), (3.0, 0.1, -0.2)), DECADE),
    "about the greatest moment": (spinning((1.0, 1.5, 1.7), (-0.1, 0.2, -3.0)), DECADE),
    "unnormalised attitude": (spinning((1.7, 1.0, 1.5), (1.0, 2.0, 3.0), (0.3, -2.0, 0.5, 0.1)), DECADE),
    "one rate zero": (spinning((1.0, 1.5, 1.7), (-2.0, -1.0, -0.0)), DECADE),
    "A = B": (spinning((1.0, 1.0, 1.7), (1.0, 1.0, 3.0)), DECADE),
    "B = C": (spinning((1.0, 2.0, 2.0), (1.0, 2.0, 3.0)), DECADE),
    "nearly A = B": (spinning((1.0, math.nextafter(1.0, 2.0), 1.7), (1.0, 2.0, 3.0)), DECADE),
    "nearly a sphere": (spinning((1.0, 1.0 + 4 * EPS, 1.0 + EPS), (1.0, 2.0, 3.0)), DECADE),
    "disc": (spinning((0.5, 0.75, 1.25), (1.0, 2.0, 3.0)), DECADE),
    "needle": (spinning((1e-12, 1.0, 1.0), (1.0, 2.0, 3.0)), DECADE),
    "needle spun about its length": (spinning((1e-9, 1.0, 1.0 + 3e-10), (1e3, 2.0, 3.0)), np.array([0.001, 0.03])),
    "sphere": (spinning((0.4, 0.4, 0.4), (1.0, 2.0, 3.0)), DECADE),
    "middle axis": (spinning((1.0, 2.0, 2.5), (0.0, -3.0, 0.0)), DECADE),
    "at rest": (spinning((1.0, 2.0, 2.5), (0.0, 0.0, 0.0)), DECADE),
    # I1 (I2 - I1) = 1 and I3 (I3 - I2) = 0.75^2, all exact in binary.
    "separatrix": (spinning((1.0, 2.0, 2.25), (0.75, 1.0, 1.0)), DECADE),
    "separatrix, towards -J": (spinning((2.0, 1.0, 2.25), (1.0, 0.75, 1.0)), DECADE),
    "just outside the separatrix": (spinning((1.0, 2.0, 2.25), (math.nextafter(0.75, 1), 1.0, 1.0)), 6 * DECADE),
    "just inside the separatrix": (spinning((1.0, 2.0, 2.25), (math.nextafter(0.75, 0), 1.0, 1.0)), 6 * DECADE),
    "almost the middle axis": (spinning((1.0, 2.0, 2.25), (1e-12, 3.0, -3e-13)), 6 * DECADE),
}

#: Motions that leave the unstable axis after hundreds of its time constants, or never within the time.
NEARLY_STEADY = {
    "the smallest deviation there is": spinning((1.0, 2.0, 2.25), (5e-324, 1.0, 0.0)),
    "two very small deviations": spinning((1.0, 2.0, 2.25), (1e-320, 1.0, 1e-300)),
    "no deviation in a turned frame": spinning((1.0, 2.0, 2.25), (0.0, 1.0, 0.0), axes=(0.0, 0.6, 0.0, 0.8)),
}

#: Motions of some hundred thousand rad, through which no integration steps at a reasonable cost, and the last instant (s).
LONG = {
    "near the separatrix": (spinning((1.0, 2.0, 2.25), (1e-12, 3.0, -3e-13), (0.1, 0.2, 0.3, 0.9)), 1e5),
    "a million rad": (spinning((0.3, 0.2, 0.4), (50.0, 20.0, -70.0), (0.5, 0.5, -0.5, 0.5), (0.6, 0.0, 0.8, 0.0)), 11000.0),
}


def real(value: np.longdouble) -> object:
    """A number of the wide type in multiprecision."""
    numerator, denominator = value.as_integer_ratio()
    return MP.mpf(numerator) / denominator


def exact(value: np.longdouble) -> Fraction:
    """A number of the wide type as a fraction."""
    return Fraction(*value.as_integer_ratio())


def angle_from(attitude: list[int], quaternion: WideArray) -> float:
    """Angle (rad) between an attitude in fixed point and one in the wide type (4,)."""
    w, x, y, z = attitude
    a, b, c, d = (fixed(exact(part)) for part in quaternion)
    scalar = w * a + x * b + y * c + z * d
    vector = (w * b - x * a - y * d + z * c, w * c + x * d - y * a - z * b, w * d - x * c + y * b - z * a)
    return 2 * math.atan2(math.isqrt(sum(part * part for part in vector)) / ONE**2, abs(scalar) / ONE**2)


@pytest.mark.parametrize(("scene", "times"), CASES.values(), ids=CASES)
def test_error_is_within_its_bound(scene: Scene, times: Array) -> None:
    """Against 200-bit integers. Their angular velocities are rounded to double precision."""
    found = witness(scene, times)
    assert found.quaternion is not None
    assert found.angular_velocity is not None
    states = integer_series.witness(scene, times)
    angles = [angle_from(attitude, quaternion) for (attitude, _), quaternion in zip(states, found.quaternion, strict=True)]
    assert np.all(np.array(angles) <= found.error)
    rates = np.array([rates for _, rates in states])
    apart = np.abs(rates - found.angular_velocity).max(axis=1)
    assert np.all(apart <= found.angular_velocity_error + EPS * np.abs(rates).max())


@pytest.mark.parametrize("regime", REGIMES)
def test_error_is_within_its_bound_for_bodies_in_files(regime: str) -> None:
    """Against the multiprecision motion of the numbers of the file, to 1e6 rad of turning."""
    text, times = drawn(regime, 7)
    found, states = witness(parse(text, regime).scene, np.array(times)), read(text).motion(times)
    assert found.quaternion is not None
    assert found.angular_velocity is not None
    for n, state in enumerate(states):
        w, *v = [real(part) for part in found.quaternion[n]]
        w0, *v0 = state.quaternion
        across = vector(v0) * w - vector(v) * w0 - cross(vector(v), vector(v0))
        angle = 2 * MP.atan2(norm(across), abs(w * w0 + dot(vector(v), vector(v0))))
        assert angle <= np.broadcast_to(found.error, len(states))[n]
        apart = vector([real(part) for part in found.angular_velocity[n]]) - state.angular_velocity
        assert norm(apart) <= found.angular_velocity_error


@pytest.mark.skipif(WIDE_EPS == EPS, reason="no type wider than double precision")
@pytest.mark.parametrize(("scene", "end"), LONG.values(), ids=LONG)
def test_its_own_error_stays_far_below_double_precision(scene: Scene, end: float) -> None:
    found, speed = witness(scene, np.array([0.0, end])), float(np.linalg.norm(scene.initial.angular_velocity))
    # 1e-18 for each rad of turning is what ten roundings of the wide type cost.
    assert np.max(found.error) <= 1e-16 + 3e-18 * speed * end
    assert np.max(found.angular_velocity_error) <= 1e-15 * speed


def test_agrees_with_an_integration_in_a_turned_frame() -> None:
    scene = spinning((1.0, 1.5, 2.1), (2.0, 0.3, -1.0), (0.1, 0.7, -0.1, 0.7), (0.2, -0.4, 0.8, 0.4))
    times = np.linspace(0.0, 4.0, 9)
    found = witness(scene, times)
    assert found.quaternion is not None
    assert found.angular_velocity is not None
    # The integration knows principal axes alone: it gets the rates along them, and its attitudes are turned back.
    axes = normalise(np.array(scene.body.axes))
    p, q, r = rotate(conjugate(axes), np.array(scene.initial.angular_velocity)).tolist()
    along = quasi_coordinates.integrate(spinning(scene.body.moments, (p, q, r)), times)
    before = np.tile(multiply(normalise(np.array(scene.initial.quaternion)), axes), (len(times), 1))
    attitude = multiply(multiply(before, along.quaternion), np.tile(conjugate(axes), (len(times), 1)))
    # DOP853 at a relative tolerance of 2.3e-14 is good to some 1e-13 after a few turns.
    assert angle_between(attitude, found.quaternion).max() < 1e-12
    rates = rotate(np.tile(axes, (len(times), 1)), along.angular_velocity)
    np.testing.assert_allclose(found.angular_velocity.astype(float), rates, atol=1e-12)


@pytest.mark.parametrize(
    ("scene", "end"), [*((scene, 1e4) for scene, _ in CASES.values()), *LONG.values()], ids=[*CASES, *LONG]
)
def test_energy_and_angular_momentum_are_conserved(scene: Scene, end: float) -> None:
    found = witness(scene, np.linspace(0.0, end, 201))
    assert found.quaternion is not None
    assert found.angular_velocity is not None
    axes = np.tile(normalise(np.array(scene.body.axes, dtype=np.longdouble)), (201, 1))
    rates, moments = rotate(conjugate(axes), found.angular_velocity), np.array(scene.body.moments)
    energy = (moments * rates * rates).sum(axis=1)
    momentum = rotate(found.quaternion, rotate(axes, moments * rates))
    # A bound of the angle also bounds the relative changes; forming the two costs a few roundings.
    allowed = np.max(found.error) + 32 * WIDE_EPS
    assert np.ptp(energy) <= 2 * allowed * energy[0]
    length = np.sqrt((momentum[0] ** 2).sum())
    assert np.sqrt(((momentum - momentum[0]) ** 2).sum(axis=1)).max() <= 2 * allowed * length


def test_on_the_separatrix_the_body_ends_in_a_spin_about_the_middle_axis() -> None:
    scene, times = spinning((1.0, 2.0, 2.25), (0.75, 1.0, 1.0)), np.array([0.0, 1.0, 20.0, 1e6])
    found = witness(scene, times)
    assert found.angular_velocity is not None
    # sn = tanh: L2 = |L| tanh(u0 + lambda t), since L^2 = 2 T I2.
    length = math.hypot(0.75, 2.0, 2.25)
    rate = length / 2 * math.sqrt(1.0 * 0.25 / (1.0 * 2.25))
    expected = length / 2 * np.tanh(math.atanh(2.0 / length) + rate * times)
    np.testing.assert_allclose(found.angular_velocity[:, 1].astype(float), expected, rtol=8 * EPS)
    assert np.abs(found.angular_velocity[-1, [0, 2]]).max() < 1e-100


def test_the_order_of_the_times_does_not_matter() -> None:
    scene, times = LONG["a million rad"][0], np.linspace(-3.0, 10.0, 27)
    shuffled = np.random.default_rng(0).permutation(27)
    forward, anyhow = witness(scene, times), witness(scene, times[shuffled])
    assert forward.quaternion is not None
    assert anyhow.quaternion is not None
    np.testing.assert_array_equal(forward.quaternion[shuffled], anyhow.quaternion)
    empty = witness(scene, np.array([])).quaternion
    assert empty is not None
    assert empty.shape == (0, 4)


def test_every_rotation_matrix_becomes_its_quaternion() -> None:
    exact_ones = [(1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1)]
    q = np.concatenate([exact_ones, np.random.default_rng(0).normal(size=(100, 4))]).astype(np.longdouble)
    q = normalise(q)
    columns = [rotate(q, np.tile(axis, (len(q), 1)).astype(np.longdouble)) for axis in np.eye(3)]
    assert angle_between(quaternion_of(np.stack(columns, axis=2)), q).max() <= 32 * WIDE_EPS


def test_without_a_wider_type_the_bound_grows_and_holds() -> None:
    """What a machine would do whose long double is a double: the same code with the wide type taken away."""
    scene, times = LONG["a million rad"][0], [0.0, 1.0, 100.0, 10000.0]
    program = f"""
import json
import numpy as np
np.longdouble = np.float64
from bodycheck.reference.independent.closed_form import witness
from bodycheck.reference.scene import Body, Scene, State
body = Body(1.0, {scene.body.moments}, axes={scene.body.axes})
initial = State(quaternion={scene.initial.quaternion}, angular_velocity={scene.initial.angular_velocity})
found = witness(Scene(body, initial), np.array({times}))
print(json.dumps([found.quaternion.tolist(), found.error.tolist()]))
"""
    output = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout
    quaternion, limit = json.loads(output)
    here = witness(scene, np.array(times))
    assert here.quaternion is not None
    apart = angle_between(np.array(quaternion), here.quaternion)
    assert np.all(apart <= here.error + np.array(limit))
    assert 1e-14 < limit[1] < 1e-12


# Faults planted in the truth: for motions through which no integration steps, the second closed form sees them.


def with_a_slow_clock(scene: Scene, times: Array) -> Trajectory:
    found = truth.flight(scene, times * (1 + 1e-9)).motion
    return replace(found, t=times)


def with_rates_of_the_wrong_sign(scene: Scene, times: Array) -> Trajectory:
    found = truth.flight(scene, times).motion
    return replace(found, angular_velocity=-found.angular_velocity)


def with_a_smaller_moment(scene: Scene, times: Array) -> Trajectory:
    a, b, c = scene.body.moments
    return truth.flight(replace(scene, body=replace(scene.body, moments=(0.75 * a, b, c))), times).motion


FAULTS: dict[str, tuple[Callable[[Scene, Array], Trajectory], str]] = {
    "clock times 1 + 1e-9": (with_a_slow_clock, "error"),
    "rates with the wrong sign": (with_rates_of_the_wrong_sign, "angular_velocity_error"),
    "moment A times 3/4": (with_a_smaller_moment, "error"),
}


def beyond_both_bounds(scene: Scene, motion: Trajectory, own: Bounds, seen: Witness) -> dict[str, float]:
    found = excess(scene, motion, own, seen)
    return {name: float(getattr(found, name).max()) for name in STATES}


@pytest.mark.parametrize(("scene", "end"), LONG.values(), ids=LONG)
@pytest.mark.parametrize(("fault", "figure"), FAULTS.values(), ids=FAULTS)
def test_a_fault_of_the_truth_is_seen(scene: Scene, end: float, fault: Callable[..., Trajectory], figure: str) -> None:
    times = np.linspace(0.0, end, 101)
    own, seen = truth.flight(scene, times).bounds, witness(scene, times)
    # Each fault moves the body by far more than a thousandth of what the clock loses, 1e-9 of the angle.
    assert beyond_both_bounds(scene, fault(scene, times), own, seen)[figure] > 1e-12 * end


@pytest.mark.parametrize(
    ("scene", "end"),
    [*((scene, 1e4) for scene in (*(scene for scene, _ in CASES.values()), *NEARLY_STEADY.values())), *LONG.values()],
    ids=[*CASES, *NEARLY_STEADY, *LONG],
)
def test_the_truth_is_not_contradicted(scene: Scene, end: float) -> None:
    times = np.linspace(0.0, end, 101)
    found = truth.flight(scene, times)
    assert set(beyond_both_bounds(scene, found.motion, found.bounds, witness(scene, times)).values()) == {0.0}


def test_it_stands_in_where_integrations_fail_or_lose_digits() -> None:
    def named(scene: Scene, end: float) -> bool:
        return NAME in [way.name for way in witnesses(scene, np.linspace(0.0, end, 5), backend())]

    assert named(*LONG["near the separatrix"])
    # For a second the integrations are good to some 1e-15 rad. Later the first of these motions has come by the unstable axis.
    wobbling = spinning((1.0, 2.0, 2.25), (1e-5, 3.0, 1e-5))
    assert named(wobbling, 30.0)
    assert not named(spinning((1.0, 1.5, 2.1), (2.0, 0.3, -1.0)), 1.0)
