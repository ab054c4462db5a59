"""Bodies that lie flat on a plane, slide and spin, with every law of friction."""

import math

from bodycheck.reference.inertia import principal_moments
from bodycheck.reference.scene import Body, Brick, Cylinder, Plane, Scene, State

BRICK, DISK = Brick((0.1, 0.2, 0.05)), Cylinder(0.15, 0.05)
PLANES = [Plane(0.5, "area"), Plane(0.5, "area", "balanced"), Plane(0.5, "corners"), Plane(0.5, "decoupled")]


def flat(velocity: tuple[float, float], spin: float, plane: Plane, shape: Brick | Cylinder = BRICK) -> Scene:
    start = State((0.3, -0.2, 0.05), (math.cos(0.2), 0.0, 0.0, math.sin(0.2)), (*velocity, 0.0), (0.0, 0.0, spin))
    return Scene(Body(1.2, principal_moments(shape, 1.2), shape), start, 9.81, plane)
