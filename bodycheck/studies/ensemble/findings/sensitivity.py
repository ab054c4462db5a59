"""The dependence of a figure on the drawn numbers, by two measures for each number.

Spearman's rank correlation says whether a figure rises or falls with a number. The first-order share of the variance says how
much of the variance of the logarithm of a figure the number explains by itself, in whatever way the figure depends on it.
Members are divided into bins of the number, and the variance of the means of the bins is compared with the variance of all.
This is the first-order index of Sobol, estimated by the correlation ratio. The share that bins of few members explain by chance
is subtracted (the epsilon squared of Kelley, "An unbiased correlation ratio measure", Proc. Natl. Acad. Sci. 21 (1935)).
"""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import rankdata

from bodycheck.reference.trajectory import Array
from bodycheck.studies.ensemble.findings.stored import Ensemble

#: The number of members that are examined. More would change no digit that is shown; the first are spread as evenly as all.
MOST_MEMBERS = 1 << 17

#: The fewest members of a bin, and the most bins.
LEAST_OF_BIN, MOST_BINS = 25, 32

#: The fewest failed members, and the fewest members that have not failed, with which the dependence on a number is computed.
LEAST_FAILED = 5

#: The name under which the failures of a method are treated like a figure: 1 for a member that failed and 0 for others.
FAILURE = "failure"

#: The smallest share of the variance that is more than chance.
RELEVANT = 0.02

#: The relative spread below which numbers count as constant, such as the lengths of vectors on a sphere: far above rounding.
CONSTANT = 1e-9


@dataclass(frozen=True)
class Dependence:
    """The dependence of a method's figure on a drawn number.

    Attributes
    ----------
    method
        The index of the method.
    figure
        The name of the figure, or `FAILURE`.
    number
        The name of the number; `|KEY|` is the length of a drawn vector.
    rank_correlation
        Spearman's rank correlation, from -1 to 1.
    share
        The first-order share of the variance, from 0 to 1.
    """

    method: int
    figure: str
    number: str
    rank_correlation: float
    share: float


def numbers(ensemble: Ensemble, most: int = MOST_MEMBERS, only: Collection[str] = ()) -> dict[str, Array]:
    """Return the drawn numbers of the first members by name, and the lengths of drawn vectors, without constant ones.

    Parameters
    ----------
    ensemble
        The ensemble.
    most
        The number of members.
    only
        The names of the numbers that are wanted; all if it is empty. The length of a vector is named `|KEY|`; quaternions have
        none.
    """
    vectors: dict[str, list[str]] = {}
    for name in ensemble.drawn:
        key, _, last = name.rpartition(".")
        if last.isdecimal() and not key.endswith("quaternion"):
            vectors.setdefault(f"|{key}|", []).append(name)
    sources = {name: [name] for name in ensemble.drawn} | {
        name: components_of for name, components_of in vectors.items() if len(components_of) > 1
    }
    drawn = {}
    for name, components_of in sources.items():
        if only and name not in only:
            continue
        components = [ensemble.values(one)[:most].copy() for one in components_of]
        values = _length(components) if name in vectors else components[0]
        if _varies(values):
            drawn[name] = values
    return drawn


def dependences(ensemble: Ensemble, drawn: Mapping[str, Array], figures: tuple[str, ...]) -> list[Dependence]:
    """Return the dependences of figures of all methods on numbers, and those of `FAILURE` if enough members failed.

    Parameters
    ----------
    ensemble
        The ensemble.
    drawn
        Numbers by name, each of the same first members (k,).
    figures
        The names of the figures.
    """
    if not drawn:
        return []
    members = len(next(iter(drawn.values())))
    ranks = {name: rankdata(values) for name, values in drawn.items()}
    figure_dependences: list[Dependence] = []
    for index in range(len(ensemble.methods)):
        failed, was_run = ensemble.failed[index, :members], ensemble.supported[index, :members]
        if LEAST_FAILED <= np.count_nonzero(failed) <= np.count_nonzero(was_run) - LEAST_FAILED:
            figure_dependences += _dependences(index, FAILURE, np.where(was_run, failed, np.nan), ranks)
    for figure in figures:
        values = logarithms(ensemble.column(figure)[:, :members])
        for index, method_values in enumerate(values):
            figure_dependences += _dependences(index, figure, method_values, ranks)
    return figure_dependences


