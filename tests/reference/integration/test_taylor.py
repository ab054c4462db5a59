"""Taylor's method: wide arithmetic against wider, Euler angles against a quaternion, and what mechanics conserves."""

import json
import math
import os
import sqlite3
import subprocess
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bodycheck import load
from bodycheck.reference.certified import BITS
from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.inertia import principal_moments
from bodycheck.reference.integration import lagrangian
from bodycheck.reference.kinematics import normalise, rotate
from bodycheck.reference.scene import Body, Brick, Scene, State, Vector
from bodycheck.reference.trajectory import Array

hy = pytest.importorskip("heyoka")

from bodycheck.reference.integration import heyoka_solver, taylor  # noqa: E402
from bodycheck.reference.integration.rotation import Rotation  # noqa: E402
from bodycheck.reference.integration.sensitivity import growth  # noqa: E402
from bodycheck.reference.integration.taylor import attitude_difference, euler_lagrange  # noqa: E402
from tests.support.euler_motion import quasi_coordinates  # noqa: E402

#: Unit roundoff of the 80-bit type.
ROUNDING = float(np.finfo(np.longdouble).eps) / 2

Way = Callable[..., Rotation]

TIMES = np.linspace(0, 10, 101)
FLIP = Scene(
    Body(1.0, principal_moments(Brick((0.1, 0.3, 0.2)), 1.0)),
    State(quaternion=(math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0), angular_velocity=(0.1, 0.0, 10.0)),
    gravity=9.81,
)


def spinning(moments: Vector, rates: Vector) -> Scene:
    return Scene(Body(1.0, moments), State(angular_velocity=rates))


def finite(scale: float) -> st.SearchStrategy[float]:
    return st.floats(-scale, scale, allow_subnormal=False)


@st.composite
def bodies(draw: st.DrawFn) -> Vector:
    """Any body that can exist: discs, needles and nearly symmetric ones among them."""
    ratio = draw(st.one_of(st.floats(0.01, 1), st.floats(-8, 0).map(lambda x: 10**x), st.just(1.0)))
    least, middle = ratio, 1.0
    # The largest moment lies between the middle one and the sum.
    largest = middle + least * draw(st.one_of(st.floats(0, 1), st.floats(0, 1e-12), st.just(1.0)))
    a, b, c = draw(st.permutations([least, middle, largest]))
    return a, b, c


@st.composite
def scenes(draw: st.DrawFn) -> Scene:
    quaternion = draw(st.tuples(*4 * [finite(1)]).filter(lambda q: math.hypot(*q) > 0.1))
    rates = draw(st.one_of(st.tuples(*3 * [finite(6)]), st.sampled_from([(0.0, 0.0, 5.0), (0.0, -5.0, 0.0), (0.0, 0.0, 0.0)])))
    return Scene(Body(1.0, draw(bodies())), State(quaternion=quaternion, angular_velocity=rates))


# The equations.


def test_heyoka_derives_the_hand_written_equations() -> None:
    equations = taylor.lagrange_equations()
    variables = [variable for variable, _ in equations]
    derivatives = hy.cfunc(
        [derivative for _, derivative in equations], vars=variables, fp_type=np.longdouble, compact_mode=True
    )
    random = np.random.default_rng(3)
    for _ in range(200):
        a, b, c = random.uniform(0.2, 1.0, 3)
        theta, psi = random.uniform(0.5, math.pi - 0.5), random.uniform(-math.pi, math.pi)
        dtheta, dphi, dpsi = random.normal(size=3)
        state = np.array([psi, 0.0, theta, dpsi, dphi, dtheta], dtype=np.longdouble)
        wide = np.array([a, b, c], dtype=np.longdouble)
        parameters = np.array([(wide[0] + wide[1]) / (2 * wide[2]), (wide[0] - wide[1]) / (2 * wide[2])])
        ddpsi, ddphi, ddtheta = derivatives(state, pars=parameters)[3:].astype(float)
        by_hand = lagrangian.angular_accelerations((a, b, c), theta, psi, dtheta, dphi, dpsi)
        # In double the hand-written formula loses what it divides by A B sin^2(theta), at worst a factor of 20.
        np.testing.assert_allclose(by_hand, (ddtheta, ddphi, ddpsi), rtol=0, atol=1e-14 * np.linalg.norm(by_hand))


