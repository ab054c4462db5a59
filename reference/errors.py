"""Exceptions of the reference: the scenes it has no model of, and the motions it cannot compute.

Results show the text of these exceptions in their column `reason`, so each text must make sense on its own. Invalid arguments
raise `ValueError`.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Literal

import numpy as np

#: The parts of a mechanism without which a motion may have a truth.
Cause = Literal["dry friction", "stops", "controllers", "followers"]


class NotModelled(Exception):
    """The reference has no model of something that the scene contains; the text names it.

    cause: what a mechanism must be without, if that is enough; None if it is not.
    """

    def __init__(self, text: str, cause: Cause | None = None) -> None:
        super().__init__(text)
        self.cause = cause


class OutOfReach(Exception):
    """The reference cannot compute this motion, or not in a reasonable number of steps; the text says why.

    cause: the part of a mechanism that makes the motion undecidable; None if there is no such part.
    """

    def __init__(self, text: str, cause: Cause | None = None) -> None:
        super().__init__(text)
        self.cause = cause


class Stopped(OutOfReach):
    """A motion was followed until a time (s)."""

    def __init__(self, text: str, time: float, cause: Cause | None = None) -> None:
        super().__init__(text, cause)
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
