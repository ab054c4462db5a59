"""Mass and inertia tensor of a body in rational arithmetic, without any rounding.

The second moments <x_i x_j> of the mass are formed first, from integrals of powers: they add up over parts, and the tensor is
I = tr(S) - S with S = sum of m <x x^T> about the centre of mass [G 2.29].
"""

import math
from collections.abc import Callable, Iterable, Sequence
from fractions import Fraction

from bodycheck.reference.scene import Attitude, Brick, Cylinder, Definition, Ellipsoid, Particle, Shape, Solid, Sphere, Tensor

#: A matrix of rational numbers by its rows.
Rows = list[list[Fraction]]

#: Maps an attitude to its matrix of direction cosines, from the axes of the part to the axes of the body.
Cosines = Callable[[Attitude], Rows]

#: Binary digits kept of a second moment of a rotated part. Exact quotients of many parts would have ever longer denominators.
PART_BITS = 800

#: Binary digits of a denominator up to which a second moment is kept exactly.
SHORT_BITS = 200


def mass_and_tensor(definition: Definition, cosines: Cosines) -> tuple[Fraction, Rows]:
    """The mass (kg) and the inertia tensor (kg m^2) about the centre of mass in the frame of the body that a file defines.

    cosines: the matrix of an attitude, which is irrational for Euler angles.
    """
    match definition.inertia:
        case Tensor(mass, rows):
            return Fraction(mass), [[(Fraction(rows[i][j]) + Fraction(rows[j][i])) / 2 for j in range(3)] for i in range(3)]
        case Solid() as alone:
            return Fraction(alone.mass), from_second_moments(_turned(alone, cosines))
        case parts:
            return _joined(parts, cosines)


def from_second_moments(second: Rows) -> Rows:
    """The inertia tensor (kg m^2) that follows from second moments of the mass (kg m^2)."""
    trace = second[0][0] + second[1][1] + second[2][2]
    return [[(trace if i == j else 0) - second[i][j] for j in range(3)] for i in range(3)]


def along_axes(moments: Sequence[float], axes: Rows) -> Rows:
    """The inertia tensor (kg m^2) of a body with principal moments (kg m^2) about the columns of a matrix."""
    return _congruent([Fraction(moment) for moment in moments], axes)


def inverse(rows: Rows) -> Rows:
    """The inverse of a matrix by its cofactors. Raises `ZeroDivisionError` for a singular matrix."""

    def cofactor(i: int, j: int) -> Fraction:
        (a, b), (c, d) = ((rows[p % 3][j + 1 - 3], rows[p % 3][j + 2 - 3]) for p in (i + 1, i + 2))
        return a * d - b * c

    cofactors = [[cofactor(i, j) for j in range(3)] for i in range(3)]
    determinant = sum((rows[0][j] * cofactors[0][j] for j in range(3)), Fraction(0))
    return [[cofactors[j][i] / determinant for j in range(3)] for i in range(3)]


def mean_squares(shape: Shape) -> list[Fraction]:
    """The means of x^2, y^2 and z^2 over a homogeneous solid, along its own axes (m^2)."""
    match shape:
        case Brick(sizes):
            return [_mean_power(2, 0) * Fraction(size) ** 2 for size in sizes]
        case Ellipsoid(sizes):  # the image of the unit ball, over which the mean of r^2 is shared by three directions
            return [_mean_power(2, 2) / 3 * Fraction(size) ** 2 for size in sizes]
        case Cylinder(radius, half_length):  # in a disk the mean of r^2 is shared by two directions
            across = _mean_power(2, 1) / 2 * Fraction(radius) ** 2
            return [across, across, _mean_power(2, 0) * Fraction(half_length) ** 2]
        case Sphere(radius):
            return [_mean_power(2, 2) / 3 * Fraction(radius) ** 2] * 3


def _mean_power(power: int, weight: int) -> Fraction:
    """The mean of r^power over 0 < r < 1 where r has the density r^weight: a quotient of integrals of powers."""
    return Fraction(weight + 1, power + weight + 1)


def _turned(part: Solid, cosines: Cosines) -> Rows:
    """The second moments (kg m^2) of a solid about its own centre, along the axes of the body."""
    mass = Fraction(part.mass)
    principal = [mass * square for square in mean_squares(part.shape)]
    if part.attitude == (1.0, 0.0, 0.0, 0.0):
        return [[principal[i] if i == j else Fraction(0) for j in range(3)] for i in range(3)]
    return _congruent(principal, cosines(part.attitude))


def _congruent(diagonal: Sequence[Fraction], axes: Rows) -> Rows:
    """R D R^T for a diagonal matrix D and a matrix R."""
    d, d_scale = over_common_denominator(diagonal)
    flat, scale = over_common_denominator([entry for row in axes for entry in row])
    r = flat[:3], flat[3:6], flat[6:]
    product: Rows = [[Fraction(0)] * 3 for _ in range(3)]
    for i in range(3):
        for j in range(i, 3):
            product[i][j] = product[j][i] = Fraction(sum(r[i][k] * d[k] * r[j][k] for k in range(3)), d_scale * scale * scale)
    return product


def over_common_denominator(values: Iterable[Fraction | float]) -> tuple[list[int], int]:
    """Numbers as whole numbers over one common denominator; these are much faster to compute with than fractions."""
    ratios = [value.as_integer_ratio() for value in values]
    common = math.lcm(*(denominator for _, denominator in ratios))
    return [numerator * (common // denominator) for numerator, denominator in ratios], common


def _joined(parts: Sequence[Particle] | Sequence[Solid], cosines: Cosines) -> tuple[Fraction, Rows]:
    """The mass and the inertia tensor of particles or solids about their common centre of mass."""
    masses, mass_scale = over_common_denominator([part.mass for part in parts])
    flat, scale = over_common_denominator([coordinate for part in parts for coordinate in part.position])
    places = [flat[n : n + 3] for n in range(0, len(flat), 3)]
    turned = [_turned(part, cosines) for part in parts if isinstance(part, Solid)]
    mass = sum(masses)
    first = [sum(m * position[i] for m, position in zip(masses, places, strict=True)) for i in range(3)]
    total: Rows = [[Fraction(0)] * 3 for _ in range(3)]
    for i in range(3):
        for j in range(i, 3):
            second = sum(m * position[i] * position[j] for m, position in zip(masses, places, strict=True))
            about_centre = Fraction(second * mass - first[i] * first[j], mass * mass_scale * scale * scale)
            total[i][j] = total[j][i] = about_centre + sum((_short(tensor[i][j]) for tensor in turned), Fraction(0))
    return Fraction(mass, mass_scale), from_second_moments(total)


def _short(value: Fraction) -> Fraction:
    """A number rounded down to `PART_BITS` binary digits, or unchanged if its denominator is short."""
    numerator, denominator = value.numerator, value.denominator
    shift = PART_BITS - numerator.bit_length() + denominator.bit_length()
    if denominator.bit_length() <= SHORT_BITS or shift <= 0:
        return value
    return Fraction((numerator << shift) // denominator, 1 << shift)
