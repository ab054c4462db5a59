"""The probe of energy: what a symmetrical top gains or loses of its rotational energy in each turn.

By its symmetry a scheme changes the energy in every step alike, so that nothing oscillates. What the damping that was found
takes is not counted again.
"""

from math import expm1, log, tau

import numpy as np

from bodycheck.reference.scene import Scene, State
from bodycheck.reference.trajectory import Array
from bodycheck.studies.audit.flights import Flight, NotFlown, Pilot
from bodycheck.studies.audit.probe import Finding
from bodycheck.studies.audit.probes.answers import not_probed, watch
from bodycheck.studies.audit.probes.damping import law
from bodycheck.studies.audit.probes.precision import roundoff
from bodycheck.studies.audit.probes.scenes import TOP

#: One turn a second (rad/s).
SPIN = (0.6 * tau, 0.0, 0.8 * tau)

TURNS, SAMPLES = 2, 20

#: The relative change of the energy in a step, in units of roundoff, that rounding explains.
ROUNDINGS = 4

#: The part of the loss to damping by which the measured damping may be off.
DAMPING_OFF = 0.01


def spinning_top(pilot: Pilot) -> Flight:
    """Return the flight of the top."""
    steps = max(1, round(TURNS / SAMPLES / pilot.timestep))
    return Flight(Scene(TOP, State(angular_velocity=SPIN)), pilot.timestep, (steps,) * SAMPLES)


def energy(pilot: Pilot) -> tuple[Finding, ...]:
    """Return a finding of energy-per-turn."""
    flight = spinning_top(pilot)
    states, damped = watch(pilot, flight), law(pilot, "angular velocity")
    for result in (states, damped):
        if isinstance(result, NotFlown):
            return not_probed("energy", result.reason, "energy-per-turn")
    assert not isinstance(states, NotFlown)
    assert not isinstance(damped, NotFlown)
    times = np.array([0, *np.cumsum(flight.strides)]) * pilot.timestep
    spins = np.concatenate([[SPIN], states[:, 10:]])
    rates = np.linalg.norm(spins, axis=1)
    turns = float(np.trapezoid(rates, times)) / tau
    lost = 2 * damped.loss(rates, times)
    change = log(_energy(spins[-1]) / _energy(spins[0])) + lost
    allowed = ROUNDINGS * roundoff(pilot) * sum(flight.strides) + DAMPING_OFF * abs(lost)
    if not abs(change) > allowed:
        return (Finding("energy-per-turn", "energy", "none", expected="0"),)
    return (Finding("energy-per-turn", "energy", "found", expm1(change / turns), "", "0"),)


def _energy(spin: Array) -> float:
    return float(np.array(TOP.moments) @ spin**2) / 2