@given(scenes())
def test_angles_keep_45_degrees_from_their_singularity(scene: Scene) -> None:
    moments, rates = np.array(scene.body.moments), quasi_coordinates(scene, TIMES).angular_velocity
    momentum = moments * rates
    if not momentum.any():
        return
    axis = taylor.axis_across(moments.astype(np.longdouble), momentum[0])
    cosine_squared = momentum[:, axis] ** 2 / (momentum * momentum).sum(axis=1)
    # Where the moments differ in their last digit, rounding shifts the border between the two axes by a thousandth.
    assert cosine_squared.max() < 0.51


# Accuracy.


@pytest.mark.parametrize("name", ["free-brick", "short-axis-spin", "osrf-boxes-complex", "gimbal-start"])
def test_error_against_128_bits(name: str) -> None:
    scene = load(name).scene
    exact = euler_lagrange(scene, TIMES, "quadruple").quaternion
    found = euler_lagrange(scene, TIMES).quaternion
    grown = growth(scene, TIMES)
    # Some roundings of angles of up to 2 pi in each of some hundred steps, and of the start, as the motion makes them grow.
    allowed = ROUNDING * (100 * (1 + grown.of_initial) + 10 * grown.of_any)
    assert (attitude_difference(found, exact) <= allowed).all()


def test_error_of_a_flip_against_128_bits() -> None:
    scene = load("intermediate-axis-flip").scene
    exact = euler_lagrange(scene, TIMES, "quadruple").quaternion
    # The flip makes a rounding of 80 bits grow 6e4-fold within its ten seconds, in each of some thousand steps.
    assert attitude_difference(euler_lagrange(scene, TIMES).quaternion, exact).max() <= 1e-13


@pytest.mark.parametrize("way", [euler_lagrange, quasi_coordinates])
@pytest.mark.parametrize("scene", [FLIP, spinning((0.8083333, 0.6833333, 0.1416667), (0.1, 5.0, 0.1))], ids=["flip", "box"])
def test_error_is_rounding_times_growth(scene: Scene, way: Way) -> None:
    exact = quasi_coordinates(scene, TIMES, "quadruple").quaternion
    error = attitude_difference(way(scene, TIMES).quaternion, exact)
    # A handful of roundings in each step, of which there are about ten a turn.
    assert (error <= 10 * ROUNDING * growth(scene, TIMES).of_any).all()


def test_two_ways_agree_to_28_digits_in_128_bits() -> None:
    ways = [way(FLIP, TIMES, "quadruple") for way in (euler_lagrange, quasi_coordinates)]
    # Rounding at 1e-34 times a growth of 1e5.
    assert attitude_difference(*(way.quaternion for way in ways)).max() < 1e-28
    assert np.abs(ways[0].angular_velocity - ways[1].angular_velocity).max() < 1e-26


@settings(max_examples=60)
@given(scenes())
def test_two_ways_agree_for_any_body_and_any_start(scene: Scene) -> None:
    one, other = euler_lagrange(scene, TIMES), quasi_coordinates(scene, TIMES)
    apart = attitude_difference(one.quaternion, other.quaternion)
    # Twice the worst of 1000 random scenes.
    assert (apart <= 40 * ROUNDING * growth(scene, TIMES).of_any).all()


def momentum_drift(scene: Scene, quaternion: Array, angular_velocity: Array) -> float:
    momentum = rotate(quaternion, angular_velocity * np.array(scene.body.moments, dtype=quaternion.dtype))
    return float(np.sqrt(((momentum - momentum[0]) ** 2).sum(axis=1) / (momentum[0] ** 2).sum()).max())


