"""Principal moments and principal axes of an inertia tensor in exact arithmetic [G p. 49]."""

import itertools
import math

import numpy as np

from bodycheck.reference.exact.inertia import Components
from bodycheck.reference.exact.numbers import MP, NEGLIGIBLE, Quaternion4, Real, Vector3
from bodycheck.reference.exact.rotations import IDENTITY, matrix, multiply, unit
from bodycheck.reference.trajectory import Array

#: Every order of three axes, with +1 for right-handed orders and -1 for left-handed orders.
_AXIS_ORDERS = (((0, 1, 2), 1), ((1, 2, 0), 1), ((2, 0, 1), 1), ((0, 2, 1), -1), ((2, 1, 0), -1), ((1, 0, 2), -1))

#: The indices of XY, XZ and YZ among the components of a tensor, each with its two axes and the third axis.
_PAIRS = ((3, 0, 1, 2), (4, 0, 2, 1), (5, 1, 2, 0))


def principal_axes(tensor: Components) -> tuple[Vector3, Quaternion4]:
    """Principal moments and principal axes of a symmetric inertia tensor (kg m^2).

    Returns the moments A, B, C (kg m^2), and the unit quaternion (w, x, y, z) that rotates components along the principal
    axes to components in the frame of the tensor. Of the possible orders and signs of the axes, those are chosen that give the
    smallest rotation; a diagonal tensor gives no rotation at all. Where moments are equal, their axes are arbitrary.

    The axes in double precision are improved by Jacobi's rotations, which square the remaining components off the diagonal.
    Moments that differ from one another or from zero only by rounding errors are made equal or zero.
    """
    if not any(tensor[3:]):
        return (tensor[0], tensor[1], tensor[2]), IDENTITY
    axes = _axes_in_doubles(tensor)
    components = _along(tensor, axes)
    smallest = max(abs(component) for component in tensor) * NEGLIGIBLE**2
    while (largest := max(_PAIRS, key=lambda pair: abs(components[pair[0]])))[0] and abs(components[largest[0]]) > smallest:
        components, axes = _rotated(components, axes, largest)
    order, turn = _labels(matrix(axes))
    a, b, c = (components[axis] for axis in order)
    w, x, y, z = unit(multiply(axes, turn))
    # Of the two quaternions of a rotation, the one with the smaller angle.
    return _equalised([a, b, c]), (w, x, y, z) if w >= 0 else (-w, -x, -y, -z)


def _axes_in_doubles(tensor: Components) -> Quaternion4:
    """The axes in double precision, right-handed and in any order."""
    scale = max(abs(component) for component in tensor)
    xx, yy, zz, xy, xz, yz = (float(component / scale) for component in tensor)
    _, vectors = np.linalg.eigh(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))
    if np.linalg.det(vectors) < 0:
        vectors[:, 0] *= -1
    return _quaternion(vectors)


def _labels(rows: tuple[Vector3, Vector3, Vector3]) -> tuple[tuple[int, int, int], Quaternion4]:
    """The order of the columns of a rotation matrix, and the turn about its own axes, that make it the smallest rotation.

    The smallest rotation has the largest trace. If the signs that make every term of the trace positive give a left-handed
    frame, the sign of the smallest term is changed.
    """
    best: tuple[Real, tuple[int, int, int], list[int]] | None = None
    for order, handedness in _AXIS_ORDERS:
        diagonal = [rows[row][column] for row, column in enumerate(order)]
        signs = [1 if part >= 0 else -1 for part in diagonal]
        if math.prod(signs) * handedness < 0:
            signs[min(range(3), key=lambda row: abs(diagonal[row]))] *= -1
        trace = sum(part * sign for part, sign in zip(diagonal, signs, strict=True))
        if best is None or trace > best[0]:
            best = trace, order, signs
    assert best is not None
    _, order, signs = best
    turn = np.zeros((3, 3))
    turn[list(order), [0, 1, 2]] = signs
    w, x, y, z = _quaternion(turn)
    largest = max(abs(part) for part in (w, x, y, z))
    # Apart from their signs, the components of such a turn are 0 or 1, times a common factor.
    a, b, c, d = (MP.nint(part / largest) for part in (w, x, y, z))
    return order, (a, b, c, d)


def _quaternion(turn: Array) -> Quaternion4:
    """The quaternion of a rotation matrix (3, 3)."""
    from scipy.spatial.transform import Rotation  # imported here, since it takes longer than all else that most runs need

    w, x, y, z = Rotation.from_matrix(turn).as_quat(canonical=True, scalar_first=True).tolist()
    return MP.mpf(w), MP.mpf(x), MP.mpf(y), MP.mpf(z)


def _along(tensor: Components, axes: Quaternion4) -> list[Real]:
    """The components of a tensor along axes: R^T I R."""
    rows = matrix(axes)
    xx, yy, zz, xy, xz, yz = tensor
    full = ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))
    half = [[sum(full[i][k] * rows[k][j] for k in range(3)) for j in range(3)] for i in range(3)]

    def component(i: int, j: int) -> Real:
        return sum(rows[k][i] * half[k][j] for k in range(3))

    return [component(0, 0), component(1, 1), component(2, 2), component(0, 1), component(0, 2), component(1, 2)]


def _rotated(components: list[Real], axes: Quaternion4, pair: tuple[int, int, int, int]) -> tuple[list[Real], Quaternion4]:
    """The components and the axes after the rotation about one axis that makes a component off the diagonal zero.

    The formulas are those of Golub and Van Loan, Matrix Computations, 8.5.
    """
    off_diagonal, p, q, r = pair
    off = components[off_diagonal]
    tau = (components[q] - components[p]) / (2 * off)
    t = (1 if tau >= 0 else -1) / (abs(tau) + MP.sqrt(1 + tau * tau))
    c = 1 / MP.sqrt(1 + t * t)
    s = t * c
    rotated = list(components)
    rotated[p], rotated[q], rotated[off_diagonal] = components[p] - t * off, components[q] + t * off, MP.mpf(0)
    pr, qr = (next(index for index, *axes_of in _PAIRS if set(axes_of[:2]) == {one, r}) for one in (p, q))
    rotated[pr], rotated[qr] = c * components[pr] - s * components[qr], s * components[pr] + c * components[qr]
    # The new axes are p' = c p - s q and q' = s p + c q: a rotation about r = p x q, or about its opposite.
    sense = 1 if (q - p) % 3 == 1 else -1
    cos_half = MP.sqrt((1 + c) / 2)
    step = [cos_half, MP.mpf(0), MP.mpf(0), MP.mpf(0)]
    step[1 + r] = -sense * s / (2 * cos_half)
    return rotated, multiply(axes, (step[0], step[1], step[2], step[3]))


def _equalised(moments: list[Real]) -> Vector3:
    """Return the moments after making zero or equal the moments that differ from zero or from one another only by rounding."""
    largest = max(moments)
    equal = [moment if abs(moment) > NEGLIGIBLE * largest else MP.mpf(0) for moment in moments]
    order = sorted(range(3), key=equal.__getitem__)
    for one, other in itertools.pairwise(order):
        if equal[other] - equal[one] <= NEGLIGIBLE * largest:
            equal[other] = equal[one]
    return equal[0], equal[1], equal[2]
