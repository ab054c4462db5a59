"""A motion of a tree in many digits, which is handed to a proof as a candidate."""

from collections.abc import Callable
from typing import Any

from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.trajectory import Array

#: The bits of the mantissa of the widest type of NumPy.
WIDE_BITS = 64


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
        if bits <= WIDE_BITS:
            wide = recursion.coordinates(scene, times)
            high = wide.astype(float)
            pairs = zip(high.tolist(), (wide - high).astype(float).tolist(), strict=True)
            return [[arb(a) + arb(b) for a, b in zip(*pair, strict=True)] for pair in pairs]
        return [[arb(str(value)).mid() for value in row] for row in recursion.coordinates(scene, times, hy.real, bits)]

    return candidate
