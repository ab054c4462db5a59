"""The value at which an answer changes."""

from collections.abc import Callable
from math import sqrt

#: The relative distance of the two values between which the answer changes, in the end.
CLOSE = 2e-3


def threshold(answer: Callable[[float], bool], below: float, above: float) -> float:
    """Return the value between two positive ones at which an answer changes, to a thousandth of it.

    Parameters
    ----------
    answer
        A function of the value, whose results at `below` and `above` are True and False in this order.
    below, above
        The two values, in either order.
    """
    while abs(above / below - 1) > CLOSE:
        middle = sqrt(below * above)
        below, above = (middle, above) if answer(middle) else (below, middle)
    return sqrt(below * above)
