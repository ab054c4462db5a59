"""Numbers and names as they are written into URDF and MJCF files."""

from collections.abc import Iterable

import numpy as np

from bodycheck.reference.robots.model import RobotJoint

#: The value that is written if a file must state a limit and the model has none (rad, m, N m, N, and per second).
UNLIMITED = 1e9


def number(value: float | np.floating) -> str:
    """Return a number as text that reads back as the same number: as a double if it is one, else in the 80-bit type."""
    if float(value) == value or value != value:
        return repr(float(value))
    return np.format_float_scientific(value)


def numbers(values: Iterable[float | np.floating]) -> str:
    """Return numbers as text, separated by spaces."""
    return " ".join(number(value) for value in values)


def limits(joint: RobotJoint) -> tuple[float, float]:
    """Return the lower and the upper limit of a joint, with `UNLIMITED` and its negative for missing limits."""
    return -UNLIMITED if joint.lower is None else joint.lower, UNLIMITED if joint.upper is None else joint.upper
