"""Find what makes a call about many things fail: the things are halved until those that fail are alone."""

from collections.abc import Callable
from typing import TypeVar

from bodycheck.processes.failures import Crashed, TimedOut

Result = TypeVar("Result")

#: Smallest part of the time limit of a whole call that a call about a part of it has; a single thing has all of it.
LEAST_PART = 1 / 16


def in_halves(
    attempt: Callable[[int, int], Result | Crashed | TimedOut], first: int, last: int
) -> list[tuple[range, Result | Crashed | TimedOut]]:
    """Return what calls about parts of some things gave, in the order of the things.

    The first call is about all of them. Where a call fails, its things are halved, until a failure is that of one thing alone.

    Parameters
    ----------
    attempt
        Makes a call about the things from one place up to another one, without it.
    first, last
        The places of all things, without the last.
    """
    result = attempt(first, last)
    if last - first == 1 or not isinstance(result, Crashed | TimedOut):
        return [(range(first, last), result)]
    middle = (first + last) // 2
    return [*in_halves(attempt, first, middle), *in_halves(attempt, middle, last)]


def limit_of(part: int, whole: int, limit: float) -> float:
    """Return the time limit (s) of a call about a part of some things, from that of a call about the whole.

    What stops short of it is halved further, so that a small limit costs time and changes no result.
    """
    return limit if part == 1 else limit * max(LEAST_PART, part / whole)
