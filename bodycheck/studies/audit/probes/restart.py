"""The probe of hidden state: a run that is continued, against a run that is restarted from its positions and velocities.

A box slides and spins on a plane, and three boxes stand on one another. In mechanics their positions and velocities determine
their further motion. An engine that keeps something else from step to step, such as the age of a contact, or the impulses of
the last step from which it begins the next solution, moves otherwise after a restart.

Contacts may amplify rounding. Two further restarts, from states that differ by rounding, show by how much.
"""

from collections.abc import Mapping

import numpy as np

from bodycheck.reference.kinematics import normalise
from bodycheck.reference.mechanisms.mechanism import BodyStart, JointedBody, Mechanism
from bodycheck.reference.scene import Brick, Plane, Solid, vector_of
from bodycheck.reference.trajectory import Array
from bodycheck.studies.audit.flights import Flight, NotFlown, Pilot
from bodycheck.studies.audit.probe import Finding, not_probed

#: The boxes, and the mass of each (kg).
BOX, MASS = Brick((0.2, 0.15, 0.05)), 1.0

#: The gravitational acceleration (m/s^2) and the coefficient of friction.
GRAVITY, FRICTION = 9.81, 0.4

#: The initial states (bodies, 13) of the boxes in each scene, by words.
SCENES: Mapping[str, Array] = {
    "a box that slides and spins": np.array([[0.0, 0.0, 0.05, 1.0, 0.0, 0.0, 0.0, 1.5, 0.75, 0.0, 0.0, 0.0, 3.0]]),
    "three boxes on one another": np.array(
        [[x, 0.0, z, 1.0, *(0.0,) * 9] for x, z in ((0.0, 0.05), (0.05, 0.15), (-0.03, 0.25))],
    ),
}

#: The number of steps before the restart, and after it.
BEFORE, AFTER = 20, 100

#: The largest difference in a step that rounding can explain, in units of roundoff.
ROUNDINGS_A_STEP = 2

#: The relative changes of the states of the further restarts, in units of roundoff, and the multiple of their effect that
#: rounding can explain.
NUDGES, AMPLIFIED = (-2, 2), 4


def restart(pilot: Pilot) -> tuple[Finding, ...]:
    """Return findings about the property hidden-state, one for each of `SCENES`.

    The value is the largest difference of a component, in m, m/s, rad/s or without unit, `AFTER` steps after the restart. The
    components are of the size of 1.
    """
    return tuple(_finding(pilot, words, start) for words, start in SCENES.items())


def _finding(pilot: Pilot, words: str, start: Array) -> Finding:
    name = f"restart: {words}"
    first = pilot.fly(Flight(lying(start), pilot.timestep, (BEFORE, AFTER)))
    if isinstance(first, NotFlown):
        return not_probed(name, first.reason, "hidden-state")[0]
    if not np.isfinite(first.states).all():
        return not_probed(name, "its states are not numbers", "hidden-state")[0]
    seen, continued = first.states
    restarted = []
    for nudge in (0, *NUDGES):
        again = pilot.fly(Flight(lying(seen * (1 + nudge * pilot.roundoff)), pilot.timestep, (AFTER,)))
        if isinstance(again, NotFlown):
            return not_probed(name, again.reason, "hidden-state")[0]
        restarted.append(again.states[0])
    same, *nudged = restarted
    difference = float(np.abs(continued - same).max())
    amplified = AMPLIFIED * float(np.abs(np.array(nudged) - same).max())
    hidden = not difference <= max(amplified, ROUNDINGS_A_STEP * pilot.roundoff * AFTER)
    said = f"{name}, {AFTER} steps after a restart"
    return Finding("hidden-state", said, "found" if hidden else "none", difference, "", "0")


def lying(states: Array) -> Mechanism:
    """Return the scene of boxes on the plane, in the states (bodies, 13)."""
    bodies = [
        JointedBody(f"box {number}", Solid(BOX, MASS), start=_start(state), shape=BOX) for number, state in enumerate(states)
    ]
    return Mechanism(tuple(bodies), gravity=GRAVITY, plane=Plane(friction=FRICTION))


def _start(state: Array) -> BodyStart:
    w, x, y, z = normalise(state[3:7]).tolist()
    return BodyStart(vector_of(state[:3]), (w, x, y, z), vector_of(state[7:10]), vector_of(state[10:]))
