"""A simulation loop for engines that are stepped from Python, with one call per step."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from bodycheck.adapters.contract import EngineDiverged, Strides, single
from bodycheck.reference.trajectory import Array

State = TypeVar("State")


@dataclass
class Loop(Generic[State]):
    """A simulation of one scene with one body, stepped in a Python loop.

    Parameters
    ----------
    state
        The current state, in the form that the engine uses.
    step
        Returns the state one time step after a given state; it may raise `EngineDiverged`.
    seen
        Returns a copy of the numbers (k,) that describe a state.
    rows
        Converts the numbers (n, k) of n states to rows (n, 13) in the columns of `Simulation.advance`.
    """

    state: State
    step: Callable[[State], State]
    seen: Callable[[State], Array]
    rows: Callable[[Array], Array]

    def advance(self, strides: Strides) -> Array:
        """Return the states (1, n, 1, 13) after each of n strides, as `Simulation.advance` does."""
        step, state = self.step, self.state
        seen = np.empty((len(strides), len(self.seen(state))))
        for place, stride in enumerate(strides.tolist()):
            try:
                for _ in range(stride):
                    state = step(state)
            except EngineDiverged as signal:
                seen[place] = self.seen(state)
                signal.states = single(self.rows(seen[: place + 1]))
                raise
            seen[place] = self.seen(state)
        self.state = state
        return single(self.rows(seen))
