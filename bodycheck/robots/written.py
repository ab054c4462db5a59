"""Numbers and names as they are written into URDF and MJCF files."""

from collections.abc import Iterable

import numpy as np

from bodycheck.reference.robots.model import RobotJoint

#: A limit that is written where a file must have one and the model has none (rad, m, N m, N, and per second).
UNLIMITED = 1e9


def number(value: float | np.floating) -> str:
    """A number as text from which the same number is read: a double as that double, any other one in the 80-bit type."""
    if float(value) == value or value != value:
        return repr(float(value))
    return np.format_float_scientific(value)


def numbers(values: Iterable[float | np.floating]) -> str:
    """Numbers as text, separated by spaces."""
    return " ".join(number(value) for value in values)


def limits(joint: RobotJoint) -> tuple[float, float]:
    """The lower and the upper limit of a joint, and `UNLIMITED` where it has none."""
    return -UNLIMITED if joint.lower is None else joint.lower, UNLIMITED if joint.upper is None else joint.upper
