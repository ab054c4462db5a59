"""The numbers of attributes of robot models that a case is made of: all of them must be there, and of a limited size."""

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
        Where they are.
    counts
        How many there may be.
    default
        What is returned without the attribute, which is required if it is None.

    Raises
    ------
    BadInput
        If the attribute is missing, if something is no number or exceeds `MAX_NUMBER`, or if there are more or fewer.
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


def number(element: Element, attribute: str, default: float | None = None) -> float:
    """Return the number of an attribute, as `numbers` does."""
    (value,) = numbers(element, attribute, (1,), None if default is None else (default,))
    return value


def positive(element: Element, attribute: str, default: float | None = None) -> float:
    """Return the number of an attribute, as `numbers` does. Raises `BadInput` unless it is positive."""
    if not (value := number(element, attribute, default)) > 0:
        refuse(element, attribute, f"read {value!r}; allowed: a positive number")
    return value
