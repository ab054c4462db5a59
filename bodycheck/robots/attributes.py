"""Read numbers, positions and attitudes from attributes of URDF. An unreadable value is a fault, and its default is used.

Numbers are the doubles nearest to the written decimals, as every engine reads them. All computation with them is exact.
"""

import math
import re

from bodycheck.reference.exact.numbers import MP, Quaternion4, Vector3, vector
from bodycheck.reference.exact.rotations import IDENTITY, unit
from bodycheck.robots.elements import Element, quoted
from bodycheck.robots.faults import About, FaultyQuantity
from bodycheck.robots.orientations import euler

#: A decimal number. `float` would also accept 1_000, nan, infinity and digits of other scripts.
NUMBER = re.compile(r"[+-]?([0-9]+(\.[0-9]*)?|\.[0-9]+)([eE][+-]?[0-9]+)?")

#: Words that C's `strtod`, and so many readers, accept as numbers, but that are not finite.
NOT_FINITE = re.compile(r"[+-]?(nan|inf|infinity)", re.IGNORECASE)

#: Most characters of an attribute that holds numbers.
MAX_CHARACTERS = 2000

#: Space in an attribute of XML. `str.split` would also accept the white space of other scripts.
SPACE = " \t\r\n"

#: The default of positions and angles.
ZERO = (0.0, 0.0, 0.0)


def read_numbers(text: str, longest: int = MAX_CHARACTERS) -> tuple[float, ...] | None:
    """Return the numbers in the text of an attribute; they may be NaN or infinite.

    Return None if the text is empty or longer than `longest` characters, or contains anything but numbers.
    """
    words = text.strip(SPACE)
    if not 0 < len(words) <= longest:
        return None
    values = [_value(word) for word in re.split(f"[{SPACE}]+", words)]
    return None if None in values else tuple(value for value in values if value is not None)


def count_in_words(count: int) -> str:
    """Return a phrase for messages that says how many numbers an attribute has."""
    return "one number" if count == 1 else f"{count} numbers separated by spaces"


def numbers(
    about: About, quantity: FaultyQuantity, element: Element, attribute: str, default: tuple[float, ...]
) -> tuple[float, ...]:
    """Return the numbers of an attribute, as many as `default` has; the default if the attribute is missing or unreadable.

    An attribute that is unreadable or has a number that is not finite is a fault; such a number is returned as it is.
    """
    text = element.attributes.get(attribute)
    if text is None:
        return default
    values = read_numbers(text)
    fits = values is not None and len(values) == len(default)
    if values is None or not fits or not all(map(math.isfinite, values)):
        about.add(quantity, element, attribute, f"read {quoted(text)}; allowed: {count_in_words(len(default))}")
    return values if values is not None and fits else default


def number(about: About, quantity: FaultyQuantity, element: Element, attribute: str, default: float = 0.0) -> float:
    """Return the number of an attribute, as `numbers` does."""
    (value,) = numbers(about, quantity, element, attribute, (default,))
    return value


def required(about: About, quantity: FaultyQuantity, element: Element, attribute: str) -> float:
    """Return the number of an attribute, as `numbers` does; 0 and a fault if it is missing."""
    if attribute not in element.attributes:
        about.add(quantity, element, attribute, "is missing; allowed: one number")
    return number(about, quantity, element, attribute)


def position(about: About, quantity: FaultyQuantity, origin: Element | None) -> Vector3:
    """Return the position (m) of an <origin>; 0 if it is None or gives no position."""
    return vector(ZERO if origin is None else numbers(about, quantity, origin, "xyz", ZERO))


def attitude(about: About, quantity: FaultyQuantity, origin: Element | None) -> Quaternion4:
    """Return the attitude of an <origin>: a unit quaternion (w, x, y, z) from its axes to those around it.

    The attitude is given by `rpy`, rotations about the fixed axes x, y and z in this order (rad), or by `quat_xyzw` if the
    version of the file allows it.
    """
    if origin is None:
        return IDENTITY
    if about.quaternions and "quat_xyzw" in origin.attributes:
        if "rpy" in origin.attributes:
            about.add(quantity, origin, "quat_xyzw", "rpy is given too; allowed: one of them")
        x, y, z, w = map(MP.mpf, numbers(about, quantity, origin, "quat_xyzw", (0.0, 0.0, 0.0, 1.0)))
        if x or y or z or w:
            return unit((w, x, y, z))
        about.add(quantity, origin, "quat_xyzw", "its length is 0; allowed: a quaternion that is not 0")
        return IDENTITY
    angles = numbers(about, quantity, origin, "rpy", ZERO)
    return euler(vector(angles), "XYZ") if any(angles) else IDENTITY


def _value(word: str) -> float | None:
    """Return the number that a word represents; None if it is not a number."""
    return float(word) if NUMBER.fullmatch(word) or NOT_FINITE.fullmatch(word) else None
