"""Datasets of charts in little space: an array of numbers as text, from which the script of the page reads it again.

Numbers are stored as 16-bit integers: evenly between the least and the largest one, or evenly between their logarithms for
errors, which are drawn on logarithmic scales. What is drawn differs by less than a pixel.
"""

import math
from base64 import b64encode
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

#: The datasets whose numbers are stored by their logarithms; zeros, which a logarithmic scale cannot show, become null.
LOGARITHMIC = ("series", "floor")

#: The datasets whose instants stay as they are, because several curves share them.
SHARED_INSTANTS = (*LOGARITHMIC, "times")

#: The fewest numbers of an array that is stored in this way; fewer need as much space as they are.
FEWEST = 8

#: The largest 16-bit integer. Zero stands for null, 1 for the least number, and this for the largest.
LEVELS = 65535

#: The decimals of the least and the largest logarithm, and the significant digits of the least and the largest number. Both are
#: rounded outwards.
DECIMALS, DIGITS = 3, 4


def packed(datasets: Mapping[str, Sequence[Mapping[str, Any]]]) -> dict[str, list[dict[str, Any]]]:
    """Return datasets in which long arrays of numbers are lists of the least number, the largest one, and the codes of all.

    The codes are the base64 text of 16-bit integers (little-endian). In the datasets `LOGARITHMIC`, the least and the largest
    number are decimal logarithms.
    """
    return {
        name: [
            {
                key: value if (key == "t" and name in SHARED_INSTANTS) or not isinstance(value, list) else _stored(value, name)
                for key, value in row.items()
            }
            for row in rows
        ]
        for name, rows in datasets.items()
    }


def _stored(values: list[float | None], name: str) -> list[Any]:
    if len(values) < FEWEST:
        return values
    numbers = np.array([np.nan if value is None else value for value in values], dtype=float)
    if name in LOGARITHMIC:
        numbers = np.log10(numbers, out=np.full_like(numbers, np.nan), where=numbers > 0)
    known = np.isfinite(numbers)
    least, largest = (float(numbers[known].min()), float(numbers[known].max())) if known.any() else (0.0, 0.0)
    least, largest = _outwards(least, largest, name in LOGARITHMIC)
    shares = (numbers - least) / ((largest - least) or 1.0)
    codes = np.where(known, 1 + np.rint(np.where(known, shares, 0.0) * (LEVELS - 1)), 0).astype("<u2")
    return [least, largest, b64encode(codes.tobytes()).decode("ascii")]


def _outwards(least: float, largest: float, log: bool) -> tuple[float, float]:
    """Return the ends of a range after rounding outwards, so that they need few characters."""
    size = max(abs(least), abs(largest))
    decimals = DECIMALS if log or not size else DIGITS - 1 - math.floor(math.log10(size))
    unit = 10.0**-decimals
    return round(math.floor(least / unit) * unit, decimals), round(math.ceil(largest / unit) * unit, decimals)
