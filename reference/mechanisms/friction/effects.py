"""The effects of uncertain decisions about joints with dry friction on the errors of a motion."""

from collections.abc import Iterable

import numpy as np

from bodycheck.reference.mechanisms.friction.sticking import Doubt
from bodycheck.reference.mechanisms.growth import Growth
from bodycheck.reference.mechanisms.link_states import Decision, floating
from bodycheck.reference.mechanisms.link_states import sizes as sizes_in_state
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.mechanisms.ways import reach
from bodycheck.reference.trajectory import Array


def errors_of_links(decision: Decision, errors: dict[str, float]) -> list[float]:
    """The errors of the components of a state of links, from the errors of a motion by the names of `bounds.STATES`."""
    of_components: list[float] = []
    for link in decision.tree.links:
        held, moving = sizes_in_state(link)
        slides = link.kind == "prismatic"
        of_components += [errors["position_error" if slides else "error"]] * held
        of_components += [errors["velocity_error" if slides else "angular_velocity_error"]] * moving
    for _ in floating(decision.tree.links):
        of_components += [errors["position_error"]] * 3 + [errors["velocity_error"]] * 3
    return [0.0 if index in decision.exact else error for index, error in enumerate(of_components)]


def add_doubts(mechanism: Mechanism, grown: Growth, doubtful: Iterable[Doubt], errors: dict[str, Array]) -> None:
    """Add to errors (n,) what uncertain accelerations of joints cause, and its growth, at the instants of the growth."""
    length = length_of(mechanism)
    for doubt in doubtful:
        later = np.maximum(grown.t - doubt.since, 0.0)
        slipped = doubt.acceleration * later * grown.of_start
        moved = slipped * later / 2
        errors["velocity_error"] += slipped * (length if doubt.turns else 1.0)
        errors["position_error"] += moved * (length if doubt.turns else 1.0)
        if doubt.turns:
            errors["angular_velocity_error"] += slipped
            errors["error"] += moved


def length_of(mechanism: Mechanism) -> float:
    """The largest distance of a body from a joint that moves it (m)."""
    return float(sum(np.linalg.norm(joint.position) for joint in mechanism.joints)) + reach(mechanism)
