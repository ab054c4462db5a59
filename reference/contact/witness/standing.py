"""Bodies that stand on a face or, as spheres, on a point, and the points at which they bear each other."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.contact.witness.faces import DECIMALS, along_plane, axis, half_lengths
from bodycheck.reference.contact.witness.reading import FreeBody
from bodycheck.reference.independent.arithmetic import Real, Vector, cross, dot, norm
from bodycheck.reference.independent.border import MP
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.scene import Brick, Cylinder, Sphere
from bodycheck.reference.trajectory import Array

#: The number of corners of the polygon within a disk.
CORNERS = 96


@dataclass(frozen=True, eq=False)
class Standing:
    """A body that stands.

    Attributes
    ----------
    body
        The body.
    height
        Half its height along the normal (m).
    middle
        The height of its centre of mass above the plane (m).
    half
        Its larger half-length (m).
    foot
        (k, 2) the corners of its face along axes in the plane, counter-clockwise; one point for a sphere (m).
    tilt
        The angle by which it does not stand upright, because of the decimals in the file (rad).
    """

    body: FreeBody
    height: Real
    middle: Real
    half: float
    foot: Array
    tilt: float


def axes_of(normal: Vector) -> tuple[Vector, Vector]:
    """Two unit vectors along a plane that is turned about y: downhill, and across."""
    across = (MP.zero, MP.one, MP.zero)
    return cross(across, normal), across


def standing(body: FreeBody, normal: Vector) -> Standing | None:
    """The body as one that stands on a plane, or None if no face of it is parallel to the plane."""
    basis = axes_of(normal)
    centre = np.array([float(dot(body.position, each)) for each in basis])
    middle = dot(body.position, normal)
    match body.shape:
        case Sphere(radius):
            return Standing(body, MP.mpf(radius), middle, radius, centre[None], 0.0)
        case Cylinder() | Brick():
            halves = half_lengths(body)
        case _:
            return None
    slants = [norm(along_plane(axis(body, each), normal)) for each in range(3)]
    up = 2 if isinstance(body.shape, Cylinder) else min(range(3), key=lambda each: slants[each])
    if slants[up] > DECIMALS:
        return None
    if isinstance(body.shape, Cylinder):
        angles = 2 * np.pi * np.arange(CORNERS) / CORNERS
        foot = centre + float(halves[0]) * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    else:
        sides = [
            float(halves[each]) * np.array([float(dot(axis(body, each), along)) for along in basis])
            for each in range(3)
            if each != up
        ]
        turned = sides[0][0] * sides[1][1] > sides[0][1] * sides[1][0]
        one, other = sides if turned else sides[::-1]
        foot = centre + np.array([one + other, other - one, -one - other, one - other])
    return Standing(body, halves[up], middle, float(max(halves)), foot, float(slants[up]))


def shared(one: Array, other: Array) -> Array:
    """The corners (k, 2) of the area that two convex faces have in common, counter-clockwise; empty if they have none.

    A face may be a single point, which is the result if it is within the other face.
    """
    if len(one) == 1:
        one, other = other, one
    corners = list(other)
    for begin, end in zip(one, np.roll(one, -1, axis=0), strict=True):
        along = end - begin
        sides = [along[0] * (corner[1] - begin[1]) - along[1] * (corner[0] - begin[0]) for corner in corners]
        kept = []
        for index, corner in enumerate(corners):
            before, side = sides[index - 1], sides[index]
            if before * side < 0:
                kept.append(corners[index - 1] + (corner - corners[index - 1]) * (before / (before - side)))
            if side >= 0:
                kept.append(corner)
        corners = kept
    return np.array(corners).reshape(-1, 2)


def shrunk(face: Array, part: float) -> Array:
    """A face that is made smaller about its centre by a part of itself."""
    centre = face.mean(axis=0)
    return np.asarray(centre + (1 - part) * (face - centre))


def friction_of(scene: AnyScene, pair: Sequence[int]) -> Real:
    """The coefficient of friction of two bodies, or of a body and the plane, by their indices; it may be infinite."""
    assert scene.plane is not None  # the caller has checked this
    contacts = scene.contacts if isinstance(scene, Mechanism) else ()
    stated = [contact.friction for contact in contacts if set(contact.bodies) == set(pair)]
    return MP.mpf(stated[0] if stated else scene.plane.friction)
