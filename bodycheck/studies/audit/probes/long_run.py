"""The probe of very many steps: the time that they take, and the norm of the quaternion after them.

A sphere moves and spins uniformly for ten million steps, or for as many as an engine takes in three minutes. Errors of rounding
add up: the sum of the time steps differs from their number times the time step, positions in single precision stop growing when
a step is less than their last digit, and a quaternion that is never normalised loses its norm.
"""

from time import monotonic

import numpy as np

from bodycheck.adapters.contract import EngineDiverged, Method, Normalising, SceneUnsupported
from bodycheck.judging.schemes.scheme_rounding import ROUNDOFF
from bodycheck.reference.trajectory import Array
from bodycheck.studies.audit.flights import Flight, NotFlown, Pilot
from bodycheck.studies.audit.probe import OF_LONG_RUNS, Finding, not_probed
from bodycheck.studies.audit.probes.scenes import DIRECTION, coast

#: The name of the probe.
NAME = "long-run"

#: The largest number of steps, the number of steps between two samples, and the time (s) after which no further steps begin.
STEPS, STRIDE, LIMIT_S = 10**7, 1000, 180.0

#: The speed (m/s) and the spin (rad/s) of the sphere.
SPEED, SPIN = 1.0, 1.0

#: The smallest relative change of the speed by which the motion no longer is uniform.
SLOWS = 1e-6

#: The largest deviation of a norm from 1 that rounding can explain if quaternions are normalised, in units of roundoff.
ROUNDINGS = 16


def long_run(pilot: Pilot) -> tuple[Finding, ...]:
    """Return findings about the properties long-time-base and long-quaternion-norm, with the number of steps.

    The value of long-time-base is the path of the sphere divided by its speed, the time step and the number of steps, minus 1.
    More than the rounding of sums in double precision is a finding.
    """
    flown = steps_taken(pilot)
    if isinstance(flown, NotFlown):
        return not_probed(NAME, flown.reason, *OF_LONG_RUNS)
    steps, state, norm = flown
    words = f"{NAME}: {steps} steps"
    return (_time(pilot, steps, state, words), _norm(pilot, norm, words))


def steps_taken(pilot: Pilot) -> tuple[int, Array, float] | NotFlown:
    """Return the number of steps that were taken, the last state (13,), and the largest deviation of a norm from 1."""
    method, began = Method.parse(pilot.integrator, pilot.timestep), monotonic()
    off, steps = 0.0, 0
    try:
        simulation = pilot.simulation(Flight(coast(SPEED, SPIN), pilot.timestep, ()), method)
        while True:
            state = simulation.advance(np.array([STRIDE]))[0, 0, 0]
            steps += STRIDE
            off = max(off, abs(float(np.linalg.norm(state[3:7])) - 1))
            if steps >= STEPS or monotonic() - began >= LIMIT_S:
                break
    except (SceneUnsupported, EngineDiverged) as error:
        return NotFlown(f"{error}; after {steps} steps")
    if isinstance(simulation, Normalising):
        off = max(off, simulation.quaternion_norm_error)
    return (steps, state, off) if np.isfinite(state).all() else NotFlown(f"its states are not numbers after {steps} steps")


def _time(pilot: Pilot, steps: int, state: Array, words: str) -> Finding:
    speed = float(np.linalg.norm(state[7:10]))
    if abs(speed / SPEED - 1) > SLOWS:
        return not_probed(words, f"the speed is {speed:.3g} of what it was", "long-time-base")[0]
    off = float(state[:3] @ np.array(DIRECTION)) / (SPEED * steps * pilot.timestep) - 1
    wrong = abs(off) > steps * ROUNDOFF["float64"]
    return Finding("long-time-base", words, "found" if wrong else "none", off, "", "0")


def _norm(pilot: Pilot, norm: float, words: str) -> Finding:
    wrong = norm > ROUNDINGS * pilot.roundoff
    return Finding("long-quaternion-norm", words, "found" if wrong else "none", norm, "", "0")
