"""The face on which a body lies, in the body frame about the point under the centre of mass.

The face is fixed there, and a turning body is handled by turning its velocity. An area is loaded all over, `Points` only
where they are. The load is a combination of the three functions 1, x, y.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.trajectory import Array

#: Distance of the instantaneous centre from the edge of an area, in radii of the footprint, below which no nearer is told.
#:
#: Friction has a term d^2 ln|d| there: a step of this length leaves an error of its cube, below rounding.
MIN_EDGE_DISTANCE_RADII = 1e-5

#: Fraction of a body's speed below which a single point no longer slides.
STUCK_SLIP = 1e-10


@dataclass(frozen=True, eq=False)
class Polygon:
    """A convex polygon, evenly able to bear load; vertices (n, 2) counter-clockwise (m)."""

    vertices: Array


@dataclass(frozen=True)
class Disk:
    """A circular disk about the point under the centre of mass (m)."""

    radius: float


@dataclass(frozen=True, eq=False)
class Points:
    """Single points that bear load; points (n, 2) (m)."""

    points: Array


Footprint = Polygon | Disk | Points


def rectangle(a: float, b: float) -> Array:
    """The corners (4, 2) of the rectangle of half-lengths a along I and b along J, counter-clockwise."""
    return np.array([[a, b], [-a, b], [-a, -b], [a, -b]])


def outline(footprint: Footprint) -> Array:
    """Points (n, 2) that reach as far as the footprint; of a disk, one on its rim."""
    match footprint:
        case Polygon(vertices):
            return vertices
        case Points(points):
            return points
        case Disk(radius):
            return np.array([[radius, 0.0]])


def reach(footprint: Footprint) -> float:
    """Distance (m) of the farthest point of the footprint."""
    return float(np.hypot(*outline(footprint).T).max())


def load_moments(footprint: Footprint) -> Array:
    """The matrix (3, 3) of the sums of (1, x, y) times (1, x, y) over the footprint."""
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
            # Over the triangle from the origin to two corners, the middles of its sides carry a third of its area each.
            middles = np.stack([vertices / 2, following / 2, (vertices + following) / 2])
            terms = np.concatenate([np.ones_like(middles[..., :1]), middles], axis=-1)
            return np.asarray(np.einsum("n,tni,tnj->ij", areas / 3, terms, terms))


def nearness(footprint: Footprint) -> Callable[[float, float, float], float]:
    """The function of v1, v2 (m/s) and w (rad/s) that grows as the inverse distance to where friction is not smooth.

    That is where the instantaneous centre crosses the edge of an area, the distance being in radii of the footprint, and
    where one of several points comes to rest, it being the fraction of its slip in the body's speed.
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
                # The integral of 1/rho^2 along an edge: smooth off it, and pi/d close to it.
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
