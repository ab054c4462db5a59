"""The rows of the tables of an ensemble."""

from dataclasses import dataclass
from typing import Annotated

from bodycheck.figures.columns import FIGURES
from bodycheck.results.tables import RUN, Meaning, table_of

#: The probabilities of the quantiles, by the names of their columns.
QUANTILES = {"q05": 0.05, "q50": 0.5, "q95": 0.95, "q99": 0.99}

#: The meaning of their columns.
QUANTILE = "quantile over the members, in the unit of the figure; empty if no member has it"


@dataclass(frozen=True)
class Row:
    """The distribution of one figure of one method over the members of an ensemble.

    A member has failed if its status is not ok, or if it breaks an expectation of the case.
    """

    case: str
    engine: str
    version: str
    integrator: str
    timestep: float
    members: Annotated[
        int,
        Meaning(
            "Members",
            "number of members that were run with the method, without those that its engine does not support",
            counts="members",
        ),
    ]
    failed: Annotated[float, Meaning("Failed", "share of these members that failed")]
    failed_low: Annotated[float, Meaning("Failed, low", "lower end of the 95 % confidence interval of that share")]
    failed_high: Annotated[float, Meaning("Failed, high", "upper end of the 95 % confidence interval of that share")]
    figure: Annotated[
        str, Meaning("Figure", "name of the figure of results; empty if no member has any", words=frozenset(FIGURES))
    ] = ""
    q05: Annotated[float | None, Meaning("5 % quantile", QUANTILE)] = None
    q50: Annotated[float | None, Meaning("Median", QUANTILE)] = None
    q95: Annotated[float | None, Meaning("95 % quantile", QUANTILE)] = None
    q99: Annotated[float | None, Meaning("99 % quantile", QUANTILE)] = None
    max: Annotated[float | None, Meaning("Largest", "largest value over the members, in the unit of the figure")] = None
    worst_member: Annotated[
        int | None,
        Meaning("Worst member", "member with the largest value, the first of equal ones, counted from 0", counts="place"),
    ] = None


@dataclass(frozen=True)
class DependenceRow:
    """The dependence of one figure of one method on one of the drawn numbers."""

    case: str
    engine: str
    version: str
    integrator: str
    timestep: float
    figure: Annotated[str, Meaning("Figure", 'name of the figure, or "failure": 1 for members that failed and 0 for others')]
    number: Annotated[str, Meaning("Number", "path of the drawn number in the case file; `|KEY|` is the length of a vector")]
    rank_correlation: Annotated[
        float, Meaning("Rank correlation", "Spearman's rank correlation of the two, from -1 to 1", signed=True)
    ]
    share: Annotated[
        float,
        Meaning(
            "Share",
            "share of the variance of the logarithm of the figure that the number explains by itself, from 0 to 1",
            signed=True,
        ),
    ]


ROWS = table_of(
    Row,
    "ensemble",
    "ensembles",
    key=(*RUN, "figure"),
    filled=("case", "engine", "version", "integrator", "timestep", "members", "failed", "failed_low", "failed_high"),
)
DEPENDENCES = table_of(DependenceRow, "sensitivity", "dependence of figures on drawn numbers", key=(*RUN, "figure", "number"))

#: The tables of the study, the main one first.
TABLES = (ROWS, DEPENDENCES)
