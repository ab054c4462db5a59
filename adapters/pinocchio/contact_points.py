"""Find the points at which bodies touch a plane and each other, in every step.

- On the plane: the corners of a brick; the lowest point of a sphere or an ellipsoid; of a cylinder, at each end, the lowest
  point of the rim and three others, a quarter of the rim apart, so that it may roll on its side or stand.
- A sphere and a brick, or two spheres: the closest points of the two bodies.
- Two bricks: the corners of the part of one brick's face that is over a face of the other brick. Contacts of crossing edges are
  not found.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.mechanisms.mechanism import WORLD
from bodycheck.reference.scene import Brick, Cylinder, Ellipsoid, Shape, Sphere
from bodycheck.reference.trajectory import Array

#: The corners of a brick in half-lengths.
CORNERS = np.array([[x, y, z] for x in (1.0, -1.0) for y in (1.0, -1.0) for z in (1.0, -1.0)])

#: Distance beyond the edge of a face, relative to its size, up to which a corner is on the face.
ON_EDGE = 1e-9


@dataclass(frozen=True, eq=False)
class Point:
    """A point at which two bodies touch, or may touch within a step.

    Attributes
    ----------
    bodies
        The indices of the two bodies, the lower first; the first may be `WORLD`.
    number
        The number of the point among the points of the two bodies.
    position
        The position (3,) of the point, world frame (m).
    axes
        Two tangents and the normal as columns (3, 3), world frame. The normal points from the first body to the second.
    gap
        The distance between the two bodies at the point (m); negative if they overlap.
    """

    bodies: tuple[int, int]
    number: int
    position: Array
    axes: Array
    gap: float


@dataclass(frozen=True, eq=False)
class Placed:
    """A shape, with the position (3,) of its centre (m) and the rotation matrix (3, 3) from its axes to the world's axes."""

    shape: Shape
    centre: Array
    turn: Array


def radius(shape: Shape) -> float:
    """Return the radius (m) of the smallest sphere around the centre of a shape that contains the shape."""
    match shape:
        case Brick(semi_axes):
            return math.hypot(*semi_axes)
        case Ellipsoid(semi_axes):
            return max(semi_axes)
        case Cylinder(own, half_length):
            return math.hypot(own, half_length)
        case Sphere(own):
            return own


def on_plane(index: int, body: Placed, axes: Array, margin: float) -> Iterator[Point]:
    """Yield the points of a body that are at most a margin (m) above the plane through the origin with the given axes (3, 3).

    The columns of `axes` are two tangents of the plane and its normal.
    """
    normal = axes[:, 2]
    if normal @ body.centre - radius(body.shape) > margin:
        return
    points = body.centre + lowest(body.shape, -normal @ body.turn) @ body.turn.T
    gaps = (points @ normal).tolist()
    for number, gap in enumerate(gaps):
        if gap <= margin:
            yield Point((WORLD, index), number, points[number], axes, gap)


def lowest(shape: Shape, down: Array) -> Array:
    """Return the points (n, 3) of a shape that may be its lowest points; `down` (3,) is a unit vector. All are in its frame."""
    match shape:
        case Brick(semi_axes):
            return np.asarray(CORNERS * semi_axes)
        case Sphere(own):
            return np.asarray(own * down[None])
        case Ellipsoid(semi_axes):
            scaled = down * semi_axes
            return np.asarray((scaled * semi_axes / np.linalg.norm(scaled))[None])
        case Cylinder(own, half_length):
            across = math.hypot(down[0], down[1])
            x, y = (own * down[:2] / across).tolist() if across else (own, 0.0)
            rim = [(x, y), (-y, x), (-x, -y), (y, -x)]
            return np.array([[*point, end] for end in (half_length, -half_length) for point in rim])


def between(places: tuple[int, int], one: Placed, other: Placed, margin: float) -> Iterator[Point]:
    """Yield the points at which the gap between two bodies is at most a margin (m)."""
    match one.shape, other.shape:
        case Sphere(first), Sphere(second):
            apart = other.centre - one.centre
            distance = float(np.linalg.norm(apart))
            if (gap := distance - first - second) <= margin:
                normal = apart / distance
                yield Point(places, 0, one.centre + first * normal, with_tangents(normal), gap)
        case Brick(semi_axes), Sphere(own):
            yield from _on_brick(places, one, np.array(semi_axes), other.centre, own, 1.0, margin)
        case Sphere(own), Brick(semi_axes):
            yield from _on_brick(places, other, np.array(semi_axes), one.centre, own, -1.0, margin)
        case Brick(first), Brick(second):
            yield from _face_to_face(places, (one, np.array(first)), (other, np.array(second)), margin)


