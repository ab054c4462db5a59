"""Probes of losses: the damping of the speed and the spin of a sphere in uniform motion, and the energy of a top.

The speed u of a sphere on which nothing acts is constant. By a law of damping du/dt = -(c + k u) u, the rate -d(ln u)/dt is
c + k u, and it is measured at two speeds. The loss by the truncation error of a scheme vanishes with the time step, but the
loss by a law of damping does not. Therefore the rates are also measured with twice the time step, and extrapolated to a time
step of 0.

Because of its symmetry, a symmetrical top gains or loses the same rotational energy in every step of a scheme, so that the
energy does not oscillate. The loss by the damping that was found is not counted again.
"""

from dataclasses import dataclass
from math import expm1, log, tau
from typing import Literal

import numpy as np

from bodycheck.reference.scene import Scene, State
from bodycheck.reference.trajectory import Array
from bodycheck.studies.audit.flights import Flight, NotFlown, Pilot
from bodycheck.studies.audit.probe import Finding, Property, not_probed
from bodycheck.studies.audit.probes.conventions import watch
from bodycheck.studies.audit.probes.falling import roundoff
from bodycheck.studies.audit.probes.scenes import TOP, coast

#: Speeds (m/s) and spins (rad/s) of the two launches.
SLOW, FAST = 1.0, 8.0

#: The number of steps, and the shortest time step (s). With shorter steps, rounding would cause larger errors of a rate.
STEPS, SHORTEST = 32, 4e-3

#: The largest relative change of a speed in a step that rounding in some dozen operations can explain, in units of roundoff.
ROUNDINGS = 16

#: The smallest rate (1/s) that counts as damping: a loss of 3 % a year. Iterative solvers cause smaller rates.
LEAST = 1e-9

#: The smallest fraction of a rate that a term of the law must contribute, because mean speeds over a flight are not exact.
SHARE = 0.002

#: A coefficient belongs to a law if more than this fraction of it remains with half the time step. The fraction is 1 for a law,
#: and half or less for a truncation error.
LASTS = 0.6

#: The angular velocity (rad/s) of the top: one turn per second.
TOP_SPIN = (0.6 * tau, 0.0, 0.8 * tau)

#: The number of turns of the top, and the number of samples.
TURNS, SAMPLES = 2, 20

#: The largest relative change of the energy in a step that rounding can explain, in units of roundoff.
ENERGY_ROUNDINGS = 4

#: The relative error that the measured loss by damping may have.
DAMPING_OFF = 0.01

#: The columns of the velocity and the angular velocity.
Columns = Literal["velocity", "angular velocity"]
PLACES: dict[Columns, slice] = {"velocity": slice(7, 10), "angular velocity": slice(10, 13)}


@dataclass(frozen=True)
class Law:
    """A law of damping: the coefficients c (1/s) and k (1/m or 1/rad), which are 0 for terms that the law lacks.

    Parameters
    ----------
    linear, quadratic
        The coefficients, extrapolated to a time step of 0.
    stepped
        The coefficients measured with the audited time step, or with `SHORTEST` if that is larger. They describe the damping
        that the scheme makes of the law at this time step.
    """

    linear: float = 0.0
    quadratic: float = 0.0
    stepped: tuple[float, float] = (0.0, 0.0)

    def loss(self, speeds: Array, times: Array) -> float:
        """Return the decrease of the logarithm of a speed by the coefficients `stepped`.

        speeds: the speeds (n,). times: their instants (n,), s.
        """
        return float(np.trapezoid(self.stepped[0] + self.stepped[1] * speeds, times))


def damping(pilot: Pilot) -> tuple[Finding, ...]:
    """Return findings about linear-damping, angular-damping, and quadratic-damping of the velocity and the angular velocity."""
    return (
        *_findings(pilot, "velocity", "linear-damping", "1/m"),
        *_findings(pilot, "angular velocity", "angular-damping", "1/rad"),
    )


