"""Orientation by matrices [G 2.10-2.20, 2.23-2.26]: chains of body rotations, the angles and the one rotation behind a matrix.

A1 (..., 3, 3) maps body to inertial components, its columns being the body axes I, J, K in the inertial frame [G 2.10];
A2, its transpose, maps inertial to body components [G 2.11]. Angles are in rad and broadcast over leading axes.
"""

import numpy as np
from scipy.spatial.transform import Rotation

from bodycheck.reference.kinematics import Float, Floats
from bodycheck.reference.trajectory import Array

#: Entries of a rotation matrix up to this size are rounding, and the direction that they give means nothing.
SINE_ROUNDING = 4 * float(np.finfo(float).eps)

#: How far the axes of a matrix may be from orthonormal: what single precision leaves of them, and no reflection or scaling.
ORTHONORMALITY_TOLERANCE = 1e-6


def rx(alpha: Floats[Float]) -> Floats[Float]:
    """Rx of [G 2.15], (..., 3, 3): components as seen from a body that turns by alpha about its own I."""
    c, s, zero, one = _entries(alpha)
    return _matrix([[one, zero, zero], [zero, c, s], [zero, -s, c]])


def ry(beta: Floats[Float]) -> Floats[Float]:
    """Ry of [G 2.15], (..., 3, 3): components as seen from a body that turns by beta about its own J."""
    c, s, zero, one = _entries(beta)
    return _matrix([[c, zero, -s], [zero, one, zero], [s, zero, c]])


def rz(gamma: Floats[Float]) -> Floats[Float]:
    """Rz of [G 2.15], (..., 3, 3): components as seen from a body that turns by gamma about its own K."""
    c, s, zero, one = _entries(gamma)
    return _matrix([[c, s, zero], [-s, c, zero], [zero, zero, one]])


ELEMENTARY_ROTATIONS = {"x": rx, "y": ry, "z": rz}


def inertial_to_body(axes: str, *angles: Floats[Float]) -> Floats[Float]:
    """A2 (..., 3, 3) after any number of turns about the body's own axes, the first one first [G 2.20].

    axes: a letter x, y or z a turn, "zxz" for [G 2.17]. angles: one (...) a turn.

    Raises `ValueError` for other letters, and where there is not one angle a letter.
    """
    if len(axes) != len(angles) or not set(axes) <= ELEMENTARY_ROTATIONS.keys():
        raise ValueError(f"axes {axes!r} with {len(angles)} angles: give a letter x, y or z for each angle")
    matrix = np.eye(3, dtype=np.result_type(float, *angles))
    for axis, angle in zip(axes, angles, strict=True):
        matrix = ELEMENTARY_ROTATIONS[axis](angle) @ matrix
    return matrix


def body_to_inertial(axes: str, *angles: Floats[Float]) -> Floats[Float]:
    """A1 (..., 3, 3) of the same chain, whose columns are the body axes in the inertial frame [G 2.20]. Raises likewise."""
    return np.asarray(np.swapaxes(inertial_to_body(axes, *angles), -1, -2))


def zxz(phi: Floats[Float], theta: Floats[Float], psi: Floats[Float]) -> Floats[Float]:
    """A1 (..., 3, 3) of the book's Euler angles [G 2.14, 2.18]."""
    return body_to_inertial("zxz", phi, theta, psi)


def aeronautical(yaw: Floats[Float], pitch: Floats[Float], roll: Floats[Float]) -> Floats[Float]:
    """A1 (..., 3, 3) of yaw phi about K, then pitch theta about J, then roll psi about I [G p. 46].

    With I_z = -sin(theta), as the book's own Ry and its angular velocity require; the book prints sin(theta) with the other
    sign throughout.
    """
    return body_to_inertial("zyx", yaw, pitch, roll)


