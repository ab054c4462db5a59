"""Mass, centre of mass and inertia of rigid bodies in exact arithmetic [G 2.9, 2.27-2.32].

Inertia is always about the centre of mass. A tensor is given by its six components XX, YY, ZZ, XY, XZ, YZ.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from bodycheck.reference.exact.numbers import MP, Real, Vector3, vector
from bodycheck.reference.exact.rotations import IDENTITY, ORIGIN, attitude, matrix
from bodycheck.reference.scene import Brick, Cylinder, Ellipsoid, Given, Particle, Shape, Solid, Sphere, Tensor

#: The components XX, YY, ZZ, XY, XZ, YZ of a symmetric tensor.
Components = tuple[Real, Real, Real, Real, Real, Real]


@dataclass(frozen=True, eq=False)
class MassProperties:
    """Mass (kg), centre of mass (m), and inertia tensor about the centre of mass (kg m^2), in some frame."""

    mass: Real
    centre: Vector3
    tensor: Components


def moments(shape: Shape, mass: float) -> Vector3:
    """Moments A, B, C (kg m^2) about I, J, K of a homogeneous solid of the given mass (kg): the integrals of [G 2.29]."""
    m = MP.mpf(mass)
    match shape:
        case Brick(sizes):
            return _across(vector(sizes), m / 3)
        case Ellipsoid(sizes):
            return _across(vector(sizes), m / 5)
        case Cylinder(radius, half_length):
            square = MP.mpf(radius) ** 2
            across = m * (square / 4 + MP.mpf(half_length) ** 2 / 3)
            return across, across, m * square / 2
        case Sphere(radius):
            moment = 2 * m * MP.mpf(radius) ** 2 / 5
            return moment, moment, moment


def _across(sizes: Vector3, factor: Real) -> Vector3:
    aa, bb, cc = (size * size for size in sizes)
    return factor * (bb + cc), factor * (aa + cc), factor * (aa + bb)


def solid(part: Solid) -> MassProperties:
    """Mass properties of a homogeneous solid that is displaced and turned in some frame."""
    principal, turn = moments(part.shape, part.mass), attitude(part.attitude)
    if turn == IDENTITY:
        return MassProperties(MP.mpf(part.mass), vector(part.position), (*principal, *(MP.mpf(0),) * 3))
    rows = matrix(turn)

    def component(i: int, j: int) -> Real:
        return sum(rows[i][k] * principal[k] * rows[j][k] for k in range(3))

    tensor = (component(0, 0), component(1, 1), component(2, 2), component(0, 1), component(0, 2), component(1, 2))
    return MassProperties(MP.mpf(part.mass), vector(part.position), tensor)


def particle(part: Particle) -> MassProperties:
    """Mass properties of a point mass."""
    zero = MP.mpf(0)
    return MassProperties(MP.mpf(part.mass), vector(part.position), (zero,) * 6)


def joined(parts: Sequence[MassProperties]) -> MassProperties:
    """Mass properties of bodies joined into one, all given in the same frame, by the parallel-axis theorem [G 2.9, 2.29].

    The centre of bodies without mass is the origin.
    """
    mass = sum(part.mass for part in parts)
    if not mass:
        return MassProperties(mass, ORIGIN, (*ORIGIN, *ORIGIN))
    x0, y0, z0 = (sum(part.mass * part.centre[axis] for part in parts) / mass for axis in range(3))
    total = [MP.mpf(0)] * 6
    for part in parts:
        x, y, z = part.centre[0] - x0, part.centre[1] - y0, part.centre[2] - z0
        mx, my, mz = part.mass * x, part.mass * y, part.mass * z
        moved = (my * y + mz * z, mx * x + mz * z, mx * x + my * y, -mx * y, -mx * z, -my * z)
        total = [have + term + more for have, term, more in zip(total, part.tensor, moved, strict=True)]
    xx, yy, zz, xy, xz, yz = total
    return MassProperties(mass, (x0, y0, z0), (xx, yy, zz, xy, xz, yz))


def mass_properties(definition: Given) -> MassProperties:
    """Mass properties of a body as a file defines it, in the frame of the body.

    If the upper and the lower half of a tensor differ in their last digits, their mean is taken.
    """
    match definition:
        case Solid() as alone:
            return solid(alone)
        case Tensor(mass, (a, b, c)):
            (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = vector(a), vector(b), vector(c)
            zero = MP.mpf(0)
            mean = (xx, yy, zz, (xy + yx) / 2, (xz + zx) / 2, (yz + zy) / 2)
            return MassProperties(MP.mpf(mass), (zero, zero, zero), mean)
        case parts:
            return joined([solid(part) if isinstance(part, Solid) else particle(part) for part in parts])
