"""How bad the value of a figure is, for many members at once."""

import numpy as np

from bodycheck.figures.columns import FIGURES
from bodycheck.reference.trajectory import Array


def distances(name: str, values: Array) -> Array:
    """Return how far values (n,) of a figure are from the value of a run without any error, in the figure's unit.

    That is the value itself where the ideal value is 0, as in `figures.columns.distance_from_ideal`. NaN, where the figure was
    not measured, stays NaN.
    """
    ideal = FIGURES[name].ideal
    return np.abs(values - ideal) if ideal else values