def _on_brick(
    places: tuple[int, int], brick: Placed, half: Array, centre: Array, radius_of_ball: float, sign: float, margin: float
) -> Iterator[Point]:
    """Yield the contact point of a sphere and a brick if their gap is at most a margin (m).

    `sign` is 1 if the normal points from the brick to the sphere, and -1 if it points from the sphere to the brick.
    """
    local = (centre - brick.centre) @ brick.turn
    closest = np.clip(local, -half, half)
    apart = local - closest
    distance = float(np.linalg.norm(apart))
    if distance:
        normal = apart / distance
    else:  # the centre of the sphere is in the brick
        axis = int(np.argmin(half - np.abs(local)))
        normal = np.zeros(3)
        normal[axis] = math.copysign(1.0, local[axis])
        distance = float(abs(local[axis]) - half[axis])
        closest[axis] = normal[axis] * half[axis]
    if (gap := distance - radius_of_ball) <= margin:
        axes = with_tangents(sign * (brick.turn @ normal))
        yield Point(places, 0, brick.centre + brick.turn @ closest, axes, gap)


def _face_to_face(
    places: tuple[int, int], one: tuple[Placed, Array], other: tuple[Placed, Array], margin: float
) -> Iterator[Point]:
    """Yield the corners of the part of a face of one brick that is over a face of the other brick."""
    apart = other[0].centre - one[0].centre
    distances = [_separations(one, other, apart), _separations(other, one, -apart)]
    which = int(distances[1].max() > distances[0].max() + ON_EDGE * one[1].max())
    if distances[which].max() > margin:
        return
    (base, half), (above, size) = (one, other) if which == 0 else (other, one)
    axis = int(np.argmax(distances[which]))
    toward = apart if which == 0 else -apart
    normal = base.turn[:, axis] * math.copysign(1.0, toward @ base.turn[:, axis])
    facing = normal @ above.turn
    face = int(np.argmax(np.abs(facing)))
    a, b = (face + 1) % 3, (face + 2) % 3
    corners = np.zeros((4, 3))
    corners[:, face] = -math.copysign(size[face], facing[face])
    corners[:, a], corners[:, b] = size[a] * np.array([1, -1, -1, 1]), size[b] * np.array([1, 1, -1, -1])
    polygon = (above.centre + corners @ above.turn.T - base.centre) @ base.turn
    sides = [(axis + 1) % 3, (axis + 2) % 3]
    for side in sides:
        for sign in (1.0, -1.0):
            polygon = _cut(polygon, sign * polygon[:, side] - half[side] * (1 + ON_EDGE))
            if not len(polygon):
                return
    axes = with_tangents(normal if which == 0 else -normal)
    points = base.centre + polygon @ base.turn.T
    gaps = ((points - base.centre) @ normal - half[axis]).tolist()
    for number, gap in enumerate(gaps):
        if gap <= margin:
            yield Point(places, number, points[number], axes, gap)


def _separations(one: tuple[Placed, Array], other: tuple[Placed, Array], apart: Array) -> Array:
    """Return the gaps (3,) between two bricks along the axes of the first one (m); negative where their projections overlap.

    `apart` is the vector (3,) from the centre of the first brick to the centre of the second.
    """
    (base, half), (above, size) = one, other
    return np.asarray(np.abs(apart @ base.turn) - half - np.abs(base.turn.T @ above.turn) @ size)


def _cut(polygon: Array, beyond: Array) -> Array:
    """Return the part of a polygon (n, 3) that is not beyond a plane; `beyond` (n,) are the distances of its corners (m)."""
    if (beyond <= 0).all():
        return polygon
    kept = []
    for index in range(len(polygon)):
        here, there = float(beyond[index - 1]), float(beyond[index])
        if (here <= 0) != (there <= 0):
            kept.append(polygon[index - 1] + here / (here - there) * (polygon[index] - polygon[index - 1]))
        if there <= 0:
            kept.append(polygon[index])
    return np.array(kept).reshape(-1, 3)


def with_tangents(normal: Array) -> Array:
    """Return two tangents and the given unit normal (3,) as the columns of a right-handed matrix (3, 3)."""
    first = np.zeros(3)
    first[int(np.argmin(np.abs(normal)))] = 1.0
    first -= (first @ normal) * normal
    first /= np.linalg.norm(first)
    return np.column_stack([first, np.cross(normal, first), normal])
