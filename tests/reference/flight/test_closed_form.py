"""The closed form against Taylor series in 200-bit integers, against the integrators, and against what mechanics demands."""

import json
import math
import subprocess
import sys
from dataclasses import replace
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.flight.closed_form import flight, flip_period
from bodycheck.reference.inertia import principal_moments
from bodycheck.reference.integration import quasi_coordinates
from bodycheck.reference.kinematics import geodesic_angle, multiply, normalise, rotate
from bodycheck.reference.scene import Body, Brick, Quaternion, Scene, State, Vector
from bodycheck.reference.trajectory import Array, Trajectory
from tests.reference.flight.integer_series import ONE, angle_between, fixed, taylor_step, witness

EPS = float(np.finfo(float).eps)
WIDE_EPS = float(np.finfo(Wide).eps)
UPRIGHT = (1.0, 0.0, 0.0, 0.0)
FLIP = Scene(
    Body(1.0, principal_moments(Brick((0.1, 0.3, 0.2)), 1.0)),
    State(quaternion=(math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0), angular_velocity=(0.1, 0.0, 10.0)),
)


def spinning(moments: Vector, rates: Vector, quaternion: Quaternion = UPRIGHT) -> Scene:
    return Scene(Body(1.0, moments), State(quaternion=quaternion, angular_velocity=rates))


def motion(scene: Scene, times: Array) -> Trajectory:
    return flight(scene, times).motion


def bound(scene: Scene, times: Array) -> Array:
    return flight(scene, times).bounds.error


def errors(scene: Scene, times: Array) -> tuple[Array, Array]:
    """Attitude errors (n,), rad, and errors of the body rates (n,), relative to the largest, of the closed form."""
    trajectory, states = motion(scene, times), witness(scene, times)
    attitude = [angle_between(exact, got) for (exact, _), got in zip(states, trajectory.quaternion, strict=True)]
    rates = [np.abs(exact - got).max() for (_, exact), got in zip(states, trajectory.angular_velocity, strict=True)]
    fastest = max(np.abs(exact).max() for _, exact in states)
    return np.array(attitude), np.array(rates) / (fastest or 1.0)


