"""The next instant at which two spheres touch, whose distance changes as that of points with constant accelerations.

The square of the distance is a polynomial of the fourth degree in time, of the second degree if both spheres fly. Its first
root is found between the roots of its derivative, which are found in the same way.
"""

import itertools
from collections.abc import Sequence

from bodycheck.reference.contact.spheres.ball import size
from bodycheck.reference.errors import NotModelled
from bodycheck.reference.exact.numbers import DIGITS, MP, NEGLIGIBLE, Real, Vector3
from bodycheck.reference.exact.rotations import dot

#: The number of halvings of an interval with a root, after which it has all digits.
HALVINGS = int(DIGITS / 0.3) + 20


def next_touch(apart: Vector3, velocity: Vector3, acceleration: Vector3, reach: Real, until: Real, *, touching: bool) -> Real:
    """The time (s) until two spheres touch while they approach each other; infinity if they do not before `until` (s).

    Parameters
    ----------
    apart, velocity, acceleration
        Position (m), velocity (m/s) and acceleration (m/s^2) of the second centre relative to the first.
    reach
        The sum of the radii (m).
    until
        The end of the search (s); infinite only without an acceleration.
    touching
        Whether the spheres touch now, without approaching each other.

    Raises
    ------
    NotModelled
        If spheres that touch are pressed against each other by their accelerations.
    """
    closing = dot(apart, velocity)
    if not any(acceleration):
        return MP.inf if touching else _straight(dot(apart, apart) - reach * reach, closing, dot(velocity, velocity))
    if size(apart) - reach > until * (size(velocity) + until / 2 * size(acceleration)):
        return MP.inf  # too far apart
    powers = [
        MP.zero if touching else dot(apart, apart) - reach * reach,
        2 * closing,
        dot(velocity, velocity) + dot(apart, acceleration),
        dot(velocity, acceleration),
        dot(acceleration, acceleration) / 4,
    ]
    scale = reach * reach + dot(velocity, velocity) + dot(acceleration, acceleration)
    while touching and powers and abs(powers[0]) <= NEGLIGIBLE * scale:
        powers = powers[1:]  # the root at the present instant is left out
    if touching and powers and powers[0] < 0:
        raise NotModelled("spheres that stay in touch and press on each other")
    roots = [root for root in _roots(powers, until) if root > 0]
    return next((root for root in roots if _slope(powers, root) < 0), MP.inf)


def _straight(gap: Real, closing: Real, square: Real) -> Real:
    """The time (s) until gap + 2 closing t + square t^2 becomes negative; infinity if it never does."""
    under = closing * closing - square * gap
    if closing >= 0 or under <= 0:
        return MP.inf
    return gap / (MP.sqrt(under) - closing)


def _roots(powers: Sequence[Real], until: Real) -> list[Real]:
    """The real roots between 0 and `until`, in ascending order, at which a polynomial changes its sign."""
    if len(powers) < 2:
        return []
    derivative = [order * power for order, power in enumerate(powers)][1:]
    edges = [MP.zero, *_roots(derivative, until), until]
    roots = []
    for low, high in itertools.pairwise(edges):
        before, after = _value(powers, low), _value(powers, high)
        if before * after < 0:
            roots.append(_bisected(powers, low, high, before))
    return roots


def _bisected(powers: Sequence[Real], low: Real, high: Real, before: Real) -> Real:
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        if _value(powers, middle) * before > 0:
            low = middle
        else:
            high = middle
    return high


def _value(powers: Sequence[Real], time: Real) -> Real:
    return MP.polyval(list(reversed(powers)), time)


def _slope(powers: Sequence[Real], time: Real) -> Real:
    return _value([order * power for order, power in enumerate(powers)][1:], time)
