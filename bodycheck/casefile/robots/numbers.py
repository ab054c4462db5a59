"""Read the numbers that a case needs from attributes of a robot model; all must be present, and of limited size."""

from collections.abc import Sequence

from bodycheck.casefile.values import MAX_NUMBER
from bodycheck.robots.attributes import count_in_words, read_numbers
from bodycheck.robots.elements import Element, quoted, refuse


def numbers(
    element: Element, attribute: str, counts: Sequence[int], default: tuple[float, ...] | None = None
) -> tuple[float, ...]:
    """Return the numbers of an attribute.

    Parameters
    ----------
    element, attribute
        The element and the attribute that contains the numbers.
    counts
        The allowed numbers of values.
    default
        The result if the attribute is missing; if it is None, the attribute is required.

    Raises
    ------
    BadInput
        If the attribute is missing, a value is no number or exceeds `MAX_NUMBER`, or the number of values is not allowed.
    """
    text = element.attributes.get(attribute)
    allowed = " or ".join(map(count_in_words, counts))
    if text is None:
        if default is not None:
            return default
        refuse(element, attribute, f"is missing; allowed: {allowed}")
    values = read_numbers(text)
    if values is None or len(values) not in counts or not all(abs(value) <= MAX_NUMBER for value in values):
        refuse(element, attribute, f"read {quoted(text)}; allowed: {allowed} of at most {MAX_NUMBER:g} in size")
    return values


def many(element: Element, attribute: str, default: tuple[float, ...] | None = None) -> tuple[float, ...]:
    """Return the numbers of an attribute that may have any number of them, as `numbers` does."""
    text = element.attributes.get(attribute)
    if text is None:
        if default is not None:
            return default
        refuse(element, attribute, "is missing; allowed: numbers separated by spaces")
    values = read_numbers(text, len(text))
    if values is None or not all(abs(value) <= MAX_NUMBER for value in values):
        refuse(
            element, attribute, f"read {quoted(text)}; allowed: numbers separated by spaces, of at most {MAX_NUMBER:g} in size"
        )
    return values


def number(element: Element, attribute: str, default: float | None = None) -> float:
    """Return the number of an attribute, as `numbers` does."""
    (value,) = numbers(element, attribute, (1,), None if default is None else (default,))
    return value


def positive(element: Element, attribute: str, default: float | None = None) -> float:
    """Return the number of an attribute, as `numbers` does. Raises `BadInput` unless it is positive."""
    if not (value := number(element, attribute, default)) > 0:
        refuse(element, attribute, f"read {value!r}; allowed: a positive number")
    return value