def test_the_witness_conserves_energy_and_length() -> None:
    scene = spinning((1.0, 2.0, 2.5), (1.0, 2.0, 0.5))
    a, b, c = map(Fraction, scene.body.moments)
    ratios = [fixed((b - c) / a), fixed((c - a) / b), fixed((a - b) / c)]
    rates, attitude = [fixed(Fraction(rate) / 4) for rate in scene.initial.angular_velocity], [ONE, 0, 0, 0]

    def energy() -> Fraction:
        return sum((moment * rate**2 for moment, rate in zip((a, b, c), rates, strict=True)), Fraction(0)) / ONE**2

    before = energy()
    for _ in range(20):
        rates, attitude = taylor_step(ratios, rates, attitude, ONE // 2)
    assert abs(energy() - before) < Fraction(1, 2**160)
    assert abs(sum(Fraction(part, ONE) ** 2 for part in attitude) - 1) < Fraction(1, 2**160)


def test_the_witness_agrees_with_a_128_bit_integrator() -> None:
    heyoka = pytest.importorskip("heyoka")
    real = heyoka.real128
    p, q, r, w, x, y, z = heyoka.make_vars("p", "q", "r", "w", "x", "y", "z")
    a, b, c = (heyoka.par[n] for n in range(3))
    system = [(p, (b - c) * q * r / a), (q, (c - a) * r * p / b), (r, (a - b) * p * q / c)]
    system += [(w, (-x * p - y * q - z * r) / 2), (x, (w * p + y * r - z * q) / 2)]
    system += [(y, (w * q + z * p - x * r) / 2), (z, (w * r + x * q - y * p) / 2)]
    integrator = heyoka.taylor_adaptive(
        system,
        [real(value) for value in (*FLIP.initial.angular_velocity, *FLIP.initial.quaternion)],
        pars=[real(moment) for moment in FLIP.body.moments],
        fp_type=real,
        compact_mode=True,
    )
    integrator.propagate_until(real(3.0))
    ((exact, _),) = witness(FLIP, np.array([3.0]))
    for part, got in zip(exact, integrator.state[3:], strict=True):
        head = float(got)
        # 128 bits have 34 digits, of which some tens of steps and the turn of 30 rad lose three.
        assert abs(Fraction(part, ONE) - Fraction(head) - Fraction(float(got - real(head)))) < 1e-30


# The closed form against the witness.

DECADE = np.array([0.0, 1.0, 10.0])
CASES = {
    "flip": (FLIP, DECADE),
    "free brick": (spinning(principal_moments(Brick((0.1, 0.2, 0.3)), 1.0), (0.1, 0.0, 10.0)), DECADE),
    "box benchmark": (spinning((0.8083333, 0.6833333, 0.1416667), (0.1, 5.0, 0.1)), DECADE),
    "about the least moment": (spinning((1.0, 1.5, 1.7), (3.0, 0.1, -0.2)), DECADE),
    "about the greatest moment": (spinning((1.0, 1.5, 1.7), (0.1, 0.2, 3.0)), DECADE),
    "unnormalised attitude": (spinning((1.7, 1.0, 1.5), (1.0, 2.0, 3.0), (0.3, -2.0, 0.5, 0.1)), DECADE),
    "one rate zero": (spinning((1.0, 1.5, 1.7), (-2.0, -1.0, -0.0)), DECADE),
    "A = B": (spinning((1.0, 1.0, 1.7), (1.0, 2.0, 3.0)), DECADE),
    "B = C": (spinning((1.0, 2.0, 2.0), (1.0, 2.0, 3.0)), DECADE),
    "A = C": (spinning((1.3, 1.0, 1.3), (1.0, -2.0, 3.0)), DECADE),
    "nearly A = B": (spinning((1.0, math.nextafter(1.0, 2.0), 1.7), (1.0, 2.0, 3.0)), DECADE),
    "nearly a sphere": (spinning((1.0, 1.0 + 4 * EPS, 1.0 + EPS), (1.0, 2.0, 3.0)), DECADE),
    "tossed coin": (spinning((0.25, 0.25 + 1e-9, 0.5), (5.0, 3.0, 1e-3)), DECADE),
    "disc": (spinning((0.5, 0.75, 1.25), (1.0, 2.0, 3.0)), DECADE),
    "needle": (spinning((1e-12, 1.0, 1.0), (1.0, 2.0, 3.0)), DECADE),
    "needle spun about its length": (spinning((1e-9, 1.0, 1.0 + 3e-10), (1e3, 2.0, 3.0)), np.array([0.001, 0.03])),
    "sphere": (spinning((0.4, 0.4, 0.4), (1.0, 2.0, 3.0)), DECADE),
    "middle axis": (spinning((1.0, 2.0, 2.5), (0.0, -3.0, 0.0)), DECADE),
    "at rest": (spinning((1.0, 2.0, 2.5), (0.0, 0.0, 0.0)), DECADE),
    # I1 (I2 - I1) = 1 and I3 (I3 - I2) = 0.75^2, all exact in binary.
    "separatrix": (spinning((1.0, 2.0, 2.25), (0.75, 1.0, 1.0)), DECADE),
    "separatrix, towards -J": (spinning((1.0, 2.0, 2.25), (-0.75, 1.0, 1.0)), DECADE),
    "just outside the separatrix": (spinning((1.0, 2.0, 2.25), (math.nextafter(0.75, 1), 1.0, 1.0)), 6 * DECADE),
    "just inside the separatrix": (spinning((1.0, 2.0, 2.25), (math.nextafter(0.75, 0), 1.0, 1.0)), 6 * DECADE),
    "almost the middle axis": (spinning((1.0, 2.0, 2.25), (1e-12, 3.0, -3e-13)), 6 * DECADE),
}


@pytest.mark.parametrize(("scene", "times"), CASES.values(), ids=CASES)
def test_error_is_within_the_bound(scene: Scene, times: Array) -> None:
    attitude, rates = errors(scene, times)
    assert np.all(attitude <= bound(scene, times))
    # The rates are found from the same phase; their own rounding is what the attitude's bound allows, in units of the largest.
    assert np.all(rates <= bound(scene, times))


@pytest.mark.skipif(WIDE_EPS == EPS, reason="no type wider than double precision")
@pytest.mark.parametrize("scene", [scene for scene, _ in CASES.values()], ids=CASES)
def test_bound_is_near_what_double_precision_can_store(scene: Scene) -> None:
    fastest = max(map(abs, scene.initial.angular_velocity)) or 1.0
    assert bound(scene, np.array([1e4 / fastest]))[0] <= 100 * EPS


SIZES = st.one_of(st.just(0.0), st.floats(1e-9, 1.0), st.floats(1e-9, 1e-6), st.floats(1.0, 1.0 + 1e-12))
RATES = st.one_of(st.just(0.0), st.floats(-5.0, 5.0), st.floats(-1e-9, 1e-9))
PARTS = st.floats(-1.0, 1.0)


@st.composite
def bodies(draw: st.DrawFn) -> Vector:
    """Moments that some mass distribution has: discs, needles, spheres and what is nearly so among them."""
    a, b, c = draw(st.tuples(SIZES, SIZES, SIZES).filter(lambda sizes: sorted(sizes)[1] > 0))
    return b + c, a + c, a + b


@settings(max_examples=60, deadline=None)
@given(
    moments=bodies(),
    rates=st.tuples(RATES, RATES, RATES),
    quaternion=st.tuples(PARTS, PARTS, PARTS, PARTS).filter(lambda q: math.hypot(*q) > 0.1),
)
@example(moments=(1.5, 1.0, 0.5), rates=(0.0, 5e-324, 1.0), quaternion=UPRIGHT)
def test_error_is_within_the_bound_for_any_body(moments: Vector, rates: Vector, quaternion: Quaternion) -> None:
    scene, times = spinning(moments, rates, quaternion), np.array([0.0, 0.5, 2.0])
    attitude, _ = errors(scene, times)
    assert np.all(attitude <= bound(scene, times))


def test_without_a_wider_type_the_bound_grows_and_holds() -> None:
    """What a machine would do whose long double is a double: the same code with the wide type taken away."""
    times = [0.0, 1.0, 10.0, 100.0]
    program = f"""
import json
import numpy as np
np.longdouble = np.float64
from bodycheck.reference.flight.closed_form import flight
from bodycheck.reference.scene import Body, Scene, State
scene = Scene(Body(1.0, {FLIP.body.moments}), State(quaternion={FLIP.initial.quaternion}, angular_velocity=(0.1, 0.0, 10.0)))
times = np.array({times})
found = flight(scene, times)
print(json.dumps([found.motion.quaternion.tolist(), found.bounds.error.tolist()]))
"""
    output = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout
    quaternion, limit = json.loads(output)
    here = motion(FLIP, np.array(times))
    assert np.all(geodesic_angle(here.quaternion, np.array(quaternion)) <= bound(FLIP, np.array(times)) + np.array(limit))
    assert 1e-14 < limit[2] < 1e-12


# The closed form against the equations of motion integrated in double precision, projectile included.


@pytest.mark.parametrize("order", [(0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0)])
@pytest.mark.parametrize("rates", [(2.0, 0.3, -1.0), (0.2, -0.1, 2.0), (-2.0, 0.2, 0.1)])
def test_agrees_with_an_integrator_for_any_labels_of_the_axes(order: tuple[int, int, int], rates: Vector) -> None:
    moments = (1.0, 1.5, 2.1)
    scene = Scene(
        Body(2.0, (moments[order[0]], moments[order[1]], moments[order[2]])),
        State((1.0, 2.0, 3.0), (0.1, 0.7, -0.1, 0.7), (3.0, -4.0, 5.0), (rates[order[0]], rates[order[1]], rates[order[2]])),
        gravity=9.81,
    )
    times = np.linspace(0.0, 4.0, 9)
    closed, integrated = motion(scene, times), quasi_coordinates.integrate(scene, times)
    # DOP853 at a relative tolerance of 2.3e-14 is good to some 1e-13 after a few turns.
    assert geodesic_angle(closed.quaternion, integrated.quaternion).max() < 1e-12
    np.testing.assert_allclose(closed.angular_velocity, integrated.angular_velocity, atol=1e-12)
    np.testing.assert_allclose(closed.position, integrated.position, atol=1e-12)
    np.testing.assert_allclose(closed.velocity, integrated.velocity, atol=1e-12)


def test_projectile_is_a_parabola_in_vacuum() -> None:
    scene = Scene(Body(1.0, (1.0, 1.0, 1.0)), State((1.0, -2.0, 3.0), velocity=(4.0, 5.0, 6.0)), gravity=8.0)
    trajectory = motion(scene, np.array([2.0, 0.0, -0.5]))
    np.testing.assert_array_equal(trajectory.position, [[9.0, 8.0, -1.0], [1.0, -2.0, 3.0], [-1.0, -4.5, -1.0]])
    np.testing.assert_array_equal(trajectory.velocity, [[4.0, 5.0, -10.0], [4.0, 5.0, 6.0], [4.0, 5.0, 10.0]])


@pytest.mark.skipif(WIDE_EPS == EPS, reason="no type wider than double precision")
def test_centre_of_mass_is_exact_to_the_last_digit() -> None:
    scene = Scene(FLIP.body, State((0.1, 0.2, 0.3), velocity=(1.1, -2.2, 3.3), angular_velocity=(0.0, 0.0, 1.0)), gravity=9.81)
    times = np.linspace(0, 10, 101)
    found = motion(scene, times)
    for time, height, speed in zip(times.tolist(), found.position[:, 2].tolist(), found.velocity[:, 2].tolist(), strict=True):
        t, z, v, g = map(Fraction, (time, 0.3, 3.3, 9.81))
        assert abs(z + v * t - g * t * t / 2 - Fraction(height)) <= Fraction(math.ulp(height)) * Fraction(51, 100)
        assert abs(v - g * t - Fraction(speed)) <= Fraction(math.ulp(speed)) * Fraction(51, 100)


# What mechanics demands.


@pytest.mark.parametrize("scene", [scene for scene, _ in CASES.values()], ids=CASES)
def test_energy_and_inertial_angular_momentum_are_conserved_for_long(scene: Scene) -> None:
    trajectory = motion(scene, np.linspace(0.0, 1000.0, 2001))
    moments = np.array(scene.body.moments)
    energy = (moments * trajectory.angular_velocity**2).sum(axis=1)
    momentum = rotate(trajectory.quaternion, moments * trajectory.angular_velocity)
    exact_energy = (moments * np.square(scene.initial.angular_velocity)).sum()
    exact_momentum = rotate(normalise(np.array(scene.initial.quaternion)), moments * np.array(scene.initial.angular_velocity))
    # Some ten roundings each, as in the bound: nothing may accumulate.
    assert np.abs(energy - exact_energy).max() <= 16 * EPS * exact_energy
    assert np.linalg.norm(momentum - exact_momentum, axis=1).max() <= 16 * EPS * np.linalg.norm(exact_momentum)


def test_the_order_of_the_times_does_not_matter() -> None:
    times = np.linspace(-3.0, 10.0, 27)
    shuffled = np.random.default_rng(0).permutation(27)
    forward, anyhow = motion(FLIP, times), motion(FLIP, times[shuffled])
    np.testing.assert_array_equal(forward.quaternion[shuffled], anyhow.quaternion)
    np.testing.assert_array_equal(forward.angular_velocity[shuffled], anyhow.angular_velocity)
    assert len(motion(FLIP, np.array([]))) == 0


@pytest.mark.parametrize("rates", [(2.0, 0.3, -1.0), (0.2, -0.1, 2.0), (-2.0, 0.2, 0.1)])
def test_a_reversed_spin_runs_the_motion_backwards(rates: Vector) -> None:
    moments, times = (1.0, 1.5, 2.1), np.linspace(0.0, 5.0, 11)
    forward = motion(spinning(moments, rates), -times)
    back = motion(spinning(moments, (-rates[0], -rates[1], -rates[2])), times)
    assert geodesic_angle(forward.quaternion, back.quaternion).max() < 32 * EPS
    # The same motion by other signs: some ten roundings of rates of 2 rad/s.
    np.testing.assert_allclose(forward.angular_velocity, -back.angular_velocity, atol=32 * EPS)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_spin_about_a_principal_axis_is_steady_even_about_the_middle_one(axis: int) -> None:
    rates = np.zeros(3)
    rates[axis] = -3.0
    times = np.linspace(0.0, 100.0, 101)
    trajectory = motion(spinning((1.0, 1.5, 2.1), (rates[0], rates[1], rates[2])), times)
    turned = np.zeros((101, 4))
    turned[:, 0], turned[:, 1 + axis] = np.cos(1.5 * times), -np.sin(1.5 * times)
    assert geodesic_angle(trajectory.quaternion, turned).max() < 16 * EPS
    assert np.all(trajectory.angular_velocity == rates)


def test_a_symmetric_body_precesses_steadily() -> None:
    a, c, rates = 1.0, 1.7, np.array([0.5, 0.0, 3.0])
    times = np.linspace(0.0, 20.0, 201)
    trajectory = motion(spinning((a, a, c), (0.5, 0.0, 3.0)), times)
    around = (c - a) / a * 3.0 * times
    expected = np.column_stack([0.5 * np.cos(around), 0.5 * np.sin(around), np.full(201, 3.0)])
    # The angle of the expected value itself is rounded: 42 rad times eps.
    np.testing.assert_allclose(trajectory.angular_velocity, expected, atol=50 * EPS)
    momentum = np.array([a, a, c]) * rates
    rate = np.linalg.norm(momentum) / a
    turn = np.column_stack([np.cos(rate * times / 2), np.outer(np.sin(rate * times / 2), momentum / np.linalg.norm(momentum))])
    spin = np.column_stack([np.cos(around / 2), np.zeros(201), np.zeros(201), -np.sin(around / 2)])
    assert geodesic_angle(trajectory.quaternion, multiply(turn, spin)).max() < 150 * EPS


def test_a_nearly_symmetric_body_moves_as_a_symmetric_one() -> None:
    times = np.linspace(0.0, 3.0, 31)
    exact = motion(spinning((1.0, 1.0, 1.7), (1.0, 2.0, 3.0)), times)
    nearly = motion(spinning((1.0, 1.0 + 4 * EPS, 1.7), (1.0, 2.0, 3.0)), times)
    assert geodesic_angle(exact.quaternion, nearly.quaternion).max() < 200 * EPS


# The flip.


@pytest.mark.parametrize("rates", [(0.1, 0.0, 10.0), (3.0, 1.0, 0.2), (0.3, 2.0, 0.1)])
def test_after_a_flip_two_rates_are_reversed(rates: Vector) -> None:
    scene = spinning(FLIP.body.moments, rates)
    period = flip_period(scene)
    (after,) = motion(scene, np.array([period])).angular_velocity
    # The middle axis is K; of I and J the one that is not encircled is reversed with it. A period is rounded once.
    speed = max(map(abs, rates))
    reversals = np.isclose(after, -np.array(rates), atol=20 * EPS * speed * (1 + speed * period))
    kept = np.isclose(after, np.array(rates), atol=20 * EPS * speed * (1 + speed * period))
    assert reversals[2]
    assert reversals[0] != kept[0] or rates[0] == 0
    assert np.all(reversals | kept)


def test_flip_period_is_that_of_the_elliptic_functions() -> None:
    a, b, c = map(mpmath.mpf, (1.0, 1.5, 2.1))
    p, q, r = 0.3, 1.0, 2.0
    energy, momentum = a * p * p + b * q * q + c * r * r, (a * p) ** 2 + (b * q) ** 2 + (c * r) ** 2
    m = (b - a) * (energy * c - momentum) / ((c - b) * (momentum - energy * a))
    rate = mpmath.sqrt((c - b) * (momentum - energy * a) / (a * b * c))
    assert flip_period(spinning((1.0, 1.5, 2.1), (p, q, r))) == pytest.approx(
        float(2 * mpmath.ellipk(m) / rate), rel=1e-14, abs=0
    )


def test_flip_period_of_a_symmetric_body_is_half_a_turn_of_its_precession() -> None:
    # A few roundings.
    assert flip_period(spinning((1.0, 1.0, 1.7), (1.0, 2.0, 3.0))) == pytest.approx(math.pi / (0.7 * 3.0), rel=1e-15, abs=0)


def test_flip_period_grows_with_the_logarithm_of_the_distance_from_the_separatrix() -> None:
    growth = math.sqrt(1.0 * 0.25 / (1.0 * 2.25))  # of a small deviation from the spin about J, per rad of that spin
    near, nearer = (flip_period(spinning((1.0, 2.0, 2.25), (e, 3.0, 0.0))) for e in (1e-20, 1e-120))
    assert nearer - near == pytest.approx(2 * 100 * math.log(10) / (3.0 * growth), rel=1e-14, abs=0)


def test_the_flip_period_does_not_depend_on_the_frame_of_the_body() -> None:
    plain = spinning((1.0, 1.5, 2.1), (2.0, 0.3, -1.0))
    axes = (0.5, 0.5, 0.5, 0.5)  # I becomes J, J becomes K, K becomes I
    x, y, z = rotate(np.array(axes), np.array(plain.initial.angular_velocity)).tolist()
    turned = Scene(replace(plain.body, axes=axes), State(angular_velocity=(x, y, z)))
    assert flip_period(turned) == pytest.approx(flip_period(plain), rel=1e-15, abs=0)


@pytest.mark.parametrize(
    ("moments", "rates"),
    [
        ((1.0, 2.0, 2.25), (0.75, 1.0, 1.0)),
        ((1.0, 2.0, 2.25), (0.0, 1.0, 0.0)),
        ((1.0, 2.0, 2.25), (1.0, 0.0, 0.0)),
        ((1.0, 1.0, 1.0), (1.0, 2.0, 3.0)),
        ((1.0, 1.0, 1.5), (1.0, 2.0, 0.0)),
        ((1.0, 2.0, 2.25), (0.0, 0.0, 0.0)),
    ],
    ids=["separatrix", "middle axis", "least axis", "sphere", "across the axis of symmetry", "at rest"],
)
def test_what_does_not_flip_has_no_flip_period(moments: Vector, rates: Vector) -> None:
    assert flip_period(spinning(moments, rates)) == math.inf
