"""The rows of the table of an ensemble, ensemble.csv."""

from dataclasses import dataclass

#: The probabilities of the quantiles, by the names of their columns.
QUANTILES = {"q05": 0.05, "q50": 0.5, "q95": 0.95, "q99": 0.99}


@dataclass(frozen=True)
class Row:
    """The distribution of one figure of one method over the members of an ensemble.

    Attributes
    ----------
    case, engine, version, integrator, timestep
        The case and the method; the time step is in s.
    members
        The number of members that were run with the method; those that its engine does not support are not counted.
    failed, failed_low, failed_high
        The share of these members that failed, and the ends of its 95 % confidence interval. A member has failed if its status
        is not ok, or if it breaks an expectation of the case.
    figure
        The name of the figure; empty where no member has any.
    q05, q50, q95, q99, max
        Quantiles and the largest value over the members that have the figure, in its unit; None where no member has it.
    worst_member
        The member with the largest value, the first of equal ones.
    """

    case: str
    engine: str
    version: str
    integrator: str
    timestep: float
    members: int
    failed: float
    failed_low: float
    failed_high: float
    figure: str = ""
    q05: float | None = None
    q50: float | None = None
    q95: float | None = None
    q99: float | None = None
    max: float | None = None
    worst_member: int | None = None


@dataclass(frozen=True)
class DependenceRow:
    """The dependence of a method's figure on one of the drawn numbers: a row of sensitivity.csv.

    Attributes
    ----------
    case, engine, version, integrator, timestep
        The case and the method; the time step is in s.
    figure
        The name of the figure, or "failure": 1 for members that failed and 0 for others.
    number
        The path of the drawn number in the case file; `|KEY|` is the length of a vector.
    rank_correlation
        Spearman's rank correlation of the two, from -1 to 1.
    share
        The share of the variance of the logarithm of the figure that the number explains by itself, from 0 to 1.
    """

    case: str
    engine: str
    version: str
    integrator: str
    timestep: float
    figure: str
    number: str
    rank_correlation: float
    share: float
