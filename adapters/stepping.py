"""The loop of engines that are stepped from Python, a call a step."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from bodycheck.adapters.contract import EngineDiverged, Strides, single
from bodycheck.reference.trajectory import Array

State = TypeVar("State")


@dataclass
class Loop(Generic[State]):
    """One scene of one body, stepped in a Python loop.

    Parameters
    ----------
    state
        Where the simulation stands, in whatever form the engine has it.
    step
        From a state to the state one time step later; may raise `EngineDiverged`.
    seen
        From a state to its numbers (k,), copied.
    rows
        From the numbers (n, k) of n states to rows (n, 13), as `Simulation.advance` has them.
    """

    state: State
    step: Callable[[State], State]
    seen: Callable[[State], Array]
    rows: Callable[[Array], Array]

    def advance(self, strides: Strides) -> Array:
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
