"""Read values of a raw document, which may have faults: a value of the wrong type counts as empty or zero."""

from collections.abc import Mapping
from datetime import date, time
from typing import Any

from bodycheck.casefile.values import MAX_NUMBER


def mapping(value: Any) -> dict[str, Any]:
    """Return the table, or an empty one if the value is not a table; the grammar reports invalid types."""
    return value if isinstance(value, dict) else {}


def tables_of(document: Mapping[str, Any], name: str, most: int) -> list[dict[str, Any]]:
    """Return the tables of an array, at most `most` of them; the grammar reports invalid types."""
    value = document.get(name)
    return [mapping(item) for item in value[:most]] if isinstance(value, list) else []


def number(value: Any) -> float:
    """Return the number, or 0.0 if it is invalid; the grammar reports invalid types."""
    return (numbers([value], 1) or [0.0])[0]


def numbers(value: Any, length: int) -> list[float] | None:
    """Return the list if it contains `length` finite numbers, else None; the grammar reports invalid types."""
    if not isinstance(value, list) or len(value) != length:
        return None
    if not all(isinstance(item, int | float) and not isinstance(item, bool) for item in value):
        return None
    return [float(item) for item in value] if all(abs(item) <= MAX_NUMBER for item in value) else None


#: The longest quotation (characters).
MAX_QUOTE_LENGTH = 60


def quote(value: Any) -> str:
    """Return the beginning of a value, on one line."""
    try:
        quote = str(value) if isinstance(value, date | time) else repr(value)
    except RecursionError:
        return "a deeply nested value"
    return quote if len(quote) <= MAX_QUOTE_LENGTH else quote[: MAX_QUOTE_LENGTH - 1] + "…"
