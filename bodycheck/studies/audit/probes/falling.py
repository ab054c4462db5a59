"""Probes of precision, of the time base and of gravity, by a falling body.

- precision: the number of binary digits in the states of a falling body;
- time base: whether a step advances the body by the time step;
- gravity: substeps, and whether a step moves the body before gravity acts on it.

In each step of h' seconds the height changes by h' ((1 - a) v_old + a v_new). If a = 1, the velocity is advanced before the
position; if a = 0, it is advanced after the position; if a = 1/2, the displacement is of second order. With n equal substeps
that each advance the velocity first, a = (n + 1) / (2 n), because the velocity grows evenly over the substeps. With n equal
substeps that each advance the position first, a = (n - 1) / (2 n).
"""

from dataclasses import dataclass

import numpy as np

from bodycheck.judging.schemes.scheme_rounding import ROUNDOFF
from bodycheck.reference.scene import Scene, State
from bodycheck.studies.audit.flights import Flight, NotFlown, Pilot
from bodycheck.studies.audit.probe import Finding, not_probed
from bodycheck.studies.audit.probes.conventions import watch
from bodycheck.studies.audit.probes.scenes import SPHERE

#: The number of steps of the fall.
STEPS = 64

#: The launch. Its numbers are not numbers of single precision, and the body is too fast to be put to sleep.
LAUNCH = State((0.0, 0.0, 0.1), velocity=(0.0, 0.0, -1.1))

#: Binary digits of the significands of single and double precision.
SINGLE, DOUBLE = 24, 53

#: The smallest number of changes of a value from which its precision is determined. By chance, one number of double precision
#: in 2^29 is also a number of single precision.
ENOUGH = 8

#: The largest relative deviation of the time base that rounding can explain, in units of roundoff. It is fitted to 64 steps.
TIME_ROUNDINGS = 1000

#: The largest relative deviation of a number of substeps from an integer.
NEAR_INTEGER = 0.02

#: The largest number of substeps that can be distinguished from a displacement of second order.
MOST_SUBSTEPS = 50


@dataclass(frozen=True)
class Fall:
    """The fall of a body: the time for which it moves in a step, and the relation of its displacement to its velocities.

    Parameters
    ----------
    timestep
        The time (s) for which the body moves in a step.
    weight
        The weight a of the new velocity in the displacement of a step.
    uncertainty
        The relative error that `timestep` may have, because the fit has residuals, and because the acceleration changes during
        a step if damping acts on the velocities between substeps.
    """

    timestep: float
    weight: float
    uncertainty: float


def fall(timestep: float) -> Flight:
    """Return the flight of a falling body, with a state after every step."""
    return Flight(Scene(SPHERE, LAUNCH, gravity=9.81), timestep, (1,) * STEPS)


def falling(pilot: Pilot) -> Fall | NotFlown:
    """Return the fall of a body, or the reason why it cannot be determined.

    It is fitted to displacements and velocities, so that it depends neither on gravity nor on damping.
    """
    states = watch(pilot, fall(pilot.timestep))
    if isinstance(states, NotFlown):
        return states
    moved, old, new = np.diff(states[:, 2]), states[:-1, 9], states[1:, 9]
    change = float(np.abs(new - old).max())
    if not change > 0.0:
        return NotFlown("the body does not fall")
    parts = np.stack([(old + new) / 2, new - old], axis=1)
    timestep, part = np.linalg.lstsq(parts, moved)[0].tolist()
    uneven = float(np.ptp(new - old)) / float(np.abs(new).max()) / 100
    # The limit is a hundredth of the effect of the weight in a step. Larger residuals mean another law of displacement.
    residual = float(np.abs(parts @ [timestep, part] - moved).max())
    if not residual < 0.01 * pilot.timestep * change:
        return NotFlown("the displacement in a step is not a mean of its two velocities")
    return Fall(timestep, 0.5 + part / timestep, 10 * residual / float(np.abs(moved).max()) + uneven)


def precision(pilot: Pilot) -> tuple[Finding, ...]:
    """Return a finding about the property single-precision."""
    digits = significand(pilot)
    if isinstance(digits, NotFlown):
        return not_probed("precision", digits.reason, "single-precision")
    if digits == SINGLE:
        return (Finding("single-precision", "precision", "found", SINGLE, "binary digits", str(DOUBLE)),)
    return (Finding("single-precision", "precision", "none", expected=str(DOUBLE)),)


def significand(pilot: Pilot) -> int | NotFlown:
    """Return the number of binary digits with which a method keeps its states: `SINGLE` or `DOUBLE`.

    If all values of any changing component of the position or the velocities of a falling body are numbers of single precision,
    the states are kept in single precision. All components are examined, because an adapter may convert some of them in double
    precision.
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
    """Return the unit roundoff of a method: for the precision found, or for the adapter's stated precision if it is larger."""
    return max(pilot.roundoff, ROUNDOFF["float32"] if significand(pilot) == SINGLE else 0.0)


def time_base(pilot: Pilot) -> tuple[Finding, ...]:
    """Return a finding about the property time-base.

    Its value is the time for which a body moves in a step, divided by the time step, minus 1.
    """
    seen = falling(pilot)
    if isinstance(seen, NotFlown):
        return not_probed("time base", seen.reason, "time-base")
    off = seen.timestep / pilot.timestep - 1
    wrong = abs(off) > max(TIME_ROUNDINGS * roundoff(pilot), seen.uncertainty)
    return (Finding("time-base", "time base", "found" if wrong else "none", off if wrong else None, "", "0"),)


def gravity(pilot: Pilot) -> tuple[Finding, ...]:
    """Return findings about the properties substeps and gravity-after-position."""
    seen = falling(pilot)
    if isinstance(seen, NotFlown):
        return not_probed("gravity", seen.reason, "substeps", "gravity-after-position")
    lead = 2 * seen.weight - 1
    after = lead < -1 / MOST_SUBSTEPS
    words = "gravity: a step moves the body by its old velocity" if after else "gravity"
    return _substeps(lead), Finding("gravity-after-position", words, "found" if after else "none")


def _substeps(lead: float) -> Finding:
    """Return the finding about substeps, whose number is 1 / |lead|.

    lead: 2 a - 1, where a is the weight of the new velocity in a displacement.
    """
    if abs(lead) <= 1 / MOST_SUBSTEPS:
        reason = "the displacement in a step is of second order, and so it is with any number of substeps"
        return not_probed("gravity", reason, "substeps")[0]
    number = 1 / abs(lead)
    if abs(number / round(number) - 1) > NEAR_INTEGER:
        reason = f"the new velocity has the weight {lead / 2 + 0.5:.3g} in the displacement, which is that of no equal substeps"
        return not_probed("gravity", reason, "substeps")[0]
    several = round(number) > 1
    return Finding("substeps", "gravity", "found" if several else "none", round(number) if several else None, "", "1")
