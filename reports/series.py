"""Curves with few enough points to draw, that still have every peak."""

import heapq
import math
from collections.abc import Iterable

import numpy as np

from bodycheck.reference.trajectory import Array


def ends(samples: int, points: int) -> np.ndarray[tuple[int], np.dtype[np.intp]]:
    """The index of each interval's last sample (at most `points` of them), when so many samples are cut evenly."""
    cuts = np.linspace(0, samples, min(samples, points) + 1).round().astype(np.intp)
    return cuts[1:] - 1


def envelope(values: Array, points: int) -> Array:
    """The largest of values (n,) in each interval of `ends`: at the end of an interval, the largest since the one before."""
    starts = np.concatenate([[0], ends(len(values), points)[:-1] + 1])
    return np.maximum.reduceat(values, starts)


def corners(t: Array, values: Array, most: int, tolerance: float = 1e-3) -> list[int]:
    """Indices, ascending, of those instants t (n,) between which straight lines follow the curves values (n, k).

    The lines miss no sample by more than the tolerance, a share of the curves' range, unless that takes more than `most`
    instants; then the worst misses are mended first (Douglas and Peucker's way, in order of need).
    """
    allowed = tolerance * (float(np.ptp(values)) or 1.0)
    kept = {0, len(t) - 1}
    queue = [_worst_miss(t, values, 0, len(t) - 1)]
    while queue and len(kept) < most:
        miss, start, at, stop = heapq.heappop(queue)
        if -miss <= allowed:
            break
        kept.add(at)
        for span in ((start, at), (at, stop)):
            heapq.heappush(queue, _worst_miss(t, values, *span))
    return sorted(kept)


def _worst_miss(t: Array, values: Array, start: int, stop: int) -> tuple[float, int, int, int]:
    """Where between two samples the straight line misses the curves most: minus the miss, start, there, stop."""
    if stop - start < 2:
        return 0.0, start, start, stop
    share = ((t[start + 1 : stop] - t[start]) / (t[stop] - t[start]))[:, None]
    misses = np.abs(values[start + 1 : stop] - (1 - share) * values[start] - share * values[stop]).max(axis=1)
    at = int(misses.argmax())
    return -float(misses[at]), start, start + 1 + at, stop


def rounded(values: Iterable[float], digits: int = 4) -> list[float | None]:
    """Values to so many significant digits; what is not finite has no place in JSON and becomes None."""
    return [float(f"{value:.{digits}g}") if math.isfinite(value) else None for value in values]