@pytest.mark.parametrize("scene", [FLIP, spinning((0.3, 0.45, 0.6), (2.0, 3.0, -4.0))], ids=["flip", "tumble"])
def test_angular_momentum_over_1000_seconds(scene: Scene) -> None:
    times = np.linspace(0, 1000, 2001)
    rotation = euler_lagrange(scene, times)
    # Some 15,000 steps that round at 5e-20 add up to their square root of it, times the ten radians of an angle.
    assert momentum_drift(scene, rotation.quaternion, rotation.angular_velocity) < 1e-16


@given(scenes())
def test_starts_where_it_is_told_to(scene: Scene) -> None:
    for way in (euler_lagrange, quasi_coordinates):
        start = way(scene, np.array([0.0]))
        attitude = normalise(np.array([scene.initial.quaternion], dtype=np.longdouble))
        assert attitude_difference(start.quaternion, attitude).max() <= 20 * ROUNDING
        rates = np.array(scene.initial.angular_velocity, dtype=np.longdouble)
        assert np.abs(start.angular_velocity - rates).max() <= 20 * ROUNDING * np.abs(rates).max()


def test_difference_sees_the_last_digits_of_every_type() -> None:
    turned = np.array([[1.0, 1e-30, 0.0, 0.0]]).astype(taylor.QUADRUPLE)
    upright = np.array([[1.0, 0.0, 0.0, 0.0]])
    assert attitude_difference(turned, upright) == pytest.approx([2e-30], rel=1e-15, abs=0)
    third = np.array([[1.0, 1.0, 0.0, 0.0]], dtype=np.longdouble) / 3
    assert attitude_difference(third, third) == [0.0]
    # One unit in the last place of an 80-bit number is 1e-19 of it.
    assert 1e-20 < attitude_difference(third, third * np.array([1, 1 + np.finfo(np.longdouble).eps, 1, 1]))[0] < 1e-18


# What a change of units or of samples must not do.


def same(one: Rotation, other: Rotation) -> bool:
    return bool((one.quaternion == other.quaternion).all() and (one.angular_velocity == other.angular_velocity).all())


@pytest.mark.parametrize("way", [euler_lagrange, quasi_coordinates])
def test_a_faster_or_heavier_body_moves_alike(way: Way) -> None:
    slow = spinning((0.3, 0.45, 0.6), (2.0, 3.0, -4.0))
    fast = spinning((0.3 * 2**20, 0.45 * 2**20, 0.6 * 2**20), (2.0 * 2**-30, 3.0 * 2**-30, -4.0 * 2**-30))
    expected, found = way(slow, TIMES), way(fast, TIMES * 2.0**30)
    assert same(expected, Rotation(found.quaternion, found.angular_velocity * 2.0**30))


@pytest.mark.parametrize("way", [euler_lagrange, quasi_coordinates])
def test_samples_do_not_depend_on_one_another(way: Way) -> None:
    every = way(FLIP, TIMES)
    chosen = [100, 50, 50, 7]
    found = way(FLIP, TIMES[chosen])
    assert same(found, Rotation(every.quaternion[chosen], every.angular_velocity[chosen]))


@pytest.mark.parametrize("times", [[], [0.0], [0.0, 0.0]])
def test_few_instants(times: list[float]) -> None:
    found = euler_lagrange(FLIP, np.array(times))
    assert found.quaternion.shape == (len(times), 4)
    assert found.angular_velocity.shape == (len(times), 3)


def test_threads_do_not_disturb_one_another() -> None:
    flips = [spinning(FLIP.body.moments, (0.1, 0.0, rate)) for rate in (5.0, 10.0, 20.0)]
    expected = [euler_lagrange(flip, TIMES) for flip in flips]
    with ThreadPoolExecutor(3) as pool:
        for _ in range(5):
            found = pool.map(lambda flip: euler_lagrange(flip, TIMES), flips)
            assert all(same(*pair) for pair in zip(found, expected, strict=True))


