"""Miniature engines that start over, say that they do, or both."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from miniature import Flight, Miniature, exact

from bodycheck.adapters.contract import EngineReset, Method
from bodycheck.reference.scene import Scene

#: s, after which they start over.
LAST = 0.5


@dataclass
class Restart(Flight):
    says: bool = False
    does: bool = False

    def advance(self, strides: np.ndarray) -> np.ndarray:
        states = super().advance(strides)
        times = np.cumsum(strides) * self.timestep
        after = times > LAST
        if self.does:
            states[0, after, 0] = [self._state(t - LAST) for t in times[after]]
        if self.says:
            signal = EngineReset(f"the miniature engine starts over at t = {LAST} s")
            signal.states = states[:, : int(np.argmax(after)) + 1]
            raise signal
        return states


@dataclass(frozen=True)
class Restarting(Miniature):
    says: bool = False
    does: bool = False

    def prepare(self, scenes: Sequence[Scene], method: Method) -> Restart:
        return Restart(scenes[0], method.timestep, self.spoil, says=self.says, does=self.does)


RESETTING = Restarting("resetting", exact, says=True, does=True)
CRYING = Restarting("crying", exact, says=True)
JUMPING = Restarting("jumping", exact, does=True)
