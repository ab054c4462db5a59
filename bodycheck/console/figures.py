"""Format numbers for tables on the terminal."""

from collections.abc import Mapping
from typing import Any

from bodycheck.console.tables import Column
from bodycheck.figures.bounds import rounded_up, within_truth
from bodycheck.figures.columns import FIGURES
from bodycheck.results.verdicts import WITHIN_ASCII


def scaled(scale: float, value: float | None) -> float | None:
    """Return a value times a scale; None if the value is None."""
    return None if value is None else scale * value


def figure_text(value: float | None) -> str:
    """Return a number with three significant digits; an empty text if it is None."""
    return "" if value is None else f"{value:.3g}"


def error_text(row: Mapping[str, Any], *names: str) -> str:
    """Return the text of the first named error that a row of results contains; empty if it contains none.

    If the error does not exceed the bound of the truth's own error, the text is this bound, preceded by a sign.
    """
    name = next((name for name in names if row.get(name) is not None), None)
    if name is None:
        return ""
    bound = within_truth(FIGURES[name], row)
    return figure_text(row[name]) if bound is None else f"{WITHIN_ASCII} {figure_text(rounded_up(bound, 3))}"


def error_column(name: str, head: str, *instead: str, **options: Any) -> Column[Mapping[str, Any]]:
    """Return the table column for an error in rows of results.

    Parameters
    ----------
    name, head
        The name of the column of results, and the head with the unit.
    instead
        Further columns; if a row has no value for `name`, the first of these with a value is shown.
    options
        Further fields of `Column`.
    """

    def value(row: Mapping[str, Any]) -> float | None:
        return next((row[one] for one in (name, *instead) if row.get(one) is not None), None)

    return Column(name, head, lambda row: error_text(row, name, *instead), value, **options)


def bound_column(name: str, head: str, **options: Any) -> Column[Mapping[str, Any]]:
    """Return the table column for a bound of the truth's own error, rounded up, with the parameters of `error_column`."""

    def value(row: Mapping[str, Any]) -> float | None:
        return row.get(name)

    def text(row: Mapping[str, Any]) -> str:
        bound = value(row)
        return "" if bound is None else f"{rounded_up(bound, 2):.2g}"

    return Column(name, head, text, value, **options)


def microseconds(name: str, head: str, **options: Any) -> Column[Mapping[str, Any]]:
    """Return the table column for a time in rows of results, in us, with the parameters of `error_column`."""

    def value(row: Mapping[str, Any]) -> float | None:
        return scaled(1e6, row.get(name))

    return Column(name, head, lambda row: figure_text(value(row)), value, **options)
