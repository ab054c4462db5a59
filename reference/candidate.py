"""A motion of a tree in many digits, which is handed to a proof as a candidate."""

from collections.abc import Callable
from typing import Any

from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.trajectory import Array


def candidate_of(scene: AnyScene) -> Callable[[Array, int], list[list[Any]]] | None:
    """Return a function from ascending times (n,), s, and a number of bits to coordinates (n, k) near to those of a mechanism.

    Returns None for a single body, for which no proof needs it, and without heyoka.
    """
    if not isinstance(scene, Mechanism):
        return None
    try:
        import heyoka as hy
    except ImportError:
        return None
    from flint import arb

    from bodycheck.reference.mechanisms import recursion

    def candidate(times: Array, bits: int) -> list[list[Any]]:
        return [[arb(str(value)).mid() for value in row] for row in recursion.follow(scene, times, hy.real, bits).position]

    return candidate
