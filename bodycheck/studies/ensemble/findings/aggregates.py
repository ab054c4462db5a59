"""Aggregates for the tables and the report of an ensemble: counts, quantiles, histograms and tails of each method.

Their size does not depend on the number of members. One column of all runs is in memory at a time.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bodycheck.figures.columns import FIGURES
from bodycheck.reference.trajectory import Array
from bodycheck.studies.ensemble.findings.intervals import Share, quantile_interval, quantiles, share
from bodycheck.studies.ensemble.findings.stored import OK, UNSUPPORTED, EngineMethod, Ensemble, Flags
from bodycheck.studies.ensemble.rows import QUANTILES, Row

#: The figures that may rank methods. The first of them in which a run has more than the truth's own error is used.
RANKING = ("attitude_error", "position_error", "stop_position_error", "energy_drift", "energy_error")

#: The most bins of a histogram, and the most points of a tail.
BINS, POINTS = 48, 60

#: The probabilities of the quantiles that have a confidence interval.
WITH_INTERVALS = ("q50", "q99")

#: The name of the way of failing of a run that completed but breaks an expectation.
BROKEN = "breaks an expectation"


@dataclass(frozen=True)
class Way:
    """A way in which members failed with a method.

    Attributes
    ----------
    name
        The status, or `BROKEN` for runs that completed but break an expectation.
    count
        The number of members.
    first
        The first of these members.
    reason
        The reason why the first member failed.
    """

    name: str
    count: int
    first: int
    reason: str


@dataclass(frozen=True)
class Method:
    """The outcomes of the runs of a method.

    Attributes
    ----------
    engine_method
        The method.
    members
        The number of members that were run, without those that the engine does not support.
    unsupported
        The reason why the engine does not support other members; empty if it supports all.
    failed
        The share of the members that failed. None if no member was run.
    ways
        The ways in which members failed, the most frequent way first.
    wall_time
        The sum of the measured times of all runs (s).
    """

    engine_method: EngineMethod
    members: int
    unsupported: str
    failed: Share | None
    ways: tuple[Way, ...]
    wall_time: float


@dataclass(frozen=True, eq=False)
class Distribution:
    """The distribution of one figure of one method.

    Attributes
    ----------
    method
        The index of the method.
    figure
        The name of the figure.
    count
        The number of members that have the figure.
    quantiles
        Quantiles by the names of their columns.
    intervals
        Confidence intervals of some of them.
    largest, worst
        The largest value, and the member with it.
    zeros
        The number of members with the value zero, which log scales cannot show.
    histogram
        The number of members in each bin of `Figure.edges` (b,).
    tail
        Values (k,) in ascending order, and for each value the share (k,) of the members that were run whose figure is at least
        as large, or that failed without a figure.
    """

    method: int
    figure: str
    count: int
    quantiles: dict[str, float]
    intervals: dict[str, tuple[float, float]]
    largest: float
    worst: int
    zeros: int
    histogram: NDArray[np.int64]
    tail: tuple[Array, Array]


@dataclass(frozen=True, eq=False)
class Figure:
    """The distributions of a figure of all methods that have it.

    Attributes
    ----------
    name
        The name of the figure.
    edges
        The ends of the bins of the histograms (b + 1,); empty if no method has a value other than zero.
    distributions
        The distributions by the indices of the methods.
    best
        By the indices of the methods, the share of the members in which the method has the smallest value of all methods.
        Methods with equal values share a member. Empty if there is one method.
    truth
        The median and the largest bound of the truth's own error in the figure; None where it is not known.
    """

    name: str
    edges: Array
    distributions: dict[int, Distribution]
    best: dict[int, float]
    truth: tuple[float, float] | None


@dataclass(frozen=True, eq=False)
class Aggregates:
    """Counts, distributions and the ranking of methods for an ensemble of one case.

    Attributes
    ----------
    case
        The name of the case.
    members
        The number of members.
    methods
        The methods.
    figures
        The figures by name.
    ranking
        The name of the figure that methods are ranked by; empty if there is none.
    """

    case: str
    members: int
    methods: tuple[Method, ...]
    figures: dict[str, Figure]
    ranking: str

    @property
    def ranked(self) -> list[int]:
        """The indices of the methods that were run, the best first: fewest failures, then the smallest 99 % quantile."""
        figure = self.figures.get(self.ranking)

        def badness(index: int) -> tuple[float, float]:
            failed, distribution = self.methods[index].failed, figure.distributions.get(index) if figure else None
            return (failed.value if failed else 1.0, distribution.quantiles["q99"] if distribution else np.inf)

        return sorted((index for index, method in enumerate(self.methods) if method.members), key=badness)

    def rows(self) -> list[Row]:
        """Return the rows of ensemble.csv: method by method, and its figures in the order of results."""
        rows = []
        for index, method in enumerate(self.methods):
            if method.members:
                names = [name for name, figure in self.figures.items() if index in figure.distributions]
                rows += [self.row(index, name) for name in names or ("",)]
        return rows

    def row(self, index: int, name: str) -> Row:
        """Return the row of a method that was run and a figure; without the numbers of a figure if the method lacks it."""
        method, figure = self.methods[index], self.figures.get(name)
        assert method.failed is not None  # it has members
        shares = (method.failed.value, method.failed.low, method.failed.high)
        alone = Row(self.case, *_names(method.engine_method), method.members, *shares)
        distribution = figure.distributions.get(index) if figure is not None else None
        if distribution is None:
            return alone
        more: dict[str, Any] = {
            "figure": name,
            **distribution.quantiles,
            "max": distribution.largest,
            "worst_member": distribution.worst,
        }
        return replace(alone, **more)


def aggregate(ensemble: Ensemble) -> Aggregates:
    """Return the aggregates of an ensemble."""
    times = _wall_times(ensemble)
    methods = tuple(_method(ensemble, index, times[index]) for index in range(len(ensemble.methods)))
    names = [name for name in FIGURES if name in ensemble.figures and not FIGURES[name].of_truth]
    figures = {name: figure for name in names if (figure := _figure(ensemble, name)).distributions}
    named = [name for name in RANKING if name in figures]
    known = [name for name in named if _is_measured(figures[name])] or named or [*figures]
    return Aggregates(ensemble.case, len(ensemble.members), methods, figures, known[0] if known else "")


def _is_measured(figure: Figure) -> bool:
    """Return whether a figure has a value above the truth's own error, so that it is more than rounding."""
    return max(distribution.largest for distribution in figure.distributions.values()) > (
        figure.truth[1] if figure.truth is not None else 0.0
    )


