"""Accelerations of a sliding body by quadrature over its face, from the data of the case file alone.

This is the witness's own law of friction. It shares no code with `friction`: the moment of inertia, the load and the direction
of sliding are sums over nodes of the face, for many states at once. Where the instantaneous centre is near, the face is a fan
of triangles with their common corner in the centre: the direction of sliding is constant along a ray from it, and the nodes
along an edge are graded by s = |d| sinh(sigma), with the distance d of the centre from the line of the edge, which makes the
integrand an entire function. Where the centre is far away, the integrand is smooth, and Gauss's rule on the face is used. The
accelerations have errors of 1e-13 of mu g at most, for faces up to 33 times as long as wide.
"""

import math
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.scene import Brick, Cylinder, Plane, Scene, Solid, Tensor, valid
from bodycheck.reference.trajectory import Array

#: Distance of the instantaneous centre, in radii of the face, beyond which the nodes are fixed. There the rules below have
#: errors of (2 + sqrt 5)^-28 and 3^-40 at most.
FAR = 3.0

#: Number of nodes along an edge; on half of a rim; in each direction of a rectangle; along a radius and around a disk.
EDGE, RIM, ACROSS, RADIAL, AROUND = 20, 40, 14, 14, 40

#: The smallest and the largest length of the grading of a rim (rad). A kink of the integrand that is narrower than the smallest
#: length causes an error of the order of the square of this length; with the largest length, the nodes are nearly as without
#: grading.
FINEST_GRADING, WIDEST_GRADING = 1e-6, 4.0

#: Nodes and weights of Gauss's rules for integrals of t dt times a polynomial along a ray, for t from 0 to 1. The rule with one
#: node is exact for linear polynomials, as in the torque, and the rule with two nodes for cubic polynomials; with a linear
#: pressure, the polynomial is quadratic.
RAY_OF_TORQUE = ((2 / 3, 1 / 2),)
RAY_OF_PRESSURE = tuple(((6 + sign * math.sqrt(6)) / 10, 1 / 4 + sign * math.sqrt(6) / 36) for sign in (-1, 1))

#: Number of states that are computed at once, so that their nodes stay in the cache of a processor.
CHUNK = 256

#: Size of velocities, per unit of speed, up to which they count as zero.
NOTHING = 1e-300


@dataclass(frozen=True, eq=False)
class Flat:
    """A body that lies on a plane, as the case file defines it.

    Attributes
    ----------
    shape
        Its shape, a brick or a cylinder.
    plane
        The plane.
    gravity
        Gravitational acceleration (m/s^2).
    gyration
        Radius of gyration sqrt(C/m) about the vertical (m).
    nodes
        (n, 2) nodes on the face, body frame (m): the nodes of a quadrature rule, or the corners.
    shares
        (n,) shares of the nodes in the face, whose sum is 1.
    """

    shape: Brick | Cylinder
    plane: Plane
    gravity: float
    gyration: float
    nodes: Array
    shares: Array

    @property
    def height(self) -> float:
        """Height of the centre of mass (m)."""
        return self.shape.semi_axes[2] if isinstance(self.shape, Brick) else self.shape.half_length


def flat(scene: Scene) -> Flat:
    """The body of a scene with a plane, as its file defines it.

    A homogeneous body that lies flat is a prism, whose C/m is the mean of r^2 over its face. If the file states a tensor, or
    the scene has no valid definition, C is taken from the tensor or from the scene.
    """
    shape, plane = scene.body.shape, scene.plane
    assert isinstance(shape, Brick | Cylinder)
    assert plane is not None
    nodes, shares = _face(shape)
    square = scene.body.moments[2] / scene.body.mass
    if scene.definition is not None and valid(scene).inertia:
        match scene.definition.inertia:
            case Solid():
                square = float(shares @ (nodes**2).sum(axis=1))
            case Tensor(mass, rows):
                square = rows[2][2] / mass
    gyration = math.sqrt(square)
    if plane.law == "corners" and isinstance(shape, Brick):
        a, b, _ = shape.semi_axes
        nodes, shares = np.array([[-a, -b], [-a, b], [a, -b], [a, b]]), np.full(4, 0.25)
    return Flat(shape, plane, scene.gravity, gyration, nodes, shares)


def accelerations(body: Flat, yaw: Array, velocity: Array) -> Array:
    """Accelerations of a sliding body by friction.

    Parameters
    ----------
    body
        The body.
    yaw
        (n,) yaw (rad).
    velocity
        (n, 3) dx/dt, dy/dt and sqrt(C/m) dpsi/dt, world frame (m/s).

    Returns
    -------
    Array
        (n, 3) rates of change of these velocities (m/s^2); zero for a body at rest.
    """
    pieces = [
        _accelerations(body, yaw[first : first + CHUNK], velocity[first : first + CHUNK]) for first in range(0, len(yaw), CHUNK)
    ]
    return np.concatenate(pieces) if pieces else np.empty((0, 3))


