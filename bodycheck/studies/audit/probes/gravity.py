"""The probe of gravity: substeps, and whether a step moves the body before gravity acts on it."""

from bodycheck.studies.audit.flights import NotFlown, Pilot
from bodycheck.studies.audit.probe import Finding
from bodycheck.studies.audit.probes.answers import not_probed
from bodycheck.studies.audit.probes.falling import falling

#: The largest relative deviation of a number of substeps from an integer.
NEAR = 0.02

#: The largest number of substeps that can be told from a displacement of second order.
MOST = 50


def gravity(pilot: Pilot) -> tuple[Finding, ...]:
    """Return findings of substeps and gravity-after-position."""
    seen = falling(pilot)
    if isinstance(seen, NotFlown):
        return not_probed("gravity", seen.reason, "substeps", "gravity-after-position")
    lead = 2 * seen.weight - 1
    after = lead < -1 / MOST
    words = "gravity: a step moves the body by its old velocity" if after else "gravity"
    return _substeps(lead), Finding("gravity-after-position", words, "found" if after else "none")


def _substeps(lead: float) -> Finding:
    """Return the finding of substeps, the number of which is 1 / |2 a - 1| for the weight a of the new velocity."""
    if abs(lead) <= 1 / MOST:
        reason = "the displacement in a step is of second order, and so it is with any number of substeps"
        return not_probed("gravity", reason, "substeps")[0]
    number = 1 / abs(lead)
    if abs(number / round(number) - 1) > NEAR:
        reason = f"the new velocity has the weight {lead / 2 + 0.5:.3g} in the displacement, which is that of no equal substeps"
        return not_probed("gravity", reason, "substeps")[0]
    several = round(number) > 1
    return Finding("substeps", "gravity", "found" if several else "none", round(number) if several else None, "", "1")
