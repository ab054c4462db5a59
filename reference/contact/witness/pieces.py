"""Pieces of a motion: the states of a body at instants within a flight or within a step on the plane."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from bodycheck.reference.independent.arithmetic import WIDE_EPS, Real, Vector, Wide, WideArray
from bodycheck.reference.trajectory import Array

#: The number of roundings of a state in the wide type, relative to the sum of the sizes of its terms.
ROUNDINGS = 64.0 * WIDE_EPS

#: The part of a time up to which an instant counts as this time. Times are known to many more digits.
SAME = 1e-60

#: The largest number of steps of Newton's method for the part of a step at an instant.
NEWTON_STEPS = 60


@dataclass(frozen=True, eq=False)
class Piece:
    """A part of a motion, as polynomials in a parameter s that starts at zero.

    Attributes
    ----------
    start
        The time at which it begins (s).
    position
        (3,) position at the start (m), which `path` is added to.
    turn
        (4,) quaternion w, x, y, z of the rotation from t = 0 to the start, along the axes of the world.
    path, velocity, spin
        (3, k) coefficients of the path (m), of the velocity (m/s) and of the angular velocity (rad/s), world frame.
    turning
        (4, k) coefficients of the rotation since t = 0; None if the body turns about a fixed axis.
    clock
        (k,) coefficients of the time since the start (s).
    """

    start: Real
    position: WideArray
    turn: WideArray
    path: WideArray
    velocity: WideArray
    spin: WideArray
    turning: WideArray | None
    clock: WideArray


@dataclass(frozen=True, eq=False)
class States:
    """The states of one body at n instants, and bounds of their rounding errors.

    Attributes
    ----------
    position, velocity, spin
        (n, 3) position (m), velocity (m/s) and angular velocity (rad/s), world frame.
    turn
        (n, 4) quaternion w, x, y, z of the rotation since t = 0, along the axes of the world.
    errors
        (n,) bounds of rounding errors, by the names of `bounds.STATES`.
    """

    position: WideArray
    velocity: WideArray
    spin: WideArray
    turn: WideArray
    errors: dict[str, Array]


def uniform(start: Real, position: Vector, turn: Vector, velocity: tuple[Vector, Vector], spin: tuple[Vector, Vector]) -> Piece:
    """The piece of a body whose velocity and angular velocity change uniformly, from its state at the start.

    velocity, spin: each at the start, and its constant rate. The angular velocity keeps its axis.
    """
    speeds, rates = (wide(each) for each in velocity)
    none = np.zeros(3, Wide)
    return Piece(
        start,
        wide(position),
        wide(turn),
        np.stack([none, speeds, rates / 2], axis=1),
        np.stack([speeds, rates], axis=1),
        np.stack([wide(each) for each in spin], axis=1),
        None,
        np.array([0, 1], Wide),
    )


def states(pieces: Sequence[Piece], times: Array) -> States:
    """The states at ascending times (n,) >= 0 (s). At the instant of an impact they are those before it."""
    index, lasting = _places(pieces, times)
    position, velocity, spin = (np.zeros((len(times), 3), Wide) for _ in range(3))
    turn = np.zeros((len(times), 4), Wide)
    sizes = np.zeros((4, len(times)))
    for number in np.unique(index):
        here, piece = index == number, pieces[number]
        s = _parameters(piece.clock, lasting[here])
        path, far = _sums(piece.path, s)
        position[here] = piece.position + path
        velocity[here], fast = _sums(piece.velocity, s)
        spin[here], rapid = _sums(piece.spin, s)
        turn[here], turned = _turns(piece, s)
        sizes[:, here] = turned, far + _lengths(piece.position), fast, rapid
    names = "error", "position_error", "velocity_error", "angular_velocity_error"
    return States(position, velocity, spin, turn, dict(zip(names, ROUNDINGS * sizes, strict=True)))


def wide(values: Sequence[Real]) -> WideArray:
    """Numbers of a hundred digits (k,) in the widest type of NumPy."""
    heads = [float(value) for value in values]
    tails = [float(value - head) for value, head in zip(values, heads, strict=True)]
    return np.asarray(np.array(heads, Wide) + np.array(tails, Wide))


def _places(pieces: Sequence[Piece], times: Array) -> tuple[Array, WideArray]:
    """The indices (n,) of the pieces of ascending instants (n,), and the times (n,) since the starts of these pieces (s)."""
    index, lasting, number = np.zeros(len(times), int), [], 0
    for row, time in enumerate(times.tolist()):
        while number + 1 < len(pieces) and pieces[number + 1].start < time * (1 - SAME):
            number += 1
        index[row] = number
        lasting.append(time - pieces[number].start)
    return index, wide(lasting)


def _parameters(clock: WideArray, lasting: WideArray) -> WideArray:
    """The parameters (n,) at which a polynomial of the time (k,), which increases, has the values (n,)."""
    if len(clock) == 2:
        return np.asarray(lasting / clock[1])
    s = np.clip(lasting / clock.sum(), 0, 1)
    pace = clock[1:] * np.arange(1, len(clock))
    for _ in range(NEWTON_STEPS):
        change = (_horner(clock, s) - lasting) / _horner(pace, s)
        s = np.clip(s - change, 0, 1)
        if np.all(np.abs(change) <= WIDE_EPS):
            break
    return np.asarray(s)


def _turns(piece: Piece, s: WideArray) -> tuple[WideArray, Array]:
    """The rotations (n, 4) since t = 0 at parameters (n,), and the sizes (n,) of the angles that they are rounded to."""
    if piece.turning is not None:
        turn, sizes = _sums(piece.turning, s)
        return turn / np.sqrt((turn * turn).sum(axis=1))[:, None], sizes
    first, faster = piece.spin.T
    axis = first if np.any(first) else faster
    size = np.sqrt(axis @ axis)
    axis = axis / (size if size else 1)
    rates = axis @ first, axis @ faster / 2
    angle = s * (rates[0] + s * rates[1])
    added = np.concatenate([np.cos(angle / 2)[:, None], np.sin(angle / 2)[:, None] * axis], axis=1)
    turn = np.stack(multiplied(added.T, piece.turn), axis=1)
    return turn, (1 + s * (abs(rates[0]) + s * abs(rates[1]))).astype(float)


def multiplied(p: Iterable[Any], q: Iterable[Any]) -> tuple[Any, Any, Any, Any]:
    """The components of the product of two quaternions, given by their components w, x, y, z: numbers or arrays."""
    a, b, c, d = p
    w, x, y, z = q
    return (
        a * w - b * x - c * y - d * z,
        a * x + b * w + c * z - d * y,
        a * y - b * z + c * w + d * x,
        a * z + b * y - c * x + d * w,
    )


def along_body(spin: WideArray, attitude: WideArray) -> WideArray:
    """The components (n, 3) of vectors (n, 3) along the axes of a body with attitudes (n, 4)."""
    w, x, y, z = attitude.T
    back = multiplied((w, -x, -y, -z), (np.zeros_like(w), *spin.T))
    return np.stack(multiplied(back, attitude.T)[1:], axis=1)


def _sums(coefficients: WideArray, s: WideArray) -> tuple[WideArray, Array]:
    """The values (n, j) of j polynomials (j, k) at parameters (n,), and the sums (n,) of the sizes of their terms."""
    values = np.stack([_horner(row, s) for row in coefficients], axis=1)
    sizes = _horner(np.sqrt((coefficients * coefficients).sum(axis=0)), np.abs(s))
    return values, sizes.astype(float)


def _horner(coefficients: WideArray, s: WideArray) -> WideArray:
    total = np.zeros_like(s)
    for coefficient in coefficients[::-1]:
        total = total * s + coefficient
    return total


def _lengths(vector: WideArray) -> float:
    return float(np.sqrt(vector @ vector))