def _accelerations(body: Flat, yaw: Array, velocity: Array) -> Array:
    speed = np.linalg.norm(velocity, axis=1)
    # Friction depends on the direction of the motion alone.
    unit = velocity / np.where(speed > 0, speed, 1.0)[:, None]
    # Complex numbers turn vectors: the body components of v are v exp(-i psi).
    turn = np.exp(1j * yaw)
    v, w = (unit[:, 0] + 1j * unit[:, 1]) / turn, unit[:, 2] / body.gyration
    scale = body.plane.friction * body.gravity
    if body.plane.law == "decoupled":
        _, arm = _means(body, np.zeros(1, dtype=complex), np.ones(1))
        size = np.abs(v)
        force = -v / np.where(size > NOTHING, size, 1.0)
        torque = -np.sign(w) * arm[0, 0]
    else:
        directions, arms = _means(body, v, w)
        pressure = _pressures(body, directions)
        force = -(pressure * directions).sum(axis=1)
        torque = -(pressure * arms).sum(axis=1)
    force = force * turn
    return np.asarray(scale * np.column_stack([force.real, force.imag, torque / body.gyration]) * (speed > 0)[:, None])


def _pressures(body: Flat, directions: Array) -> Array:
    """Pressures (n, k) p0, p_x, p_y, divided by the mean pressure; only p0 = 1 for a uniform pressure.

    A balanced pressure has its centre at -(h/N) F, where friction and load have no moment about the centre of mass: the mean of
    p is 1, and the mean of p r is h mu times the mean of p e.

    Parameters
    ----------
    body
        The body.
    directions
        (n, k) means over the face of 1, x, y times the direction of sliding, a complex number.
    """
    pressure = np.zeros_like(directions.real)
    pressure[:, 0] = 1
    if body.plane.pressure == "uniform":
        return pressure
    second = body.shares @ body.nodes**2
    matrix = np.zeros((len(directions), 3, 3))
    matrix[:] = np.diag([1.0, *second])
    lever = body.plane.friction * body.height
    matrix[:, 1] -= lever * directions.real
    matrix[:, 2] -= lever * directions.imag
    return np.asarray(np.linalg.solve(matrix, pressure[:, :, None])[:, :, 0])


def _means(body: Flat, v: Array, w: Array) -> tuple[Array, Array]:
    """Means (n, k) over the face of 1, x, y times the direction of sliding e = e1 + i e2, and times its moment r x e.

    There are k = 3 of each, or for a uniform pressure only the first.

    Parameters
    ----------
    body
        The body.
    v, w
        (n,) velocities v1 + i v2 and spins, body frame.
    """
    # A pressure that is the same everywhere needs the means of 1 alone.
    count = 1 if body.plane.pressure == "uniform" else 3
    directions, arms = np.zeros((len(v), count), dtype=complex), np.zeros((len(v), count))
    fixed = np.full(len(v), body.plane.law == "corners") | (np.abs(v) > FAR * _radius(body.shape) * np.abs(w))
    if fixed.any():
        positions = body.nodes[:, 0] + 1j * body.nodes[:, 1]
        slip = v[fixed, None] + 1j * w[fixed, None] * positions
        size = np.abs(slip)
        directions[fixed], arms[fixed] = _sums(positions[None], slip / np.where(size > NOTHING, size, 1.0), body.shares, count)
    near = ~fixed & (w != 0)
    if near.any():
        # A point r slides with v + i w r = i w (r - c).
        centre = 1j * v[near] / w[near]
        reached, unit, shares = _fan(body.shape, centre)
        sliding = 1j * np.sign(w[near])[:, None] * unit
        for t, weight in RAY_OF_TORQUE if count == 1 else RAY_OF_PRESSURE:
            positions = centre[:, None] + t * (reached - centre[:, None])
            ray = _sums(positions, sliding, weight * shares, count)
            directions[near], arms[near] = directions[near] + ray[0], arms[near] + ray[1]
    return directions, arms


def _sums(positions: Array, sliding: Array, shares: Array, count: int) -> tuple[Array, Array]:
    """Sums over the last axis of shares times the first `count` of 1, x, y, times e, and times r x e."""
    moment = (positions.real * sliding.imag - positions.imag * sliding.real) * shares
    weighted = sliding * shares
    functions = (1.0, positions.real, positions.imag)[:count]
    return (
        np.stack([(weighted * value).sum(axis=1) for value in functions], axis=1),
        np.stack([(moment * value).sum(axis=1) for value in functions], axis=1),
    )


