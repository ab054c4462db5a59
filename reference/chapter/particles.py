"""Three particles at fixed distances from one another: the six degrees of freedom of a rigid body [G 2.1-2.8].

Positions (..., 3, 3) have the rows r1, r2, r3 (m). Coordinates (..., 6) are x1, y1, z1 (m), the longitude alpha and the
colatitude beta of r2 - r1, and the angle gamma of r3 about r2 - r1 (rad). Distances (..., 3) are d12, d13, d23 (m).

[G 2.8] is used in a corrected form: a is a length along the unit vector r12/d12, and the second vector of [G 2.7], which is
not perpendicular to the first, is replaced by v2 = r12/d12 x v1.
"""

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.chapter.placing import direction, longitude_and_colatitude
from bodycheck.reference.trajectory import Array

#: Relative amount by which two distances may fall short of the third, because of rounding for three particles in a row.
TRIANGLE_TOLERANCE = 1e-12

#: Sine of the angle between r12 and i up to which i x r12 is a rounding error.
PARALLEL_SINE = 4 * float(np.finfo(float).eps)


class NoTriangle(ValueError):
    """No three particles have these distances from one another, or two particles are at the same place."""


def positions(coordinates: Array, distances: Array) -> Array:
    """Positions (..., 3, 3), m, from coordinates (..., 6) and distances (..., 3) [G 2.2, 2.8].

    Raises `NoTriangle` if no triangle has these distances.
    """
    r1, (alpha, beta, gamma) = coordinates[..., :3], np.moveaxis(coordinates[..., 3:], -1, 0)
    a, _, r = (length[..., None] for length in circle(distances))
    along = direction(alpha, beta)
    v1, v2 = normals(along)
    across = np.cos(gamma)[..., None] * v1 + np.sin(gamma)[..., None] * v2
    r1, r2, r3 = np.broadcast_arrays(r1, r1 + distances[..., :1] * along, r1 + a * along + r * across)
    return np.stack([r1, r2, r3], axis=-2)


def coordinates(positions: Array) -> Array:
    """The six coordinates (..., 6) of particles at positions (..., 3, 3), m.

    alpha and gamma are in [-pi, pi], and beta is in [0, pi]. alpha = 0 where r2 - r1 is vertical, and gamma = 0 where the three
    particles are in a row, since neither is determined there.

    Raises `NoTriangle` if two particles are at the same place.
    """
    circle(separations(positions))
    r1, r2, r3 = np.moveaxis(positions, -2, 0)
    alpha, beta = longitude_and_colatitude(r2 - r1)
    v1, v2 = normals(direction(alpha, beta))
    gamma = np.arctan2(((r3 - r1) * v2).sum(axis=-1), ((r3 - r1) * v1).sum(axis=-1))
    return np.concatenate([r1, np.stack([alpha, beta, gamma], axis=-1)], axis=-1)


def separations(positions: Array) -> Array:
    """The distances d12, d13, d23 (..., 3), m, between particles at positions (..., 3, 3), m."""
    r1, r2, r3 = np.moveaxis(positions, -2, 0)
    return np.asarray(np.linalg.norm(np.stack([r2 - r1, r3 - r1, r3 - r2], axis=-2), axis=-1))


def residuals(positions: Array, distances: Array) -> Array:
    """Residuals (ri - rj).(ri - rj) - dij^2 (..., 3), m^2, of the constraints [G 2.1].

    positions: (..., 3, 3), m. distances: (..., 3), m.
    """
    return np.asarray(separations(positions) ** 2 - distances**2)


def circle(distances: Array) -> tuple[Array, Array, Array]:
    """The circle on which r3 lies, for distances (..., 3), m [G 2.4, 2.5].

    Returns the distances a from r1 and b from r2 to the centre of the circle along r12, and its radius r, each (...), m. The
    radicand of [G 2.5], 16 times the square of the area of the triangle, is computed in Kahan's form, since the printed form
    loses digits by cancellation for thin triangles.

    Raises `NoTriangle` if a distance is not positive and finite, or exceeds the sum of the other two.
    """
    smallest, middle, largest = np.moveaxis(np.sort(distances, axis=-1), -1, 0)
    _require((smallest > 0) & np.isfinite(largest), distances)
    slack = smallest - (largest - middle)
    _require(slack >= -TRIANGLE_TOLERANCE * largest, distances)
    d12, d13, d23 = np.moveaxis(distances, -1, 0)
    a = (d12 + (d13 - d23) * ((d13 + d23) / d12)) / 2
    squared = (largest + (middle + smallest)) * np.maximum(slack, 0) * (smallest + (largest - middle))
    r = np.sqrt(squared * (largest + (middle - smallest))) / (2 * d12)
    return a, d12 - a, r


def normals(along: Array) -> tuple[Array, Array]:
    """Unit vectors v1, v2 (..., 3) that form a right-handed triad with unit vectors r12/d12 (..., 3), `along`.

    v1 is the vector of [G 2.7], along i x r12. Where r12 is parallel to i to rounding, v1 is along j x r12 instead; no choice
    of v1 is continuous for every direction.
    """
    x, y, z = np.moveaxis(along, -1, 0)
    zero = np.zeros_like(x)
    parallel = (np.hypot(y, z) <= PARALLEL_SINE)[..., None]
    v1 = np.where(parallel, np.stack([z, zero, -x], axis=-1), np.stack([zero, -z, y], axis=-1))
    v1 /= np.linalg.norm(v1, axis=-1, keepdims=True)
    return v1, np.cross(along, v1)


def _require(triangle: NDArray[np.bool_], distances: Array) -> None:
    """Raise `NoTriangle` with the first distances (..., 3) for which `triangle` (...) is false."""
    if not triangle.all():
        d12, d13, d23 = np.reshape(distances, (-1, 3))[~np.reshape(triangle, -1)][0].tolist()
        raise NoTriangle(f"distances d12 = {d12}, d13 = {d13}, d23 = {d23} m make no triangle")
