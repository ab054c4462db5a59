"""Findings of the probes, and the states that they look at."""

import numpy as np

from bodycheck.reference.trajectory import Array
from bodycheck.studies.audit.flights import Flight, NotFlown, Pilot
from bodycheck.studies.audit.probe import Finding, Property
from bodycheck.studies.audit.probes.conventions import convention, in_contract


def watch(pilot: Pilot, flight: Flight) -> Array | NotFlown:
    """Return the states (n, 13) of a flight in the columns and frames of the contract, however the method returns them."""
    known, flown = convention(pilot), pilot.recall(flight)
    if isinstance(flown, NotFlown):
        return flown
    if not np.isfinite(flown.states).all():
        return NotFlown("its states are not numbers")
    return flown.states if isinstance(known, NotFlown) else in_contract(flown.states, known)


def not_probed(name: str, reason: str, *properties: Property) -> tuple[Finding, ...]:
    """Return that a probe cannot tell of some properties, and why."""
    return tuple(Finding(own, f"{name}: {reason}", "not-probed") for own in properties)
