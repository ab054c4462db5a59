"""Reduction of curves to so few points that they can be stored in a page, without the loss of peaks."""

import heapq
import math
from collections.abc import Iterable

import numpy as np

from bodycheck.reference.trajectory import Array


def ends(samples: int, points: int) -> np.ndarray[tuple[int], np.dtype[np.intp]]:
    """Return the indices of the last samples when `samples` samples are divided evenly into at most `points` intervals."""
    cuts = np.linspace(0, samples, min(samples, points) + 1).round().astype(np.intp)
    return cuts[1:] - 1


def envelope(values: Array, points: int) -> Array:
    """Return the largest of the values (n,) in each interval of `ends`."""
    starts = np.concatenate([[0], ends(len(values), points)[:-1] + 1])
    return np.maximum.reduceat(values, starts)


def corners(t: Array, values: Array, most: int, tolerance: float = 1e-3) -> list[int]:
    """Return the ascending indices of instants between which straight lines follow curves.

    This is the algorithm of Douglas and Peucker, with the largest deviation split first. It passes over the samples at most
    2 `most` times for any values. Samples with a value that is not finite are ignored.

    Parameters
    ----------
    t
        Instants (n,).
    values
        Curves (n, k).
    most
        The largest number of instants.
    tolerance
        The largest deviation of a sample from the lines, as a share of the range of all curves. The deviation can be larger if
        `most` instants do not suffice.
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

    A span without a sample between its ends is left out, so every returned span can be split.
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
    """Return values rounded to `digits` significant digits, with None for values that are not finite, as JSON requires."""
    return [float(f"{value:.{digits}g}") if math.isfinite(value) else None for value in values]
