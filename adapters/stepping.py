"""Simulations that adapters share: loops in Python, error control, normalised quaternions, and simulations stepped in turn."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Generic, Protocol, TypeVar, runtime_checkable

import numpy as np

from bodycheck.adapters.contract import (
    EngineDiverged,
    ErrorControlled,
    Law,
    Normalising,
    Signals,
    Simulation,
    Strides,
    Work,
    single,
)
from bodycheck.reference.trajectory import Array

State = TypeVar("State")


@dataclass
class Loop(Generic[State]):
    """A simulation of one scene, or of several scenes with one body each, stepped in a Python loop.

    Parameters
    ----------
    state
        The current state, in the form that the engine uses.
    step
        Returns the state one time step after a given state; it may raise `EngineDiverged`.
    seen
        Returns a copy of the numbers that describe a state, as (k,), or as (scenes, k) for several scenes.
    rows
        Converts the numbers (n, k) of n states to rows (n, 13) in the columns of `Simulation.advance`; if a single scene has
        several bodies, to rows (n, bodies, 13).
    """

    state: State
    step: Callable[[State], State]
    seen: Callable[[State], Array]
    rows: Callable[[Array], Array]

    def advance(self, strides: Strides) -> Array:
        """Return the states (scenes, n, bodies, 13) after each of n strides, as `Simulation.advance` does."""
        step, state = self.step, self.state
        seen = np.empty((len(strides), *self.seen(state).shape))
        for row, stride in enumerate(strides.tolist()):
            try:
                for _ in range(stride):
                    state = step(state)
            except EngineDiverged as signal:
                seen[row] = self.seen(state)
                signal.states = single(self.rows(seen[: row + 1]))
                raise
            seen[row] = self.seen(state)
        self.state = state
        if seen.ndim == 2:
            return single(self.rows(seen))
        return np.array(self.rows(seen.reshape(-1, seen.shape[-1])).reshape(*seen.shape[:2], 1, 13).swapaxes(0, 1))


Body = TypeVar("Body")


def several(
    step: Callable[[], object], bodies: Sequence[Body], seen: Callable[[Body], Array], rows: Callable[[Array], Array]
) -> Loop[None]:
    """Return the simulation of one scene with several bodies, from functions for one of them.

    Parameters
    ----------
    step
        Takes a time step of the whole scene; it may raise `EngineDiverged`.
    bodies
        The bodies, in the form that the engine uses.
    seen, rows
        As in `Loop`, for one body.
    """

    def stepped(_: None) -> None:
        step()

    def together(_: None) -> Array:
        return np.concatenate([seen(body) for body in bodies])

    def of_each(numbers: Array) -> Array:
        return rows(numbers.reshape(len(numbers) * len(bodies), -1)).reshape(len(numbers), len(bodies), 13)

    return Loop(None, stepped, together, of_each)


@dataclass
class Controlled:
    """A simulation of one scene by a method with error control, which reaches one time after another.

    Parameters
    ----------
    timestep
        The largest step (s).
    at
        Steps to a time (s), not before the current one, and returns a copy of the numbers (k,) that describe the state at this
        time; it may raise `EngineDiverged`.
    rows
        Converts the numbers (n, k) of n states to rows (n, 13) in the columns of `Simulation.advance`; if the scene has several
        bodies, to rows (n, bodies, 13).
    counts
        Returns the work of the engine since the start.
    between
        Returns the numbers (k,) at each of some ascending times (n,), in s, without ending a step of the engine there; None if
        the engine can only end a step at each time.
    taken
        The number of largest steps up to the current time, if `advance` reached it.
    """

    timestep: float
    at: Callable[[float], Array]
    rows: Callable[[Array], Array]
    counts: Callable[[], Work]
    between: Callable[[Array], Iterator[Array]] | None = None
    taken: int = 0

    def reach(self, times: Array) -> Array:
        """Return the states (1, n, bodies, 13) at times (n,), as `ErrorControlled.reach` does."""
        return self._states(map(self.at, times.tolist()) if self.between is None else self.between(times))

    def finish(self, time: float) -> None:
        """Step to a time (s), as `ErrorControlled.finish` does."""
        self.at(time)

    def _states(self, numbers: Iterator[Array]) -> Array:
        """Return the states (1, n, bodies, 13) that some numbers describe, up to an `EngineDiverged`."""
        seen: list[Array] = []
        try:
            seen.extend(numbers)
        except EngineDiverged as signal:
            if seen:
                signal.states = single(self.rows(np.array([*seen, np.full_like(seen[0], np.nan)])))
            raise
        return single(self.rows(np.array(seen)))

    def advance(self, strides: Strides) -> Array:
        """Return the states (1, n, bodies, 13) after each of n strides of largest steps, as `Simulation.advance` does."""
        ends = self.taken + np.cumsum(strides)
        states = self._states(map(self.at, (ends.astype(np.float64) * self.timestep).tolist()))
        self.taken = int(ends[-1])
        return states

    @property
    def work(self) -> Work:
        """The work of the engine since the start."""
        return self.counts()


@dataclass
class Normalised:
    """A simulation whose quaternions are divided by their norms, for an engine that lets them drift from 1.

    Parameters
    ----------
    simulation
        The simulation of the engine, whose quaternions may have any norm except zero.
    quaternion_norm_error
        The largest deviation of their norms from 1 so far. In a simulation of one scene it is infinite after a norm that is
        NaN; in a simulation of several scenes such norms are ignored.
    quaternion_norm_errors
        The largest deviation so far of each scene (scenes,); infinite after a norm that is NaN.
    """

    simulation: Simulation
    quaternion_norm_error: float = 0.0
    quaternion_norm_errors: Array = field(default_factory=lambda: np.zeros(1))

    def advance(self, strides: Strides) -> Array:
        """Return the states (scenes, n, bodies, 13) after each of n strides, as `Simulation.advance` does."""
        return self._normalised_of(lambda: self.simulation.advance(strides))

    def _normalised_of(self, stepped: Callable[[], Array]) -> Array:
        """Return the states that a function returns, or that its `EngineDiverged` holds, with unit quaternions."""
        try:
            return self._normalised(stepped())
        except EngineDiverged as signal:
            signal.states = self._normalised(signal.states)
            raise

    def _normalised(self, states: Array) -> Array:
        """Return states with unit quaternions, and remember how far their norms were from 1."""
        norms = np.linalg.norm(states[..., 3:7], axis=-1, keepdims=True)
        off = np.nan_to_num(np.abs(norms - 1), nan=np.inf if len(states) == 1 else 0.0)
        self.quaternion_norm_error = max(self.quaternion_norm_error, float(off.max(initial=0.0)))
        each = np.nan_to_num(np.abs(norms - 1), nan=np.inf).max(axis=(1, 2, 3), initial=0.0)
        self.quaternion_norm_errors = np.maximum(self.quaternion_norm_errors, each)
        states[..., 3:7] /= norms
        return states


@dataclass
class NormalisedControl(Normalised):
    """A simulation with error control whose quaternions are divided by their norms, as `Normalised` does."""

    simulation: ErrorControlled

    def reach(self, times: Array) -> Array:
        """Return the states (1, n, bodies, 13) at times (n,), as `ErrorControlled.reach` does."""
        return self._normalised_of(lambda: self.simulation.reach(times))

    def finish(self, time: float) -> None:
        """Step to a time (s), as `ErrorControlled.finish` does."""
        self.simulation.finish(time)

    @property
    def work(self) -> Work:
        """The work of the engine since the start."""
        return self.simulation.work


@dataclass
class Taking:
    """A simulation of one mechanism whose joints take efforts, as `bodycheck.adapters.contract.Driven`.

    Parameters
    ----------
    simulation
        The simulation of the engine.
    read
        Returns the coordinates and velocities (j,) of the driven joints.
    exert
        Exerts efforts (j,) on them from now on.
    """

    simulation: Simulation
    read: Callable[[], tuple[Array, Array]]
    exert: Callable[[Array], None]

    def advance(self, strides: Strides) -> Array:
        """Return the states (1, n, bodies, 13) after each of n strides, as `Simulation.advance` does."""
        return self.simulation.advance(strides)

    def state(self) -> tuple[Array, Array]:
        """Return the coordinates and velocities (j,) of the driven joints."""
        return self.read()

    def apply(self, efforts: Array) -> None:
        """Exert efforts (j,) from now on."""
        self.exert(efforts)

    @property
    def quaternion_norm_error(self) -> float:
        """The largest deviation from 1 of the norm of a quaternion, as in `Normalising`; zero if the engine normalises them."""
        return self.simulation.quaternion_norm_error if isinstance(self.simulation, Normalising) else 0.0


@dataclass
class TakingLaws(Taking):
    """A simulation of one mechanism that obeys laws at its stages, as `bodycheck.adapters.contract.Staged`.

    Parameters
    ----------
    follow
        Exerts from now on the efforts of a law, in addition to those of `exert`.
    """

    follow: Callable[[Law], None]

    def obey(self, law: Law) -> None:
        """Exert from now on the efforts of a law, evaluated at each stage."""
        self.follow(law)


@dataclass
class TakingControl(Taking):
    """A simulation of one mechanism with error control whose joints take efforts."""

    simulation: ErrorControlled

    def reach(self, times: Array) -> Array:
        """Return the states (1, n, bodies, 13) at times (n,), as `ErrorControlled.reach` does."""
        return self.simulation.reach(times)

    def finish(self, time: float) -> None:
        """Step to a time (s), as `ErrorControlled.finish` does."""
        self.simulation.finish(time)

    @property
    def work(self) -> Work:
        """The work of the engine since the start."""
        return self.simulation.work


@runtime_checkable
class NormalisingEach(Protocol):
    """A simulation of several scenes that has, for each scene, the error that `Normalising` has for all scenes together."""

    @property
    def quaternion_norm_errors(self) -> Array:
        """The largest deviation from 1 of the norm of a quaternion of each scene (scenes,), in all its states so far."""
        ...


def norm_errors(simulation: Simulation, scenes: int) -> Array:
    """Return the largest deviation from 1 of the norms of the quaternions that the engine returned, for each scene (scenes,).

    The deviation is zero if the simulation does not normalise quaternions. If the simulation has a single error for all scenes
    together, every scene gets this error.
    """
    if isinstance(simulation, NormalisingEach):
        return simulation.quaternion_norm_errors
    return np.full(scenes, simulation.quaternion_norm_error if isinstance(simulation, Normalising) else 0.0)


@dataclass
class InTurn:
    """A simulation of several scenes that consists of simulations of one or more scenes each, which are stepped in turn.

    A scene that fails does not stop the others.

    Parameters
    ----------
    parts
        The simulations, each with the indices of its scenes.
    signals
        The signals of engines so far, keyed by the indices of the scenes that the engines gave up.
    """

    parts: Sequence[tuple[Sequence[int], Simulation]]
    signals: dict[int, str] = field(default_factory=dict)

    def advance(self, strides: Strides) -> Array:
        """Return the states (scenes, n, 1, 13) of all scenes after each of n strides, as `Simulation.advance` does."""
        states = np.full((self._scenes, len(strides), 1, 13), np.nan)
        for places, simulation in self.parts:
            if len(places) == 1:
                self._advance_one(places[0], simulation, strides, states)
                continue
            states[list(places)] = simulation.advance(strides)
            if isinstance(simulation, Signals):
                self.signals |= {places[index]: text for index, text in simulation.signals.items()}
        return states

    @property
    def quaternion_norm_errors(self) -> Array:
        """The largest deviation of a norm from 1 of each scene (scenes,), as in `NormalisingEach`."""
        errors = np.zeros(self._scenes)
        for places, simulation in self.parts:
            errors[list(places)] = norm_errors(simulation, len(places))
        return errors

    @property
    def _scenes(self) -> int:
        return sum(len(places) for places, _ in self.parts)

    def _advance_one(self, index: int, simulation: Simulation, strides: Strides, states: Array) -> None:
        """Write the states of one scene into `states`, unless the engine has already given up this scene."""
        if index in self.signals:
            return
        try:
            states[index] = simulation.advance(strides)[0]
        except EngineDiverged as signal:
            sound = signal.states[0, :-1]  # the last state is the state at the signal
            states[index, : len(sound)] = sound
            self.signals[index] = str(signal)
