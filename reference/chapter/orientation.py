"""Orientation by rotation matrices [G 2.10-2.20, 2.23-2.26]: chains of rotations, Euler angles, and single rotations.

A1 (..., 3, 3) maps body components to inertial components; its columns are the body axes I, J, K in the inertial frame
[G 2.10]. A2, its transpose, maps inertial components to body components [G 2.11]. Angles are in rad, and arrays of angles
broadcast over their leading axes.
"""

import numpy as np
from scipy.spatial.transform import Rotation

from bodycheck.reference.kinematics import Float, Floats
from bodycheck.reference.trajectory import Array

#: Size up to which entries of a rotation matrix are rounding errors, so that a direction computed from them is meaningless.
SINE_ROUNDING = 4 * float(np.finfo(float).eps)

#: Largest deviation of the scalar products of the axes of a matrix from the scalar products of orthonormal axes. It admits
#: matrices in single precision, but no scaled matrices.
ORTHONORMALITY_TOLERANCE = 1e-6


def rx(alpha: Floats[Float]) -> Floats[Float]:
    """Rx (..., 3, 3) [G 2.15], which maps body components before a rotation by alpha about I to body components after it."""
    c, s, zero, one = _entries(alpha)
    return _matrix([[one, zero, zero], [zero, c, s], [zero, -s, c]])


def ry(beta: Floats[Float]) -> Floats[Float]:
    """Ry (..., 3, 3) [G 2.15], which maps body components before a rotation by beta about J to body components after it."""
    c, s, zero, one = _entries(beta)
    return _matrix([[c, zero, -s], [zero, one, zero], [s, zero, c]])


def rz(gamma: Floats[Float]) -> Floats[Float]:
    """Rz (..., 3, 3) [G 2.15], which maps body components before a rotation by gamma about K to body components after it."""
    c, s, zero, one = _entries(gamma)
    return _matrix([[c, s, zero], [-s, c, zero], [zero, zero, one]])


#: The elementary rotations by the letter of their axis.
ELEMENTARY_ROTATIONS = {"x": rx, "y": ry, "z": rz}


def inertial_to_body(axes: str, *angles: Floats[Float]) -> Floats[Float]:
    """A2 (..., 3, 3) after a chain of rotations about the body's own axes [G 2.20].

    axes: one letter x, y or z for each rotation, the first rotation first; "zxz" gives [G 2.17]. angles: one array (...) of
    angles (rad) for each rotation.

    Raises `ValueError` for other letters, and if the numbers of letters and of angles differ.
    """
    if len(axes) != len(angles) or not set(axes) <= ELEMENTARY_ROTATIONS.keys():
        raise ValueError(f"axes {axes!r} with {len(angles)} angles: give a letter x, y or z for each angle")
    matrix = np.eye(3, dtype=np.result_type(float, *angles))
    for axis, angle in zip(axes, angles, strict=True):
        matrix = ELEMENTARY_ROTATIONS[axis](angle) @ matrix
    return matrix


def body_to_inertial(axes: str, *angles: Floats[Float]) -> Floats[Float]:
    """A1 (..., 3, 3), the transpose of `inertial_to_body` for the same arguments; it raises the same errors [G 2.20]."""
    return np.asarray(np.swapaxes(inertial_to_body(axes, *angles), -1, -2))


def zxz(phi: Floats[Float], theta: Floats[Float], psi: Floats[Float]) -> Floats[Float]:
    """A1 of the book's Euler angles [G 2.14, 2.18].

    Parameters
    ----------
    phi, theta, psi
        (...) rotations about K, then I, then K (rad).

    Returns
    -------
    array
        (..., 3, 3) matrices A1.
    """
    return body_to_inertial("zxz", phi, theta, psi)


def aeronautical(yaw: Floats[Float], pitch: Floats[Float], roll: Floats[Float]) -> Floats[Float]:
    """A1 of the aeronautical angles [G p. 46].

    Here I_z = -sin(theta), as the book's own Ry and its angular velocity require. The book prints sin(theta) with the opposite
    sign throughout.

    Parameters
    ----------
    yaw, pitch, roll
        (...) rotations phi about K, then theta about J, then psi about I (rad).

    Returns
    -------
    array
        (..., 3, 3) matrices A1.
    """
    return body_to_inertial("zyx", yaw, pitch, roll)


def zxz_angles(a1: Floats[Float]) -> tuple[Floats[Float], Floats[Float], Floats[Float]]:
    """Euler angles (phi, theta, psi), each (...), rad, of matrices A1 (..., 3, 3).

    theta is in [0, pi], the others are in [-pi, pi]. Where sin(theta) is zero, or no larger than the rounding of a matrix, only
    phi + psi is determined (where theta = pi: phi - psi). There phi = 0, psi is the whole angle and theta is 0 or pi, which is
    the book's convention [G p. 45].

    Raises `ValueError` if a matrix is not a rotation matrix.
    """
    _require_rotations(a1)
    k = a1[..., 2]
    sine = np.hypot(k[..., 0], k[..., 1])
    singular = sine <= SINE_ROUNDING
    phi = np.where(singular, 0, np.arctan2(k[..., 0], -k[..., 1]))
    theta = np.arctan2(np.where(singular, 0, sine), k[..., 2])
    # psi is measured from the line of nodes I* and not from k.I and k.J. So it compensates for the rounding error of phi, which
    # is large near the singularity.
    nodes = np.stack([np.cos(phi), np.sin(phi)], axis=-1)
    psi = np.arctan2(-(a1[..., :2, 1] * nodes).sum(axis=-1), (a1[..., :2, 0] * nodes).sum(axis=-1))
    return phi, theta, psi


