"""Follow a mechanism with many rigid stops by its Lagrangian with those alone that its motion reaches.

A coordinate reaches a stop if the cubic between two instants, with the coordinates and velocities there, may do so.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.integration.rotation import WideArray
from bodycheck.reference.mechanisms.lagrangian.border import SIZES, steps
from bodycheck.reference.mechanisms.lagrangian.poses import WideMotion
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.trajectory import Array

#: The number of rigid stops from which on the stops that are not reached are left out, and of evenly spaced instants.
MANY, INSTANTS = 5, 1025


def with_reached_stops(mechanism: Mechanism, times: Array, follow: Callable[[Mechanism, Array], WideMotion]) -> WideMotion:
    """The motion of a mechanism at ascending times (n,) >= 0, s, by a function that follows mechanisms.

    Stops are added to the mechanism without any until the motion reaches no others.
    """
    rigid = frozenset(index for index, joint in enumerate(mechanism.joints) if joint.stops is not None and joint.stops.rigid)
    if mechanism.loops or len(rigid) < MANY or not len(times):
        return follow(mechanism, times)
    end = float(times[-1])
    until = end if mechanism.stops_until is None else min(end, mechanism.stops_until)
    instants = np.union1d(times, np.linspace(0.0, until, INSTANTS))
    kept = frozenset[int]()
    while True:
        reduced = _without(mechanism, rigid - kept)
        try:
            motion = follow(reduced, instants)
        except OutOfReach:
            if kept == rigid:
                raise
            kept = rigid
            continue
        new = _touched(mechanism, motion, instants <= until, instants, rigid - kept)
        if not new:
            return _at(motion, np.searchsorted(instants, times))
        kept |= new


def _without(mechanism: Mechanism, indices: frozenset[int]) -> Mechanism:
    joints = tuple(replace(joint, stops=None) if n in indices else joint for n, joint in enumerate(mechanism.joints))
    return replace(mechanism, joints=joints)


def _touched(
    mechanism: Mechanism, motion: WideMotion, rows: NDArray[np.bool_], t: Array, indices: frozenset[int]
) -> frozenset[int]:
    """The indices of joints that may reach their stops at the instants t (n,), s, in a mask (n,) `rows`, or between them."""
    third, new, held, moving = np.diff(t[rows]) / 3, set[int](), 0, 0
    for index, joint in enumerate(mechanism.joints):
        first, column = held, moving
        for kind, *_ in steps(mechanism, joint):
            held, moving = held + SIZES[kind][0], moving + SIZES[kind][1]
        if index not in indices or (stops := joint.stops) is None:
            continue
        q, v = motion.joint_position[rows, first], motion.joint_velocity[rows, column]
        # A cubic is within the range of its coefficients in Bernstein's polynomials.
        reach = np.concatenate([q, q[:-1] + v[:-1] * third, q[1:] - v[1:] * third])
        if (stops.upper is not None and reach.max() >= stops.upper) or (stops.lower is not None and reach.min() <= stops.lower):
            new.add(index)
    return frozenset(new)


def _at(motion: WideMotion, rows: NDArray[np.intp]) -> WideMotion:
    """The motion at some of its instants."""

    def part(values: WideArray, axis: int) -> WideArray:
        return np.take(values, rows, axis=axis)

    bodies = {name: part(getattr(motion, name), 1) for name in ("position", "quaternion", "velocity", "angular_velocity")}
    return replace(
        motion, **bodies, joint_position=part(motion.joint_position, 0), joint_velocity=part(motion.joint_velocity, 0)
    )
