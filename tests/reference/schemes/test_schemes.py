"""Textbook schemes on the exact equations: their orders, and what is true of each of them exactly."""

from dataclasses import replace

import mpmath
import numpy as np
import pytest
from scipy.linalg import expm

from bodycheck import load
from bodycheck.reference.inertia import along_principal_axes, in_body_frame
from bodycheck.reference.kinematics import geodesic_angle, multiply, rotate
from bodycheck.reference.observables import observe
from bodycheck.reference.scene import Scene, State
from bodycheck.reference.schemes.catalogue import CATALOGUE, ON_TWIST
from bodycheck.reference.schemes.formulations import Equations, body_twist, world_velocity
from bodycheck.reference.schemes.increments import (
    Pair,
    displace_se3,
    displace_so3_r3,
    inverse_dexp_se3,
    inverse_dexp_so3_r3,
    turn,
)
from bodycheck.reference.schemes.one_step import step_through
from bodycheck.reference.trajectory import Trajectory
from bodycheck.reference.truth import truth
from tests.support.cases import shortened

TUMBLE = shortened(load("osrf-boxes-complex"), 1.0, 11).scene
#: Some 4 m/s^2 at first: without a force that depends on the velocity, half of the schemes make no error in the position.
DRAGGED = replace(TUMBLE, drag=0.5)

FORMULATIONS = ("", ON_TWIST)
EULER = ["explicit Euler", "semi-implicit Euler", "linearly implicit Euler"]
MIDPOINT, AVERAGED, MUNTHE_KAAS = "implicit midpoint", "averaged Runge-Kutta 4", "Runge-Kutta-Munthe-Kaas 4"

#: In attitude, in position with the rotation apart, and in position on the body twist.
#:
#: With the rotation apart the translation is in a vector space, where averages of velocities are what they should be.
ORDERS = dict.fromkeys(EULER, (1, 1, 1)) | {MIDPOINT: (2, 2, 2), AVERAGED: (2, 4, 2), MUNTHE_KAAS: (4, 4, 4)}
#: One scheme of each sort, in both choices of velocity.
SCHEMES = list(ORDERS)


def stepped(name: str, formulation: str, scene: Scene, timestep: float, strides: list[int]) -> Trajectory:
    states = step_through(CATALOGUE[name].scheme, CATALOGUE[name].formulations[formulation], scene, timestep, np.array(strides))
    return Trajectory(np.cumsum(strides) * timestep, *np.split(states, [3, 7, 10], axis=1))


def vectors(seed: int, *sizes: float) -> list[np.ndarray]:
    """A vector of each length in some direction."""
    directions = np.random.default_rng(seed).normal(size=(len(sizes), 3))
    return [size * direction / np.linalg.norm(direction) for size, direction in zip(sizes, directions, strict=True)]


def pair(linear: np.ndarray, angular: np.ndarray) -> Pair:
    x, y, z = linear.tolist()
    p, q, r = angular.tolist()
    return (x, y, z), (p, q, r)


def hat(v: np.ndarray) -> np.ndarray:
    """The matrix of the vector product v x."""
    x, y, z = v
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


@pytest.mark.parametrize("formulation", FORMULATIONS)
@pytest.mark.parametrize("name", SCHEMES)
def test_orders_by_halving_the_step(name: str, formulation: str) -> None:
    in_attitude, *in_position = ORDERS[name]
    exact = truth(DRAGGED, np.array([1.0])).trajectory
    ends = [stepped(name, formulation, DRAGGED, 1 / count, [count]) for count in (100, 200, 400)]
    turned = np.array([geodesic_angle(exact.quaternion, end.quaternion)[0] for end in ends])
    moved = np.array([np.linalg.norm(exact.position - end.position) for end in ends])
    # The next term of an error is smaller by h times the rates: 10 ms times 5 rad/s, of which half tells in the ratio.
    np.testing.assert_allclose(np.log2(turned[:-1] / turned[1:]), in_attitude, atol=0.05)
    np.testing.assert_allclose(np.log2(moved[:-1] / moved[1:]), in_position[FORMULATIONS.index(formulation)], atol=0.05)


