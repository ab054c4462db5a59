"""Mass, centre and inertia of bodies about their centre of mass [G 2.27-2.31], and principal axes."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from bodycheck.reference.kinematics import conjugate, rotate
from bodycheck.reference.scene import Body, Brick, Cylinder, Ellipsoid, Quaternion, Shape, Sphere, Vector
from bodycheck.reference.trajectory import Array

#: Relative amount by which A + B may fall short of C: what rounding does to the moments of a disc or a needle.
TRIANGLE_TOLERANCE = 1e-12


@dataclass(frozen=True, eq=False)
class MassProperties:
    """mass (kg), centre of mass (3,) in some frame (m), inertia tensor (3, 3) about it along that frame's axes (kg m^2)."""

    mass: float
    centre: Array
    inertia: Array


def principal_moments(shape: Shape, mass: float) -> Vector:
    """Moments A, B, C (kg m^2) about I, J, K of a homogeneous solid of the given mass (kg)."""
    match shape:
        case Brick((a, b, c)):
            return mass * (b * b + c * c) / 3, mass * (a * a + c * c) / 3, mass * (a * a + b * b) / 3
        case Ellipsoid((a, b, c)):
            return mass * (b * b + c * c) / 5, mass * (a * a + c * c) / 5, mass * (a * a + b * b) / 5
        case Cylinder(radius, half_length):
            across = mass * (radius * radius / 4 + half_length * half_length / 3)
            return across, across, mass * radius * radius / 2
        case Sphere(radius):
            moment = 2 * mass * radius * radius / 5
            return moment, moment, moment


def solid(shape: Shape, mass: float, position: ArrayLike = (0, 0, 0), quaternion: ArrayLike = (1, 0, 0, 0)) -> MassProperties:
    """A homogeneous solid with its centre at a position (3,) and its axes turned by a unit quaternion (4,), w x y z."""
    turn = Rotation.from_quat(np.asarray(quaternion, dtype=float), scalar_first=True).as_matrix()
    inertia = turn @ np.diag(principal_moments(shape, mass)) @ turn.T
    return MassProperties(mass, np.asarray(position, dtype=float), inertia)


def particles(masses: ArrayLike, positions: ArrayLike) -> MassProperties:
    """Particles of masses (n,) at positions (n, 3): the sum in [G 2.29]."""
    m, r = np.asarray(masses, dtype=float), np.asarray(positions, dtype=float)
    mass = float(m.sum())
    centre = np.asarray(m @ r / mass)
    return MassProperties(mass, centre, _second_moments_to_inertia((r - centre).T @ (m[:, None] * (r - centre))))


def mesh(vertices: ArrayLike, triangles: ArrayLike, mass: float) -> MassProperties:
    """A homogeneous solid of some mass (kg) inside a closed surface of triangles (n, 3), indices of vertices (k, 3).

    Signed tetrahedra from a point near the surface; the second moments of one are (sum r_i sum r_j + sum r_i r_j) V / 20
    over its corners. Raises `ValueError` where the surface encloses no volume, as one does whose triangles disagree on
    which side is out.
    """
    points = np.asarray(vertices, dtype=float)
    origin = points.mean(axis=0)  # moments about a point far away would cancel
    corners = (points - origin)[np.asarray(triangles, dtype=int)]
    volumes = np.linalg.det(corners) / 6
    volume = float(volumes.sum())
    if not abs(volume) > 1e-12 * float(np.abs(volumes).sum()):
        raise ValueError("the surface encloses no volume: is it closed, and are its triangles ordered alike?")
    sums = corners.sum(axis=1)
    centre = volumes @ sums / (4 * volume)
    second = np.einsum("n,ni,nj->ij", volumes, sums, sums) + np.einsum("n,nki,nkj->ij", volumes, corners, corners)
    second = mass * (second / (20 * volume) - np.outer(centre, centre))
    return MassProperties(mass, origin + centre, _second_moments_to_inertia(second))


def composite(parts: Sequence[MassProperties]) -> MassProperties:
    """Several bodies as one, their axes parallel: Steiner's theorem."""
    centres = particles([part.mass for part in parts], [part.centre for part in parts])
    inertia = centres.inertia + sum(part.inertia for part in parts)
    return MassProperties(centres.mass, centres.centre, inertia)


def principal_axes(inertia: Array) -> tuple[Vector, Quaternion]:
    """Principal moments A, B, C of a symmetric tensor (3, 3), and the rotation from principal to the tensor's components.

    The axes are in the order, and with the signs, that turn them least from the tensor's own; a diagonal tensor keeps its
    own exactly. Where moments are equal their axes are any; those found are returned.
    """
    if not (inertia - np.diag(np.diag(inertia))).any():
        a, b, c = np.diag(inertia).tolist()
        return (a, b, c), (1.0, 0.0, 0.0, 0.0)
    _, axes = np.linalg.eigh(inertia)
    best = max(
        (axes[:, order] * signs for order in PERMUTATIONS for signs in SIGNS),
        key=lambda turn: float(np.trace(turn)) if np.linalg.det(turn) > 0 else -math.inf,
    )
    a, b, c = np.einsum("ij,ik,jk->k", inertia, best, best).tolist()
    w, x, y, z = Rotation.from_matrix(best).as_quat(canonical=True, scalar_first=True).tolist()
    return (a, b, c), (w, x, y, z)


PERMUTATIONS = ([0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2])
SIGNS = [np.array([i, j, k]) for i in (1, -1) for j in (1, -1) for k in (1, -1)]


def inertia_tensor(body: Body) -> Array:
    """The inertia tensor (3, 3) of a body along the axes of its own frame (kg m^2)."""
    turn = Rotation.from_quat(body.axes, scalar_first=True).as_matrix()
    return np.asarray(turn @ np.diag(body.moments) @ turn.T)


def angular_momentum(body: Body, angular_velocity: NDArray[np.float64]) -> Array:
    """Angular momenta (..., 3) in the body frame from body rates (..., 3), rad/s [G 2.32]."""
    to_body = np.array(body.axes)
    return rotate(to_body, np.array(body.moments) * rotate(conjugate(to_body), angular_velocity))


def satisfies_triangle_inequality(moments: Vector) -> bool:
    """Whether a mass distribution with these principal moments exists: none exceeds the sum of the other two."""
    smallest, middle, largest = sorted(moments)
    return largest <= (smallest + middle) * (1 + TRIANGLE_TOLERANCE)


def _second_moments_to_inertia(second: Array) -> Array:
    """I_ij = delta_ij S_kk - S_ij from the second moments S_ij = sum of m r_i r_j."""
    return np.asarray(np.trace(second) * np.eye(3) - second)
