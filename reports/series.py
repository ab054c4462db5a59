"""Curves with few enough points to be stored in a page, which still have every peak."""

import heapq
import math
from collections.abc import Iterable

import numpy as np

from bodycheck.reference.trajectory import Array


def ends(samples: int, points: int) -> np.ndarray[tuple[int], np.dtype[np.intp]]:
    """Return the index of the last sample of each interval when samples are divided evenly into at most `points` intervals."""
    cuts = np.linspace(0, samples, min(samples, points) + 1).round().astype(np.intp)
    return cuts[1:] - 1


def envelope(values: Array, points: int) -> Array:
    """Return the largest of values (n,) in each interval of `ends`."""
    starts = np.concatenate([[0], ends(len(values), points)[:-1] + 1])
    return np.maximum.reduceat(values, starts)


def corners(t: Array, values: Array, most: int, tolerance: float = 1e-3) -> list[int]:
    """Return the ascending indices of instants between which straight lines follow curves.

    This is the algorithm of Douglas and Peucker, with the largest deviation split first. Whatever the values are, it passes
    over the samples at most 2 `most` times; samples with a value that is not finite are not among those that it looks at.

    Parameters
    ----------
    t
        Instants (n,).
    values
        Curves (n, k).
    most
        The largest number of instants.
    tolerance
        Largest deviation of a sample from the lines, as a share of the range of all curves. It is exceeded if it would take
        more than `most` instants.
    """
    finite = np.flatnonzero(np.isfinite(values).all(axis=1))
    if not finite.size:
        return sorted({0, len(t) - 1})
    t, values = t[finite], values[finite]
    allowed = tolerance * (float(np.ptp(values)) or 1.0)
    kept = {0, len(t) - 1}
    queue = _worst_misses(t, values, (0, len(t) - 1))
    while queue and len(kept) < most:
        miss, start, at, stop = heapq.heappop(queue)
        if -miss <= allowed:
            break
        kept.add(at)
        for found in _worst_misses(t, values, (start, at), (at, stop)):
            heapq.heappush(queue, found)
    return [int(finite[at]) for at in sorted(kept)]


def _worst_misses(t: Array, values: Array, *spans: tuple[int, int]) -> list[tuple[float, int, int, int]]:
    """Return (-deviation, start, index, stop) of the sample in each span that is farthest from the straight line.

    A span without a sample between its ends has none, so that each one that is returned can be split.
    """
    found = []
    for start, stop in spans:
        if stop - start < 2:
            continue
        share = ((t[start + 1 : stop] - t[start]) / (t[stop] - t[start]))[:, None]
        misses = np.abs(values[start + 1 : stop] - (1 - share) * values[start] - share * values[stop]).max(axis=1)
        at = int(misses.argmax())
        found.append((-float(misses[at]), start, start + 1 + at, stop))
    return found


def rounded(values: Iterable[float], digits: int = 4) -> list[float | None]:
    """Return values with so many significant digits, with None for those that are not finite, which JSON cannot hold."""
    return [float(f"{value:.{digits}g}") if math.isfinite(value) else None for value in values]
