"""Principal moments of homogeneous solids about their centre of mass [G 2.29]."""

from bodycheck.reference.scene import Brick, Cylinder, Ellipsoid, Shape, Sphere, Vector

TRIANGLE_TOLERANCE = 1e-12
"""Relative amount by which A + B may fall short of C: what rounding does to the moments of a disc or a needle."""


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


def satisfies_triangle_inequality(moments: Vector) -> bool:
    """Whether a mass distribution with these principal moments exists: none exceeds the sum of the other two."""
    smallest, middle, largest = sorted(moments)
    return largest <= (smallest + middle) * (1 + TRIANGLE_TOLERANCE)
