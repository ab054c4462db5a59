"""The estimated cost of the integration of a slide.

Ordinary slides take some hundred steps. Two kinds take many:

- A body whose moment of inertia is tiny for its face: friction brakes its spin much faster than its slide. The equations are
  stiff, and an explicit method takes steps that are no longer than a few times that shorter time. This is known beforehand.
- A body that turns often before friction stops it: its friction changes as its face turns, and is not smooth where the
  instantaneous centre crosses an edge. The cost of a turn depends on how near the centre comes to the edges. It is measured in
  the first steps, and the remaining angle is estimated from velocity and spin.
"""

import math

from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.sliding.friction import Law

#: Largest expected number of steps with which a slide is integrated; so many steps take some ten seconds.
MAX_SLIDE_STEPS = 10_000

#: Number of steps after which the cost of a motion with many turns is estimated; so many steps take half a second.
PROBED_STEPS = 500

#: Ratio of the largest number of steps that are taken to the largest expected number, since the pace of a motion changes.
PATIENCE = 1.2

#: Largest product of the step and a rate of decay at which DOP853 is stable.
STABLE_STEP = 6.3

#: Spin, in speeds over the radius of gyration, that is small for the derivative of the torque of friction.
SMALL_SPIN = 1e-4


def refuse_stiff(law: Law, mass: float, gyration: float, deceleration: float, v1: float, v2: float, lasting: float) -> None:
    """Raise `OutOfReach` for a body whose spin is braked so much faster than its slide that too many steps are needed.

    Parameters
    ----------
    law
        The law of friction.
    mass, gyration, deceleration
        Mass (kg), radius of gyration about the vertical (m), and deceleration mu g of a straight slide (m/s^2).
    v1, v2
        Initial velocity along the body axes I and J (m/s).
    lasting
        Duration of the motion in units of the time in which the speed falls by the factor e.
    """
    speed = math.hypot(v1, v2)
    if not 0 < speed < math.inf:
        return
    try:
        forward, backward = (law(v1 / speed, v2 / speed, spin / gyration)[2] for spin in (SMALL_SPIN, -SMALL_SPIN))
        faster = (backward - forward) / (2 * SMALL_SPIN) / gyration / mass / deceleration
    except (ArithmeticError, ValueError):  # beyond the range of doubles, which the integration notices
        return
    expected = faster * lasting / STABLE_STEP
    if expected > MAX_SLIDE_STEPS:
        raise OutOfReach(
            f"the slide would take some {expected:.2g} integration steps, since friction brakes the spin {faster:.2g} times "
            f"faster than the slide; {MAX_SLIDE_STEPS} steps are the limit"
        )


def turning_ahead(
    law: Law, mass: float, gyration: float, deceleration: float, speed: float, spin: float, duration: float
) -> float:
    """An estimate of the angle (rad) through which a body turns in a duration (s), or until it rests.

    Spin and slide each lengthen the time until rest, since friction is shared between them. The spin is assumed to fall at a
    constant rate.

    Parameters
    ----------
    law, mass, gyration, deceleration
        As for `refuse_stiff`.
    speed, spin
        Speed of the centre of mass (m/s) and spin (rad/s).
    duration
        The duration (s).
    """
    try:
        braking = abs(law(0.0, 0.0, 1.0)[2]) / gyration / gyration / mass
        rest = math.hypot(speed / deceleration, abs(spin) / braking)
        lasting = min(duration, rest)
        return abs(spin) * lasting * (1 - lasting / (2 * rest))
    except (ArithmeticError, ValueError):  # beyond the range of doubles, which the integration notices
        return 0.0


def refuse_long(taken: int, turned: float, left: float) -> None:
    """Raise `OutOfReach` where a motion would take too many steps.

    Nothing is estimated before half a turn, since friction on most faces repeats itself after half a turn.

    Parameters
    ----------
    taken
        Number of steps so far.
    turned, left
        The angles (rad) through which the body has turned so far, and will turn.
    """
    if turned < math.pi:
        return
    expected = taken * (1 + left / turned)
    if expected > MAX_SLIDE_STEPS:
        raise OutOfReach(
            f"the slide would take some {expected:.2g} integration steps, since the body turns through some "
            f"{turned + left:.2g} rad while it slides; {MAX_SLIDE_STEPS} steps are the limit"
        )