@pytest.mark.parametrize("way", [euler_lagrange, quasi_coordinates])
def test_too_many_steps_are_out_of_reach(way: Way, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(heyoka_solver, "MAX_STEPS", 20)
    with pytest.raises(OutOfReach, match="step_limit"):
        way(FLIP, TIMES)
    # What failed leaves nothing behind.
    assert same(way(FLIP, TIMES[:3]), way(FLIP, TIMES[:3]))


# Compiled code on disk.

PROGRAM = """
import json, numpy, bodycheck.reference.integration.taylor as taylor
from bodycheck.reference.scene import Body, Scene, State
scene = Scene(Body(1.0, (0.3, 0.45, 0.6)), State(angular_velocity=(2.0, 3.0, -4.0)))
print(json.dumps(taylor.euler_lagrange(scene, numpy.array([1.0])).quaternion.astype(float).tolist()))
"""


def stored_settings(cache: Path) -> dict[str, int]:
    """The settings that heyoka stores in a cache on disk."""
    with closing(sqlite3.connect(cache)) as connection:
        return dict(connection.execute("SELECT key, value FROM config"))


def in_another_process(cache: Path) -> list[list[float]]:
    environment = os.environ | {"HEYOKA_CACHE_DIR": str(cache)}
    done = subprocess.run([sys.executable, "-c", PROGRAM], env=environment, capture_output=True, text=True, check=True)
    quaternions: list[list[float]] = json.loads(done.stdout)
    return quaternions


def test_compiled_code_is_kept_only_where_no_one_else_can_write(tmp_path: Path) -> None:
    rotation = euler_lagrange(spinning((0.3, 0.45, 0.6), (2.0, 3.0, -4.0)), np.array([1.0]))
    expected = rotation.quaternion.astype(float).tolist()
    own, shared, corrupt = tmp_path / "own", tmp_path / "shared", tmp_path / "corrupt"
    for folder in (shared, corrupt / "bodycheck"):
        folder.mkdir(mode=0o700, parents=True)
    shared.chmod(0o777)
    (corrupt / "bodycheck" / "cache.db").write_text("not a data base")

    assert in_another_process(own) == expected
    assert heyoka_solver.is_private(own / "bodycheck")
    assert stored_settings(own / "bodycheck" / "cache.db")["size_limit"] == heyoka_solver.DISK_CACHE_BYTES
    assert not (own / "cache.db").exists()  # that of other programs is left alone, however large it is
    assert in_another_process(shared) == expected
    assert not list(shared.iterdir())
    assert in_another_process(corrupt) == expected
    assert in_another_process(own / "bodycheck" / "cache.db") == expected


def test_private_means_written_by_no_one_else(tmp_path: Path) -> None:
    for mode, private in ((0o700, True), (0o755, True), (0o775, False), (0o777, False)):
        tmp_path.chmod(mode)
        assert heyoka_solver.is_private(tmp_path) == private


@pytest.mark.parametrize(
    ("dtype", "bits"),
    [*((each, None) for each in heyoka_solver.STEP_TOLERANCES), *((hy.real, bits) for bits in (160, *BITS))],
)
def test_what_is_at_rest_where_its_acceleration_is_stationary_has_a_first_step(dtype: Any, bits: int | None) -> None:
    """The angle of a pendulum that begins horizontal has the powers 2, 6, 10, ... of time, and its rate 1, 5, 9, ..."""

    def pendulum() -> heyoka_solver.Equations:
        angle, rate = hy.make_vars("angle", "rate")
        return [(angle, rate), (rate, -hy.cos(angle))]

    solver = heyoka_solver.compiled(pendulum(), dtype, bits)
    outcome, step = solver.step()
    assert outcome == hy.taylor_outcome.success
    assert 0.1 < step < 1.0  # about a seventh of the distance of the nearest singularity, which is of the order of a period
    energy = 0.5 * solver.state[1] ** 2 + np.sin(float(solver.state[0]))
    assert abs(float(energy)) < 1e-15  # the sine is that of double precision
