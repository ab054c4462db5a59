"""Bodies that stand on a face, or on a point of a sphere: the positions of their faces, and the common areas of two faces."""

from dataclasses import dataclass

import numpy as np

from bodycheck.reference.contact.problem import NONE, ContactBody
from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.kinematics import conjugate, rotate
from bodycheck.reference.scene import Brick, Cylinder, Ellipsoid, Sphere
from bodycheck.reference.witness import WideArray

#: The number of corners of the polygon that represents a disk.
CORNERS = 256

#: The fraction by which outlines are shrunk, or enlarged, for the check whether two outlines have an area in common.
SLIVER = 1e-9


@dataclass(frozen=True, eq=False)
class Upright:
    """A body with a lower and an upper face that are parallel to the plane, seen along the normal.

    Attributes
    ----------
    centre
        (2,) centre of its faces along x and y (m).
    bottom, top
        Heights of its faces above the plane (m).
    half
        (2,) half-lengths of a rectangle, or the radius of a disk in both components (m).
    sides
        (2, 2) unit vectors along the sides of a rectangle, as rows.
    disk
        Whether its faces are disks, not rectangles. The faces of a sphere are points, and the disk is its outline.
    ball
        Whether it is a sphere.
    tilt
        The angle between its axis and the normal (rad), which differs from zero only by the decimals in the file.
    """

    centre: WideArray
    bottom: Wide
    top: Wide
    half: WideArray
    sides: WideArray
    disk: bool
    ball: bool
    tilt: float

    @property
    def size(self) -> float:
        """The larger half-length (m)."""
        return float(max(*self.half, (self.top - self.bottom) / 2))


def upright(body: ContactBody) -> Upright | None:
    """Return the faces of a body that stands; None for an ellipsoid, and for a body that does not stand on a face."""
    match body.shape:
        case Sphere(radius):
            return _standing(body, np.eye(3), (radius, radius, radius), ball=True)
        case Brick(semi_axes):
            rows = rotate(conjugate(body.quaternion), np.eye(3, dtype=Wide)).T
            return _standing(body, rows, semi_axes)
        case Cylinder(radius, half_length):
            rows = rotate(conjugate(body.quaternion), np.eye(3, dtype=Wide)).T
            return _standing(body, rows, (radius, radius, half_length))
        case Ellipsoid():
            return None


def _standing(body: ContactBody, rows: WideArray, half: tuple[float, float, float], *, ball: bool = False) -> Upright | None:
    """Return the faces of a body that stands; None if none of its axes is along the normal.

    rows: (3, 3) its axes, one per row, along the axes of the plane. half: its half-lengths along its axes (m).
    """
    vertical = int(np.argmax(np.abs(rows[:, 2])))
    tilt = float(np.hypot(*np.delete(rows[:, 2], vertical)))
    disk = not isinstance(body.shape, Brick)
    if tilt > NONE or (isinstance(body.shape, Cylinder) and vertical != 2):
        return None
    lengths = np.array(half, dtype=Wide)
    height = lengths[vertical]
    return Upright(
        centre=body.position[:2],
        bottom=body.position[2] - height,
        top=body.position[2] + height,
        half=np.delete(lengths, vertical),
        sides=np.delete(rows, vertical, axis=0)[:, :2],
        disk=disk,
        ball=ball,
        tilt=tilt,
    )


def margin(face: Upright, point: WideArray) -> Wide:
    """Return the distance (m) of a point (2,) from the border of a face's outline; negative for a point outside."""
    away = face.sides @ (point - face.centre)
    return Wide(face.half[0] - np.hypot(*away) if face.disk else np.min(face.half - np.abs(away)))


def outline(face: Upright, *, larger: float = 0.0) -> WideArray:
    """The corners (k, 2) of the outline of a face, counter-clockwise. A disk is represented by a polygon within or around it.

    larger: the fraction by which the outline is enlarged, or shrunk if it is negative.
    """
    if face.disk:
        angles = 2 * np.pi * np.arange(CORNERS) / CORNERS
        around = 1 / np.cos(np.pi / CORNERS) if larger > 0 else 1.0
        corners = around * face.half[0] * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    else:
        corners = (np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) * face.half) @ face.sides
        if np.linalg.det(face.sides.astype(float)) < 0:
            corners = corners[::-1]
    return np.asarray(face.centre + (1 + larger) * corners)


def common(one: WideArray, other: WideArray) -> WideArray:
    """The corners (k, 2), counter-clockwise, of the intersection of two convex polygons; empty if they do not intersect."""
    if len(other) > len(one):
        one, other = other, one
    corners = list(one)
    for begin, end in zip(other, np.roll(other, -1, axis=0), strict=True):
        along, kept = end - begin, []
        inside = [along[0] * (corner[1] - begin[1]) - along[1] * (corner[0] - begin[0]) for corner in corners]
        for index, corner in enumerate(corners):
            before = index - 1
            if (inside[index] >= 0) != (inside[before] >= 0):
                part = inside[before] / (inside[before] - inside[index])
                kept.append(corners[before] + part * (corner - corners[before]))
            if inside[index] >= 0:
                kept.append(corner)
        corners = kept
    return np.array(corners).reshape(-1, 2)


def meet(one: Upright, other: Upright, *, larger: float) -> bool:
    """Return whether the outlines of two bodies have points in common. larger: the fraction by which both are enlarged."""
    apart = np.hypot(*(one.centre - other.centre))
    if one.disk and other.disk:
        return bool(apart < (1 + larger) * (one.half[0] + other.half[0]))
    if apart > (1 + abs(larger)) * (np.hypot(*one.half) + np.hypot(*other.half)):
        return False
    return len(common(outline(one, larger=larger), outline(other, larger=larger))) > 2
