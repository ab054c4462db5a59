"""Confidence intervals from the spread of the sequences that members are drawn from.

Member i belongs to sequence i mod 16. The sequences are scrambled independently of each other, so that the 16 shares of members
with some property are independent estimates of its probability, however the points of one sequence depend on each other.
The interval is the one of Student's t distribution with 15 degrees of freedom. Owen, "Practical Quasi-Monte Carlo Integration"
(2023), chapter 17, describes such replications.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtrit

from bodycheck.reference.trajectory import Array
from bodycheck.studies.ensemble.drawing.draws import SEQUENCES

#: The probability with which an interval contains the true value.
CONFIDENCE = 0.95

#: If none of N independent members has a property, its probability is at most this divided by N, with a confidence of 95 %:
#: the "rule of three", as (1 - 3/N)^N is nearly 0.05.
RULE_OF_THREE = 3.0


@dataclass(frozen=True)
class Share:
    """The share of members that have a property: the estimate of a probability, with the ends of its confidence interval."""

    value: float
    low: float
    high: float


def share(having: NDArray[np.bool_], sequence: NDArray[Any]) -> Share:
    """Return the share of members that have a property, with its confidence interval.

    The interval never leaves 0 to 1. If no member has the property, it is 0 to 3/N, and if all have it, 1 - 3/N to 1.

    Parameters
    ----------
    having
        Whether each member has the property (n,), at least one.
    sequence
        The sequence that each member belongs to (n,), from 0 to 15.
    """
    total = np.bincount(sequence, minlength=SEQUENCES)
    count = np.bincount(sequence[having], minlength=SEQUENCES)
    members, having_it = int(total.sum()), int(count.sum())
    extreme = min(1.0, RULE_OF_THREE / members)
    if not having_it:
        return Share(0.0, 0.0, extreme)
    if having_it == members:
        return Share(1.0, 1.0 - extreme, 1.0)
    there = total > 0
    half = _half_width(count[there] / total[there])
    value = having_it / members
    return Share(value, max(0.0, value - half), min(1.0, value + half))


def quantile_interval(values: Array, sequence: NDArray[Any], probability: float) -> tuple[float, float]:
    """Return the confidence interval of a quantile of values.

    The interval of the share of values that do not exceed the quantile is converted to values with the distribution of the
    values: R. S. Woodruff, "Confidence intervals for medians and other position measures", J. Am. Stat. Assoc. 47 (1952).

    Parameters
    ----------
    values
        The values (n,) in any order, at least one, none of them NaN.
    sequence
        The sequence that each value belongs to (n,), from 0 to 15.
    probability
        The probability of the quantile. An end of the interval that would lie beyond all values is the extreme value.
    """
    below = share(values <= quantile(values, probability), sequence)
    low = max(0.0, probability - (below.value - below.low))
    high = min(1.0, probability + (below.high - below.value))
    ends = quantiles(values, [low, high])
    return float(ends[0]), float(ends[1])


def quantile(values: Array, probability: float) -> float:
    """Return the quantile of values (n,) for one probability; see `quantiles`."""
    return float(quantiles(values, [probability])[0])


def quantiles(values: Array, probabilities: Sequence[float]) -> Array:
    """Return quantiles (k,) of values (n,), interpolated between neighbours as NumPy and pandas do by default.

    Next to infinite values, which cannot be interpolated, a quantile is the larger neighbour.
    """
    with np.errstate(invalid="ignore"):
        interpolated = np.quantile(values, probabilities)
    return np.asarray(np.where(np.isnan(interpolated), np.quantile(values, probabilities, method="higher"), interpolated))


def _half_width(shares: Array) -> float:
    """Return half the width of the confidence interval of the mean of independent estimates (k,); 1 for a single one."""
    if len(shares) < 2:
        return 1.0
    t = float(stdtrit(len(shares) - 1, (1 + CONFIDENCE) / 2))
    return t * float(np.std(shares, ddof=1)) / math.sqrt(len(shares))
