"""The probe of precision: how many binary digits the numbers of a falling body have."""

import numpy as np

from bodycheck.judging.scheme_rounding import ROUNDOFF
from bodycheck.reference.trajectory import Array
from bodycheck.studies.audit.flights import NotFlown, Pilot
from bodycheck.studies.audit.probe import Finding
from bodycheck.studies.audit.probes.answers import not_probed
from bodycheck.studies.audit.probes.falling import fall

#: Binary digits of the significands of single and double precision.
SINGLE, DOUBLE = 24, 53

#: The least number of different values that tell. One of double precision fits into single precision once in 2^29.
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
    fits = [_fits(flown.states[:, column]) for column in (*range(3), *range(7, 13))]
    if not any(varied for varied, _ in fits):
        return NotFlown("the body does not fall")
    return SINGLE if any(varied and single for varied, single in fits) else DOUBLE


def roundoff(pilot: Pilot) -> float:
    """Return the unit roundoff of a method: that of the precision found, or the adapter's if that is larger."""
    return max(pilot.roundoff, ROUNDOFF["float32"] if significand(pilot) == SINGLE else 0.0)


def _fits(values: Array) -> tuple[bool, bool]:
    """Return whether values (n,) are enough different ones, and whether all of them are numbers of single precision."""
    with np.errstate(over="ignore"):
        single = values == values.astype(np.float32)
    return len(np.unique(values)) >= ENOUGH, bool(single.all())
