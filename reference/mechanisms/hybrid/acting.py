"""The rigid stops of a tree that act in its motion: without the others, the motion is the same, and is computed much faster.

The motion is followed without stops. Stops that it may reach are added, until the motion surely stays away from all others: a
motion that never reaches a stop is the motion without it.
"""

import functools
from dataclasses import replace

from bodycheck.reference.bounds import EPS
from bodycheck.reference.errors import Stopped
from bodycheck.reference.mechanisms.hybrid.ranges import JointLimits, passed, reached
from bodycheck.reference.mechanisms.mechanism import Joint, Mechanism
from bodycheck.reference.mechanisms.modelled import coupled

#: The number of rigid stops up to which all are followed, and the part of all stops from which on all are followed at once.
FEW, MANY = 4, 0.5


def with_acting_stops(mechanism: Mechanism, end: float) -> Mechanism:
    """Return a mechanism with the same motion until a time (s), whose joints have the rigid stops that act, and few others.

    Raises as `followed`, and `Stopped` where a joint that follows another, or is followed, reaches a rigid stop, which is not
    modelled.
    """
    stopped = _stopped(mechanism)
    if mechanism.loops or (len(stopped) <= FEW and not stopped & coupled(mechanism)):
        return mechanism
    return _with_stops_of(mechanism, acting_stops(mechanism, end))


def acting_stops(mechanism: Mechanism, end: float) -> frozenset[int]:
    """Return the indices of the joints that may reach rigid stops until a time (s), and few others; see `with_acting_stops`."""
    if mechanism.stops_until is not None and coupled(mechanism):  # some stops may be modelled until then only
        end = min(end, mechanism.stops_until)
    return _acting(replace(mechanism, stops_until=None), end)


@functools.lru_cache(maxsize=4)
def _acting(mechanism: Mechanism, end: float) -> frozenset[int]:
    stopped, acting = _stopped(mechanism), frozenset[int]()
    while True:
        reduced = _with_stops_of(mechanism, acting)
        new = _reached(reduced, [mechanism.joints[index] for index in sorted(stopped - acting)], end)
        added = frozenset(index for index in stopped if mechanism.joints[index].name in new)
        if not added:
            return acting
        if undetermined := added & coupled(mechanism):
            raise _not_modelled(reduced, [mechanism.joints[index] for index in sorted(undetermined)], end)
        acting |= added
        if len(acting) > MANY * len(stopped):
            acting = stopped - coupled(mechanism)


def _reached(reduced: Mechanism, joints: list[Joint], end: float) -> frozenset[str]:
    """Return the names of the joints that may reach their stops, which the mechanism lacks, before its motion ends."""
    limits = [JointLimits.of(joint) for joint in joints]
    while True:
        try:
            return reached(reduced, limits, end)
        except Stopped as stopped:
            if not 0 < (before := min(stopped.time, end) * (1 - 2**20 * EPS)) < end:
                raise
            end = before


def _not_modelled(reduced: Mechanism, joints: list[Joint], end: float) -> Stopped:
    """Return why the motion of a mechanism ends at the first stop of some joints."""
    passings = passed(reduced, [JointLimits.of(joint) for joint in joints], end)
    time = passings[0].time - passings[0].error if passings else 0.0
    name = passings[0].name if passings else joints[0].name
    return Stopped(
        f"the stop of {name}, a joint that follows another or is followed, is not modelled, from t = {time:.6g} s",
        time,
        "stops",
    )


def _stopped(mechanism: Mechanism) -> frozenset[int]:
    """Return the indices of the joints with rigid stops."""
    return frozenset(index for index, joint in enumerate(mechanism.joints) if joint.stops is not None and joint.stops.rigid)


def _with_stops_of(mechanism: Mechanism, acting: frozenset[int]) -> Mechanism:
    """Return a mechanism without the rigid stops of other joints."""
    others = _stopped(mechanism) - acting
    joints = tuple(replace(joint, stops=None) if index in others else joint for index, joint in enumerate(mechanism.joints))
    return replace(mechanism, joints=joints, stops_until=mechanism.stops_until if acting else None)