def _fan(shape: Brick | Cylinder, centre: Array) -> tuple[Array, Array, Array]:
    """Ends (n, k) of rays from the centres (n,) to the outline, their unit directions, and their shares in the face.

    Ends and directions are complex numbers; the share of a stretch dt of a ray is t dt times the share of the ray, for t from 0
    to 1.
    """
    if isinstance(shape, Cylinder):
        return _fan_of_disk(shape.radius, centre)
    a, b, _ = shape.semi_axes
    corners = np.array([a - 1j * b, a + 1j * b, -a + 1j * b, -a - 1j * b])
    along = np.array([1j, -1, -1j, 1])
    # In coordinates along each edge from the centre: distance d of the line, and s from s0 to s1 along it.
    first, last = ((end - centre[:, None]) / along for end in (corners, np.roll(corners, -1)))
    d = -first.imag
    width = np.maximum(np.abs(d), 1e-30 * (a + b))
    low, high = np.arcsinh(first.real / width), np.arcsinh(last.real / width)
    nodes, weights = _gauss(EDGE, 0.0, 1.0)
    sigma = low[..., None] + (high - low)[..., None] * nodes
    growing = np.exp(sigma) * width[..., None] / 2
    falling = (width * width / 4)[..., None] / growing
    s, length = growing - falling, growing + falling
    ray = (s - 1j * d[..., None]) * along[:, None]
    shares = weights * (high - low)[..., None] * d[..., None] * length / (4 * a * b)
    count = len(centre)
    return (
        (centre[:, None, None] + ray).reshape(count, -1),
        (ray / length).reshape(count, -1),
        shares.reshape(count, -1),
    )


def _fan_of_disk(radius: float, centre: Array) -> tuple[Array, Array, Array]:
    """The rays of `_fan` for a disk, with the angle theta = g sinh(sigma) on its rim counted from the centre's side."""
    distance = np.abs(centre)
    axis = np.where(distance > NOTHING, centre / np.where(distance > NOTHING, distance, 1.0), 1.0)
    # |ray|^2 = (R - q)^2 + 4 R q sin^2(theta/2) is zero at theta = +-i g.
    gap = np.abs(radius - distance) / (2 * np.sqrt(radius * np.maximum(distance, 1e-6 * radius)))
    g = np.clip(2 * np.arcsinh(gap), FINEST_GRADING, WIDEST_GRADING)
    end = np.arcsinh(np.pi / g)
    nodes, weights = _gauss(RIM, 0.0, 1.0)
    theta = g[:, None] * np.sinh(end[:, None] * nodes)
    steps = g[:, None] * np.cosh(end[:, None] * nodes) * end[:, None] * weights
    theta, steps = np.concatenate([theta, -theta], axis=1), np.concatenate([steps, steps], axis=1)
    q = distance[:, None]
    # cos - 1 = -2 sin^2(theta/2), so that nothing cancels near the rim.
    versine = 2 * np.sin(theta / 2) ** 2
    ray = (radius - q - radius * versine) + 1j * radius * np.sin(theta)
    length = np.sqrt((radius - q) ** 2 + 2 * radius * q * versine)
    shares = steps * (radius - q + q * versine) / (np.pi * radius)
    reached = (q + ray) * axis[:, None]
    return reached, ray / np.where(length > NOTHING, length, 1.0) * axis[:, None], shares


def _face(shape: Brick | Cylinder) -> tuple[Array, Array]:
    """Fixed nodes (n, 2) on the face across K, m, and their shares (n,) in it."""
    if isinstance(shape, Brick):
        a, b, _ = shape.semi_axes
        nodes, weights = _gauss(ACROSS, -1.0, 1.0)
        x, y = np.meshgrid(a * nodes, b * nodes, indexing="ij")
        return np.column_stack([x.ravel(), y.ravel()]), np.outer(weights, weights).ravel() / 4
    radii, weights = _gauss(RADIAL, 0.0, shape.radius)
    angles = 2 * np.pi * (np.arange(AROUND) + 0.5) / AROUND
    positions = np.multiply.outer(radii, np.exp(1j * angles)).ravel()
    shares = np.repeat(2 * radii * weights / (shape.radius**2 * AROUND), AROUND)
    return np.column_stack([positions.real, positions.imag]), shares


def _radius(shape: Brick | Cylinder) -> float:
    """Distance (m) of the farthest point of the face from the centre of the face."""
    return math.hypot(*shape.semi_axes[:2]) if isinstance(shape, Brick) else shape.radius


def _gauss(count: int, low: float, high: float) -> tuple[Array, Array]:
    """Nodes and weights (count,) of Gauss's rule from `low` to `high`."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    return low + (high - low) * (1 + nodes) / 2, (high - low) / 2 * weights
