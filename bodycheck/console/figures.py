"""Format numbers for tables on the terminal."""

from collections.abc import Mapping
from typing import Any

from bodycheck.figures.bounds import rounded_up, within_truth
from bodycheck.figures.columns import FIGURES

#: Sign before the truth's own error, where an error is no larger than it. It is ASCII, as some terminals know nothing else.
WITHIN = "<="


def scaled(scale: float, value: float | None) -> float | None:
    """Return a value times a scale; None if the value is None."""
    return None if value is None else scale * value


def figure_text(value: float | None) -> str:
    """Return a number with three significant digits; an empty text if it is None."""
    return "" if value is None else f"{value:.3g}"


def error_text(row: Mapping[str, Any], *names: str) -> str:
    """Return the first of some errors that a row of results has, or the truth's own error if it is no smaller, with a sign.

    The text is empty if the row has none of them.
    """
    name = next((name for name in names if row.get(name) is not None), None)
    if name is None:
        return ""
    own = within_truth(FIGURES[name], row)
    return figure_text(row[name]) if own is None else f"{WITHIN} {figure_text(rounded_up(own, 3))}"
