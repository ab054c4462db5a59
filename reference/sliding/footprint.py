"""The footprint of a body: the face on which it lies, in the body frame with the origin under the centre of mass.

The footprint is constant in this frame; if the body turns, the velocity is rotated instead. An area bears load everywhere,
`Points` bear it only at the points. The load is a linear combination of the three functions 1, x, y.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.trajectory import Array

#: Smallest distance d of the instantaneous centre from the edge of an area, in radii of the footprint, in `nearness`; smaller
#: distances count as this distance.
#:
#: Friction has a term d^2 ln|d| there: a step of this length causes an error of the order of its cube, which is below rounding.
MIN_EDGE_DISTANCE_RADII = 1e-5

#: Ratio of the sliding speed of a single point to the speed of the body below which the point counts as at rest.
STUCK_SLIP = 1e-10


@dataclass(frozen=True, eq=False)
class Polygon:
    """A convex polygon that bears load over its whole area; `vertices` (n, 2) are counter-clockwise (m)."""

    vertices: Array


@dataclass(frozen=True)
class Disk:
    """A circular disk that bears load over its whole area, about the point under the centre of mass; `radius` in m."""

    radius: float


@dataclass(frozen=True, eq=False)
class Points:
    """Single points that bear load, at `points` (n, 2), m."""

    points: Array


#: Every kind of footprint.
Footprint = Polygon | Disk | Points


def rectangle(a: float, b: float) -> Array:
    """The corners (4, 2), m, of the rectangle with the half-lengths a along I and b along J (m), counter-clockwise."""
    return np.array([[a, b], [-a, b], [-a, -b], [a, -b]])


def outline(footprint: Footprint) -> Array:
    """The vertices or points (n, 2), m, of the footprint; for a disk, one point on its rim."""
    match footprint:
        case Polygon(vertices):
            return vertices
        case Points(points):
            return points
        case Disk(radius):
            return np.array([[radius, 0.0]])


def reach(footprint: Footprint) -> float:
    """Radius of the footprint: the distance (m) of its farthest point from the origin."""
    return float(np.hypot(*outline(footprint).T).max())


def load_moments(footprint: Footprint) -> Array:
    """The matrix (3, 3) of the integrals of (1, x, y) times (1, x, y) over the footprint; sums for `Points`.

    The units are m^2, m^3 and m^4 for an area, and 1, m and m^2 for points.
    """
    match footprint:
        case Disk(radius):
            area = math.pi * radius**2
            return np.diag([area, area * radius**2 / 4, area * radius**2 / 4])
        case Points(points):
            terms = np.column_stack([np.ones(len(points)), points])
            return np.asarray(terms.T @ terms)
        case Polygon(vertices):
            following = np.roll(vertices, -1, axis=0)
            areas = (vertices[:, 0] * following[:, 1] - vertices[:, 1] * following[:, 0]) / 2
            # Over the triangle of the origin and two corners, the rule with the midpoints of the sides and a third of the area
            # as weights is exact for quadratic functions.
            middles = np.stack([vertices / 2, following / 2, (vertices + following) / 2])
            terms = np.concatenate([np.ones_like(middles[..., :1]), middles], axis=-1)
            return np.asarray(np.einsum("n,tni,tnj->ij", areas / 3, terms, terms))


def nearness(footprint: Footprint) -> Callable[[float, float, float], float]:
    """The function of v1, v2 (m/s) and w (rad/s), body frame, that measures how near a state is to non-smooth friction.

    It grows as the inverse of a distance. For an area, friction is not smooth where the instantaneous centre crosses the edge,
    and the distance is the distance of the centre from the edge, in radii of the footprint. For points, friction is not smooth
    where a point comes to rest, and the distance is the ratio of the sliding speed of that point to the speed of the body.
    """
    radius = reach(footprint)
    match footprint:
        case Points(points):
            x, y = points.T

            def nearness(v1: float, v2: float, w: float) -> float:
                slips = np.hypot(v1 - w * y, v2 + w * x) / math.hypot(v1, v2, radius * w)
                return float((1 / np.maximum(slips, STUCK_SLIP / 10)).mean())

        case Disk():

            def nearness(v1: float, v2: float, w: float) -> float:
                spin = abs(w) * radius
                return spin / math.hypot(math.hypot(v1, v2) - spin, MIN_EDGE_DISTANCE_RADII * spin) if spin else 0.0

        case Polygon(vertices):
            edges = np.roll(vertices, -1, axis=0) - vertices
            lengths = np.hypot(*edges.T)
            corners = np.column_stack([vertices, edges / lengths[:, None], lengths]).tolist()
            least = MIN_EDGE_DISTANCE_RADII * radius

            def nearness(v1: float, v2: float, w: float) -> float:
                # The integral of 1/rho^2 along an edge is smooth away from the edge, and pi/d close to it.
                if not w:
                    return 0.0
                c1, c2 = -v2 / w, v1 / w
                total = 0.0
                for x, y, t1, t2, length in corners:
                    d = math.hypot((x - c1) * t2 - (y - c2) * t1, least)
                    s = (x - c1) * t1 + (y - c2) * t2
                    total += (math.atan((s + length) / d) - math.atan(s / d)) / d
                return total * radius / math.pi

    return nearness
