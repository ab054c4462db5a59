"""The probe of returned states: the frames of velocities, the order of components, and the norm of quaternions."""

import numpy as np

from bodycheck.studies.audit.flights import NotFlown, Pilot
from bodycheck.studies.audit.probe import Finding, not_probed
from bodycheck.studies.audit.probes.conventions import Convention, convention
from bodycheck.studies.audit.probes.damping import spinning_top
from bodycheck.studies.audit.probes.falling import roundoff

#: The largest deviation of a norm from 1 that rounding can explain, in units of roundoff.
ROUNDINGS = 16


def returned_states(pilot: Pilot) -> tuple[Finding, ...]:
    """Return findings about the properties frame, order and quaternion-norm."""
    known = convention(pilot)
    if isinstance(known, NotFlown):
        return (*not_probed("returned states", known.reason, "frame", "order"), _norm(pilot))
    frames, orders = _frames(known), _orders(known)
    return (
        Finding("frame", f"returned states: {frames}" if frames else "returned states", "found" if frames else "none"),
        Finding("order", f"returned states: {orders}" if orders else "returned states", "found" if orders else "none"),
        _norm(pilot),
    )


def _frames(known: Convention) -> str:
    """Return words about the quantities that are not in the frames of the contract; empty if there are none."""
    said = {
        "the quaternion takes world components to body components": known.conjugate,
        "the velocity is along the axes of the body": known.velocity_in_body,
        "the angular velocity is along the axes of the world": known.spin_in_world,
        "a launch has its velocity along the axes of the body": known.takes_velocity_in_body,
        "a launch has its angular velocity along the axes of the world": known.takes_spin_in_world,
    }
    return ", ".join(words for words, true in said.items() if true)


def _orders(known: Convention) -> str:
    """Return the names of the components in their returned order; empty if this is the order of the contract."""
    if known.columns == Convention().columns:
        return ""
    names = np.array(["x", "y", "z", "qw", "qx", "qy", "qz", "vx", "vy", "vz", "wx", "wy", "wz"])
    return " ".join(names[np.argsort(known.columns)])


def _norm(pilot: Pilot) -> Finding:
    flown = pilot.recall(spinning_top(pilot))
    if isinstance(flown, NotFlown):
        return not_probed("returned states", flown.reason, "quaternion-norm")[0]
    off = flown.quaternion_norm_error
    wrong = off > ROUNDINGS * roundoff(pilot)
    duration = sum(spinning_top(pilot).strides) * pilot.timestep
    words = f"returned states: the largest deviation of a norm from 1 in {duration:.3g} s of a top that turns once a second"
    return Finding("quaternion-norm", words, "found" if wrong else "none", off if wrong else None, "", "0")
