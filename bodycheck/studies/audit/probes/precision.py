"""The probe of precision: how many binary digits the numbers of a falling body have."""

import numpy as np

from bodycheck.judging.schemes.scheme_rounding import ROUNDOFF
from bodycheck.studies.audit.flights import NotFlown, Pilot
from bodycheck.studies.audit.probe import Finding
from bodycheck.studies.audit.probes.answers import not_probed
from bodycheck.studies.audit.probes.falling import fall

#: Binary digits of the significands of single and double precision.
SINGLE, DOUBLE = 24, 53

#: The least number of changes of a value that tell. One of double precision fits into single precision once in 2^29.
ENOUGH = 8


def precision(pilot: Pilot) -> tuple[Finding, ...]:
    """Return a finding of single-precision."""
    digits = significand(pilot)
    if isinstance(digits, NotFlown):
        return not_probed("precision", digits.reason, "single-precision")
    if digits == SINGLE:
        return (Finding("single-precision", "precision", "found", SINGLE, "binary digits", str(DOUBLE)),)
    return (Finding("single-precision", "precision", "none", expected=str(DOUBLE)),)


def significand(pilot: Pilot) -> int | NotFlown:
    """Return the number of binary digits, that of single or of double precision, in which a method keeps its states.

    A body falls, and all its heights or all its velocities are numbers of single precision if they are kept in it. Both are
    looked at because an adapter may convert one of them in double precision.
    """
    flown = pilot.recall(fall(pilot.timestep))
    if isinstance(flown, NotFlown):
        return flown
    values = flown.states[:, [*range(3), *range(7, 13)]]
    varied = (values[1:] != values[:-1]).sum(axis=0) >= ENOUGH
    if not varied.any():
        return NotFlown("the body does not fall")
    with np.errstate(over="ignore"):
        single = (values == values.astype(np.float32)).all(axis=0)
    return SINGLE if (varied & single).any() else DOUBLE


def roundoff(pilot: Pilot) -> float:
    """Return the unit roundoff of a method: that of the precision found, or the adapter's if that is larger."""
    return max(pilot.roundoff, ROUNDOFF["float32"] if significand(pilot) == SINGLE else 0.0)