def _names(by: EngineMethod) -> tuple[str, str, str, float]:
    return by.engine, by.version, by.integrator, by.timestep


def _wall_times(ensemble: Ensemble) -> list[float]:
    if "wall_time" not in ensemble.figures:
        return [0.0] * len(ensemble.methods)
    return [float(np.nansum(row)) for row in ensemble.column("wall_time")]


def _method(ensemble: Ensemble, index: int, wall_time: float) -> Method:
    supported = ensemble.supported[index]
    places = {way: np.flatnonzero(here) for way, here in _ways(ensemble, index).items() if here.any()}
    reasons = ensemble.reasons(index, [int(members_of_way[0]) for members_of_way in places.values()])
    why = {way: reasons.get(int(members_of_way[0]), "") for way, members_of_way in places.items()}
    ways = [
        Way(way, len(members_of_way), int(ensemble.members[members_of_way[0]]), why[way])
        for way, members_of_way in places.items()
        if way != UNSUPPORTED
    ]
    return Method(
        engine_method=ensemble.methods[index],
        members=int(np.count_nonzero(supported)),
        unsupported=why.get(UNSUPPORTED, ""),
        failed=share(ensemble.failed[index][supported], ensemble.sequence[supported]) if supported.any() else None,
        ways=tuple(sorted(ways, key=lambda way: -way.count)),
        wall_time=wall_time,
    )


