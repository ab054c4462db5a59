"""Check the spellings of methods that are named for the file of a robot."""

import math

from bodycheck.adapters.contract import Method
from bodycheck.adapters.file_motion import FileFacts
from bodycheck.errors import BadInput
from bodycheck.suggestion import did_you_mean

#: The whole number from which on the value of an option is refused.
MOST_WHOLE = 2**31


class UnknownMethod(BadInput):
    """An engine has no such integrator, option or value for files; the text says what it has."""


def check(spelling: str, engine: str, file: str, facts: FileFacts) -> None:
    """Check the spelling of a method for a file. Raises `UnknownMethod`, and `BadInput` for what is no spelling."""
    method = Method.parse(spelling, 0.0)
    if method.integrator not in facts.methods:
        meant = did_you_mean(method.integrator, facts.methods)
        raise UnknownMethod(f"--integrator {spelling!r}: {engine} has for {file}: {', '.join(facts.methods)}{meant}")
    for key, value in method.options:
        if key not in facts.options:
            meant = did_you_mean(key, facts.options)
            allowed = ", ".join(facts.options) or "none"
            raise UnknownMethod(f"--integrator {spelling!r}: the options of {engine} for files are: {allowed}{meant}")
        whole = facts.options[key] is int
        if not _positive(value, whole):
            allowed = "a positive whole number" if whole else "a positive number"
            raise UnknownMethod(f"--integrator {spelling!r}: read {value!r} as {key}; allowed: {allowed}")


def _positive(value: str, whole: bool) -> bool:
    """Return whether a text is a positive finite number, and a whole one if it must be."""
    try:
        number = int(value) if whole else float(value)
    except ValueError:
        return False
    return 0 < number < (MOST_WHOLE if whole else math.inf)
