"""Probes of limits: the largest speed and the largest spin that a sphere can have, and its largest turn in one step.

A sphere is launched very fast, and at half that speed. The time steps are so short that damping has no effect and that a limit
of the turn in a step is not reached. If both launches end with the same speed, there is a limit.

Then the sphere spins so fast that it turns by most of a revolution in a step, and also more slowly. A scheme may turn it by
another angle than h w: a scheme that advances the quaternion linearly turns it by 2 atan(h w / 2). But only a limit makes all
turns equal.
"""

import numpy as np

from bodycheck.reference.kinematics import geodesic_angle
from bodycheck.reference.trajectory import Array
from bodycheck.studies.audit.flights import Flight, NotFlown, Pilot
from bodycheck.studies.audit.probe import Finding, Property, not_probed
from bodycheck.studies.audit.probes.conventions import watch
from bodycheck.studies.audit.probes.scenes import coast

#: The speed (m/s) and the spin (rad/s) of the faster launch; the other launch has half of both.
LAUNCH = 1e4

#: The largest limit that is searched for. Larger values are not reported, because a launch may lose a tenth to damping.
LARGEST = 9e3

#: The time step (s) and the number of steps.
TIMESTEP, STEPS = 1e-5, 3

#: Relative deviation below which speeds count as equal. Rounding in single precision and damping change them less.
SAME = 1e-2

#: The turns (rad) in a step: the first set that a method completes without giving up is used.
TURNS = ((6.0, 5.5, 5.0), (1.2, 1.1, 1.0))

#: The spin (rad/s) of the largest turn, and the largest fraction of a spin limit that it may be.
SPIN, BELOW_LIMIT = 30.0, 0.8

#: Relative deviation below which turns count as equal. Without a limit, the turns of a scheme differ by some percent.
SAME_TURN = 2e-3


def limits(pilot: Pilot) -> tuple[Finding, ...]:
    """Return findings about the properties speed-limit and spin-limit."""
    return (
        _finding("speed-limit", _limit(pilot, slice(7, 10)), "m/s"),
        _finding("spin-limit", spin_limit(pilot), "rad/s"),
    )


def spin_limit(pilot: Pilot) -> tuple[float, str] | NotFlown | None:
    """Return the limit of the spin (rad/s) and a description of it; None if there is no limit up to `LARGEST`."""
    return _limit(pilot, slice(10, 13))


def _limit(pilot: Pilot, columns: slice) -> tuple[float, str] | NotFlown | None:
    fast, half = (watch(pilot, Flight(coast(size, size), TIMESTEP, (1,) * STEPS)) for size in (LAUNCH, LAUNCH / 2))
    if isinstance(fast, NotFlown):
        return fast
    if isinstance(half, NotFlown):
        return half
    vectors = [_slower(states, columns) for states in (fast, half)]
    sizes = [float(np.linalg.norm(vector)) for vector in vectors]
    limited = abs(sizes[0] / sizes[1] - 1) < SAME or abs(sizes[1] / (LAUNCH / 2) - 1) < SAME
    if sizes[0] > LARGEST or not limited:
        return None
    components = np.abs(vectors[0])
    if np.ptp(components) < SAME * components.max():
        return float(components.max()), "of each component"
    return sizes[0], ""


def _slower(states: Array, columns: slice) -> Array:
    """Return a velocity (3,) from the last state, by its columns.

    For the columns of the linear velocity, the last displacement divided by the time step is returned if it is slower.
    """
    vector = states[-1, columns]
    moved = (states[-1, :3] - states[-2, :3]) / TIMESTEP
    slower = columns == slice(7, 10) and np.linalg.norm(moved) < (1 - SAME) * np.linalg.norm(vector)
    return moved if slower else vector


def _finding(which: Property, limit: tuple[float, str] | NotFlown | None, unit: str) -> Finding:
    if isinstance(limit, NotFlown):
        return not_probed("limits", limit.reason, which)[0]
    expected = f"none below {LARGEST:g} {unit}"
    if limit is None:
        return Finding(which, "limits", "none", expected=expected)
    return Finding(which, ": ".join(filter(None, ("limits", limit[1]))), "found", limit[0], unit, expected)


def turning(pilot: Pilot) -> tuple[Finding, ...]:
    """Return a finding about the property turn-limit."""
    limit = spin_limit(pilot)
    spin = min(SPIN, BELOW_LIMIT * limit[0]) if isinstance(limit, tuple) else SPIN
    for wanted in TURNS:
        timestep = wanted[0] / spin
        flown = [watch(pilot, Flight(coast(0.0, turn / timestep), timestep, (1, 1))) for turn in wanted]
        seen = [_turns(states, timestep) for states in flown if not isinstance(states, NotFlown)]
        if len(seen) == len(wanted):
            return (_turn_finding(np.array(wanted), np.array(seen)),)
    reason = next(states.reason for states in flown if isinstance(states, NotFlown))
    return not_probed("turning", reason, "turn-limit")


def _turns(states: Array, timestep: float) -> Array:
    """Return the turns (rad) in two steps (2, 2): the first column by the spin, the second by the attitudes, at most pi."""
    attitudes = np.concatenate([[(1.0, 0.0, 0.0, 0.0)], states[:, 3:7]])
    by_spin = np.linalg.norm(states[:, 10:], axis=1) * timestep
    return np.stack([by_spin, geodesic_angle(attitudes[:-1], attitudes[1:])], axis=1)


def _turn_finding(wanted: Array, seen: Array) -> Finding:
    """Return the finding from the turns (rad) of the launches in a step (n,) and the turns observed (n, 2, 2) by `_turns`."""
    expected = f"none below {wanted[0]:g} rad"
    for step in (0, 1):
        for way, words in enumerate(("of the angular velocity", "of the attitude alone")):
            turns = seen[:, step, way]
            if turns[0] > 0.0 and np.ptp(turns) < SAME_TURN * turns[0] and turns[0] < wanted[-1]:
                return Finding("turn-limit", f"turning: {words}", "found", float(turns[0]), "rad per step", expected)
    return Finding("turn-limit", "turning", "none", expected=expected)