def zxz_angles(a1: Floats[Float]) -> tuple[Floats[Float], Floats[Float], Floats[Float]]:
    """Euler angles (phi, theta, psi) of A1 (..., 3, 3), theta in [0, pi], the others in [-pi, pi].

    Where sin(theta) is 0, or no larger than rounding in a matrix, only phi + psi (at theta = pi: phi - psi) is determined:
    there phi = 0, psi turns and theta is 0 or pi, the book's convention [G p. 45].

    Raises `ValueError` where a matrix is not a rotation.
    """
    _require_rotations(a1)
    k = a1[..., 2]
    sine = np.hypot(k[..., 0], k[..., 1])
    singular = sine <= SINE_ROUNDING
    phi = np.where(singular, 0, np.arctan2(k[..., 0], -k[..., 1]))
    theta = np.arctan2(np.where(singular, 0, sine), k[..., 2])
    # From the line of nodes I*, and not from k.I and k.J: so psi makes up for what rounding near the singularity does to phi.
    nodes = np.stack([np.cos(phi), np.sin(phi)], axis=-1)
    psi = np.arctan2(-(a1[..., :2, 1] * nodes).sum(axis=-1), (a1[..., :2, 0] * nodes).sum(axis=-1))
    return phi, theta, psi


def aeronautical_angles(a1: Floats[Float]) -> tuple[Floats[Float], Floats[Float], Floats[Float]]:
    """Yaw, pitch and roll of A1 (..., 3, 3), pitch in [-pi/2, pi/2], the others in [-pi, pi].

    Where the body axis I is vertical, to the rounding of a matrix, only yaw - roll (nose up, pitch = -pi/2: yaw + roll) is
    determined: there yaw = 0, roll turns and pitch is +-pi/2.

    Raises `ValueError` where a matrix is not a rotation.
    """
    _require_rotations(a1)
    i = a1[..., 0]
    cosine = np.hypot(i[..., 0], i[..., 1])
    singular = cosine <= SINE_ROUNDING
    yaw = np.where(singular, 0, np.arctan2(i[..., 1], i[..., 0]))
    pitch = np.arctan2(-i[..., 2], np.where(singular, 0, cosine))
    # From the direction of J before the roll, for the same reason as psi in `zxz_angles`.
    level = np.stack([-np.sin(yaw), np.cos(yaw)], axis=-1)
    roll = np.arctan2(-(a1[..., :2, 2] * level).sum(axis=-1), (a1[..., :2, 1] * level).sum(axis=-1))
    return yaw, pitch, roll


def axis_and_angle(a1: Array) -> tuple[Array, Array]:
    """The single rotation that brings the body from the inertial axes to where it is [G 2.23-2.26].

    Returns the unit axis (..., 3), whose components are the same in both frames, and the angle (...) in [0, pi],
    counterclockwise about it. Found by atan2 from the quaternion: accurate near 0 and pi, where the arccos of
    [G 2.26] loses half the digits. Of the two axes of a half turn that is taken whose last component other than 0 is
    positive; without rotation, where every axis is one, it is K.

    Raises `ValueError` where a matrix is not a rotation.
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
    cosine = np.asarray(np.cos(angle))
    return cosine, np.asarray(np.sin(angle)), np.zeros_like(cosine), np.ones_like(cosine)


def _matrix(rows: list[list[Floats[Float]]]) -> Floats[Float]:
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def _require_rotations(matrices: Floats[Float]) -> None:
    if np.shape(matrices)[-2:] != (3, 3):
        raise ValueError(f"rotation matrices are (..., 3, 3), not {np.shape(matrices)}")
    i, j, k = np.moveaxis(matrices, -1, 0)
    products = np.swapaxes(matrices, -1, -2) @ matrices
    # Both comparisons are false for NaN, so that a matrix with NaN is rejected.
    if (
        not (np.abs(products - np.eye(3)) <= ORTHONORMALITY_TOLERANCE).all()
        or not ((np.cross(i, j) * k).sum(axis=-1) > 0).all()
    ):
        raise ValueError("not rotation matrices: the axes are not orthonormal, right-handed and finite")
