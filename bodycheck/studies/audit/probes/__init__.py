"""The probes of the audit. Each looks for a few properties of a method by flights whose motion is obvious."""

from collections.abc import Mapping

from bodycheck.studies.audit.probe import Probe
from bodycheck.studies.audit.probes.damping import damping, energy
from bodycheck.studies.audit.probes.falling import gravity, precision, time_base
from bodycheck.studies.audit.probes.limits import limits, turning
from bodycheck.studies.audit.probes.representation import representation
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
}
