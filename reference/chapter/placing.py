"""Placing one body axis along a direction, with a free turn about it [G pp. 41-44], and the axes of a wheel [G 2.22].

A direction is its longitude alpha, from i towards j, and its colatitude beta, from k (rad, arrays that broadcast).
"""

from typing import Literal

import numpy as np

from bodycheck.reference.kinematics import Float, Floats

Axis = Literal["I", "J", "K"]


def direction(alpha: Floats[Float], beta: Floats[Float]) -> Floats[Float]:
    """The unit vector V (..., 3) of a longitude and a colatitude [G 2.6, p. 41]."""
    sine = np.sin(beta)
    return np.stack(np.broadcast_arrays(np.cos(alpha) * sine, np.sin(alpha) * sine, np.cos(beta)), axis=-1)


def longitude_and_colatitude(vector: Floats[Float]) -> tuple[Floats[Float], Floats[Float]]:
    """alpha in [-pi, pi] and beta in [0, pi] of vectors (..., 3) of any length other than 0.

    Along k and -k, where there is no longitude, alpha = 0.

    Raises `ValueError` for a vector without a length, or one that is not finite.
    """
    x, y, z = np.moveaxis(vector, -1, 0)
    level = np.hypot(x, y)
    if not (np.isfinite(vector).all() and (np.hypot(level, z) > 0).all()):
        raise ValueError("a vector has a direction where its length is finite and not 0")
    return np.where(level > 0, np.arctan2(y, x), 0), np.arctan2(level, z)


def place(axis: Axis, alpha: Floats[Float], beta: Floats[Float], turn: Floats[Float]) -> Floats[Float]:
    """A1 (..., 3, 3) of a body whose axis points along a direction and which has turned about it [G pp. 41-43].

    turn: xi about I, chi about J, psi about K (rad). At turn = 0 the axis horizontal and to the east of the direction is K for
    I, -K for J, I for K: phi = alpha, theta = -+pi/2 for I and J, phi = alpha + pi/2, theta = beta for K. Where beta is 0 or
    pi, alpha and the turn are confounded and both count.
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
    """A1 (..., 3, 3) of a body whose axis points along vectors (..., 3) of any length; turn as for `place`.

    Raises `ValueError` for a vector without a length, or one that is not finite.
    """
    return place(axis, *longitude_and_colatitude(vector), turn)


def wheel_axes(phi: Floats[Float], theta: Floats[Float]) -> tuple[Floats[Float], Floats[Float]]:
    """I* along the track and J* from the ground to the axle K, (..., 3) each: the body axes at psi = 0 [G 2.22].

    For theta > 0 a positive spin rolls the wheel towards -I*.
    """
    c, s = np.broadcast_arrays(np.cos(theta), np.sin(theta))
    along = np.stack(np.broadcast_arrays(np.cos(phi), np.sin(phi), 0 * c), axis=-1)
    up = np.stack(np.broadcast_arrays(-c * np.sin(phi), c * np.cos(phi), s), axis=-1)
    return along, up
