"""The independent rotation and translation: the truth's, in 80 bits and in more."""

import numpy as np
import pytest

from bodycheck import Case, load
from bodycheck.reference.flight import closed_form
from bodycheck.reference.independent.border import MP, about_x, about_z, border
from bodycheck.reference.independent.closed_form import parabola
from bodycheck.reference.independent.directions import exact_quaternion, quaternion_of
from bodycheck.reference.kinematics import quaternion_from_euler, rotate
from bodycheck.reference.scene import Body, Scene, State
from bodycheck.reference.witness import angle_between

integration = pytest.importorskip("bodycheck.reference.independent.integration", reason="needs heyoka")

#: A body in a frame that is not that of its principal axes, one of whose moments is a millionth of the others.
SLENDER = Scene(
    Body(1.0, (1.0 + 1e-6, 1e-6, 1.0 + 2e-6), axes=(0.5, 0.1, -0.7, 0.5)),
    State(quaternion=(0.1, 0.3, 0.9, -0.3), angular_velocity=(0.3, -0.5, 1.1)),
)
TIMES = np.linspace(0, 20, 41)


def test_it_is_the_truth_of_every_flying_case(flying_case: Case) -> None:
    scene, times = flying_case.scene, flying_case.instants
    if not any(scene.initial.angular_velocity):
        return
    truth = closed_form.flight(scene, times)
    found = integration.spinning(border(scene), integration.EXTENDED).follow(times.astype(np.longdouble))
    # 80 bits lose less than the bound of a double, even where a flip amplifies rounding some 1e4 times.
    assert (angle_between(found.quaternion, truth.motion.quaternion) <= truth.bounds.error + 1e-14).all()
    apart = np.linalg.norm((found.angular_velocity - truth.motion.angular_velocity).astype(float), axis=1)
    assert (apart <= truth.bounds.angular_velocity_error + 1e-13).all()


def test_more_bits_are_more_accurate() -> None:
    """Of a slender body in a turned frame too, whose large mobility would drown the difference of the other two."""
    start = border(SLENDER)
    wide = integration.multiprecision(160)
    exact = integration.spinning(start, wide).follow(TIMES.astype(wide.dtype)).quaternion
    for way in (integration.EXTENDED, integration.multiprecision(100), integration.multiprecision(128)):
        found = integration.spinning(start, way).follow(TIMES.astype(way.dtype)).quaternion
        error = found - (exact if way.bits else wide.rounded(exact))
        # The slender axis amplifies a rounding a million times in 30 rad of turning.
        assert np.abs(error.astype(float)).max() < 1e8 * way.rounding


def test_accelerations_are_the_changes_of_the_rates() -> None:
    motion = integration.spinning(border(SLENDER), integration.EXTENDED)
    step = 1e-6
    rates = motion.follow(np.array([1.0, 1.0 + step, 1.0 + 2 * step], dtype=np.longdouble)).angular_velocity
    slope = ((rates[2] - rates[0]) / (2 * step)).astype(float)
    # The remainder is of second order in the step.
    np.testing.assert_allclose(motion.acceleration(rates[1:2])[0].astype(float), slope, rtol=0, atol=1e-8)


def test_the_axis_of_the_momentum_is_fixed() -> None:
    start = border(SLENDER)
    found = integration.spinning(start, integration.EXTENDED).follow(TIMES.astype(np.longdouble))
    tensor = np.array([[float(entry) for entry in row] for row in start.tensor])
    momentum = rotate(found.quaternion.astype(float), found.angular_velocity.astype(float) @ tensor)
    axis = integration.momentum_axis(start, integration.EXTENDED).astype(float)
    np.testing.assert_allclose(momentum / np.linalg.norm(momentum, axis=1)[:, None], np.tile(axis, (41, 1)), rtol=0, atol=1e-14)


def test_quaternions_of_matrices_are_those_of_euler_angles() -> None:
    """Where each of the four components is the largest, and where half turns make others zero."""
    rng = np.random.default_rng(2)
    triads = [*rng.uniform(-np.pi, np.pi, (20, 3)).tolist(), [0.0, np.pi, 0.0], [np.pi, 0.0, 0.0], [np.pi, np.pi, 0.0]]
    for phi, theta, psi in triads:
        turn = MP.matrix(about_z(phi)) * MP.matrix(about_x(theta)) * MP.matrix(about_z(psi))
        rows = turn.tolist()
        expected = quaternion_from_euler(np.array([phi]), np.array([theta]), np.array([psi]))
        assert angle_between(exact_quaternion(rows)[None], expected)[0] < 4e-16
        doubles = np.array([[float(entry) for entry in row] for row in rows])
        assert angle_between(quaternion_of(doubles[None]), expected)[0] < 2e-15


def test_the_parabola_is_within_its_bounds() -> None:
    case = load("projectile")
    scene, times = case.scene, np.array([0.0, 0.1, 3.0, 1e5])
    position, velocity, position_error, velocity_error = parabola(scene, times)
    for n, t in enumerate(times.tolist()):
        for axis in range(3):
            fall = MP.mpf(-scene.gravity) if axis == 2 else MP.mpf(0)
            first = MP.mpf(scene.initial.velocity[axis])
            there = MP.mpf(scene.initial.position[axis]) + first * t + fall * t * t / 2
            for found, exact, bound in ((position, there, position_error), (velocity, first + fall * t, velocity_error)):
                head = float(found[n, axis])
                error = MP.mpf(head) + MP.mpf(float(found[n, axis] - np.longdouble(head))) - exact
                assert abs(error) <= bound[n]
