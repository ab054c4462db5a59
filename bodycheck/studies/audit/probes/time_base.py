"""The probe of the time base: whether a step lasts as long as it should."""

from bodycheck.studies.audit.flights import NotFlown, Pilot
from bodycheck.studies.audit.probe import Finding
from bodycheck.studies.audit.probes.answers import not_probed
from bodycheck.studies.audit.probes.falling import falling
from bodycheck.studies.audit.probes.precision import roundoff

#: The largest relative deviation, in units of roundoff, that rounding explains: the heights of 64 steps are fitted.
ROUNDINGS = 1000


def time_base(pilot: Pilot) -> tuple[Finding, ...]:
    """Return a finding of time-base: the displacement in a step divided by velocity and time step, less 1."""
    seen = falling(pilot)
    if isinstance(seen, NotFlown):
        return not_probed("time base", seen.reason, "time-base")
    off = seen.timestep / pilot.timestep - 1
    found = abs(off) > max(ROUNDINGS * roundoff(pilot), seen.uncertainty)
    return (Finding("time-base", "time base", "found" if found else "none", off if found else None, "", "0"),)
