"""Read values of a raw document, which may have any faults: what is not of the right type counts as empty or zero."""

from collections.abc import Mapping
from typing import Any

from bodycheck.casefile.values import MAX_NUMBER


def mapping(value: Any) -> dict[str, Any]:
    """Return the table, or an empty one if the value is none; the grammar reports invalid types."""
    return value if isinstance(value, dict) else {}


def tables_of(document: Mapping[str, Any], name: str, most: int) -> list[dict[str, Any]]:
    """Return the tables of an array, as many of them as there may be; the grammar reports invalid types."""
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
