"""The motion of a driven joint in the wide type, with bounds of its errors.

The motion is followed twice, in arithmetic of a hundred and of sixty digits. The error of the second, which is far larger than
that of the first, is seen in their difference: it is large where decisions within rounding change the motion, such as a stop
that is only touched, or where errors grow as in a chaotic motion. Such a motion is refused from then on.
"""

from typing import Any

import mpmath
import numpy as np

from bodycheck.reference.errors import Stopped
from bodycheck.reference.exact.numbers import MP, Wide
from bodycheck.reference.exact.pairs import WideArray
from bodycheck.reference.mechanisms.control import Controller, Stops
from bodycheck.reference.mechanisms.driven.following import follow as followed
from bodycheck.reference.mechanisms.driven.linear import evaluated, in_wide
from bodycheck.reference.mechanisms.driven.modes import POSITION, VELOCITY, driven_joint
from bodycheck.reference.mechanisms.forms.motion import WIDE_EPS, JointForm
from bodycheck.reference.mechanisms.forms.oscillator import Oscillator
from bodycheck.reference.trajectory import Array

#: Decimal digits of the arithmetic whose error is measured.
FEWER_DIGITS = 60

#: The error of the motion in fewer digits, relative to the largest value of the motion, from which on the motion is refused.
LARGEST_ERROR = 1e-12

_FEWER = mpmath.MPContext()
_FEWER.dps = FEWER_DIGITS


def follow(plant: Oscillator, controller: Controller | None, stops: Stops | None, times: Array) -> JointForm:
    """The motion at times (n,) >= 0, s, in any order.

    plant: the joint without controller and stops.

    Raises `OutOfReach` if the motion cannot be followed, and `Stopped` if errors become large.
    """
    order = np.argsort(times, kind="stable")
    ascending = times[order].tolist()
    values, errors = _in_wide(MP, plant, controller, stops, ascending)
    others, rounding = _in_wide(_FEWER, plant, controller, stops, ascending)
    excess = np.maximum(np.abs(values - others).astype(float) - errors - rounding, 0.0)
    large = (excess > LARGEST_ERROR * np.abs(values).max(axis=0, initial=0.0)).any(axis=1)
    if large.any():
        time = ascending[int(np.argmax(large))]
        raise Stopped(f"errors grow so much that {FEWER_DIGITS} digits do not determine the motion at {time:.9g} s", time)
    errors = errors + excess
    back = np.argsort(order, kind="stable")
    values, errors = values[back], errors[back]
    return JointForm(values[:, :1], values[:, 1:], errors[:, 0], errors[:, 1])


def _in_wide(
    mp: Any, plant: Oscillator, controller: Controller | None, stops: Stops | None, times: list[float]
) -> tuple[WideArray, Array]:
    """The coordinates and velocities (n, 2) at ascending times, followed in an arithmetic, and bounds of their rounding."""
    joint = driven_joint(mp, plant, controller, stops)
    records = followed(joint, times)
    assert len(records) == len(times)
    values, errors = np.zeros((len(times), 2), dtype=Wide), np.zeros((len(times), 2))
    states: dict[int, WideArray] = {}
    groups: dict[int, list[int]] = {}
    for index, (linear, z, _) in enumerate(records):
        groups.setdefault(id(linear), []).append(index)
        if id(z) not in states:
            states[id(z)] = in_wide(z)
    for rows in groups.values():
        linear = records[rows[0]][0]
        begun = np.stack([states[id(records[row][1])] for row in rows])
        durations = in_wide([records[row][2] for row in rows])
        reached, rounding = evaluated(linear, begun, durations)
        values[rows], errors[rows] = reached[:, [POSITION, VELOCITY]], rounding[:, [POSITION, VELOCITY]]
    # The result is stored in the wide type.
    return values, errors + WIDE_EPS * np.abs(values).astype(float)