def law(pilot: Pilot, which: Columns) -> Law | NotFlown:
    """Return the law by which a method damps the velocity or the angular velocity."""
    here = _rates(pilot, which, 1)
    if isinstance(here, NotFlown):
        return here
    allowed = ROUNDINGS * roundoff(pilot) / max(SHORTEST, pilot.timestep)
    if float(np.abs(here[0]).max()) <= allowed:
        return Law()
    coarser = _rates(pilot, which, 2)
    if isinstance(coarser, NotFlown):
        return coarser
    # Rates with double steps have half the rounding error. Twice the rates with single steps, less the rates with double steps,
    # therefore have 2.5 times the rounding error of single steps.
    least = max(2.5 * allowed, LEAST, SHARE * float(np.abs(here[0]).max()))
    fine, coarse, speeds = _coefficients(*here), _coefficients(*coarser), (1.0, float(here[1].max()))
    linear, quadratic = (
        2 * b - a if abs(2 * b - a) * speed > least and b / a > LASTS else 0.0
        for a, b, speed in zip(coarse, fine, speeds, strict=True)
    )
    return Law(linear, quadratic, fine) if linear or quadratic else Law()


def _coefficients(rates: Array, speeds: Array) -> tuple[float, float]:
    """Return the coefficients c and k from the rates c + k u (2,) at two speeds u (2,).

    If a limit makes the two speeds nearly equal, k is 0.
    """
    if abs(speeds[1] - speeds[0]) < 0.1 * speeds[1]:
        return float(rates.mean()), 0.0
    quadratic = float((rates[1] - rates[0]) / (speeds[1] - speeds[0]))
    return float(rates[0]) - quadratic * float(speeds[0]), quadratic


def _rates(pilot: Pilot, which: Columns, multiple: int) -> Array | NotFlown:
    """Return an array (2, 2) with the rates (1/s) of both launches and their mean speeds, at a multiple of the time step."""
    rates, timestep = [], multiple * max(SHORTEST, pilot.timestep)
    for speed in (SLOW, FAST):
        states = watch(pilot, Flight(coast(speed, speed), timestep, (1,) * STEPS))
        if isinstance(states, NotFlown):
            return states
        speeds = np.linalg.norm(states[:, PLACES[which]], axis=1)
        if not speeds.min() > 0.0:
            return NotFlown(f"the {which} vanishes")
        duration = (STEPS - 1) * timestep
        rates.append((-np.log(speeds[-1] / speeds[0]) / duration, np.trapezoid(speeds) / (STEPS - 1)))
    return np.array(rates).T


def _findings(pilot: Pilot, which: Columns, linear: Property, unit: str) -> tuple[Finding, ...]:
    damping_law, name = law(pilot, which), f"damping: of the {which}"
    if isinstance(damping_law, NotFlown):
        return not_probed(name, damping_law.reason, linear, "quadratic-damping")
    return (_finding(linear, name, damping_law.linear, "1/s"), _finding("quadratic-damping", name, damping_law.quadratic, unit))


def _finding(which: Property, name: str, coefficient: float, unit: str) -> Finding:
    if not coefficient:
        return Finding(which, name, "none", expected="0")
    return Finding(which, name, "found", coefficient, unit, "0")


def spinning_top(pilot: Pilot) -> Flight:
    """Return the flight of the spinning top."""
    steps = max(1, round(TURNS / SAMPLES / pilot.timestep))
    return Flight(Scene(TOP, State(angular_velocity=TOP_SPIN)), pilot.timestep, (steps,) * SAMPLES)


def energy(pilot: Pilot) -> tuple[Finding, ...]:
    """Return a finding about the property energy-per-turn, whose value is the relative change of the energy in a turn."""
    flight = spinning_top(pilot)
    states, damped = watch(pilot, flight), law(pilot, "angular velocity")
    for result in (states, damped):
        if isinstance(result, NotFlown):
            return not_probed("energy", result.reason, "energy-per-turn")
    assert not isinstance(states, NotFlown)
    assert not isinstance(damped, NotFlown)
    times = np.array([0, *np.cumsum(flight.strides)]) * pilot.timestep
    spins = np.concatenate([[TOP_SPIN], states[:, 10:]])
    rates = np.linalg.norm(spins, axis=1)
    turns = float(np.trapezoid(rates, times)) / tau
    lost = 2 * damped.loss(rates, times)
    change = log(_energy(spins[-1]) / _energy(spins[0])) + lost
    allowed = ENERGY_ROUNDINGS * roundoff(pilot) * sum(flight.strides) + DAMPING_OFF * abs(lost)
    if not abs(change) > allowed:
        return (Finding("energy-per-turn", "energy", "none", expected="0"),)
    return (Finding("energy-per-turn", "energy", "found", expm1(change / turns), "", "0"),)


def _energy(spin: Array) -> float:
    return float(np.array(TOP.moments) @ spin**2) / 2
