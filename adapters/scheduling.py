"""Step a simulation from instant to instant of its controllers, and exert the efforts that `driving` computes."""

import math
from collections.abc import Iterator
from fractions import Fraction

import numpy as np

from bodycheck.adapters.contract import (
    Driven,
    Efforts,
    EngineDiverged,
    ErrorControlled,
    Method,
    Normalising,
    SceneUnsupported,
    Simulation,
    Staged,
    Strides,
    Work,
)
from bodycheck.adapters.driving import Controls, controls_of
from bodycheck.reference.mechanisms.control import SLACK, Controller
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.trajectory import Array


class Scheduled:
    """A simulation with steps of a fixed size whose joints are driven.

    Parameters
    ----------
    simulation
        The simulation of the engine.
    controls
        What drives the joints.
    timestep
        The time step (s).
    """

    def __init__(self, simulation: Driven, controls: Controls, timestep: float) -> None:
        self.simulation, self.controls, self.timestep, self.step = simulation, controls, timestep, 0

    def advance(self, strides: Strides) -> Array:
        """Return the states (1, n, bodies, 13) after each of n strides, as `Simulation.advance` does."""
        ends = self.step + np.cumsum(strides)
        parts: list[Array] = []
        taken, last = 0, int(ends[-1])
        while taken < len(ends):
            following = last
            if self.step < last:
                self.exert()
                following = self.controls.following(self.step, last, self.timestep)
            sampled = ends[taken : np.searchsorted(ends, following, side="right")]
            stops = np.append(sampled, following) if not len(sampled) or sampled[-1] < following else sampled
            parts.append(_advanced(parts, self.simulation, np.diff(stops, prepend=self.step))[:, : len(sampled)])
            self.step, taken = following, taken + len(sampled)
        return np.concatenate(parts, axis=1)

    def exert(self) -> None:
        """Exert the efforts that act from the present step on."""
        self.controls.exert(self.step * Fraction(self.timestep), self.simulation.state, self.simulation.apply)

    @property
    def quaternion_norm_error(self) -> float:
        """The largest deviation of the norm of a quaternion from 1, as in `Normalising`; zero if the engine normalises them."""
        return self.simulation.quaternion_norm_error if isinstance(self.simulation, Normalising) else 0.0


def _advanced(before: list[Array], simulation: Simulation, strides: Strides) -> Array:
    """Return the states after strides; if the engine gives up, its signal also holds the states before."""
    try:
        return simulation.advance(strides)
    except EngineDiverged as signal:
        signal.states = np.concatenate([*before, signal.states], axis=1)
        raise


class ScheduledControl:
    """A simulation with error control whose joints are driven, and whose steps end at each instant of the controllers.

    Parameters
    ----------
    simulation
        The simulation of the engine, which is `Driven`.
    controls
        What drives the joints.
    timestep
        The largest step (s).
    """

    def __init__(self, simulation: ErrorControlled, controls: Controls, timestep: float) -> None:
        self.simulation, self.controls, self.timestep, self.now, self.taken = simulation, controls, timestep, 0.0, 0

    def advance(self, strides: Strides) -> Array:
        """Return the states (1, n, bodies, 13) after each of n strides of largest steps, as `Simulation.advance` does."""
        ends = self.taken + np.cumsum(strides)
        states = self.reach(ends.astype(np.float64) * self.timestep)
        self.taken = int(ends[-1])
        return states

    def reach(self, times: Array) -> Array:
        """Return the states (1, n, bodies, 13) at times (n,), in s, as `ErrorControlled.reach` does."""
        parts: list[Array] = []
        taken = 0
        for end in self._legs(times):
            sampled = times[taken : np.searchsorted(times, end, side="right")]
            stops = np.append(sampled, end) if not len(sampled) or sampled[-1] < end else sampled
            try:
                parts.append(self.simulation.reach(stops)[:, : len(sampled)])
            except EngineDiverged as signal:
                signal.states = np.concatenate([*parts, signal.states], axis=1)
                raise
            taken += len(sampled)
        return np.concatenate(parts, axis=1)

    def finish(self, time: float) -> None:
        """Step to a time (s), as `ErrorControlled.finish` does."""
        for end in self._legs(np.array([time])):
            self.simulation.finish(end)

    def _legs(self, times: Array) -> Iterator[float]:
        """Yield the times (s) at which efforts change, up to the last of some times (n,), which is yielded too.

        A time of these that is within the slack of an instant is yielded in its place.
        """
        last = float(times[-1])
        if self.now >= last:
            yield last
        while self.now < last:
            self.exert()
            self.now = min([last, *(_nearest(times, each.instant, each.controller) for each in self.controls.samplers)])
            yield self.now

    def exert(self) -> None:
        """Exert the efforts that act from the present time on."""
        assert isinstance(self.simulation, Driven)
        self.controls.exert(Fraction(self.now), self.simulation.state, self.simulation.apply)

    @property
    def work(self) -> Work:
        """The work of the engine since the start."""
        return self.simulation.work

    @property
    def quaternion_norm_error(self) -> float:
        """The largest deviation of the norm of a quaternion from 1, as in `Normalising`; zero if the engine normalises them."""
        return self.simulation.quaternion_norm_error if isinstance(self.simulation, Normalising) else 0.0