def _ways(ensemble: Ensemble, index: int) -> dict[str, Flags]:
    """Return flags (n,) of the members that failed with a method in each way, by the name of the way, or are `UNSUPPORTED`."""
    by_status = {status: ensemble.status[index] == code for code, status in enumerate(ensemble.statuses)}
    ok = by_status.pop(OK, np.zeros(len(ensemble.members), np.bool_))
    return {**by_status, BROKEN: ok & ensemble.broken[index]}


def _figure(ensemble: Ensemble, name: str) -> Figure:
    values = ensemble.column(name)
    edges = _edges(values)
    there = ~np.isnan(values)
    distributions = {
        index: _distribution(ensemble, index, name, values[index], edges)
        for index in np.flatnonzero(there.any(axis=1)).tolist()
    }
    best = _best(values, [*distributions]) if len(distributions) > 1 else {}
    bounded = FIGURES[name].bounded_by
    return Figure(name, edges, distributions, best, _bound(ensemble, bounded) if bounded in ensemble.figures else None)


def _bound(ensemble: Ensemble, name: str) -> tuple[float, float] | None:
    """Return the median and the largest of the bounds of the truth's own error."""
    values = ensemble.column(name)
    known = values[~np.isnan(values)]
    if not known.size:
        return None
    return float(quantiles(known, [0.5])[0]), float(known.max())


def _distribution(ensemble: Ensemble, index: int, name: str, column: Array, edges: Array) -> Distribution:
    """Return the distribution of a method's figure, whose values (n,) are NaN for members that do not have it."""
    there = ~np.isnan(column)
    values, members = column[there], ensemble.members[there]
    method_quantiles = dict(zip(QUANTILES, quantiles(values, [*QUANTILES.values()]).tolist(), strict=True))
    sequence = ensemble.sequence[there]
    positive = np.log10(values[np.isfinite(values) & (values > 0)])
    return Distribution(
        method=index,
        figure=name,
        count=len(values),
        quantiles=method_quantiles,
        intervals={one: quantile_interval(values, sequence, QUANTILES[one]) for one in WITH_INTERVALS},
        largest=float(values.max()),
        worst=int(members[np.argmax(values)]),
        zeros=int(np.count_nonzero(values == 0)),
        histogram=np.histogram(positive, np.log10(edges))[0] if edges.size else np.zeros(0, np.int64),
        tail=_tail(
            values, int(np.count_nonzero(ensemble.supported[index])), int(np.count_nonzero(ensemble.failed[index] & ~there))
        ),
    )


def _tail(values: Array, members: int, without: int) -> tuple[Array, Array]:
    """Return values in ascending order, and the share of the members with a value at least as large, or without a value.

    The points are closest together in the tail: each of the largest values is a point, and ever fewer of the other values.
    members: the number of all members. without: the number of members without a value.
    """
    ordered = np.sort(values)[::-1]
    spread = np.concatenate([np.geomspace(1, len(ordered), POINTS), np.linspace(1, len(ordered), POINTS // 4)])
    ranks = np.unique(spread.round().astype(np.intp))[::-1]
    return ordered[ranks - 1], (ranks + without) / members


def _edges(values: Array) -> Array:
    """Return the ends of bins of the same width on a log scale, from the smallest positive value to the largest."""
    positive = values[np.isfinite(values) & (values > 0)]
    if not positive.size:
        return np.empty(0)
    low, high = float(positive.min()), float(positive.max())
    edges = np.geomspace(low, high, BINS + 1) if low < high else np.array([low / 2, low * 2])
    edges[0], edges[-1] = min(edges[0], low), max(edges[-1], high)  # the rounding of powers leaves no value outside
    return edges


def _best(values: Array, places: Sequence[int]) -> dict[int, float]:
    """Return, for each method, the share of members for which its value (m, n) is the smallest of all methods.

    Members without a value of any method are not counted.
    """
    method_values = np.where(np.isnan(values[places]), np.inf, values[places])
    smallest = method_values.min(axis=0)
    counted = np.isfinite(smallest)
    if not counted.any():
        return {}
    won = (method_values == smallest) & counted
    shares = (won / np.maximum(won.sum(axis=0), 1)).sum(axis=1) / np.count_nonzero(counted)
    return dict(zip(places, shares.tolist(), strict=True))
