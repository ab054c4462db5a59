"""The margins of figures to their expected limits."""

import math
from collections.abc import Iterable
from dataclasses import dataclass

from bodycheck.casefile.expectation import Expectation, Limit
from bodycheck.figures.columns import FIGURES, LIMIT, MARGIN
from bodycheck.judging.discrepancy import Summary


@dataclass(frozen=True)
class Margin:
    """A figure of a run and its expected range.

    Attributes
    ----------
    name
        The column of the figure.
    at_least, at_most
        The ends of the range, in the figure's unit; None for no limit. At least one of them is given.
    measured
        The figure.
    """

    name: str
    at_least: float | None
    at_most: float | None
    measured: float

    @property
    def limit(self) -> float:
        """The largest allowed value; if there is none, the smallest."""
        end = self.at_least if self.at_most is None else self.at_most
        assert end is not None
        return end

    @property
    def factor(self) -> float | None:
        """The limit divided by the measured value; None if the measured value is zero or not finite.

        For a largest allowed value that holds, it is at least 1; for a smallest allowed value that holds, at most 1.
        """
        return self.limit / self.measured if self.measured and math.isfinite(self.measured) else None

    @property
    def range(self) -> Limit:
        """The expected range."""
        return Limit(self.name, self.at_least, self.at_most)

    @property
    def room(self) -> float:
        """The factor by which the figure may change before it leaves its range; below 1 if it is outside the range."""
        above = math.inf if self.at_most is None else _quotient(self.at_most, self.measured)
        below = math.inf if self.at_least is None else _quotient(self.measured, self.at_least)
        return min(above, below)

    def columns(self) -> dict[str, float]:
        """Return the values of the columns of the limit and, if the margin exists, of the margin, by name."""
        columns = {self.name + LIMIT: self.limit}
        return columns if self.factor is None else columns | {self.name + MARGIN: self.factor}


def margins(expectations: Iterable[Expectation], discrepancy: Summary | None) -> tuple[Margin, ...]:
    """Return the margins of a run, in the order of `FIGURES`; if a figure has several limits, the narrowest range counts.

    Parameters
    ----------
    expectations
        The expectations that concern the run. An expected order is not a figure of one run and has no margin.
    discrepancy
        The figures of the run; None for a run that is not ok, which has no margins.
    """
    if discrepancy is None:
        return ()
    limits = [limit for expectation in expectations for limit in expectation.limits]
    limited = {limit.name for limit in limits}
    margins = []
    for name in (name for name in FIGURES if name in limited and name in discrepancy.largest):
        least = [limit.at_least for limit in limits if limit.name == name and limit.at_least is not None]
        most = [limit.at_most for limit in limits if limit.name == name and limit.at_most is not None]
        if least or most:
            margins.append(Margin(name, max(least, default=None), min(most, default=None), discrepancy.largest[name]))
    return tuple(margins)


def _quotient(above: float, below: float) -> float:
    return above / below if below else math.inf
