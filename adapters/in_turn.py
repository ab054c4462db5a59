"""Advance several simulations in turn as one, of which some may fail without the others."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from bodycheck.adapters import stepping
from bodycheck.adapters.contract import EngineDiverged, Signals, Simulation, Strides
from bodycheck.reference.trajectory import Array


@dataclass
class InTurn:
    """A simulation of several scenes, made of simulations of one or more of them each.

    Parameters
    ----------
    parts
        The simulations, each with the places of its scenes.
    signals
        What engines signalled so far, by the places of the scenes that they gave up.
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
                self.signals |= {places[own]: text for own, text in simulation.signals.items()}
        return states

    @property
    def quaternion_norm_errors(self) -> Array:
        """The largest deviations of norms from 1 of the scenes (scenes,), as `NormalisingEach` has them."""
        found = np.zeros(self._scenes)
        for places, simulation in self.parts:
            found[list(places)] = stepping.norm_errors(simulation, len(places))
        return found

    @property
    def _scenes(self) -> int:
        return sum(len(places) for places, _ in self.parts)

    def _advance_one(self, place: int, simulation: Simulation, strides: Strides, states: Array) -> None:
        """Fill in the states of one scene, unless its engine has given it up before."""
        if place in self.signals:
            return
        try:
            states[place] = simulation.advance(strides)[0]
        except EngineDiverged as signal:
            sound = signal.states[0, :-1]  # the last is the state at the signal
            states[place, : len(sound)] = sound
            self.signals[place] = str(signal)
