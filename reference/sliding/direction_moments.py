"""Moments of the direction of sliding over a footprint, from which Coulomb friction follows.

A point r of a face that moves with the velocity v and the spin w slides with u = v + w k x r, in the direction e = u/|u|. The
moments are the matrix (3, 3) of the integrals of (1, x, y), the functions of the load, times (e_x, e_y, r x e), which give
force and torque; for `Points` they are sums. Their units are powers of m, from m^2 to m^4 for an area and from 1 to m^2 for
points.

For an area two methods are used, each where it is exact to rounding: integrals along the boundary where the instantaneous
centre is near the footprint, and quadrature where it is far away.
"""

import math
from collections.abc import Callable

import numpy as np

from bodycheck.reference.sliding.footprint import Disk, Footprint, Points, Polygon, load_moments, reach
from bodycheck.reference.trajectory import Array

#: Maps the velocity v1, v2 (m/s) of the point under the centre of mass and the spin w (rad/s), body frame, to moments (3, 3).
DirectionMoments = Callable[[float, float, float], Array]

#: Distance of the instantaneous centre from the origin, in radii of the footprint, beyond which quadrature is used.
#:
#: There quadrature is exact to rounding. The integral along the boundary would be exact too, but its sums cancel when the
#: centre is far away: one digit is lost for every factor of 10 in the distance.
FAR_RADII = 4.0

#: Distance of the instantaneous centre from the centre of a disk, in radii, within which the trapezoidal rule on the rim is
#: exact to rounding: 0.5^64 is 5e-20.
NEAR_CENTRE_RADII = 0.5

#: Number of Gauss nodes in each direction of each triangle of a polygon: the error at `FAR_RADII` is (3 + sqrt 8)^-24, 5e-19.
EDGE_NODES = 12

#: Size of velocity (m/s) and spin (rad/s) below which both are scaled up, so that their squares do not underflow.
SMALLEST_UNSCALED = 2.0**-400

#: Number of nodes around the rim of a disk and along a radius: at `FAR_RADII` the errors are 4^-64 and (7 + sqrt 48)^-20, that
#: is, 1e-23.
RIM_NODES, RADIAL_NODES = 64, 10

#: Cosines of the nodes on the rim, and their powers 0, 1, 2 times the weight of a node.
RIM_COSINES = np.cos(2 * np.pi * np.arange(RIM_NODES) / RIM_NODES)
RIM_COSINE_POWERS = 2 * np.pi / RIM_NODES * np.stack([np.ones(RIM_NODES), RIM_COSINES, RIM_COSINES**2])


def direction_moments(footprint: Footprint) -> DirectionMoments:
    """The moments of the direction of sliding over a footprint, as a function of velocity and spin.

    A point that does not slide contributes zero, and the moments of a body at rest are zero.
    """
    match footprint:
        case Polygon():
            nodes, weights = polygon_rule(footprint)
            near = polygon_boundary(footprint)
        case Disk():
            nodes, weights = disk_rule(footprint)
            near = disk_boundary(footprint)
        case Points(points):
            nodes, weights = points, np.ones(len(points))
            near = point_sums(footprint)
    far = far_sums(nodes, weights, load_moments(footprint))
    farthest = FAR_RADII * reach(footprint)

    def moments(v1: float, v2: float, w: float) -> Array:
        if max(abs(v1), abs(v2), abs(w)) < SMALLEST_UNSCALED:
            # Only the direction of the motion matters, and quotients and squares of such small numbers would underflow.
            v1, v2, w = (value / SMALLEST_UNSCALED for value in (v1, v2, w))
        speed = math.hypot(v1, v2)
        if speed > farthest * abs(w):
            return far(v1 / speed, v2 / speed, w / speed)
        return near(v1, v2, w) if w else np.zeros((3, 3))

    return moments


