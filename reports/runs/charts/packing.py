"""Datasets of charts in little space: an array of numbers as text, from which the script of the page reads it again.

Numbers are stored as 16-bit integers: evenly between the least and the largest one, or evenly between their logarithms for
errors, which are drawn on logarithmic scales. What is drawn differs by less than a pixel.
"""

from base64 import b64encode
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

#: The datasets whose numbers are stored by their logarithms; zeros, which a logarithmic scale cannot show, become null.
LOGARITHMIC = ("series", "floor")

#: The fewest numbers of an array that is stored in this way; fewer need as much space as they are.
FEWEST = 8

#: The largest 16-bit integer. Zero stands for null, 1 for the least number, and this for the largest.
LEVELS = 65535


def packed(datasets: Mapping[str, Sequence[Mapping[str, Any]]]) -> dict[str, list[dict[str, Any]]]:
    """Return datasets in which long arrays of numbers are stored as objects with `least`, `largest`, `log` and `codes`.

    `codes` is the base64 text of 16-bit integers (little-endian), and `log` says whether these are even in the logarithm.
    Instants, which all curves of a dataset can share, stay as they are.
    """
    return {
        name: [
            {
                key: _stored(value, name in LOGARITHMIC) if isinstance(value, list) and key != "t" else value
                for key, value in row.items()
            }
            for row in rows
        ]
        for name, rows in datasets.items()
    }


def _stored(values: list[float | None], log: bool) -> Any:
    if len(values) < FEWEST:
        return values
    numbers = np.array([np.nan if value is None else value for value in values], dtype=float)
    if log:
        numbers = np.log10(numbers, out=np.full_like(numbers, np.nan), where=numbers > 0)
    known = np.isfinite(numbers)
    least, largest = (float(numbers[known].min()), float(numbers[known].max())) if known.any() else (0.0, 0.0)
    shares = (numbers - least) / ((largest - least) or 1.0)
    codes = np.where(known, 1 + np.rint(np.where(known, shares, 0.0) * (LEVELS - 1)), 0).astype("<u2")
    return {"least": least, "largest": largest, "log": log, "codes": b64encode(codes.tobytes()).decode("ascii")}
