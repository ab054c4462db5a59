"""The position of a body that touches a plane, in exact arithmetic."""

from bodycheck.reference.exact.numbers import MP, Real, Vector3
from bodycheck.reference.exact.rotations import attitude, conjugate, matrix, scaled, turned
from bodycheck.reference.scene import Attitude, Brick, Cylinder, Ellipsoid, Shape, Sphere


def touching_above_origin(shape: Shape, orientation: Attitude, incline: float) -> Vector3:
    """The position (m) of the centre of mass, on the normal through the origin, of a body that touches an inclined plane.

    Parameters
    ----------
    shape
        The shape, about the centre of mass.
    orientation
        The attitude of the body.
    incline
        The angle by which the plane z = 0 is turned about y (rad).
    """
    cosine, sine = MP.cos_sin(MP.mpf(incline))
    normal = sine, MP.mpf(0), cosine
    along_body = turned(matrix(conjugate(attitude(orientation))), normal)
    return scaled(_extent(shape, along_body), normal)


def _extent(shape: Shape, direction: Vector3) -> Real:
    """The extent (m) of a shape from its centre against a unit vector along its axes."""
    x, y, z = (abs(component) for component in direction)
    match shape:
        case Brick((a, b, c)):
            return x * a + y * b + z * c
        case Ellipsoid((a, b, c)):
            return MP.sqrt((x * a) ** 2 + (y * b) ** 2 + (z * c) ** 2)
        case Cylinder(radius, half_length):
            return z * half_length + MP.hypot(x, y) * radius
        case Sphere(radius):
            return MP.mpf(radius)
