"""Mechanisms that the reference does not model, with the reason."""

from bodycheck.reference.errors import NotModelled
from bodycheck.reference.mechanisms.mechanism import Mechanism


def require_independent(mechanism: Mechanism) -> None:
    """Raise `NotModelled` for joints that follow others where this is not modelled: in loops, and with dry friction on them."""
    linked = coupled(mechanism)
    if linked and mechanism.loops:
        raise NotModelled("joints that follow others in a mechanism with loops", "followers")
    if dry := [mechanism.joints[index].name for index in sorted(linked) if mechanism.joints[index].friction]:
        raise NotModelled(f"dry friction on joints that follow others or are followed: {', '.join(dry)}", "dry friction")


def require_drivable(mechanism: Mechanism) -> None:
    """Raise `NotModelled` for controllers and stops where they are not modelled."""
    if not sudden(mechanism):
        return
    if mechanism.loops and any(joint.stops for joint in mechanism.joints):
        raise NotModelled("stops in a mechanism with loops", "stops")
    joints = mechanism.joints
    if rigid := [joints[index].name for index in sorted(coupled(mechanism)) if (stops := joints[index].stops) and stops.rigid]:
        raise NotModelled(f"rigid stops of joints that follow others or are followed: {', '.join(rigid)}", "stops")


def coupled(mechanism: Mechanism) -> frozenset[int]:
    """Return the indices of the joints that follow others or are followed."""
    joints = enumerate(mechanism.joints)
    return frozenset(index for n, joint in joints if joint.mimic for index in (n, joint.mimic.joint))


def sudden(mechanism: Mechanism) -> bool:
    """Return whether a mechanism has controllers or stops, by which its equations change at events."""
    return bool(mechanism.controllers) or any(joint.stops for joint in mechanism.joints)


def require_modelled(mechanism: Mechanism) -> None:
    """Raise `NotModelled` if the recursion has no model of a mechanism, because of loops, or stops that it does not model."""
    if mechanism.loops:
        raise NotModelled("closed loops")
    require_drivable(mechanism)
