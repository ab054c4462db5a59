"""A miniature engine that steps many scenes at once, and gives up those whose bodies move too fast."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from bodycheck.adapters.contract import Engine, EngineDiverged, Integrator, Method, Varied
from bodycheck.reference.kinematics import multiply
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array

#: The speed (m/s) from which on the engine gives a scene up.
MOST_SPEED = 1e6


@dataclass
class Worlds:
    """Semi-implicit Euler for bodies whose moments are equal, as (scenes, 13)."""

    states: Array
    gravity: Array
    timestep: float
    signals: dict[int, str] = field(default_factory=dict)

    def advance(self, strides: np.ndarray) -> Array:
        rows = []
        for stride in strides.tolist():
            for _ in range(stride):
                self._step()
            rows.append(self.states.copy())
        found = np.array(rows).swapaxes(0, 1)[:, :, None, :]
        if len(found) == 1 and self.signals:
            signal = EngineDiverged(self.signals[0])
            signal.states = found[:, : 1 + np.isfinite(found[0]).all(axis=(1, 2)).sum()]
            raise signal
        return found

    def _step(self) -> None:
        now, h = self.states, self.timestep
        now[:, 9] -= self.gravity * h
        now[:, :3] += now[:, 7:10] * h
        rates = np.linalg.norm(now[:, 10:], axis=1, keepdims=True)
        axes = np.divide(now[:, 10:], rates, out=np.zeros_like(now[:, 10:]), where=rates > 0)
        turns = np.hstack([np.cos(rates * h / 2), np.sin(rates * h / 2) * axes])
        now[:, 3:7] = multiply(now[:, 3:7], turns)
        for place in np.flatnonzero(np.linalg.norm(now[:, 7:10], axis=1) > MOST_SPEED).tolist():
            self.signals.setdefault(place, "it is too fast")
            now[place] = np.nan


@dataclass(frozen=True)
class Batching:
    """The adapter of the engine. `asked` has the numbers of scenes of each call of `prepare`, and `varies` is of its record."""

    name: str = "batching"
    asked: list[int] = field(default_factory=list)
    varies: frozenset[Varied] = frozenset()

    @property
    def engine(self) -> Engine:
        modelled = frozenset({"gravity", "translation", "rotation"})
        return Engine(
            self.name,
            "bodycheck-miniature",
            "1.0",
            (Integrator("euler", order=1, evaluations=1),),
            modelled,
            batch=2,
            varies=self.varies,
        )

    def prepare(self, scenes: Sequence[Scene], method: Method) -> Worlds:
        self.asked.append(len(scenes))
        starts = [one.initial for one in scenes]
        rows = [(*own.position, *own.quaternion, *own.velocity, *own.angular_velocity) for own in starts]
        return Worlds(np.array(rows), np.array([one.gravity for one in scenes]), method.timestep)


BATCHING = Batching()
