"""Probes of sleeping, which stops a slow body in uniform motion, and of silent resets, which put a fast body back.

If an engine reports a reset, the flight ends; this is not a silent reset.
"""

from collections.abc import Callable
from math import ceil, sqrt

import numpy as np
from numpy.typing import NDArray

from bodycheck.studies.audit.flights import Flight, NotFlown, Pilot
from bodycheck.studies.audit.probe import Finding, not_probed
from bodycheck.studies.audit.probes.conventions import watch
from bodycheck.studies.audit.probes.scenes import DIRECTION, coast

#: The speeds (m/s) between which the threshold of sleeping is searched for, and the duration (s) of a flight.
SLOWEST, FASTEST = 1e-4, 10.0
DURATION = 3.0

#: The number of single steps at the start of a flight, and the number of strides in its remaining duration.
FIRST, STRIDES = 64, 100

#: The fractions of the launch speed from which a body counts as moving, and up to which it counts as still. The speed of a body
#: that crawls because of damping lies between them for a while. A body that is put to sleep stops within one stride.
MOVING, STILL = 1e-2, 1e-3

#: The launch speeds (m/s) between which the threshold is searched for, above which a body is put back to its start.
SLOW, FAST = 1e3, 1e13

#: The number of steps of these launches.
STEPS = 3

#: Tolerances of a body that is put back: of its distance from the start, relative to the distance that it had travelled or
#: travels in a step, and of its speed, relative to the launch speed.
BACK = 1e-2

#: The relative distance of the two values between which an answer changes, at which the bisection ends.
CLOSE = 2e-3


def sleeping(pilot: Pilot) -> tuple[Finding, ...]:
    """Return a finding about the property sleeping.

    Its value is the speed (m/s) below which a body without spin is put to sleep.
    """
    long = max(1, ceil((DURATION / pilot.timestep - FIRST) / STRIDES))
    strides = (1,) * FIRST + (long,) * STRIDES
    still = _still(pilot, SLOWEST, strides)
    if isinstance(still, NotFlown):
        return not_probed("sleeping", still.reason, "sleeping")
    expected = f"none above {SLOWEST:g} m/s"
    if not still[-1]:
        return (Finding("sleeping", "sleeping", "none", expected=expected),)
    first = int(np.argmax(still))
    asleep = _steps_until_still(pilot, strides[: first + 1])
    short = (max(asleep, 1), long)

    def sleeps(speed: float) -> bool:
        stopped = _still(pilot, speed, short)
        return not isinstance(stopped, NotFlown) and bool(stopped[-1])

    words = f"sleeping: after {asleep * pilot.timestep:.3g} s"
    if sleeps(FASTEST):
        return (Finding("sleeping", f"{words}, at any speed", "found", None, "m/s", expected),)
    return (Finding("sleeping", words, "found", threshold(sleeps, SLOWEST, FASTEST), "m/s", expected),)


def _steps_until_still(pilot: Pilot, strides: tuple[int, ...]) -> int:
    """Return the number of steps that a body moves, which is still in the last of some strides and stops in that before it."""
    *before, _ = strides
    last = before.pop() if before else 0
    steps = last + strides[-1]
    still = _still(pilot, SLOWEST, (*before, *(1,) * steps))
    return sum(before) + (steps if isinstance(still, NotFlown) else int(np.argmax(still[len(before) :])))


def _still(pilot: Pilot, speed: float, strides: tuple[int, ...]) -> NDArray[np.bool_] | NotFlown:
    """Return for each stride (n,) whether the body is still, having stopped within this stride or an earlier stride."""
    states = watch(pilot, Flight(coast(speed, 0.0), pilot.timestep, strides))
    if isinstance(states, NotFlown):
        return states
    moved = np.abs(np.diff(states[:, :3] @ np.array(DIRECTION), prepend=0.0)) / (speed * pilot.timestep * np.array(strides))
    before = np.concatenate([[1.0], moved[:-1]])
    stopped = np.logical_or.accumulate((moved <= STILL) & (before >= MOVING))
    return np.asarray(stopped & (moved <= STILL))


def resets(pilot: Pilot) -> tuple[Finding, ...]:
    """Return a finding about the property silent-reset.

    Its value is the distance (m) or the speed (m/s) above which a body is put back to its start.
    """
    near, far = _put_back(pilot, SLOW, pilot.timestep), _put_back(pilot, FAST, pilot.timestep)
    if isinstance(near, NotFlown):
        return not_probed("resets", near.reason, "silent-reset")
    expected = "none"
    if near:
        return (Finding("silent-reset", f"resets: at {SLOW:g} m/s", "found", None, "m/s", expected),)
    if far is not True:
        # If an engine gives up a flight, or its states are not numbers, the failure is not silent.
        words = f"resets: at {FAST:g} m/s: {far.reason}" if isinstance(far, NotFlown) else "resets"
        return (Finding("silent-reset", words, "none", expected=expected),)

    def flies(speed: float) -> bool:
        return _put_back(pilot, speed, pilot.timestep) is not True

    speed = threshold(flies, SLOW, FAST)
    # With an eighth of the time step, the body comes less than half as far, so that only a limit of the speed puts it back.
    if _put_back(pilot, 1.1 * speed, pilot.timestep / 8) is True:
        return (Finding("silent-reset", "resets: by the speed", "found", speed, "m/s", expected),)
    distance = speed * pilot.timestep * STEPS
    return (Finding("silent-reset", "resets: by the distance", "found", distance, "m", expected),)


def _put_back(pilot: Pilot, speed: float, timestep: float) -> bool | NotFlown:
    """Return whether, after any step, a body is back near its start, at rest or with the velocity of the launch."""
    states = watch(pilot, Flight(coast(speed, 0.0), timestep, (1,) * STEPS))
    if isinstance(states, NotFlown):
        return states
    way, speeds = states[:, :3] @ np.array(DIRECTION), states[:, 7:10] @ np.array(DIRECTION) / speed
    at_start = np.abs(way) <= BACK * np.maximum(np.abs(speeds) * speed * timestep, np.maximum.accumulate(way))
    as_launched = (np.abs(speeds) < BACK) | (np.abs(speeds - 1) < BACK)
    return bool((at_start & as_launched).any())


def threshold(answer: Callable[[float], bool], below: float, above: float) -> float:
    """Return the value at which an answer changes, between two positive values, to within a thousandth of it.

    Parameters
    ----------
    answer
        A function of the value, which returns True at `below` and False at `above`.
    below, above
        The two values. Either may be the larger.
    """
    while abs(above / below - 1) > CLOSE:
        middle = sqrt(below * above)
        below, above = (middle, above) if answer(middle) else (below, middle)
    return sqrt(below * above)
