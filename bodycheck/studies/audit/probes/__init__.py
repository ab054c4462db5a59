"""The probes of the audit. Each looks for a few properties of a method by flights whose motion is obvious."""

from collections.abc import Mapping

from bodycheck.adapters.method import Kind
from bodycheck.studies.audit.probe import Probe
from bodycheck.studies.audit.probes.damping import damping, energy
from bodycheck.studies.audit.probes.falling import gravity, precision, time_base
from bodycheck.studies.audit.probes.friction import friction
from bodycheck.studies.audit.probes.impact import impact
from bodycheck.studies.audit.probes.limits import limits, turning
from bodycheck.studies.audit.probes.permutation import permutation
from bodycheck.studies.audit.probes.representation import representation
from bodycheck.studies.audit.probes.restart import restart
from bodycheck.studies.audit.probes.returned_states import returned_states
from bodycheck.studies.audit.probes.stopping import resets, sleeping
from bodycheck.studies.audit.probes.tumbling import gyroscopic, scales

#: The probes by name, in the order in which they are made.
PROBES: Mapping[str, Probe] = {
    "precision": precision,
    "damping": damping,
    "limits": limits,
    "turning": turning,
    "gyroscopic": gyroscopic,
    "gravity": gravity,
    "sleeping": sleeping,
    "returned-states": returned_states,
    "time-base": time_base,
    "resets": resets,
    "energy": energy,
    "scales": scales,
    "representation": representation,
    "friction": friction,
    "impact": impact,
    "restart": restart,
    "permutation": permutation,
}

#: The kind of scene for which a method must be offered, so that a probe is made of it. A probe that is not listed is a flight.
SCENES: Mapping[str, Kind] = {"friction": "plane", "impact": "plane", "restart": "plane", "permutation": "mechanism"}
