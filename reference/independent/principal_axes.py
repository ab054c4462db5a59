"""Principal moments and axes of an inertia tensor by the trigonometric roots of its characteristic polynomial.

The deviator D = (I - tr(I)/3) / p with p^2 = |I - tr(I)/3|^2 / 6 has the eigenvalues x that solve x^3 - 3 x = 2 r with r =
det(D) / 2 (O. K. Smith, Communications of the ACM 4, 168, 1961). For r >= 0 the largest eigenvalue, x = 2 cos(arccos(r) / 3),
is at least sqrt(3) away from the other two, and for r <= 0 the smallest eigenvalue is. This eigenvalue is computed first,
together with its axis; the other two may be close to each other or equal, and are the eigenvalues of the symmetric 2 by 2
tensor across that axis.
"""

from bodycheck.reference.independent.arithmetic import ROUNDED, Matrix, Real, Vector, applied, cross, dot, norm, scaled
from bodycheck.reference.independent.border import MP

#: The unit vectors along the axes of the frame of the tensor.
UNIT_VECTORS: Matrix = (
    (MP.mpf(1), MP.mpf(0), MP.mpf(0)),
    (MP.mpf(0), MP.mpf(1), MP.mpf(0)),
    (MP.mpf(0), MP.mpf(0), MP.mpf(1)),
)


def principal_axes(tensor: Matrix) -> tuple[Vector, Matrix]:
    """The principal moments I1 <= I2 <= I3 (kg m^2) of a tensor, and its principal axes as a right-handed set of unit vectors.

    Moments whose difference can be a rounding error are equal in the result. A diagonal tensor is returned without any
    rounding.
    """
    if not any(tensor[i][j] for i in range(3) for j in range(3) if i != j):
        pairs = [(tensor[axis][axis], UNIT_VECTORS[axis]) for axis in range(3)]
    else:
        pairs = _pairs(tensor)
    pairs.sort(key=lambda pair: pair[0])
    (low, first), (middle, second), (high, _) = pairs
    if middle - low <= ROUNDED * high:
        middle = low
    if high - middle <= ROUNDED * high:
        high = middle
    return (low, middle, high), (first, second, cross(first, second))


def _pairs(tensor: Matrix) -> list[tuple[Real, Vector]]:
    """The principal moments of a tensor, each with its axis."""
    mean = (tensor[0][0] + tensor[1][1] + tensor[2][2]) / 3
    size = MP.sqrt(sum(dot(row, row) for row in _shifted(tensor, mean)) / 6)
    if size <= ROUNDED * mean:
        return [(mean, axis) for axis in UNIT_VECTORS]
    x, y, z = (scaled(row, 1 / size) for row in _shifted(tensor, mean))
    r = dot(x, cross(y, z)) / 2
    root = 2 * MP.cos(MP.acos(min(abs(r), MP.one)) / 3) * (1 if r >= 0 else -1)
    a, b, c = _shifted((x, y, z), root)
    # The rows of D - x span the plane across the axis; the largest of their vector products has lost no digits.
    axis = max((cross(a, b), cross(b, c), cross(c, a)), key=lambda each: dot(each, each))
    axis = scaled(axis, 1 / norm(axis))
    return [(mean + size * root, axis), *_across(tensor, axis)]


def _across(tensor: Matrix, axis: Vector) -> list[tuple[Real, Vector]]:
    """The two principal moments across a principal axis, each with its axis."""
    first = max((cross(axis, unit) for unit in UNIT_VECTORS), key=lambda each: dot(each, each))
    first = scaled(first, 1 / norm(first))
    second = cross(axis, first)
    along = applied(tensor, first)
    one, off, other = dot(first, along), dot(second, along), dot(second, applied(tensor, second))
    half, mean = (one - other) / 2, (one + other) / 2
    radius = MP.hypot(half, off)
    if radius <= ROUNDED * mean:
        return [(mean, first), (mean, second)]
    # The axis of the larger moment is at the angle alpha from the first, with cos(2 alpha) = half / radius.
    larger, smaller = MP.sqrt((1 + abs(half) / radius) / 2), off / (2 * radius)
    c, s = (larger, smaller / larger) if half >= 0 else (abs(smaller) / larger, larger if off >= 0 else -larger)
    turned = tuple(c * p + s * q for p, q in zip(first, second, strict=True))
    crossed = tuple(c * q - s * p for p, q in zip(first, second, strict=True))
    return [(mean + radius, (turned[0], turned[1], turned[2])), (mean - radius, (crossed[0], crossed[1], crossed[2]))]


def _shifted(tensor: Matrix, value: Real) -> Matrix:
    """A tensor minus a multiple of the unit tensor."""
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = tensor
    return (xx - value, xy, xz), (yx, yy - value, yz), (zx, zy, zz - value)
