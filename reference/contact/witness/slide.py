"""The slide of a body along a plane under a constant force and Coulomb friction, integrated in logarithmic time.

With D the force along the plane and c the force of friction, both per mass, v the velocity and x the position,

    dv/dq = |v| D - c v,    dx/dq = |v| v,    dt/dq = |v|.

These equations have no singular direction, and the stop is at infinity, where v decays exponentially. They hold for straight
and for oblique slides alike. All vectors have two components along the plane. Units of speed, time and length are those of the
start, so that |v| = 1 and |D| + c = 1.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.independent.arithmetic import Wide
from bodycheck.reference.integration.collocation import FINEST, Derivatives, Step, steps
from bodycheck.reference.witness import WideArray

#: The speed, relative to the speed at the start, below which a body has stopped. The time that is left is as short, in units of
#: the start.
STOPPED = 1e-22

#: The ratio of the velocity across the drive to the whole velocity below which it is rounding.
ALIGNED = 16 * FINEST

#: The number of nodes of a step, the size of the first step, and the largest number of evaluations of the equations.
STAGES, FIRST, MOST = 20, 0.5, 20_000

#: The factor by which an error may exceed the last terms of the series of the steps before it.
SAFETY = 8.0

#: The number of Newton's steps for the places of instants; each doubles the number of correct digits.
NEWTON = 12

#: The indices of the components of a state.
V, X, T = slice(0, 2), slice(2, 4), 4


@dataclass(frozen=True, eq=False)
class Piece:
    """A part of a slide, along a step of the integration.

    Attributes
    ----------
    step
        The step, in the units of the start.
    speed, time
        The units of speed (m/s) and of time (s).
    error
        The error of the velocity at its end, in units of the speed.
    stopped
        Whether the body stops at its end.
    """

    step: Step
    speed: Wide
    time: Wide
    error: float
    stopped: bool

    @property
    def until(self) -> Wide:
        """The time since the start of the slide at which the piece ends (s)."""
        return Wide(self.step.last()[T] * self.time)

    def states(self, times: WideArray) -> tuple[WideArray, WideArray]:
        """Displacements (n, 2), m, and velocities (n, 2), m/s, at times (n,) since the start of the slide (s)."""
        scaled = times / self.time
        first, last = self.step.state, self.step.last()
        duration = last[T] - first[T]  # zero shortly before a stop, where steps are shorter than the rounding of the time
        share = (scaled - first[T]) / duration if duration else np.ones_like(scaled)
        places = self.step.start + self.step.size * np.clip(share, 0, 1)
        for _ in range(NEWTON):
            rows = self.step.at(places)
            late = (scaled - rows[:, T]) / np.sqrt((rows[:, V] ** 2).sum(axis=1))
            places = np.clip(places + late, self.step.start, self.step.end)
        return self.at(places)

    def at(self, places: WideArray) -> tuple[WideArray, WideArray]:
        """Displacements (n, 2), m, and velocities (n, 2), m/s, at places (n,) of the step."""
        rows = self.step.at(places)
        return rows[:, X] * (self.speed * self.time), rows[:, V] * self.speed


def equations(excess: Wide, friction: Wide) -> Derivatives:
    """The derivatives (n, 5) of states (n, 5). excess: the drive, along the first axis, minus the friction; both scaled.

    With u the velocity along the drive, |v| D - c u = |v| (D - c) + c (|v| - u), so that a drive and a friction that are nearly
    equal are not subtracted from each other here.
    """

    def derivatives(states: WideArray) -> WideArray:
        velocity = states[:, V]
        along, across = velocity[:, 0], velocity[:, 1]
        speed = np.sqrt((velocity * velocity).sum(axis=1))
        slower = np.where(along > 0, across * across / (speed + np.abs(along)), speed - along)
        forces = np.stack([speed * excess + friction * slower, -friction * across], axis=1)
        return np.concatenate([forces, speed[:, None] * velocity, speed[:, None]], axis=1)

    return derivatives


def slide(velocity: WideArray, excess: Wide, friction: Wide) -> Iterator[Piece]:
    """Yield the pieces of a slide until the body stops, or without end.

    The velocity across the drive decays at a constant rate. When only rounding is left of it, it is set to zero, since steps
    could not become longer than this rate allows.

    Parameters
    ----------
    velocity
        (2,) the velocity at the start, along the drive and across it (m/s), not zero.
    excess, friction
        The drive minus the force of friction, and the force of friction, per mass (m/s^2).
    """
    speed, size = _length(velocity), excess + 2 * friction
    if not size:
        size = speed  # nothing accelerates the body, and any unit of time will do
    derivatives = equations(excess / size, friction / size)
    state = np.concatenate([velocity / speed, np.zeros(3, dtype=Wide)])
    first, error = FIRST, 0.0
    while True:
        for step in steps(derivatives, state, stages=STAGES, first=first, most=MOST, memory=1):
            error += max(step.error, FINEST) * float(step.size * np.abs(step.slopes).max())
            state = step.last()
            stopped = bool(_length(state[V]) < STOPPED)
            yield Piece(step, speed, speed / size, SAFETY * error, stopped)
            if stopped:
                return
            if state[1] and abs(state[1]) < ALIGNED * _length(state[V]):
                state[1], first, error = 0, float(step.size), error + ALIGNED
                break


def _length(vector: WideArray) -> Wide:
    return Wide(np.sqrt((vector * vector).sum()))
