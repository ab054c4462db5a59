"""Maps of an ensemble over two drawn numbers: where members fail, or where a figure is large."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.trajectory import Array
from bodycheck.studies.ensemble.findings.sensitivity import FAILURE, logarithms, numbers
from bodycheck.studies.ensemble.findings.stored import Ensemble

#: The most cells of a map along each axis, and the fewest members that a cell should have on average.
MOST_CELLS, MEMBERS_OF_CELL = 24, 8

#: A number whose values are all positive, and whose largest is this many times its smallest, has a logarithmic axis.
WIDE = 100.0


@dataclass(frozen=True, eq=False)
class Map:
    """The members of an ensemble in cells of two drawn numbers.

    Attributes
    ----------
    x, y
        The names of the numbers.
    x_edges, y_edges
        The ends of the cells along each of them (a + 1,), (b + 1,).
    figure
        `FAILURE`, or the name of a figure.
    members
        By the index of the method, the number of members in each cell (b, a) that were run, or have the figure.
    values
        By the index of the method, the share of the members in each cell (b, a) that failed, or the geometric mean of the
        figure; NaN in cells without members.
    """

    x: str
    y: str
    x_edges: Array
    y_edges: Array
    figure: str
    members: dict[int, NDArray[np.int64]]
    values: dict[int, Array]


def made(ensemble: Ensemble, figure: str, over: tuple[str, str], places: Sequence[int]) -> Map:
    """Return the map of the failures or a figure of some methods.

    Parameters
    ----------
    ensemble
        The ensemble.
    figure
        `FAILURE`, or the name of a figure.
    over
        The names of two drawn numbers, or of lengths of drawn vectors.
    places
        The indices of the methods.
    """
    drawn = numbers(ensemble, len(ensemble.members), over)
    x, y = (drawn[name] for name in over)
    cells = int(np.clip((len(x) / MEMBERS_OF_CELL) ** 0.5, 1, MOST_CELLS))
    x_edges, y_edges = _edges(x, cells), _edges(y, cells)
    cell = _cell(y, y_edges) * cells + _cell(x, x_edges)
    values = None if figure == FAILURE else logarithms(ensemble.column(figure)[list(places)])
    members, means = {}, {}
    for row, index in enumerate(places):
        method_values = np.where(ensemble.supported[index], ensemble.failed[index], np.nan) if values is None else values[row]
        there = np.isfinite(method_values)
        count = np.bincount(cell[there], minlength=cells * cells)
        total = np.bincount(cell[there], method_values[there], minlength=cells * cells)
        with np.errstate(invalid="ignore", divide="ignore"):
            mean = total / count
        members[index] = count.reshape(cells, cells)
        means[index] = (mean if values is None else 10.0**mean).reshape(cells, cells)
    return Map(*over, x_edges, y_edges, figure, members, means)


def _edges(values: Array, cells: int) -> Array:
    """Return the ends of cells of the same width over the range of values, on a log scale where the range is wide."""
    low, high = float(values.min()), float(values.max())
    return np.geomspace(low, high, cells + 1) if 0 < WIDE * low < high else np.linspace(low, high, cells + 1)


def _cell(values: Array, edges: Array) -> NDArray[np.intp]:
    return np.clip(np.searchsorted(edges, values, side="right") - 1, 0, len(edges) - 2)
