"""Rotation vectors, the matrices that give them, and their inverses, against written-out forms and moving axes."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bodycheck.reference.chapter import orientation, rotation_vector
from bodycheck.reference.kinematics import body_rates
from tests.support.rotations import ANGLE, RATE, apart


@given(ANGLE, ANGLE, ANGLE, RATE, RATE, RATE)
def test_rotation_vectors_and_their_matrices(
    phi: float, theta: float, psi: float, dphi: float, dtheta: float, dpsi: float
) -> None:
    f, t, p, rates = np.asarray(phi), np.asarray(theta), np.asarray(psi), np.array([dphi, dtheta, dpsi])
    body = rotation_vector.body_rate_matrix(t, p) @ rates
    inertial = rotation_vector.inertial_rate_matrix(f, t) @ rates
    size = 1 + float(np.abs(rates).max())
    # Sums of up to three products: some roundings of the largest rate, and for the turned one those of two matrices.
    assert apart(body, body_rates(t, p, *rates)) < 1e-15 * size
    assert apart(inertial, rotation_vector.inertial_rates(f, t, *rates)) < 1e-15 * size
    assert apart(inertial, orientation.zxz(f, t, p) @ body) < 3e-15 * size
    written_out = [
        dpsi * math.sin(theta) * math.sin(phi) + dtheta * math.cos(phi),
        -dpsi * math.sin(theta) * math.cos(phi) + dtheta * math.sin(phi),
        dpsi * math.cos(theta) + dphi,
    ]
    assert apart(inertial, written_out) < 1e-15 * size


@given(ANGLE, st.floats(1e-3, math.pi - 1e-3), ANGLE)
def test_inverse_matrices(phi: float, theta: float, psi: float) -> None:
    f, t, p = np.asarray(phi), np.asarray(theta), np.asarray(psi)
    # What rounding makes of entries as large as 1 / sin(theta).
    tolerance = 1e-15 / math.sin(theta)
    inverse = rotation_vector.inverse_body_rate_matrix(t, p)
    assert apart(inverse @ rotation_vector.body_rate_matrix(t, p), np.eye(3)) < tolerance
    inverse = rotation_vector.inverse_inertial_rate_matrix(f, t)
    assert apart(inverse @ rotation_vector.inertial_rate_matrix(f, t), np.eye(3)) < tolerance


@pytest.mark.parametrize("theta", [0.0, -0.0, math.pi, -math.pi, 2 * math.pi, 17 * math.pi, 5e-324])
def test_inverse_matrices_name_their_singularity(theta: float) -> None:
    for inverse in (
        lambda t: rotation_vector.inverse_body_rate_matrix(t, np.asarray(0.3)),
        lambda t: rotation_vector.inverse_inertial_rate_matrix(np.asarray(0.3), t),
    ):
        with pytest.raises(rotation_vector.SingularAngles, match=r"sin\(theta\) = 0 at theta = "):
            inverse(np.asarray(theta))
        with pytest.raises(rotation_vector.SingularAngles, match=r"sin\(theta\) = 0"):
            inverse(np.array([1.0, theta]))


def test_a_very_small_theta_is_not_singular() -> None:
    inverse = rotation_vector.inverse_body_rate_matrix(np.asarray(1e-300), np.asarray(0.3))
    assert np.isfinite(inverse).all()


def test_matrices_of_rates_broadcast() -> None:
    few, many = np.array([[0.4], [0.5]]), np.array([0.1, 0.2, 0.3])
    for function in (
        rotation_vector.body_rate_matrix,
        rotation_vector.inverse_body_rate_matrix,
        rotation_vector.inertial_rate_matrix,
    ):
        matrices = function(few, many)
        assert matrices.shape == (2, 3, 3, 3)
        assert apart(matrices[1, 2], function(few[1, 0], many[2])) == 0
        assert function(many, np.asarray(0.4)).shape == function(np.asarray(0.4), many).shape == (3, 3, 3)


@given(ANGLE, ANGLE, ANGLE, RATE, RATE, RATE)
def test_angular_velocity_of_moving_axes(phi: float, theta: float, psi: float, dphi: float, dtheta: float, dpsi: float) -> None:
    """[G 2.41] reproduces [G 2.21a]; the axes move by the inertial rotation vector."""
    f, t, p, rates = np.asarray(phi), np.asarray(theta), np.asarray(psi), np.array([dphi, dtheta, dpsi])
    axes = orientation.zxz(f, t, p)
    moving = np.cross(rotation_vector.inertial_rates(f, t, *rates), axes, axisb=0, axisc=0)
    found = rotation_vector.rates_of_axes(axes, moving)
    assert apart(found, body_rates(t, p, *rates)) < 5e-15 * (1 + float(np.abs(rates).max()))
    assert rotation_vector.rates_of_axes(np.stack([axes, axes]), np.stack([moving, moving])).shape == (2, 3)
