"""Miniature engines that start over, say that they do, or both."""

from dataclasses import dataclass

import numpy as np
from miniature import Flight, Miniature, exact

from bodycheck.adapters.contract import EngineReset

#: s, after which they start over.
LAST = 0.5


@dataclass
class Restart(Flight):
    says: bool = False
    does: bool = False

    def advance(self, strides: np.ndarray) -> np.ndarray:
        rows = super().advance(strides)
        times = np.cumsum(strides) * self.timestep
        after = times > LAST
        if self.does:
            rows[after] = [self._state(t - LAST) for t in times[after]]
        if self.says:
            signal = EngineReset(f"the miniature engine starts over at t = {LAST} s")
            signal.rows = rows[: int(np.argmax(after)) + 1]
            raise signal
        return rows


@dataclass(frozen=True)
class Restarting(Miniature):
    says: bool = False
    does: bool = False

    def prepare(self, scene: object, method: object) -> Restart:
        return Restart(scene, method.timestep, self.spoil, says=self.says, does=self.does)


RESETTING = Restarting(exact, says=True, does=True)
CRYING = Restarting(exact, says=True)
JUMPING = Restarting(exact, does=True)
