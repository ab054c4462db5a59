"""Loads between bodies at rest, each of which may rest on several bodies, from the balance of parallel forces."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.contact.piles.upright import Upright, common, outline
from bodycheck.reference.contact.problem import NONE, ContactBody, Problem
from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.mechanisms.mechanism import WORLD
from bodycheck.reference.trajectory import Array
from bodycheck.reference.witness import WideArray

#: The fraction by which faces are shrunk for the check of balance: more than the error of linear programming.
SAFE = 1e-6

#: The component of a vector of the null space of a linear system up to which a load counts as determined.
DETERMINED = 1e-9


@dataclass(frozen=True)
class Bearing:
    """The indices of a body, or the plane (`WORLD`), and of a body that it bears."""

    lower: int
    upper: int

    @property
    def pair(self) -> tuple[int, int]:
        """The two indices in ascending order."""
        return min(self.lower, self.upper), max(self.lower, self.upper)


def loads(problem: Problem, faces: Sequence[Upright], bearings: Sequence[Bearing]) -> Mapping[Bearing, float]:
    """The normal forces (N) that follow from the weights, and from the symmetry of the scene if it has one.

    How a weight is divided among several supports does not follow from the balance of rigid bodies. Such bearings are left out,
    unless symmetry determines their forces.
    """
    rows = [
        [float(bearing.upper == index) - float(bearing.lower == index) for bearing in bearings]
        for index in range(len(problem.bodies))
    ]
    if len(bearings) > len(problem.bodies):
        rows += [row for images in _mirrors(problem, faces) for row in _equal(bearings, images)]
    matrix, sides = np.array(rows), np.zeros(len(rows))
    sides[: len(problem.bodies)] = [float(body.mass * -problem.gravity[2]) for body in problem.bodies]
    values, _, rank, _ = np.linalg.lstsq(matrix, sides, rcond=None)
    free = np.linalg.svd(matrix)[2][rank:]
    return {
        bearing: float(value)
        for bearing, value, loose in zip(bearings, values, np.abs(free).T.reshape(len(bearings), -1), strict=True)
        if not (loose > DETERMINED).any()
    }


def _equal(bearings: Sequence[Bearing], images: Mapping[int, int]) -> list[list[float]]:
    """The rows of the equations that each bearing has the same force as its mirror image; empty if a bearing has no image.

    images: the index of the image of each body.
    """
    mirrored = [Bearing(images.get(bearing.lower, WORLD), images[bearing.upper]) for bearing in bearings]
    if set(mirrored) != set(bearings):
        return []
    return [
        [float(other == bearing) - float(other == image) for other in bearings]
        for bearing, image in zip(bearings, mirrored, strict=True)
    ]


def centre_of(bodies: Sequence[ContactBody]) -> WideArray:
    """The common centre of mass (3,) of bodies, along the axes of the plane (m)."""
    masses = np.array([body.mass for body in bodies])
    return np.asarray(masses @ np.array([body.position for body in bodies]) / masses.sum())


def _mirrors(problem: Problem, faces: Sequence[Upright]) -> list[dict[int, int]]:
    """Return, for each mirror plane along the normal under which the scene is symmetric, the index of each body's image."""
    centre = centre_of(problem.bodies)
    axes = (1,) if problem.plane.incline else (0, 1)
    candidates = (_images(problem, faces, axis, centre[axis]) for axis in axes)
    return [images for images in candidates if images is not None]


def _images(problem: Problem, faces: Sequence[Upright], axis: int, centre: Wide) -> dict[int, int] | None:
    """The indices of the images of all bodies in the mirror plane perpendicular to an axis, at `centre` (m) along it.

    Returns None if a body has no image.
    """
    images = {}
    for index, face in enumerate(faces):
        mirrored = _marks(face)
        mirrored[:, axis] = 2 * centre - mirrored[:, axis]
        image = next(
            (
                other
                for other, candidate in enumerate(faces)
                if problem.bodies[other].mass == problem.bodies[index].mass and _alike(face, mirrored, candidate)
            ),
            None,
        )
        if image is None:
            return None
        images[index] = image
    return images


def _marks(face: Upright) -> WideArray:
    """Four points (4, 2) of the outline of a body: the corners of a rectangle, or the points of a disk along x and y."""
    if face.disk:
        return np.asarray(face.centre + face.half[0] * np.array([[1, 0], [-1, 0], [0, 1], [0, -1]]))
    return outline(face)


def _alike(face: Upright, mirrored: WideArray, other: Upright) -> bool:
    """Return whether `other` is the image of a body. mirrored: (4, 2) images of four points of its outline."""
    near = 4 * NONE * (face.size + other.size + float(np.abs(mirrored).max()))
    if (face.disk, face.ball) != (other.disk, other.ball):
        return False
    if max(abs(face.bottom - other.bottom), abs(face.top - other.top)) > near:
        return False
    apart = mirrored[:, None] - _marks(other)
    return bool((np.hypot(apart[..., 0], apart[..., 1]).min(axis=1) <= near).all())


def balanced(problem: Problem, faces: Sequence[Upright], bearings: Sequence[Bearing], slope: float) -> bool:
    """Return whether forces along gravity between the faces can balance all weights.

    The forces act at the corners of the common area of two faces, which is equivalent to forces anywhere in it. slope: tangent
    of the plane's incline.
    """
    from scipy.optimize import linprog  # imported here, since the import takes longer than all ways of contact

    points = [_seen(problem, faces, bearing, slope) for bearing in bearings]
    columns = np.repeat(np.arange(len(bearings)), [len(each) for each in points])
    places = np.concatenate(points)
    matrix, sides = [], []
    for index, body in enumerate(problem.bodies):
        signs = np.array([float(each.upper == index) - float(each.lower == index) for each in bearings])[columns]
        seen = (body.position[:2] + np.array([body.position[2] * slope, Wide(0)])).astype(float)
        arms = (places - seen) / faces[index].size
        matrix += [signs, signs * arms[:, 0], signs * arms[:, 1]]
        sides += [float(body.mass), 0.0, 0.0]
    scale = np.repeat([float(body.mass) for body in problem.bodies], 3)
    solution = linprog(np.zeros(len(places)), A_eq=np.array(matrix) / scale[:, None], b_eq=np.array(sides) / scale)
    return bool(solution.status == 0)


def _seen(problem: Problem, faces: Sequence[Upright], bearing: Bearing, slope: float) -> Array:
    """The corners (k, 2) of the common area of a bearing, projected onto the plane along gravity."""
    upper = faces[bearing.upper]
    if upper.ball:
        corners = upper.centre[None]
    elif bearing.lower == WORLD:
        corners = outline(upper, larger=-SAFE)
    else:
        corners = common(outline(upper, larger=-SAFE), outline(faces[bearing.lower], larger=-SAFE))
    return np.asarray((corners + np.array([upper.bottom * slope, Wide(0)])).astype(float))