def _nearest(times: Array, instant: Fraction, controller: Controller) -> float:
    """Return the one of some times (n,), in s, that is within the slack of an instant of a controller, else the instant."""
    assert controller.rate is not None
    time = float(instant)
    near = times[np.abs(times - time) <= float(SLACK) / controller.rate]
    return float(near[0]) if len(near) else time


def driven(simulation: Simulation, scene: AnyScene, method: Method) -> Simulation:
    """Return a simulation whose joints are driven, if efforts drive any, else the simulation as it is.

    Raises `SceneUnsupported` if the simulation takes no efforts, and for continuous laws that error control would hold from
    the start of a step of unknown length.
    """
    if not isinstance(scene, Mechanism):
        return simulation
    controls = controls_of(scene, method, isinstance(simulation, Staged))
    if not (scene.controllers or controls.stops):
        return simulation
    if not isinstance(simulation, Driven):
        raise SceneUnsupported(f"efforts of controllers with the method {method.name}")
    if isinstance(simulation, Staged) and controls.continuous:
        simulation.obey(controls.law)
    if method.accuracy is None:
        return Scheduled(simulation, controls, method.timestep)
    if controls.each_step:
        raise SceneUnsupported("efforts that are computed at each step, with a method that chooses its steps")
    assert isinstance(simulation, ErrorControlled)
    return ScheduledControl(simulation, controls, method.timestep)


def exert(simulation: Simulation) -> None:
    """Exert the efforts that act from now on in a simulation whose joints are driven; do nothing in any other."""
    if isinstance(simulation, Scheduled | ScheduledControl):
        simulation.exert()


def computed(simulation: object) -> Efforts:
    """Return when the efforts on driven joints are computed, as the column `efforts` has it; empty if none are driven."""
    return simulation.controls.computed if isinstance(simulation, Scheduled | ScheduledControl) else ""


def lateness(scene: AnyScene, method: Method, duration: float) -> dict[str, float]:
    """Return the largest times (s) by which the efforts of controllers are late in a run, by the names of their joints.

    Controllers whose instants are steps, and those that compute at each step, are left out. duration: of the run, in s.
    """
    if not isinstance(scene, Mechanism) or method.accuracy is not None:
        return {}
    late = {}
    for each in scene.controllers:
        if each.rate is None:
            continue
        period = 1 / (Fraction(each.rate) * Fraction(method.timestep))  # in steps
        instants = min(math.ceil(Fraction(duration) * Fraction(each.rate)), period.denominator)
        # In units of a step divided by the denominator; a remainder of almost a step belongs to an instant just reached.
        missing = (-number * period.numerator % period.denominator for number in range(instants))
        most = max((one for one in missing if one < period.denominator - SLACK * period.numerator), default=0)
        if most > SLACK * period.numerator:
            late[scene.joints[each.joint].name] = most / period.denominator * method.timestep
    return late
