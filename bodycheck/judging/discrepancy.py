"""Compute the errors of a run: all figures of `bodycheck.figures` that apply to the scene and were measured."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field

import numpy as np

from bodycheck.figures.columns import BEFORE_DEPARTURE, DEPARTURE, FIGURES
from bodycheck.figures.definition import Comparison
from bodycheck.figures.sensors import errors_of
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truths import Truth
from bodycheck.results.outcome import Completed, Run


@dataclass(frozen=True)
class Summary:
    """The figures of a run without the series over time.

    Attributes
    ----------
    largest
        The largest value of every series, and the figures that are single numbers, by their names.
    instants
        The instant (s) at which each series first reaches its largest value, by the name of its column.
    before
        The columns about the time before the departure of a robot from its file; empty if there is none.
    sensors
        As in `Discrepancy`.
    """

    largest: Mapping[str, float]
    instants: Mapping[str, float]
    before: Mapping[str, float] = field(default_factory=dict)
    sensors: Mapping[str, float] = field(default_factory=dict)

    def maxima(self) -> dict[str, float]:
        """Return the largest value of every series, and the figures that are single numbers, by their names."""
        return dict(self.largest)


@dataclass(frozen=True, eq=False)
class Discrepancy:
    """The figures of a run, by the names of their columns.

    Attributes
    ----------
    t
        The n instants of the run (n,), s.
    series
        Figures with a value at each instant (n,), never negative, in the units of their columns. A value is NaN at instants at
        which mechanics does not determine the motion; a figure with only such values is left out.
    figures
        Figures that are single numbers.
    sensors
        The errors of sensors in their own units, by their names; a wrench has those of its force and its moment.
    """

    t: Array
    series: Mapping[str, Array]
    figures: Mapping[str, float]
    sensors: Mapping[str, float] = field(default_factory=dict)

    def maxima(self) -> dict[str, float]:
        """Return the largest value of every series, and the figures that are single numbers, by their names."""
        return {name: float(np.nanmax(values)) for name, values in self.series.items()} | dict(self.figures)

    def summary(self, departure: float | None = None) -> Summary:
        """Return the summary of the figures, whose size does not depend on the number of instants.

        departure: the last instant (s) at which neither limits nor contacts of a robot's file have acted; None if they do not.
        """
        instants = {name: float(self.t[int(np.nanargmax(values))]) for name, values in self.series.items()}
        return Summary(self.maxima(), instants, {} if departure is None else self._before(departure), self.sensors)

    def _before(self, departure: float) -> dict[str, float]:
        """Return the columns about the time up to a departure (s). Without an instant after the start, there are no errors."""
        rows = self.t <= departure
        errors = {
            column: float(np.nanmax(self.series[name][rows]))
            for name, column in BEFORE_DEPARTURE.items()
            if name in self.series and rows[1:].any() and not np.isnan(self.series[name][rows]).all()
        }
        return {DEPARTURE: departure, **errors}


def compare(truth: Truth, run: Run, names: Collection[str] = FIGURES) -> Discrepancy:
    """Return the errors of a completed run against the truth of its case at the same instants: the figures with these names.

    This integrates nothing; `bodycheck.judging.comparison.compare` also accepts a truth at other instants. Raises `ValueError`
    if the run has no trajectory, or the truth is not at the instants of the run.
    """
    if not isinstance(run.outcome, Completed):
        raise ValueError(f"the run has no trajectory to compare, its status is {run.outcome.status}: {run.outcome.reason}")
    done, trajectory = run.outcome, run.outcome.trajectory
    if not np.array_equal(truth.trajectory.t, trajectory.t):
        raise ValueError("the truth is not at the instants of the run; `Truth.at` computes it there")
    measured = (done.load, done.quaternion_norm_error, done.interfaces, run.sensors, done.sensed)
    compared = Comparison(truth, trajectory, *measured)
    series: dict[str, Array] = {}
    figures: dict[str, float] = {}
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):  # errors too large for a number are infinite
        for name in names:
            figure = FIGURES[name]
            value = figure.compute(compared)
            if isinstance(value, np.ndarray):
                if figure.jumps and compared.between_events is not None:
                    value = np.where(compared.between_events, value, np.nan)
                if not np.isnan(value).all():
                    series[name] = value
            elif value is not None:
                figures[name] = value
        sensors = {each.name: each.error for each in errors_of(compared) if each.error is not None}
    return Discrepancy(trajectory.t, series, figures, sensors)