def far_sums(nodes: Array, weights: Array, loads: Array) -> DirectionMoments:
    """The moments by quadrature, for an instantaneous centre far away.

    The value for pure translation is subtracted from the integrand and added exactly, so that the torque keeps its relative
    accuracy as the spin vanishes.

    Parameters
    ----------
    nodes
        (n, 2) nodes of the quadrature rule (m).
    weights
        (n,) weights of the quadrature rule.
    loads
        (3, 3) moments of the footprint, from `footprint.load_moments`.

    Returns
    -------
    DirectionMoments
        The moments as a function of a velocity of unit length and of the spin over the speed (1/m).
    """
    x, y = np.ascontiguousarray(nodes.T)
    squares = x * x + y * y
    basis = weights * np.stack([np.ones_like(x), x, y])

    def sums(e1: float, e2: float, w: float) -> Array:
        # |u|^2 = 1 + h, and u/|u| - e = (w k x r - e (|u| - 1)) / |u| with |u| - 1 = h/(1 + |u|).
        h = 2 * w * (e2 * x - e1 * y) + w * w * squares
        speed = np.sqrt(1 + h)
        excess = h / (1 + speed)
        d1, d2 = (-w * y - e1 * excess) / speed, (w * x - e2 * excess) / speed
        turned = basis @ np.stack([d1, d2, x * d2 - y * d1]).T
        translation = np.column_stack([e1 * loads[0], e2 * loads[0], e2 * loads[1] - e1 * loads[2]])
        return np.asarray(turned + translation)

    return sums


def polygon_rule(polygon: Polygon) -> tuple[Array, Array]:
    """Nodes (m, 2), m, and weights (m,), m^2, of Gauss's rule on the triangles of the origin and each edge of a polygon."""
    t, weights = np.polynomial.legendre.leggauss(EDGE_NODES)
    t, weights = (1 + t) / 2, weights / 2
    vertices, following = polygon.vertices, np.roll(polygon.vertices, -1, axis=0)
    edge = vertices[:, None] + t[:, None] * (following - vertices)[:, None]
    doubled = vertices[:, 0] * following[:, 1] - vertices[:, 1] * following[:, 0]
    nodes = t[:, None, None, None] * edge
    return nodes.reshape(-1, 2), np.einsum("t,n,s->tns", t * weights, doubled, weights).ravel()


def disk_rule(disk: Disk) -> tuple[Array, Array]:
    """Nodes (m, 2), m, and weights (m,), m^2, of Gauss's rule along the radius and the trapezoidal rule around a disk."""
    t, weights = np.polynomial.legendre.leggauss(RADIAL_NODES)
    radii, weights = disk.radius * (1 + t) / 2, disk.radius * weights / 2
    angles = 2 * np.pi * np.arange(RIM_NODES) / RIM_NODES
    nodes = radii[:, None, None] * np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    return nodes.reshape(-1, 2), np.repeat(radii * weights * 2 * np.pi / RIM_NODES, RIM_NODES)


def point_sums(points: Points) -> DirectionMoments:
    """The moments of single points, for any velocity and spin."""
    x, y = np.ascontiguousarray(points.points.T)
    basis = np.stack([np.ones_like(x), x, y])

    def sums(v1: float, v2: float, w: float) -> Array:
        u1, u2 = v1 - w * y, v2 + w * x
        speed = np.hypot(u1, u2)
        speed[speed == 0] = np.inf
        e1, e2 = u1 / speed, u2 / speed
        return np.asarray(basis @ np.stack([e1, e2, x * e2 - y * e1]).T)

    return sums


def polygon_boundary(polygon: Polygon) -> DirectionMoments:
    """The moments of a polygon by exact integrals along its edges; the spin must not be zero.

    With rho = r - r_c, the position relative to the instantaneous centre r_c = k x v/w, all moments are integrals over the area
    of gradients or divergences of |rho|, of |rho| rho_i and of |rho| rho_i rho / 4. So they are integrals of |rho| and s |rho|
    along the edges, where s is the length along an edge.
    """
    vertices = polygon.vertices
    edges = np.roll(vertices, -1, axis=0) - vertices
    lengths = np.hypot(*edges.T)
    corners = np.column_stack([vertices, edges / lengths[:, None], lengths]).tolist()

    def moments(v1: float, v2: float, w: float) -> Array:
        c1, c2 = -v2 / w, v1 / w
        g1 = g2 = b11 = b12 = b21 = b22 = q1 = q2 = 0.0
        for x, y, t1, t2, length in corners:
            n1, n2 = t2, -t1
            d = (x - c1) * n1 + (y - c2) * n2
            s = (x - c1) * t1 + (y - c2) * t2
            start, end = math.hypot(d, s), math.hypot(d, s + length)
            whole = ((s + length) * end - s * start) / 2
            if abs(d) > 1e-150:  # below, d^2 underflows
                whole += d * d * (math.asinh((s + length) / abs(d)) - math.asinh(s / abs(d))) / 2
            along = (end**3 - start**3) / 3
            e1, e2 = d * whole * n1 + along * t1, d * whole * n2 + along * t2
            g1, g2 = g1 + n1 * whole, g2 + n2 * whole
            b11, b12, b21, b22 = b11 + e1 * n1, b12 + e1 * n2, b21 + e2 * n1, b22 + e2 * n2
            q1, q2 = q1 + d * e1, q2 + d * e2
        return assembled(c1, c2, math.copysign(1, w), (g1, g2), (b11, b12, b21, b22), (q1, q2))

    return moments


