"""Curves that lie on each other: which they are, the bands that make the lower ones visible, and a sentence about them."""

from collections.abc import Mapping, Sequence

import numpy as np

from bodycheck.reference.trajectory import Array
from bodycheck.reports.quantities import listing

#: The largest ratio of two curves that cannot be distinguished. On a chart of three decades this is less than two pixels.
NEAR = 1.05

#: The share of the points of two curves that must be near. The others, such as the first ones, may be rounding.
SHARE = 0.95

#: The width (pixels) of the band around the uppermost of the lower curves, how much broader each band below it is, and the most
#: different widths.
NARROWEST, BROADER, MOST_WIDTHS = 6, 4, 3

#: The most groups, and the most methods of each group, that a sentence names.
MOST_GROUPS, MOST_NAMES = 3, 4


def coinciding(curves: Mapping[str, Array]) -> list[list[str]]:
    """Return the labels of curves that coincide, in groups of at least two.

    curves: the values of each curve by its label; curves with different numbers of points do not coincide. Only points at which
    both values are positive are compared, since a logarithmic scale shows no others.
    """
    groups: list[list[str]] = []
    for label, values in curves.items():
        same = next((group for group in groups if _coincide(curves[group[0]], values)), None)
        if same is None:
            groups.append([label])
        else:
            same.append(label)
    return [group for group in groups if len(group) > 1]


def _coincide(one: Array, other: Array) -> bool:
    if len(one) != len(other):
        return False
    seen, their = (np.isfinite(values) & (values > 0) for values in (one, other))
    both = seen & their
    if not both.any() or (seen != their).mean() > 1 - SHARE:
        return False
    near = np.abs(np.log(one[both] / other[both])) < np.log(NEAR)
    return bool(near.mean() >= SHARE)


def bands(groups: Sequence[Sequence[str]]) -> dict[str, int]:
    """Return the widths (pixels) of the bands around curves that lie below others, by label; groups: those of `coinciding`."""
    widths = {}
    for group in groups:
        for above, label in enumerate(reversed(group[:-1])):
            widths[label] = NARROWEST + BROADER * min(above, MOST_WIDTHS - 1)
    return widths


def told(groups: Sequence[Sequence[str]]) -> str:
    """Return a sentence about curves that coincide; empty if there are none."""
    if not groups:
        return ""
    named = [listing(group, MOST_NAMES, "method") for group in groups[:MOST_GROUPS]]
    more = len(groups) - len(named)
    rest = f"; and {more} more groups" if more > 1 else "; and one more group" if more else ""
    return f"These curves coincide, and the lower ones have pale bands: {'; '.join(named)}{rest}."
