"""The columns of the tables of submissions: their titles, units and meanings, for readers and for programs."""

from collections.abc import Mapping

from bodycheck.figures.columns import COLUMNS, FIGURES
from bodycheck.figures.definition import Column
from bodycheck.site.submissions.tables import TABLES
from bodycheck.studies.releases.rows import ALLOWANCE_SUFFIX
from bodycheck.studies.tradeoff.columns import BATCHES, COSTS


def _number(name: str, title: str, meaning: str, unit: str = "", counts: str = "") -> Column:
    return Column(name, "number", title, meaning, unit, counts)


def _text(name: str, title: str, meaning: str) -> Column:
    return Column(name, "string", title, meaning)


#: Columns that have these names in any table of a study.
_SHARED = (
    _text("scene", "Scene", "name of the case"),
    _text("quantity", "Quantity", "what the numbers of the row are of"),
    _text("figure", "Figure", "name of the figure of results; empty where the run did not complete"),
    _number("value", "Value", "its value, in the unit that the row names"),
    _text("unit", "Unit", "unit of the values of the row"),
)

#: The further columns of each table.
_OWN: Mapping[str, tuple[Column, ...]] = {
    "attribution.csv": (
        _number("total", "Total", "error of the quantity, engine minus truth, in s, m or rad"),
        _number("model_form", "Model form", "part of the error from another law of friction; empty where none is known"),
        _number("constraint", "Constraint", "part that remains for vanishing time steps under the engine's own law"),
        _number("time_step", "Time step", "part that vanishes with the time step; empty for a method with one time step"),
    ),
    "tradeoff.csv": (*COSTS, *BATCHES),
    "orders.csv": (
        _number("order", "Order", "observed order of convergence; empty where no asymptotic range was found"),
        _number("order_low", "Order, low", "least order over the time steps in the asymptotic range"),
        _number("order_high", "Order, high", "largest order over the time steps in the asymptotic range"),
        _number("floor", "Floor", "error below which no time step gets, in rad, m or relative; empty where it was not reached"),
        _text("floor_cause", "Cause of the floor", "limit, if small steps tend to a motion that is not the truth, or rounding"),
        _number("horizon", "Horizon", "time in which order and floor were observed; empty for the whole run", "s"),
        _number("claimed", "Claimed order", "order that the method claims; empty if it claims none"),
        _text("scheme", "Scheme", "textbook scheme whose trajectory equals that of the engine"),
        _text("nearest_scheme", "Nearest scheme", "that scheme, or else one that leaves at most a hundredth of the error"),
        _number("scheme_residual", "Residual of the scheme", "largest attitude difference from the nearest scheme", "rad"),
    ),
    "changes.csv": (
        _text("from_version", "From", "earlier version"),
        _text("to_version", "To", "next version that could be measured"),
        _text("before", "Before", "value or status in the earlier version, in the unit of the quantity"),
        _text("after", "After", "value or status in the later version, in the unit of the quantity"),
        _number("factor", "Factor", "ratio of the larger error to the smaller one; empty for a status", counts="times"),
        _number("order_before", "Order before", "observed order of convergence in the earlier version"),
        _number("order_after", "Order after", "observed order of convergence in the later version"),
        _text("scheme_before", "Scheme before", "textbook scheme of the earlier version; empty if none is named"),
        _text("scheme_after", "Scheme after", "textbook scheme of the later version; empty if none is named"),
        _number("allowance", "Allowance", "difference that is allowed if nothing has changed, in the unit of the quantity"),
    ),
    "contact.csv": (
        _text("setting", "Setting", "defaults, for what the engine does by itself, or best, for the smallest value found"),
        _number("truth", "Truth", "what the figure is about in mechanics, such as the instant of an impact, in the row's unit"),
        _number("truth_error", "Bound", "bound of the error of the truth, in the row's unit"),
    ),
    "parity.csv": (
        _text("model", "Model", "file of the robot"),
        _text("status", "Status", "what came of the comparison with the file"),
        _text("subject", "Subject", "body or joint; model for the whole"),
        _text("engine_value", "Engine", "numbers or words of the engine, at the state with the largest difference"),
        _text("truth_value", "File", "numbers or words of the file, at the same state"),
        _number("difference", "Difference", "largest difference of a component, in the unit of the quantity"),
        _number("relative", "Relative difference", "difference relative to the size of the quantity"),
        _text("cause", "Cause", "why it differs; empty where it does not"),
    ),
    "audit.csv": (
        _text("property", "Property", "what the probe looks for that mechanics does not have"),
        _text("status", "Status", "default and deviates are findings; none, for as mechanics has it; not-probed, for unknown"),
        _number("attitude_error", "Attitude error", "largest attitude error of the method in intermediate-axis-flip", "rad"),
        _text("expected", "Expected", "value of an engine that computes mechanics alone"),
        _text("probe", "Probe", "probe that gave the answer, with what it saw or why it could not tell"),
    ),
    "ensemble.csv": (
        _number("members", "Members", "number of members that were run with the method", counts="members"),
        _number("failed", "Failed", "share of these members that failed"),
        _number("failed_low", "Failed, low", "lower end of the 95 % confidence interval of that share"),
        _number("failed_high", "Failed, high", "upper end of the 95 % confidence interval of that share"),
        _number("q05", "5 % quantile", "quantile over the members, in the unit of the figure"),
        _number("q50", "Median", "quantile over the members, in the unit of the figure"),
        _number("q95", "95 % quantile", "quantile over the members, in the unit of the figure"),
        _number("q99", "99 % quantile", "quantile over the members, in the unit of the figure"),
        _number("max", "Largest", "largest value over the members, in the unit of the figure"),
        _number("worst_member", "Worst member", "member with the largest value, counted from 0", counts="place"),
    ),
}

#: The columns with the allowed difference of a figure from release to release.
_ALLOWANCES = {
    f"{name}{ALLOWANCE_SUFFIX}": _number(
        f"{name}{ALLOWANCE_SUFFIX}",
        f"{figure.title}, allowance",
        f"difference of {name} that is allowed if nothing has changed",
        figure.unit,
        figure.counts,
    )
    for name, figure in FIGURES.items()
}


def columns(table: str) -> dict[str, Column]:
    """Return the columns that a table may have, by name and in the order of `TABLES`. table: the name of its file."""
    own = {column.name: column for column in (*_SHARED, *_OWN.get(table, ()))}
    known = COLUMNS | _ALLOWANCES | own
    return {name: known[name] for name in TABLES[table].kinds}
