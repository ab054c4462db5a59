"""Probes by a body in uniform motion that an engine interrupts: sleeping stops a slow one, a reset puts a fast one back.

An engine that says that it started over ends the flight, which is no silent reset.
"""

from collections.abc import Callable
from math import ceil, sqrt

import numpy as np
from numpy.typing import NDArray

from bodycheck.studies.audit.flights import Flight, NotFlown, Pilot
from bodycheck.studies.audit.probe import Finding, not_probed
from bodycheck.studies.audit.probes.conventions import watch
from bodycheck.studies.audit.probes.scenes import DIRECTION, coast

#: The speeds (m/s) between which a threshold is looked for, and how long (s) a body is watched.
SLOWEST, FASTEST = 1e-4, 10.0
DURATION = 3.0

#: The number of single steps that are watched first, and that of strides for the rest.
FIRST, STRIDES = 64, 100

#: The parts of the launch speed with which a body moves or is still. One that crawls after damping is between them for a while,
#: and one that is put to sleep stops within one stride of many steps.
MOVING, STILL = 1e-2, 1e-3

#: Speeds (m/s) of the launches between which the one is looked for from which on a body is put back.
SLOW, FAST = 1e3, 1e13

#: The number of steps of these launches.
STEPS = 3

#: The part of the way that it came, or comes in a step, within which of its start a body is back, and that of its speed.
BACK = 1e-2

#: The relative distance of the two values between which the answer changes, in the end.
CLOSE = 2e-3


def sleeping(pilot: Pilot) -> tuple[Finding, ...]:
    """Return a finding of sleeping: the threshold of the speed (m/s) of a body without spin."""
    long = max(1, ceil((DURATION / pilot.timestep - FIRST) / STRIDES))
    strides = (1,) * FIRST + (long,) * STRIDES
    still = _still(pilot, SLOWEST, strides)
    if isinstance(still, NotFlown):
        return not_probed("sleeping", still.reason, "sleeping")
    expected = f"none above {SLOWEST:g} m/s"
    if not still[-1]:
        return (Finding("sleeping", "sleeping", "none", expected=expected),)
    first = int(np.argmax(still))
    short = (sum(strides[: first + 1]), strides[first + 1] if first + 1 < len(strides) else 1)

    def sleeps(speed: float) -> bool:
        stopped = _still(pilot, speed, short)
        return not isinstance(stopped, NotFlown) and bool(stopped[-1])

    words = f"sleeping: after {short[0] * pilot.timestep:.3g} s"
    if sleeps(FASTEST):
        return (Finding("sleeping", f"{words}, at any speed", "found", None, "m/s", expected),)
    return (Finding("sleeping", words, "found", threshold(sleeps, SLOWEST, FASTEST), "m/s", expected),)


def _still(pilot: Pilot, speed: float, strides: tuple[int, ...]) -> NDArray[np.bool_] | NotFlown:
    """Return in which strides (n,) a body that moved before is still, and all of those after them."""
    states = watch(pilot, Flight(coast(speed, 0.0), pilot.timestep, strides))
    if isinstance(states, NotFlown):
        return states
    moved = np.abs(np.diff(states[:, :3] @ np.array(DIRECTION), prepend=0.0)) / (speed * pilot.timestep * np.array(strides))
    before = np.concatenate([[1.0], moved[:-1]])
    stopped = np.logical_or.accumulate((moved <= STILL) & (before >= MOVING))
    return np.asarray(stopped & (moved <= STILL))


def resets(pilot: Pilot) -> tuple[Finding, ...]:
    """Return a finding of silent-reset: the distance (m) or the speed (m/s) from which on a body is put back."""
    near, far = _put_back(pilot, SLOW, pilot.timestep), _put_back(pilot, FAST, pilot.timestep)
    if isinstance(near, NotFlown):
        return not_probed("resets", near.reason, "silent-reset")
    expected = "none"
    if near:
        return (Finding("silent-reset", f"resets: at {SLOW:g} m/s", "found", None, "m/s", expected),)
    if far is not True:
        # An engine that gives up a flight, or whose states are no numbers, does not keep it silent.
        words = f"resets: at {FAST:g} m/s: {far.reason}" if isinstance(far, NotFlown) else "resets"
        return (Finding("silent-reset", words, "none", expected=expected),)

    def flies(speed: float) -> bool:
        return _put_back(pilot, speed, pilot.timestep) is not True

    speed = threshold(flies, SLOW, FAST)
    # In steps of an eighth it comes less than half as far.
    if _put_back(pilot, 1.1 * speed, pilot.timestep / 8) is True:
        return (Finding("silent-reset", "resets: by the speed", "found", speed, "m/s", expected),)
    distance = speed * pilot.timestep * STEPS
    return (Finding("silent-reset", "resets: by the distance", "found", distance, "m", expected),)


def _put_back(pilot: Pilot, speed: float, timestep: float) -> bool | NotFlown:
    """Return whether a body is at or near its start after some step, at rest or with the velocity of the launch."""
    states = watch(pilot, Flight(coast(speed, 0.0), timestep, (1,) * STEPS))
    if isinstance(states, NotFlown):
        return states
    way, speeds = states[:, :3] @ np.array(DIRECTION), states[:, 7:10] @ np.array(DIRECTION) / speed
    at_start = np.abs(way) <= BACK * np.maximum(np.abs(speeds) * speed * timestep, np.maximum.accumulate(way))
    as_launched = (np.abs(speeds) < BACK) | (np.abs(speeds - 1) < BACK)
    return bool((at_start & as_launched).any())


def threshold(answer: Callable[[float], bool], below: float, above: float) -> float:
    """Return the value between two positive ones at which an answer changes, to a thousandth of it.

    Parameters
    ----------
    answer
        A function of the value, whose results at `below` and `above` are True and False in this order.
    below, above
        The two values, in either order.
    """
    while abs(above / below - 1) > CLOSE:
        middle = sqrt(below * above)
        below, above = (middle, above) if answer(middle) else (below, middle)
    return sqrt(below * above)
