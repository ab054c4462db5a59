"""Step several scenes in MuJoCo by rollouts from all of their states, each as if it were alone.

A rollout of a scene goes on from its state, but not from what MuJoCo's solver of constraints found in the last step, unless the
solver is told. MuJoCo tells it only of the scene that was rolled out last. Models in which something can touch are therefore
rolled out one after another, and so are those with an external force, which is a function in Python; all others together, on
all processors.
"""

import os
from collections.abc import Iterator, Sequence

import mujoco
import numpy as np

from bodycheck.adapters.contract import EngineDiverged, Strides
from bodycheck.adapters.mujoco import stepping
from bodycheck.adapters.mujoco.models import Force, Joints
from bodycheck.adapters.mujoco.stepping import Stepper, external_force, warnings
from bodycheck.reference.trajectory import Array

#: The spelling of a state in MuJoCo: the clock first, then the coordinates and the velocities.
FULL = mujoco.mjtState.mjSTATE_FULLPHYSICS

#: The number of scenes from which rollouts of several scenes pay off; releases before 3.2.7 have none.
BATCH = 2 if stepping.Rollout is not None else 1

#: Most steps of all scenes in one rollout, which returns every state: 16 MiB for a free body.
MOST_STATES = 1 << 17


def processors() -> int:
    """Return the number of processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class Worlds:
    """Several scenes whose models have the same coordinates, with their current states.

    Parameters
    ----------
    models
        MuJoCo's compiled models.
    data
        The data in which external forces act.
    joints
        The joints of each body, with its initial state.
    forces
        The external force on each body; all are None if there are none.

    Attributes
    ----------
    signals
        What MuJoCo signalled so far, by the places of the scenes that it gave up.
    """

    def __init__(
        self,
        models: Sequence[mujoco.MjModel],
        data: mujoco.MjData,
        joints: Sequence[Joints],
        forces: Sequence[Force | None],
    ) -> None:
        self.models, self.joints, self.forces = models, joints, forces
        self.signals: dict[int, str] = {}
        self.together = not models[0].ngeom and forces[0] is None
        threads = min(processors(), len(models)) if self.together else 0
        self.data = [data, *(mujoco.MjData(models[0]) for _ in range(threads - 1))]
        self.pool = stepping.Rollout(nthread=threads)
        # A reset sets the clock to 0 before its step. It begins one step later, so that a reset is seen in any step.
        self.states = np.zeros((len(models), mujoco.mj_stateSize(models[0], FULL)))
        self.states[:, 0] = models[0].opt.timestep
        self.states[:, 1 : 1 + models[0].nq + models[0].nv] = [(*own.qpos, *own.qvel) for own in joints]
        self.warmstarts = np.zeros((len(models), models[0].nv))

    def advance(self, strides: Strides) -> Array:
        """Return the states (scenes, n, 1, 13) after each of n strides, as `Simulation.advance` does."""
        states = np.full((len(self.models), len(strides), 1, 13), np.nan)
        before, warm = self.states.copy(), self.warmstarts.copy()
        for places in self._parts(int(strides.sum())):
            with external_force(self.forces[places[0]]):
                seen, sound = self._rolled_out(places, np.cumsum(strides))
            for place, rows, held in zip(places, seen, sound, strict=True):
                if held:
                    states[place, :, 0] = self.joints[place].rows(rows)
                else:
                    known = self._until_signal(place, before[place], warm[place], strides)
                    states[place, : len(known)] = known
        return states

    def _parts(self, steps: int) -> Iterator[list[int]]:
        """Yield the places of the scenes that are rolled out together, without those that MuJoCo gave up."""
        left = [place for place in range(len(self.models)) if place not in self.signals]
        size = max(len(self.data), MOST_STATES // max(1, steps)) if self.together else 1
        for first in range(0, len(left), size):
            yield left[first : first + size]

    def _rolled_out(self, places: Sequence[int], ends: Strides) -> tuple[Array, Array]:
        """Advance some scenes to the ends (n,) of strides, in steps from the current state.

        Returns the coordinates and velocities (scenes, n, nq + nv) there, and whether MuJoCo gave no warning (scenes,).
        """
        width = self.models[0].nq + self.models[0].nv
        seen, sound = np.empty((len(places), len(ends), width)), np.ones(len(places), dtype=bool)
        most, done = max(1, MOST_STATES // len(places)), 0
        while True:
            count = min(most, int(ends[-1]) - done)
            block = np.empty((len(places), count + 1, self.states.shape[1]))
            block[:, 0] = self.states[places]
            if count:
                block[:, 1:] = self._rollout(places, count)
            first, last = np.searchsorted(ends, (done, done + count + 1))
            seen[:, first:last] = block[:, ends[first:last] - done, 1 : 1 + width]
            # After a warning the clock of a rollout stands still, and after a reset it jumps back.
            sound &= (np.diff(block[:, :, 0], axis=1) > 0).all(axis=1)
            sound &= self.together or not warnings(self.data[0])
            self.states[places] = block[:, -1]
            if not self.together and count:
                self.warmstarts[places] = self.data[0].qacc_warmstart
            done += count
            if done == ends[-1]:
                return seen, sound

    def _rollout(self, places: Sequence[int], count: int) -> Array:
        """Return the states (scenes, count, ...) after each of a number of steps of some scenes."""
        models, start = [self.models[place] for place in places], self.states[places]
        states, _ = self.pool.rollout(models, self.data, start, nstep=count, initial_warmstart=self.warmstarts[places])
        return np.asarray(states)

    def _until_signal(self, place: int, before: Array, warm: Array, strides: Strides) -> Array:
        """Repeat the strides of a scene that MuJoCo gave up, and return its states (k, 1, 13) before the signal."""
        model, data = self.models[place], self.data[0]
        mujoco.mj_resetData(model, data)
        mujoco.mj_setState(model, data, before, FULL)
        data.time -= model.opt.timestep
        data.qacc_warmstart[:] = warm
        try:
            Stepper(model, data, self.joints[place], self.forces[place]).advance(strides)
        except EngineDiverged as signal:
            self.signals[place] = str(signal)
            return np.asarray(signal.states[0, :-1])
        raise AssertionError("a rollout of several scenes gave up one that is stepped alone without a warning")
