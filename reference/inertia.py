"""Inertia of rigid bodies in double precision [G 2.9, 2.27-2.32]; the truth uses `exact.inertia`.

Inertia is always about the centre of mass. The equations of motion are written along the principal axes of a body, which
`along_principal_axes` makes the frame of the body.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bodycheck.reference.kinematics import conjugate, multiply, normalise, rotate
from bodycheck.reference.scene import Body, Scene, Shape, Vector
from bodycheck.reference.trajectory import Array, Trajectory

#: The identity quaternion (w, x, y, z): the body frame is along the principal axes.
IDENTITY = (1.0, 0.0, 0.0, 0.0)

#: Amount by which A + B may fall short of C, relative to C, because of rounding in the moments of a disc or a needle; the same
#: as in `robots.physical`.
TRIANGLE_TOLERANCE = 1e-9


@dataclass(frozen=True, eq=False)
class MassProperties:
    """Mass, centre of mass and inertia of a body in some frame.

    Attributes
    ----------
    mass
        Mass (kg).
    centre
        (3,) centre of mass in that frame (m).
    inertia
        (3, 3) inertia tensor about the centre of mass, along the axes of that frame (kg m^2).
    """

    mass: float
    centre: Array
    inertia: Array


def principal_moments(shape: Shape, mass: float) -> Vector:
    """Moments A, B, C (kg m^2) about I, J, K of a homogeneous solid of the given mass (kg), as the nearest doubles."""
    from bodycheck.reference.exact.inertia import moments  # runs need the rest of this module, but not mpmath
    from bodycheck.reference.exact.numbers import doubles

    a, b, c = doubles(moments(shape, mass))
    return a, b, c


def mesh(vertices: ArrayLike, triangles: ArrayLike, mass: float) -> MassProperties:
    """Mass properties of a homogeneous solid that is enclosed by a surface of triangles.

    The volume is a sum of signed tetrahedra with one corner at the mean of the vertices. The second moments of a tetrahedron
    with the volume V are (sum r_i sum r_j + sum r_i r_j) V / 20, where the sums run over its corners.

    Parameters
    ----------
    vertices
        (k, 3) vertices (m).
    triangles
        (n, 3) indices of the vertices of each triangle, all ordered outwards or all inwards.
    mass
        Mass (kg).

    Returns
    -------
    MassProperties
        The mass properties in the frame of the vertices.

    Raises
    ------
    ValueError
        If the surface encloses no volume, for instance because its triangles are not ordered consistently.
    """
    points = np.asarray(vertices, dtype=float)
    origin = points.mean(axis=0)  # about a point far away, digits of the moments would be lost by cancellation
    corners = (points - origin)[np.asarray(triangles, dtype=int)]
    volumes = np.linalg.det(corners) / 6
    volume = float(volumes.sum())
    if not abs(volume) > 1e-12 * float(np.abs(volumes).sum()):
        raise ValueError("the surface encloses no volume; it must be closed, and all triangles must have the same orientation")
    sums = corners.sum(axis=1)
    centre = volumes @ sums / (4 * volume)
    second = np.einsum("n,ni,nj->ij", volumes, sums, sums) + np.einsum("n,nki,nkj->ij", volumes, corners, corners)
    second = mass * (second / (20 * volume) - np.outer(centre, centre))
    return MassProperties(mass, origin + centre, _second_moments_to_inertia(second))


def inertia_tensor(body: Body) -> Array:
    """The inertia tensor (3, 3), kg m^2, of a body about its centre of mass, along the axes of the body frame."""
    if body.axes == IDENTITY:
        return np.diag(body.moments)
    turn = _rotation_matrix(body.axes)
    return np.asarray(turn @ np.diag(body.moments) @ turn.T)


def angular_momentum(body: Body, angular_velocity: NDArray[np.float64]) -> Array:
    """Angular momentum (..., 3), kg m^2/s, about the centre of mass from the angular velocity (..., 3), rad/s [G 2.32].

    Both are in the body frame.
    """
    if body.axes == IDENTITY:
        return np.asarray(np.array(body.moments) * angular_velocity)
    to_body = np.array(body.axes)
    return rotate(to_body, np.array(body.moments) * rotate(conjugate(to_body), angular_velocity))


def along_principal_axes(scene: Scene) -> Scene:
    """The same scene with the principal axes of its body as the body frame.

    Attitude and angular velocity are converted. A scene whose body frame is along the principal axes already is returned
    unchanged.
    """
    if scene.body.axes == IDENTITY:
        return scene
    axes = np.array(scene.body.axes)
    w, x, y, z = normalise(multiply(np.array(scene.initial.quaternion), axes)).tolist()
    p, q, r = rotate(conjugate(axes), np.array(scene.initial.angular_velocity)).tolist()
    initial = replace(scene.initial, quaternion=(w, x, y, z), angular_velocity=(p, q, r))
    return replace(scene, body=replace(scene.body, axes=IDENTITY), initial=initial)


def in_body_frame(scene: Scene, motion: Trajectory) -> Trajectory:
    """The same motion in the frame of the scene's body, from a trajectory along the principal axes of that body."""
    if scene.body.axes == IDENTITY:
        return motion
    axes = np.array(scene.body.axes)
    return replace(
        motion,
        quaternion=multiply(motion.quaternion, np.broadcast_to(conjugate(axes), motion.quaternion.shape)),
        angular_velocity=rotate(np.broadcast_to(axes, motion.quaternion.shape), motion.angular_velocity),
    )


def satisfies_triangle_inequality(moments: Vector) -> bool:
    """Return whether a body can have these principal moments (kg m^2): none exceeds the sum of the other two."""
    smallest, middle, largest = sorted(moments)
    return largest - (smallest + middle) <= TRIANGLE_TOLERANCE * largest


def _second_moments_to_inertia(second: Array) -> Array:
    """The inertia tensor I_ij = delta_ij S_kk - S_ij (3, 3) from the second moments S_ij = sum of m r_i r_j (3, 3), kg m^2."""
    return np.asarray(np.trace(second) * np.eye(3) - second)


def _rotation_matrix(quaternion: ArrayLike) -> Array:
    """The rotation matrix (3, 3) of a quaternion (4,), w x y z, of any length."""
    # Imported when it is needed: `scipy.spatial` takes longer to import than all else that most runs need.
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_quat(np.asarray(quaternion, dtype=float), scalar_first=True).as_matrix())
