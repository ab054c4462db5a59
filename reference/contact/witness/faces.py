"""The axes, half-lengths and corners of bodies with faces, with a hundred digits, and conversions to the wide type."""

from collections.abc import Sequence

import numpy as np

from bodycheck.reference.contact.witness.reading import FreeBody
from bodycheck.reference.independent.arithmetic import (
    Real,
    Vector,
    Wide,
    applied,
    dot,
    minus,
    scaled,
    transposed,
    wide,
)
from bodycheck.reference.independent.border import MP
from bodycheck.reference.scene import Brick, Cylinder
from bodycheck.reference.witness import WideArray

#: The ratio of a length to the size of a body, or of a velocity along the normal to the whole velocity, up to which it counts
#: as zero, because of the decimals in the file.
DECIMALS = 1e-12

#: No velocity, or no acceleration.
STILL: Vector = (MP.zero, MP.zero, MP.zero)

#: The unit vectors along x, y and z.
AXES: tuple[Vector, ...] = tuple(tuple(MP.mpf(row == column) for column in range(3)) for row in range(3))


def axis(body: FreeBody, index: int) -> Vector:
    """An axis of a body, by its index, world frame."""
    return transposed(body.cosines)[index]


def along_axes(body: FreeBody, vector: Vector) -> Vector:
    """The components along the axes of a body of a vector in the world frame."""
    return applied(transposed(body.cosines), vector)


def in_world(body: FreeBody, vector: Vector) -> Vector:
    """The components in the world frame of a vector along the axes of a body."""
    return applied(body.cosines, vector)


def numbers(values: Sequence[float]) -> Vector:
    """Three doubles as numbers of a hundred digits."""
    x, y, z = values
    return MP.mpf(x), MP.mpf(y), MP.mpf(z)


def half_lengths(body: FreeBody) -> Vector:
    """The half-lengths of a brick or a cylinder along its axes (m): for a cylinder, its radius, twice, and half its length."""
    match body.shape:
        case Brick(semi_axes):
            return numbers(semi_axes)
        case Cylinder(radius, half_length):
            return numbers((radius, radius, half_length))
        case _:
            raise TypeError(body.shape)  # callers have excluded other shapes


def along_plane(vector: Vector, normal: Vector) -> Vector:
    """The part of a vector that is perpendicular to a unit normal."""
    return minus(vector, scaled(normal, dot(vector, normal)))


def wide_vector(vector: Sequence[Real]) -> WideArray:
    """A vector of a hundred digits, rounded to the wide type."""
    return np.array([wide(component) for component in vector], dtype=Wide)