@pytest.mark.parametrize("name", CATALOGUE)
def test_every_scheme_has_its_order_in_the_attitude(name: str) -> None:
    """From the errors at three steps, before the second of three angles is near a right angle."""
    order, duration = CATALOGUE[name].order, 0.2
    exact = truth(TUMBLE, np.array([duration])).trajectory
    counts = (80, 160, 320) if order < 2 else (8, 16, 32)
    ends = [stepped(name, "", TUMBLE, duration / count, [count]) for count in counts]
    errors = np.array([geodesic_angle(exact.quaternion, end.quaternion)[0] for end in ends])
    observed = np.log2(errors[:-1] / errors[1:])
    # Extrapolated to no step: the next term of an error is smaller by h times the rates, 12 ms times 5 rad/s, times a ratio of
    # coefficients, and the term after it by its square.
    assert 2 * observed[1] - observed[0] == pytest.approx(order, abs=0.2)


@pytest.mark.parametrize("angle", [0.0, 1e-9, 0.99e-4, 1.01e-4, 1e-3, 0.1, 1.0, 3.0])
def test_a_screw_is_the_exponential_of_its_twist(angle: float) -> None:
    rho, phi = vectors(1, 2.0, angle)
    position, attitude = displace_se3(((0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0)), pair(rho, phi))
    matrix = expm(np.block([[hat(phi), rho[:, None]], [np.zeros((1, 4))]]))
    # expm's own rounding grows with the angle.
    np.testing.assert_allclose(position, matrix[:3, 3], atol=1e-14)
    np.testing.assert_allclose(rotate(np.array([attitude] * 3), np.eye(3)).T, matrix[:3, :3], atol=1e-14)
    assert displace_so3_r3(((1.0, 2.0, 3.0), (1.0, 0.0, 0.0, 0.0)), pair(rho, phi)) == (tuple(np.add(rho, [1, 2, 3])), attitude)


@pytest.mark.parametrize("angle", [0.0, 1e-9, 0.99e-4, 1.01e-4, 1e-3, 0.1, 1.0, 3.0])
def test_rates_are_the_inverse_of_dexp(angle: float) -> None:
    """By its series in Bernoulli's numbers, sum of B_k / k! (-ad_u)^k v, in 50 digits."""
    rho, phi, linear, angular = vectors(2, max(angle, 1e-3), angle, 5.0, 5.0)
    with mpmath.workdps(50):
        ad = mpmath.matrix(np.block([[hat(phi), hat(rho)], [np.zeros((3, 3)), hat(phi)]]).tolist())
        power = expected = mpmath.matrix([*linear, *angular])
        for k in range(1, 160):  # the series converges as (angle / 2 pi)^k
            power = -ad * power
            expected = expected + mpmath.bernoulli(k) / mpmath.factorial(k) * power
        exact = np.array([float(x) for x in expected])
    got = inverse_dexp_se3(pair(rho, phi), pair(linear, angular))
    # A few roundings of velocities of 5, where angles are not small; of what is multiplied by |rho| / angle where they are.
    np.testing.assert_allclose(np.concatenate(got), exact, atol=5e-15)
    assert inverse_dexp_so3_r3(pair(rho, phi), pair(linear, angular)) == (tuple(linear), got[1])


@pytest.mark.parametrize("name", SCHEMES)
def test_the_rotation_knows_nothing_of_the_formulation(name: str) -> None:
    apart, twist = (stepped(name, formulation, DRAGGED, 0.01, [1] * 200) for formulation in FORMULATIONS)
    if name == MIDPOINT:
        # Its iteration goes on where the translation still gains: some roundings, grown little in 2 s.
        assert geodesic_angle(apart.quaternion, twist.quaternion).max() < 1e-13
    else:
        np.testing.assert_array_equal(apart.quaternion, twist.quaternion)
        np.testing.assert_array_equal(apart.angular_velocity, twist.angular_velocity)
    assert np.linalg.norm(apart.position - twist.position, axis=1).max() > 1e-8