def disk_boundary(disk: Disk) -> DirectionMoments:
    """The moments of a disk by exact integrals along its rim; the spin must not be zero."""
    radius = disk.radius

    def moments(v1: float, v2: float, w: float) -> Array:
        c1, c2 = -v2 / w, v1 / w
        distance = math.hypot(c1, c2)
        a1, a2 = (c1 / distance, c2 / distance) if distance else (1.0, 0.0)
        k = distance / radius
        i0, i1, i2 = (radius**2 * integral for integral in rim_integrals(k))
        outward, across = radius * (i2 - k * i1), radius * (i0 - i2)
        q = radius**2 * ((1 + k * k) * i1 - k * (i0 + i2))
        return assembled(
            c1,
            c2,
            math.copysign(1, w),
            (i1 * a1, i1 * a2),
            (
                outward * a1 * a1 + across * a2 * a2,
                (outward - across) * a1 * a2,
                (outward - across) * a1 * a2,
                outward * a2 * a2 + across * a1 * a1,
            ),
            (q * a1, q * a2),
        )

    return moments


def rim_integrals(k: float) -> tuple[float, float, float]:
    """Integrals of |rho| cos^j over the unit circle, j = 0, 1, 2, with |rho|^2 = 1 + k^2 - 2 k cos, k >= 0.

    They are complete elliptic integrals of the parameter m = 4 k/(1 + k)^2 [DLMF 19.2.8]. Where m is small, these would lose
    digits by cancellation, and the trapezoidal rule is used instead. |rho| = 1 is subtracted from its integrand, so that the
    integral for j = 1 keeps its relative accuracy.
    """
    if k < NEAR_CENTRE_RADII:
        excess = k * (k - 2 * RIM_COSINES) / (1 + np.sqrt(1 + k * (k - 2 * RIM_COSINES)))
        i0, i1, i2 = (RIM_COSINE_POWERS @ excess).tolist()
        return 2 * math.pi + i0, i1, math.pi + i2
    # Imported when it is needed: `scipy.special` is slow to import, and only disks that slide need it.
    from scipy.special import ellipe, ellipkm1

    rest = ((1 - k) / (1 + k)) ** 2
    m = 1 - rest
    e = float(ellipe(m))
    restk = rest * float(ellipkm1(rest)) if rest else 0.0
    # With cos = 2 sin^2 - 1 these are integrals of sqrt(1 - m sin^2) times 1, sin^2, sin^4 over a quarter of the period.
    second = ((2 * m - 1) * e + restk) / (3 * m)
    fourth = (((8 * m - 3) * m - 2) * e + (4 * m + 2) * restk) / (15 * m * m)
    scale = 4 * (1 + k)
    return scale * e, scale * (2 * second - e), scale * (4 * fourth - 4 * second + e)


def assembled(
    c1: float,
    c2: float,
    sign: float,
    gradient: tuple[float, float],
    outer: tuple[float, float, float, float],
    radial: tuple[float, float],
) -> Array:
    """The moments from integrals along the boundary of an area.

    n is the outward normal, and rho is the position relative to the instantaneous centre.

    Parameters
    ----------
    c1, c2
        The instantaneous centre (m).
    sign
        Sign of the spin; the direction of sliding is sign k x rho/|rho|.
    gradient
        Integrals of |rho| n_i, i = 1, 2.
    outer
        Integrals of |rho| rho_i n_j, in the order 11, 12, 21, 22.
    radial
        Integrals of |rho| rho_i (rho . n), i = 1, 2.

    Returns
    -------
    Array
        (3, 3) moments.
    """
    g1, g2 = gradient
    b11, b12, b21, b22 = outer
    whole = (b11 + b22) / 3  # the integral of |rho| over the area
    b11, b22 = b11 - whole, b22 - whole  # the integrals of rho_i rho_j/|rho| over the area
    moment = c1 * g1 + c2 * g2 + whole
    return sign * np.array(
        [
            [-g2, g1, moment],
            [-c1 * g2 - b12, c1 * g1 + b11, c1 * moment + c1 * b11 + c2 * b12 + radial[0] / 4],
            [-c2 * g2 - b22, c2 * g1 + b21, c2 * moment + c1 * b21 + c2 * b22 + radial[1] / 4],
        ]
    )
