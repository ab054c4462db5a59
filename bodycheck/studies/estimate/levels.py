"""Runs of one scene with one method and the time steps h, h/2, h/4, …, and the differences between them over time."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.mechanisms.mechanism import AnyScene
from bodycheck.reference.trajectory import Array
from bodycheck.running.refining import Motion
from bodycheck.studies.estimate.distances import differences
from bodycheck.studies.estimate.quantities import NAMED, OF_ONE_RUN

#: The time (s) by which two instants that are the same may differ.
SAME = 1e-6

#: The rounding of a number near 1, and that of an energy, which is a sum of several terms.
EPS, OF_ENERGY = 2.0**-52, 8.0

#: Numbers of steps.
Steps = NDArray[np.int64]


def own_steps(instants: Array, timestep: float) -> Steps:
    """Return the numbers of steps (m,) after which a run is compared: those whose ends are closest to instants (n,), s."""
    return np.unique(np.rint(instants / timestep).astype(np.int64))


def sampled_steps(instants: Array, timestep: float, coarser: int, factor: int = 2) -> Steps:
    """Return the numbers of steps (m,) after which a run is sampled, so that all coarser runs can be compared with it.

    Parameters
    ----------
    instants
        The instants of the scene (n,), s.
    timestep
        The time step (s).
    coarser
        The number of coarser levels.
    factor
        The ratio of the time steps of neighbouring levels.
    """
    ratios = [factor**level for level in range(coarser + 1)]
    return np.unique(np.concatenate([own_steps(instants, timestep * ratio) * ratio for ratio in ratios]))


def instants_of(steps: Steps, timestep: float) -> Array:
    """Return the instants (m,), s, after numbers of steps (m,) of a size (s)."""
    return steps.astype(np.float64) * timestep


@dataclass(frozen=True, eq=False)
class Level:
    """A run that completed. steps: the numbers of steps (m,) after which it was sampled."""

    timestep: float
    steps: Steps
    motion: Motion


@dataclass(frozen=True, eq=False)
class Levels:
    """Runs of a scene with one method that differ in the time step by powers of two, the largest first.

    Attributes
    ----------
    instants
        The instants of the scene (n,), s.
    scene
        The scene of a case; None for a file.
    levels
        The runs.
    nudged
        A run, the finest one when it was made, and the same from an initial state that is changed by one rounding; None if
        there are none.
    wanted
        The quantities of a case whose differences are computed.
    """

    instants: Array
    scene: AnyScene | None
    levels: tuple[Level, ...]
    nudged: tuple[Level, Motion] | None = None
    wanted: tuple[str, ...] = NAMED
    known: dict[tuple[int, int], Mapping[str, Array]] = field(default_factory=dict)

    def times(self, level: int) -> Array:
        """Return the instants (m,), s, at which a level is compared."""
        return instants_of(own_steps(self.instants, self.levels[level].timestep), self.levels[level].timestep)

    def series(self, coarse: int, fine: int) -> Mapping[str, Array]:
        """Return the differences (m,) of two levels at the instants of the coarser one, by quantities."""
        if (coarse, fine) not in self.known:
            one, other = self.levels[coarse], self.levels[fine]
            steps = own_steps(self.instants, one.timestep)
            ratio = round(one.timestep / other.timestep)
            here, there = np.searchsorted(one.steps, steps), np.searchsorted(other.steps, steps * ratio)
            pair = one.motion.part(here), other.motion.part(there)
            self.known[coarse, fine] = differences(self.scene, *pair, self.wanted)
        return self.known[coarse, fine]

    @cached_property
    def quantities(self) -> tuple[str, ...]:
        """The quantities that the scene has."""
        return tuple(self.series(0, len(self.levels) - 1)) if len(self.levels) > 1 else ()

    @cached_property
    def rounding(self) -> tuple[Array, Mapping[str, Array]]:
        """The instants (m,), s, and the differences (m,) that one rounding at the start makes, by quantities."""
        if self.nudged is None:
            return np.empty(0), {}
        level, nudged = self.nudged
        steps = own_steps(self.instants, level.timestep)
        here = np.searchsorted(level.steps, steps)
        seen = differences(self.scene, level.motion.part(here), nudged.part(here), self.wanted)
        return instants_of(steps, level.timestep), {name: values for name, values in seen.items() if name not in OF_ONE_RUN}

    def value(self, quantity: str, coarse: int, fine: int, until: float, at_end: bool = False) -> float:
        """Return the largest difference of two levels until an instant (s), or that at the last instant until then."""
        step = self.levels[coarse].timestep
        return _value(self.series(coarse, fine)[quantity], self.times(coarse), (round(until / step) + 0.5) * step, at_end)

    def nudge(self, quantity: str, until: float) -> float:
        """Return the difference that one rounding at the start makes until an instant (s), at least one rounding itself."""
        times, by_quantity = self.rounding
        if quantity not in by_quantity:
            return OF_ENERGY * EPS if quantity in OF_ONE_RUN else EPS
        return max(EPS, _value(by_quantity[quantity], times, until + SAME, False))

    def divergence(self, quantities: tuple[str, ...], error: float) -> float | None:
        """Return the first instant (s) at which one rounding at the start makes a difference above an error; None if never."""
        times, by_quantity = self.rounding
        apart = [values for name, values in by_quantity.items() if name in quantities]
        above = np.flatnonzero(np.max(apart, axis=0) > error) if apart else np.empty(0, np.int64)
        return float(times[above[0]]) if len(above) else None


def _value(values: Array, times: Array, until: float, at_end: bool) -> float:
    last = int(np.searchsorted(times, until, side="right"))
    if last == 0:
        return 0.0
    return float(values[last - 1]) if at_end else float(np.max(values[:last]))