def test_positions_under_gravity_alone() -> None:
    """With the rotation apart: a parabola, from which the first-order schemes are g h t / 2 away, up or down."""
    expected = dict.fromkeys(SCHEMES, 0.0) | dict.fromkeys(EULER, -1.0) | {"explicit Euler": 1.0}
    for name, side in expected.items():
        motion = stepped(name, "", TUMBLE, 0.01, [10] * 20)
        t = motion.t[:, None]
        parabola = t * np.array(TUMBLE.initial.velocity) - TUMBLE.gravity / 2 * t**2 * [0, 0, 1]
        # 200 roundings of some 10 m.
        np.testing.assert_allclose(motion.position, parabola + side * TUMBLE.gravity * 0.01 / 2 * t * [0, 0, 1], atol=1e-13)


@pytest.mark.parametrize("formulation", FORMULATIONS)
@pytest.mark.parametrize("name", SCHEMES)
def test_a_body_in_another_frame_moves_as_it_did(name: str, formulation: str) -> None:
    oblique = replace(DRAGGED, body=replace(DRAGGED.body, axes=(0.5, 0.1, -0.7, 0.5)))
    told = stepped(name, formulation, oblique, 0.01, [10] * 20)
    principal = in_body_frame(oblique, stepped(name, formulation, along_principal_axes(oblique), 0.01, [10] * 20))
    # 200 steps of rounding, grown some ten times in 2 s; the body flies at up to 40 m/s on the body twist.
    assert geodesic_angle(told.quaternion, principal.quaternion).max() < 1e-12
    np.testing.assert_allclose(told.position, principal.position, atol=1e-10)
    np.testing.assert_allclose(told.angular_velocity, principal.angular_velocity, atol=1e-11)


@pytest.mark.parametrize("formulation", FORMULATIONS)
@pytest.mark.parametrize("name", SCHEMES)
def test_turning_the_world_about_the_vertical_turns_the_motion(name: str, formulation: str) -> None:
    about = turn((1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 2.0))
    vx, vy, vz = rotate(np.array(about), np.array(DRAGGED.initial.velocity)).tolist()
    turned = replace(DRAGGED, initial=replace(DRAGGED.initial, quaternion=about, velocity=(vx, vy, vz)))
    motion, other = (stepped(name, formulation, scene, 0.01, [10] * 20) for scene in (DRAGGED, turned))
    by = np.tile(about, (20, 1))
    # Rounding, as in the test above.
    assert geodesic_angle(multiply(by, motion.quaternion), other.quaternion).max() < 1e-12
    np.testing.assert_allclose(rotate(by, motion.position), other.position, atol=1e-10)


def test_implicit_midpoint_keeps_the_quadratic_invariants() -> None:
    """Of Euler's equations: the rotational energy and the size of the momentum; its direction in the world drifts."""
    drifts = []
    for timestep in (0.02, 0.01):
        seen = observe(TUMBLE, stepped(MIDPOINT, "", TUMBLE, timestep, [0] + [round(0.1 / timestep)] * 100))
        size = np.linalg.norm(seen.angular_momentum, axis=1)
        # 1000 steps of rounding.
        np.testing.assert_allclose(seen.rotational_energy, seen.rotational_energy[0], rtol=1e-13)
        np.testing.assert_allclose(size, size[0], rtol=1e-13)
        drifts.append(np.linalg.norm(seen.angular_momentum - seen.angular_momentum[0], axis=1).max() / size[0])
    assert drifts[0] / drifts[1] == pytest.approx(4, rel=0.05)  # second order, the next term being of the fourth
    other = observe(TUMBLE, stepped("semi-implicit Euler", "", TUMBLE, 0.01, [0, 1000])).rotational_energy
    assert abs(other[1] / other[0] - 1) > 0.01


