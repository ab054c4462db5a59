"""The result of a closed form: coordinates and velocities of a mechanism's joints in the wide type, with bounds of errors."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.exact.pairs import WideArray
from bodycheck.reference.mechanisms.coordinates import places
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.trajectory import Array

#: The relative spacing of the numbers of the wide type.
WIDE_EPS = float(np.finfo(Wide).eps)


@dataclass(frozen=True, eq=False)
class JointForm:
    """The motion of one joint at n instants.

    Attributes
    ----------
    position, velocity
        (n, k) coordinates and (n, m) velocities, in the wide type, in the layout of `coordinates`.
    error
        (n,) bound of the error of the coordinate (m or rad), or of the error of the attitude, as an angle (rad).
    velocity_error
        (n,) bound of the error of the velocity (m/s or rad/s), or of the size of the error of the angular velocity (rad/s).
    """

    position: WideArray
    velocity: WideArray
    error: Array
    velocity_error: Array


@dataclass(frozen=True, eq=False)
class FormMotion:
    """The motion of all joints of a mechanism at n instants.

    Attributes
    ----------
    position, velocity
        (n, c) coordinates and (n, u) velocities, in the wide type, in the layout of `coordinates`.
    error, velocity_error
        (n, joints) bounds of the errors of each joint: see `JointForm`. They do not contain the rounding to doubles.
    """

    position: WideArray
    velocity: WideArray
    error: Array
    velocity_error: Array


@dataclass(frozen=True)
class Form:
    """A closed form of the motion of a mechanism.

    Attributes
    ----------
    name
        The name of the form in results.
    reason
        The reason why the form is exact, in a few words.
    follow
        The function from instants (n,), s, in any order, to the motion.
    """

    name: str
    reason: str
    follow: Callable[[Array], FormMotion]


def gathered(mechanism: Mechanism, parts: dict[int, JointForm], count: int) -> FormMotion:
    """The motion of a mechanism at `count` instants from the motions of its joints, by their indices; other joints rest."""
    slices = places(mechanism)
    last = slices[-1] if slices else (slice(0, 0), slice(0, 0))
    position = np.zeros((count, last[0].stop), dtype=Wide)
    velocity = np.zeros((count, last[1].stop), dtype=Wide)
    error, velocity_error = (np.zeros((count, len(mechanism.joints))) for _ in range(2))
    for index, part in parts.items():
        held, moving = slices[index]
        position[:, held], velocity[:, moving] = part.position, part.velocity
        error[:, index], velocity_error[:, index] = part.error, part.velocity_error
    return FormMotion(position, velocity, error, velocity_error)
