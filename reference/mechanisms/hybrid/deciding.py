"""Changes that errors may cause altogether: the order of impacts and instants, stops that are almost reached, and rest.

Small errors of a state move an event by a small time, and the growth of errors contains this. It does not contain what happens
when two events change their order, or when an event is added. Such a motion is refused where its errors do not exclude this.
"""

from collections.abc import Sequence

import numpy as np

from bodycheck.reference.errors import Stopped
from bodycheck.reference.mechanisms.link_states import Critical
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.trajectory import Array

#: The number of relative errors of a state by which the forces on joints at rest may be wrong, as a part of them.
OF_FORCES = 1e3

#: The factor by which an error may move an event further than the bound of the error says.
CAUTION = 2.0


def add_criticals(
    mechanism: Mechanism, times: Array, criticals: Sequence[Critical], relative: Array, length: float, errors: dict[str, Array]
) -> None:
    """Add to errors (n,) at times (n,), s, what velocities jump at impacts whose times are uncertain.

    Raises `Stopped`, with the time of the first such event, if the errors may change the order of events, or their number.

    Parameters
    ----------
    mechanism, times
        The mechanism and the times (s).
    criticals
        What errors may change altogether.
    relative
        (n,) the relative errors of the state.
    length
        The size of the mechanism (m).
    errors
        (n,) bounds of errors, by the names of `bounds.STATES`.
    """
    for critical in sorted(criticals, key=lambda each: each.time):
        row = min(int(np.searchsorted(times, critical.time)), len(times) - 1)
        error = CAUTION * float(errors["error" if critical.turns else "position_error"][row])
        if critical.kind == "rest":
            error = OF_FORCES * float(relative[row])
        if critical.kind == "impact":
            error = 2 * error / critical.speed
        if not error < critical.room:
            dry = critical.kind == "rest" and mechanism.joints[critical.joint].friction
            raise Stopped(_undecided(mechanism, critical), critical.time, "dry friction" if dry else "stops")
        if critical.kind == "impact":
            rate, speed = critical.jumps
            near = np.abs(times - critical.time) <= error
            errors["angular_velocity_error"][near] += len(mechanism.joints) * rate
            errors["velocity_error"][near] += len(mechanism.joints) * (speed + rate * length)


def _undecided(mechanism: Mechanism, critical: Critical) -> str:
    """The sentence on what the errors of a state leave undecided."""
    joint, at = mechanism.joints[critical.joint].name, f"at t = {critical.time:.6g} s"
    if critical.kind == "rest":
        return f"rounding leaves undecided whether the joint {joint} stays at rest {at}"
    if critical.kind == "touch":
        return f"rounding leaves undecided whether the joint {joint} touches its stop {at}"
    return f"rounding leaves undecided whether the joint {joint} reaches its stop before another event {at}"