@pytest.mark.parametrize("formulation", FORMULATIONS)
@pytest.mark.parametrize("name", SCHEMES)
def test_implicit_midpoint_alone_returns_when_reversed(name: str, formulation: str) -> None:
    there = stepped(name, formulation, TUMBLE, 0.01, [100])
    (x, y, z), (a, b, c, d) = there.position[0].tolist(), there.quaternion[0].tolist()
    (u, v, w), (p, q, r) = (-there.velocity[0]).tolist(), (-there.angular_velocity[0]).tolist()
    back = stepped(
        name, formulation, replace(TUMBLE, initial=State((x, y, z), (a, b, c, d), (u, v, w), (p, q, r))), 0.01, [100]
    )
    turned = float(geodesic_angle(back.quaternion, np.array([TUMBLE.initial.quaternion]))[0])
    moved = float(np.linalg.norm(back.position))
    if name == MIDPOINT:
        assert turned < 1e-13  # 200 steps of rounding
        assert moved < 1e-12
    else:
        assert turned > 1e-9


@pytest.mark.parametrize(
    ("name", "ratio"), [("semi-implicit Euler", 1.086895), ("linearly implicit Euler", 0.926008), (MUNTHE_KAAS, 1.0)]
)
def test_energies_of_mujocos_own_test(name: str, ratio: float) -> None:
    """A brick of 0.1, 0.2, 0.3 m with the body rates 1, 2, 3 rad/s, after 500 steps of 10 ms."""
    scene = load("mujoco-free-body").scene
    energy = observe(scene, stepped(name, "", scene, 0.01, [0, 500])).rotational_energy
    assert energy[1] / energy[0] == pytest.approx(ratio, abs=5e-7)  # as many digits as are printed


@pytest.mark.parametrize("formulation", [world_velocity, body_twist])
def test_the_relaxed_acceleration_solves_its_equations(formulation: Equations) -> None:
    """(1 - h J) x = a, with the Jacobian of the acceleration by all velocities from central differences."""
    scene = replace(TUMBLE, body=replace(TUMBLE.body, axes=(0.5, 0.1, -0.7, 0.5)))
    motion, h = formulation(scene), 0.05
    pose = (0.0, 0.0, 0.0), (0.1, 0.7, 0.5, -0.5)
    v = np.concatenate(vectors(3, 8.0, 5.0))

    def acceleration(at: np.ndarray) -> np.ndarray:
        return np.concatenate(motion.acceleration(pose, pair(*np.split(at, 2))))

    # The acceleration is quadratic in the velocity, so that central differences of any width are exact.
    jacobian = np.column_stack([(acceleration(v + axis) - acceleration(v - axis)) / 2 for axis in np.eye(6)])
    relaxed = np.concatenate(motion.relaxed_acceleration(pose, pair(*np.split(v, 2)), h))
    np.testing.assert_allclose(relaxed - h * jacobian @ relaxed, acceleration(v), atol=1e-12)  # rounding of some 100 / s^2
    assert np.linalg.norm(relaxed - acceleration(v)) > 1


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_stepping_in_pieces_is_stepping_at_once(formulation: str) -> None:
    pieces = stepped(MUNTHE_KAAS, formulation, TUMBLE, 0.01, [0, 3, 0, 5, 92])
    whole = stepped(MUNTHE_KAAS, formulation, TUMBLE, 0.01, [100])
    np.testing.assert_array_equal(pieces.quaternion[-1:], whole.quaternion)
    np.testing.assert_array_equal(pieces.position[-1:], whole.position)
    np.testing.assert_array_equal(pieces.position[:1], [TUMBLE.initial.position])
    # The body twist turns the velocity to the body and back: some roundings.
    np.testing.assert_allclose(pieces.velocity[:1], [TUMBLE.initial.velocity], rtol=1e-15)


@pytest.mark.parametrize("formulation", FORMULATIONS)
@pytest.mark.parametrize("name", SCHEMES)
def test_a_scheme_that_cannot_go_on_says_so_from_there(name: str, formulation: str) -> None:
    wild = replace(TUMBLE, initial=replace(TUMBLE.initial, angular_velocity=(1e160, 5e160, 1e160)))
    motion = stepped(name, formulation, wild, 0.01, [0, 10, 10])
    assert np.isfinite(motion.quaternion[0]).all()
    assert np.isnan(motion.quaternion[1:]).all()
