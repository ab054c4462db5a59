"""The constants of a rotation without torque, from numbers with many digits, rounded once.

The symbols are those of `torque_free`. For one scene they are computed with a hundred digits. For many they are computed with
pairs of numbers (see `exact.pairs`), with a list of the members for which pairs have too few digits.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.exact import pairs
from bodycheck.reference.exact.numbers import MP, NEGLIGIBLE, Real, Wide, real, wide
from bodycheck.reference.exact.pairs import PAIR_ROUNDING, ROUNDING, Pair
from bodycheck.reference.flight.elliptic import Wides
from bodycheck.reference.trajectory import Array

#: Largest allowed error of a difference of pairs, as a fraction of one rounding to the wide type.
NEGLIGIBLE_PART = 1 / 8

#: Smallest ratios of two moments and of two rates, other than zero, for which no product of pairs underflows in any wide type.
SMALLEST_RATIOS = 1e-20, 1e-60


@dataclass(frozen=True, eq=False)
class Constants:
    """The numbers that determine the motion of the angular momentum in the body frame, for one body or as arrays for m bodies.

    Attributes
    ----------
    order
        (3,) or (m, 3) indices, among I, J, K, of the axes 1, 2, 3.
    handedness
        +1 if the axes 1, 2, 3 are right-handed, -1 if they are left-handed.
    unit
        The unit of angular velocity (rad/s), a power of two, whose inverse is the unit of time. The unit of the moments is
        another power of two, which has no effect.
    i1, i2, i3
        The moments.
    low, high, span
        I2 - I1, I3 - I2 and I3 - I1.
    e1, e2, e3
        E1, E2, E3.
    w1, w2, w3
        The angular velocity.
    """

    order: NDArray[np.int_]
    handedness: Any
    unit: Wides
    i1: Wides
    i2: Wides
    i3: Wides
    low: Wides
    high: Wides
    span: Wides
    e1: Wides
    e2: Wides
    e3: Wides
    w1: Wides
    w2: Wides
    w3: Wides

    def part(self, places: NDArray[Any]) -> "Constants":
        """The constants of some of the bodies, by their indices or a mask."""
        return Constants(*(getattr(self, field.name)[places] for field in fields(self)))


@dataclass(frozen=True)
class Branch:
    """The choices that decide which formulas apply to a motion.

    Attributes
    ----------
    p
        Index, in the order 1, 2, 3, of the axis that the angular momentum encircles in the body: 0 or 2.
    f
        Index of the axis from which the Euler angles are counted: the extreme axis closer to being an axis of symmetry, 0 or 2.
    hyperbolic
        Whether k > k'.
    """

    p: int
    f: int
    hyperbolic: bool


def constants(moments: Sequence[Any], rates: Sequence[Any]) -> Constants:
    """The constants of one body, for principal moments (kg m^2) and an angular velocity along the principal axes (rad/s).

    The arguments have any type of number and are taken as exact. The constants are computed with a hundred digits and rounded
    once.
    """
    order = sorted(range(3), key=moments.__getitem__)
    i, _ = _scaled([real(moments[axis]) for axis in order])
    w, unit = _scaled([real(rates[axis]) for axis in order])
    low, high, span = i[1] - i[0], i[2] - i[1], i[2] - i[0]
    axial, transverse = i[2] * high * w[2] ** 2, i[0] * low * w[0] ** 2
    e2 = axial - transverse
    if abs(e2) <= NEGLIGIBLE * (axial + transverse):
        e2 = real(0)
    middle = i[1] * w[1] ** 2
    e1, e3 = middle * low + i[2] * span * w[2] ** 2, i[0] * span * w[0] ** 2 + middle * high
    values = [wide(value) for value in (*i, low, high, span, e1, e2, e3, *w)]
    handedness = 1 if (order[1] - order[0]) % 3 == 1 else -1
    return Constants(np.array(order), handedness, unit, *values)


def _scaled(values: list[Real]) -> tuple[list[Real], Wide]:
    """Numbers in units of a power of two chosen so that the largest is between 1/2 and 1, and this unit."""
    _, exponent = MP.frexp(max(abs(value) for value in values))
    return [MP.ldexp(value, -exponent) for value in values], Wide(np.ldexp(Wide(1), exponent))


def constants_of_many(moments: Pair, rates: Array) -> tuple[Constants, NDArray[np.bool_]]:
    """The constants of m bodies whose moments all differ, and a mask (m,) of the bodies whose constants are accurate.

    These constants are as accurate as the results of `constants`. For the other bodies, the differences of moments, or the
    difference E2, are so small that pairs have too few digits.

    Parameters
    ----------
    moments
        (m, 3) principal moments (kg m^2).
    rates
        (m, 3) angular velocities along the principal axes (rad/s), not all zero.
    """
    order = _ascending(moments)
    i, _ = _in_units(_ordered(moments, order))
    w, unit = _in_units(_ordered(pairs.of_wide(rates + 0.0), order))
    (i1, i2, i3), (w1, w2, w3) = ([each[:, axis] for axis in range(3)] for each in (i, w))
    low, high, span = i2 - i1, i3 - i2, i3 - i1
    squares = [each * each for each in (w1, w2, w3)]
    axial, transverse, middle = i3 * high * squares[2], i1 * low * squares[0], i2 * squares[1]
    e1, e2, e3 = middle * low + i3 * span * squares[2], axial - transverse, i1 * span * squares[0] + middle * high

    # A moment as a pair has the error of some operations, and so has a difference of moments.
    error = 8 * PAIR_ROUNDING * (axial.high * (1 + i3.high / high.high) + transverse.high * (1 + i2.high / low.high))
    allowed = NEGLIGIBLE_PART * ROUNDING
    accurate = (error <= allowed * abs(e2.high)) & (allowed * np.minimum(low.high, high.high) >= 8 * PAIR_ROUNDING)
    for values, ratio in zip((i, w), SMALLEST_RATIOS, strict=True):
        accurate &= ((values.high == 0) | (abs(values.high) >= ratio)).all(axis=1)
    handedness = np.where((order[:, 1] - order[:, 0]) % 3 == 1, 1, -1)
    parts = (value.high for value in (i1, i2, i3, low, high, span, e1, e2, e3, w1, w2, w3))
    return Constants(order, handedness, unit, *parts), np.asarray(accurate)


def _ascending(moments: Pair) -> NDArray[np.int_]:
    """The axes (m, 3) in the order of ascending moments (m, 3); axes of equal moments in the order I, J, K."""
    each = [moments[:, axis] for axis in range(3)]
    rank = np.zeros(moments.high.shape, dtype=int)
    for one, other in ((0, 1), (0, 2), (1, 2)):
        larger = pairs.compare(each[one], each[other]) > 0
        rank[:, one] += larger
        rank[:, other] += ~larger
    return np.argsort(rank, axis=1)


def _ordered(values: Pair, order: NDArray[np.int_]) -> Pair:
    return Pair(*(np.take_along_axis(part, order, axis=1) for part in (values.high, values.low)))


def _in_units(values: Pair) -> tuple[Pair, Wides]:
    """Rows (m, 3) in units (m,) of powers of two, so that the largest of a row is between 1/2 and 1, and these units."""
    _, exponent = np.frexp(abs(values.high).max(axis=1))
    down = -exponent[:, None]
    return Pair(np.ldexp(values.high, down), np.ldexp(values.low, down)), np.ldexp(Wide(1), exponent)


def branches(c: Constants) -> tuple[Any, Any, Any]:
    """The attributes p, f and hyperbolic of a `Branch`, for one body or as arrays (m,)."""
    outer = c.e2 >= 0
    encircled: Any = np.where(outer, c.e3, c.e1)
    other: Any = np.where(outer, c.low, c.high)
    k2, kc2 = other * encircled, c.span * abs(c.e2)  # both times the same factor
    p = np.where(outer, 2, 0)
    f = np.where(c.i3 * c.low <= c.i1 * c.high, 2, 0)
    return p, f, k2 > kc2


def branch(c: Constants) -> Branch:
    """The branch of the motion of one body."""
    p, f, hyperbolic = branches(c)
    return Branch(int(p), int(f), bool(hyperbolic))
