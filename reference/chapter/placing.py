"""Orientation of a body with one axis along a given direction [G pp. 41-44], and the axes of a wheel [G 2.22].

A direction is given by its longitude alpha, from i towards j, and its colatitude beta, from k, both in rad. Arrays of angles
broadcast.
"""

from typing import Literal

import numpy as np

from bodycheck.reference.kinematics import Float, Floats

#: A body axis.
Axis = Literal["I", "J", "K"]


def direction(alpha: Floats[Float], beta: Floats[Float]) -> Floats[Float]:
    """The unit vector V (..., 3) of a longitude alpha (...) and a colatitude beta (...), rad [G 2.6, p. 41]."""
    sine = np.sin(beta)
    return np.stack(np.broadcast_arrays(np.cos(alpha) * sine, np.sin(alpha) * sine, np.cos(beta)), axis=-1)


def longitude_and_colatitude(vector: Floats[Float]) -> tuple[Floats[Float], Floats[Float]]:
    """Longitude alpha in [-pi, pi] and colatitude beta in [0, pi], each (...), rad, of vectors (..., 3) of any length.

    Along k and -k, where the longitude is undefined, alpha = 0.

    Raises `ValueError` for a vector that has zero length or is not finite.
    """
    x, y, z = np.moveaxis(vector, -1, 0)
    level = np.hypot(x, y)
    if not (np.isfinite(vector).all() and (np.hypot(level, z) > 0).all()):
        raise ValueError("a vector has a direction only if its length is finite and not zero")
    return np.where(level > 0, np.arctan2(y, x), 0), np.arctan2(level, z)


def place(axis: Axis, alpha: Floats[Float], beta: Floats[Float], turn: Floats[Float]) -> Floats[Float]:
    """A1 of a body with one axis along a given direction, rotated by a given angle about that axis [G pp. 41-43].

    Before the rotation, the axis that is horizontal and points to the east of the direction is K if I is placed, -K if J is
    placed, and I if K is placed. In Euler angles this is phi = alpha, theta = -pi/2 for I; phi = alpha, theta = pi/2 for J; and
    phi = alpha + pi/2, theta = beta for K. Where beta is 0 or pi, alpha and `turn` are rotations about the same axis and
    both count.

    Parameters
    ----------
    axis
        The body axis to place.
    alpha, beta
        (...) longitude and colatitude of the direction (rad).
    turn
        (...) rotation about the axis (rad): xi about I, chi about J, psi about K.

    Returns
    -------
    array
        (..., 3, 3) matrices A1, body to inertial.
    """
    alpha, beta, turn = np.broadcast_arrays(alpha, beta, turn)
    along = direction(alpha, beta)
    east = np.stack([-np.sin(alpha), np.cos(alpha), np.zeros_like(along[..., 0])], axis=-1)
    south = np.cross(east, along)
    c, s = np.cos(turn)[..., None], np.sin(turn)[..., None]
    match axis:
        case "I":
            columns = [along, c * south + s * east, c * east - s * south]
        case "J":
            columns = [c * south + s * east, along, s * south - c * east]
        case "K":
            columns = [c * east - s * south, -c * south - s * east, along]
    return np.stack(columns, axis=-1)


def place_along(axis: Axis, vector: Floats[Float], turn: Floats[Float]) -> Floats[Float]:
    """A1 of a body with one axis along given vectors, rotated by a given angle about that axis; see `place`.

    Parameters
    ----------
    axis
        The body axis to place.
    vector
        (..., 3) vectors of any length, in the inertial frame.
    turn
        (...) rotation about the axis (rad).

    Returns
    -------
    array
        (..., 3, 3) matrices A1, body to inertial.

    Raises
    ------
    ValueError
        If a vector has zero length or is not finite.
    """
    return place(axis, *longitude_and_colatitude(vector), turn)


def wheel_axes(phi: Floats[Float], theta: Floats[Float]) -> tuple[Floats[Float], Floats[Float]]:
    """The axes I* along the track and J* from the ground to the axle K of a wheel, each (..., 3), inertial frame [G 2.22].

    They are the body axes I and J before the rotation psi about the axle, for Euler angles phi and theta (...), rad. Where
    theta > 0, a positive spin rolls the wheel towards -I*.
    """
    c, s = np.broadcast_arrays(np.cos(theta), np.sin(theta))
    along = np.stack(np.broadcast_arrays(np.cos(phi), np.sin(phi), 0 * c), axis=-1)
    up = np.stack(np.broadcast_arrays(-c * np.sin(phi), c * np.cos(phi), s), axis=-1)
    return along, up
