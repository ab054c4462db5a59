"""Exceptions of the reference: the scenes it has no model of, and the motions it cannot compute.

Results show the text of these exceptions in their column `reason`, so each text must make sense on its own. Invalid arguments
raise `ValueError`.
"""

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np


class NotModelled(Exception):
    """The reference has no model of something that the scene contains; the text names it."""


class OutOfReach(Exception):
    """The reference cannot compute this motion, or not in a reasonable number of steps; the text says why."""


class Stopped(OutOfReach):
    """An integration stopped at a time (s)."""

    def __init__(self, text: str, time: float) -> None:
        super().__init__(text)
        self.time = time


class NotFlat(Exception):
    """The body does not lie flat on the plane, or has no face to lie on; the text lists what is wrong."""


class WouldTip(Exception):
    """A balanced pressure would have to be negative somewhere, so the body tips instead of sliding; the text says where."""


@contextmanager
def within_range(what: str) -> Iterator[None]:
    """Raise `OutOfReach` where a computation leaves the range of floating-point numbers, instead of a warning.

    what: the name of the computation, for the text. A computation that continues with infinite numbers must permit them by
    `numpy.errstate`.
    """
    try:
        with np.errstate(over="raise", divide="raise", invalid="raise"):
            yield
    except (FloatingPointError, OverflowError) as error:
        raise OutOfReach(f"{what} exceeds the range of floating-point numbers: {error}") from error
