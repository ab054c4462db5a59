"""The force of Hunt and Crossley (J. Appl. Mech. 42, 1975) in the place of a coefficient of restitution.

The force of a contact is f(x) (1 + d x') while it pushes, for the penetration x and the dissipation d. The part of its speed
that an impact returns depends on the speed.
"""

import math
from collections.abc import Sequence

import numpy as np

from bodycheck.adapters.touching import TouchingBody, plane_of
from bodycheck.reference import scene as shapes
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.mechanisms.mechanism import WORLD, AnyScene
from bodycheck.reference.scene import Shape
from bodycheck.reference.trajectory import Array

#: The least dissipation (s/m) of a pair with a coefficient of restitution.
LEAST_DISSIPATION = 1e-9


def impact_speed(one: int, other: int, parts: Sequence[TouchingBody], scene: AnyScene) -> float:
    """Return the speed (m/s) of the first impact of two bodies, given by their indices, of which one may be `WORLD`.

    On the plane it is that of the centre of mass after its first fall. That of two bodies is their relative speed at the start,
    or else that of the faster fall.
    """
    if WORLD not in (one, other):
        velocities = np.array([parts[index].start.velocity for index in (one, other)])
        if relative := float(np.linalg.norm(velocities[0] - velocities[1])):
            return relative
    return max(fall(parts[index], scene) for index in (one, other) if index != WORLD)


def fall(part: TouchingBody, scene: AnyScene) -> float:
    """Return the speed (m/s) along the normal with which a body first reaches the plane; zero for one that lies on it."""
    normal = np.array(plane_of(scene).normal)
    state = part.start
    along = rotate(np.array([1.0, -1.0, -1.0, -1.0]) * np.array(state.quaternion), normal)
    height = float(normal @ state.position) - extent(part.shape, along)
    squared = float(normal @ state.velocity) ** 2 + 2 * scene.gravity * float(normal[2]) * height
    # A body that lies on the plane is above it by rounding.
    return math.sqrt(squared) if height > 1e-9 and squared > 0 else 0.0


def extent(shape: Shape, direction: Array) -> float:
    """Return how far a body extends (m) from its centre along a direction in its frame."""
    match shape:
        case shapes.Brick(half):
            return float(np.abs(direction) @ half)
        case shapes.Ellipsoid(half):
            return float(np.linalg.norm(direction * half))
        case shapes.Cylinder(radius, half_length):
            return float(radius * np.hypot(direction[0], direction[1]) + half_length * abs(direction[2]))
        case _:
            return shape.radius


def dissipation(restitution: float, speed: float) -> float:
    """Return the dissipation d (s/m) with which a point that hits a plane at a speed (m/s) has a coefficient of restitution.

    The force f(x) (1 + d x'), multiplied by the velocity and divided by 1 + d x', is integrated: u - ln(1 + u) is the same
    before and after the impact, for u = d x'. The result depends neither on f nor on the mass.
    """
    from scipy.optimize import brentq  # takes longer to import than the rest of an adapter

    if restitution == 1:
        return LEAST_DISSIPATION

    def gap(u: float) -> float:
        return u - math.log1p(u) + restitution * u + math.log1p(-restitution * u)

    largest = (1 - 1e-15) / restitution
    if gap(largest) > 0:  # the rebound has its bound 1/d except for rounding
        return largest / speed
    return float(brentq(gap, 1e-3 * (1 - restitution), largest, xtol=1e-15)) / speed