def aeronautical_angles(a1: Floats[Float]) -> tuple[Floats[Float], Floats[Float], Floats[Float]]:
    """Yaw, pitch and roll, each (...), rad, of matrices A1 (..., 3, 3).

    The pitch is in [-pi/2, pi/2], the others are in [-pi, pi]. Where the body axis I is vertical to the rounding of a matrix,
    only yaw - roll is determined (nose up, where pitch = -pi/2: yaw + roll). There yaw = 0, roll is the whole angle and
    pitch is pi/2 or -pi/2.

    Raises `ValueError` if a matrix is not a rotation matrix.
    """
    _require_rotations(a1)
    i = a1[..., 0]
    cosine = np.hypot(i[..., 0], i[..., 1])
    singular = cosine <= SINE_ROUNDING
    yaw = np.where(singular, 0, np.arctan2(i[..., 1], i[..., 0]))
    pitch = np.arctan2(-i[..., 2], np.where(singular, 0, cosine))
    # The roll is measured from the direction of J before the roll, for the same reason as psi in `zxz_angles`.
    level = np.stack([-np.sin(yaw), np.cos(yaw)], axis=-1)
    roll = np.arctan2(-(a1[..., :2, 2] * level).sum(axis=-1), (a1[..., :2, 1] * level).sum(axis=-1))
    return yaw, pitch, roll


def axis_and_angle(a1: Array) -> tuple[Array, Array]:
    """The single rotation that takes the body from the inertial axes to its attitude A1 (..., 3, 3) [G 2.23-2.26].

    Returns the unit axis (..., 3), which has the same components in both frames, and the angle (...), rad, in [0, pi],
    counterclockwise about it. The angle is computed with atan2 from the quaternion, which is accurate near 0 and near pi, where
    the arccos of [G 2.26] loses half of the digits. Of the two axes of a half turn, the axis whose last non-zero component is
    positive is returned. Where there is no rotation, every axis is valid and K is returned.

    Raises `ValueError` if a matrix is not a rotation matrix.
    """
    _require_rotations(a1)
    quaternion = Rotation.from_matrix(np.reshape(a1, (-1, 3, 3))).as_quat(canonical=False)
    vector, scalar = quaternion[:, :3], quaternion[:, 3]
    size = np.hypot(np.hypot(vector[:, 0], vector[:, 1]), vector[:, 2])
    angle = 2 * np.arctan2(size, np.abs(scalar))
    axis = np.where(size[:, None] > 0, vector, [0.0, 0.0, 1.0]) / np.where(size > 0, size, 1)[:, None]
    x, y, z = np.where(np.abs(axis) > SINE_ROUNDING, axis, 0).T
    last = np.where(z != 0, z, np.where(y != 0, y, x))
    half_turn = np.abs(scalar) <= SINE_ROUNDING
    axis *= np.where(np.where(half_turn, last, scalar) < 0, -1, 1)[:, None]
    shape = np.shape(a1)[:-2]
    return axis.reshape(*shape, 3), angle.reshape(shape)


def _entries(angle: Floats[Float]) -> tuple[Floats[Float], Floats[Float], Floats[Float], Floats[Float]]:
    """Cosine and sine of an angle, and zeros and ones, all of its shape."""
    cosine = np.asarray(np.cos(angle))
    return cosine, np.asarray(np.sin(angle)), np.zeros_like(cosine), np.ones_like(cosine)


def _matrix(rows: list[list[Floats[Float]]]) -> Floats[Float]:
    """Matrices (..., 3, 3) from three rows of three entries (...)."""
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def _require_rotations(matrices: Floats[Float]) -> None:
    """Raise `ValueError` unless all matrices (..., 3, 3) are rotation matrices."""
    if np.shape(matrices)[-2:] != (3, 3):
        raise ValueError(f"rotation matrices have the shape (..., 3, 3), not {np.shape(matrices)}")
    i, j, k = np.moveaxis(matrices, -1, 0)
    products = np.swapaxes(matrices, -1, -2) @ matrices
    # Both comparisons are false for NaN, so that a matrix with NaN is rejected.
    if (
        not (np.abs(products - np.eye(3)) <= ORTHONORMALITY_TOLERANCE).all()
        or not ((np.cross(i, j) * k).sum(axis=-1) > 0).all()
    ):
        raise ValueError("not rotation matrices: the axes are not orthonormal, right-handed and finite")