def logarithms(values: Array) -> Array:
    """Return the decimal logarithms of figures (m, n) that are not negative; NaN where a figure is missing or infinite.

    A zero counts as the smallest positive value of its row.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        logs = np.log10(values)
    least = np.min(np.where(np.isfinite(logs), logs, np.inf), axis=-1, keepdims=True)
    logs = np.where(values == 0, least, logs)
    return np.where(np.isfinite(logs), logs, np.nan)


def strongest(all_dependences: Sequence[Dependence], most: int = 2) -> list[str]:
    """Return the names of the numbers with the largest share of the variance, summed over methods and figures.

    A component of a vector and the length of the vector, which are closely related, are not returned together.
    """
    shares: dict[str, float] = {}
    for one in all_dependences:
        shares[one.number] = shares.get(one.number, 0.0) + one.share
    chosen: list[str] = []
    for name in sorted(shares, key=lambda name: -shares[name]):
        if len(chosen) < most and not any(_is_length_of(one, name) or _is_length_of(name, one) for one in chosen):
            chosen.append(name)
    return chosen


def _is_length_of(name: str, component: str) -> bool:
    """Return whether a number is the length of the vector that another one is a component of."""
    return name == f"|{component.rpartition('.')[0]}|"


def first_order(ranks: Array, values: Array) -> float:
    """Return the share of the variance of values (n,) that a number explains by itself, given the ranks of the number (n,)."""
    total = len(values)
    bins = int(np.clip(total // LEAST_OF_BIN, 1, MOST_BINS))
    where = binned(ranks, bins)
    counts = np.bincount(where, minlength=bins)
    used = int(np.count_nonzero(counts))
    centred = values - values.mean()
    whole = float(np.sum(centred * centred))
    if used < 2 or total <= used or not whole > 0:
        return 0.0
    sums = np.bincount(where, centred, bins)
    between = float(np.sum(sums**2 / np.maximum(counts, 1)))
    return max(0.0, 1 - (1 - between / whole) * (total - 1) / (total - used))


def binned(ranks: Array, bins: int) -> NDArray[np.int64]:
    """Return the bin of each of n members, from 0 on, by their ranks (n,); equal values are in the same bin."""
    return np.minimum((ranks - 0.5) * bins // len(ranks), bins - 1).astype(np.int64)


def _dependences(index: int, figure: str, values: Array, ranks: Mapping[str, Array]) -> list[Dependence]:
    there = np.isfinite(values)
    having = values[there]
    if np.count_nonzero(there) < 2 * LEAST_OF_BIN or not _varies(having):
        return []
    own_ranks = rankdata(having)
    figure_dependences = []
    for name, whole in ranks.items():
        number_ranks = whole if there.all() else rankdata(whole[there])
        figure_dependences.append(
            Dependence(index, figure, name, _correlation(number_ranks, own_ranks), first_order(number_ranks, having))
        )
    return figure_dependences


def _correlation(one: Array, other: Array) -> float:
    """Return Pearson's correlation of two rows (n,), 0 if one of them is constant."""
    a, b = one - one.mean(), other - other.mean()
    size = math.sqrt(float(np.sum(a * a)) * float(np.sum(b * b)))  # no BLAS, whose threads wait for each other
    return float(np.sum(a * b)) / size if size > 0 else 0.0


def _length(components: list[Array]) -> Array:
    squares = np.zeros(len(components[0]))
    for values in components:
        squares += values**2
    return np.asarray(np.sqrt(squares))


def _varies(values: Array) -> bool:
    finite = values[np.isfinite(values)]
    return bool(finite.size) and float(np.ptp(finite)) > CONSTANT * float(np.abs(finite).max())
