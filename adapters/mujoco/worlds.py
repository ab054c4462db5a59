"""Step several scenes in MuJoCo by rollouts from all of their states, each as if it were alone.

A rollout continues from the state of a scene. To continue exactly, MuJoCo's constraint solver also needs its last solution as a
warm start, which after a rollout is available only for the scene that was rolled out last. Models in which something can touch
are therefore rolled out one after another, and so are models with an external force, which is a Python function. All other
models are rolled out together, in as many threads as `threads` returns.
"""

import math
import os
from collections.abc import Iterator, Sequence

import mujoco
import numpy as np

from bodycheck.adapters.contract import EngineDiverged, Strides
from bodycheck.adapters.mujoco import stepping
from bodycheck.adapters.mujoco.bodies import Models
from bodycheck.adapters.mujoco.models import Force, Joints
from bodycheck.adapters.mujoco.stepping import Stepper, external_force, scratch, warnings
from bodycheck.reference.trajectory import Array

#: The layout of a state in MuJoCo: the clock first, then the coordinates and the velocities.
FULL = mujoco.mjtState.mjSTATE_FULLPHYSICS

#: The number of scenes from which rollouts of several scenes pay off; releases before 3.2.7 have none.
BATCH = 2 if stepping.Rollout is not None else 1

#: The largest number of states of all scenes in one rollout, which returns every state: 4 MiB for a free body.
MOST_STATES = 1 << 15


class Worlds:
    """Several scenes whose models have the same coordinates, with their current states.

    Parameters
    ----------
    models
        MuJoCo's compiled models of the scenes.
    data
        The data in which external forces act.
    joints
        The joints of each body, with its initial state.
    forces
        The external force on each body; either all are None or none is.

    Attributes
    ----------
    signals
        MuJoCo's signals so far, keyed by the indices of the scenes that it gave up.
    """

    def __init__(self, models: Models, data: mujoco.MjData, joints: Sequence[Joints], forces: Sequence[Force | None]) -> None:
        self.models, self.joints, self.forces = models, joints, forces
        self.signals: dict[int, str] = {}
        (first,) = models.at([0])
        self.together = not first.ngeom and forces[0] is None
        count = min(threads(), len(joints)) if self.together else 1
        self.data = [data, *(mujoco.MjData(first) for _ in range(count - 1))]
        self.pool = stepping.Rollout(nthread=count if count > 1 else 0)  # none: rollouts in the calling thread
        # A reset sets the clock to 0 before its step. The clock begins at one time step, so that a reset is seen in any step.
        self.states = np.zeros((len(joints), mujoco.mj_stateSize(first, FULL)))
        self.states[:, 0] = first.opt.timestep
        self.moving = slice(1, 1 + first.nq + first.nv)
        self.states[:, self.moving] = [(*joint.qpos, *joint.qvel) for joint in joints]
        self.warmstarts = np.zeros((len(joints), first.nv))
        self.scratch = scratch(max(MOST_STATES, count) * self.states.shape[1])

    def advance(self, strides: Strides) -> Array:
        """Return the states (scenes, n, 1, 13) after each of n strides, as `Simulation.advance` does."""
        states = np.full((len(self.joints), len(strides), 1, 13), np.nan)
        before, warm = self.states.copy(), self.warmstarts.copy()
        for places in self._parts(int(strides.sum())):
            with external_force(self.forces[places[0]]):
                seen, sound = self._rolled_out(places, np.cumsum(strides))
            for index, rows, is_sound in zip(places, seen, sound, strict=True):
                if is_sound:
                    states[index, :, 0] = self.joints[index].rows(rows)
                else:
                    before_signal = self._until_signal(index, before[index], warm[index], strides)
                    states[index, : len(before_signal)] = before_signal
        return states

    def _parts(self, steps: int) -> Iterator[list[int]]:
        """Yield groups of indices of scenes that are rolled out together, without the scenes that MuJoCo gave up."""
        left = [index for index in range(len(self.joints)) if index not in self.signals]
        size = min(self.models.most, max(len(self.data), MOST_STATES // max(1, steps))) if self.together else 1
        for first in range(0, len(left), size):
            yield left[first : first + size]

    def _rolled_out(self, places: list[int], ends: Strides) -> tuple[Array, Array]:
        """Advance some scenes to the ends (n,) of strides, in steps from the current state.

        Returns the coordinates and velocities (scenes, n, nq + nv) there, and whether MuJoCo gave no warning (scenes,).
        """
        models, now = self.models.at(places), self.states[places]
        seen = np.empty((len(places), len(ends), self.moving.stop - 1))
        seen[:, ends == 0] = now[:, None, self.moving]
        sound = np.ones(len(places), dtype=bool)
        most, done = max(1, MOST_STATES // len(places)), 0
        while done < ends[-1]:
            count = min(most, int(ends[-1]) - done)
            states = self._rollout(models, now, self.warmstarts[places], count)
            first, last = np.searchsorted(ends, (done, done + count), side="right")
            seen[:, first:last] = states[:, ends[first:last] - done - 1, self.moving]
            # After a warning the clock of a rollout stands still, and after a reset it jumps back.
            clock = states[:, :, 0]
            sound &= (clock[:, 0] > now[:, 0]) & (clock[:, 1:] > clock[:, :-1]).all(axis=1)
            sound &= self.together or not warnings(self.data[0])
            now = states[:, -1].copy()
            if not self.together:
                self.warmstarts[places] = self.data[0].qacc_warmstart
            done += count
        self.states[places] = now
        return seen, sound

    def _rollout(self, models: list[mujoco.MjModel], start: Array, warmstarts: Array, count: int) -> Array:
        """Return the states (scenes, count, ...) after each of `count` steps. The array is valid until the next call."""
        shape = len(models), count, start.shape[1]
        states = self.scratch[: math.prod(shape)].reshape(shape)
        self.pool.rollout(models, self.data, start, nstep=count, initial_warmstart=warmstarts, state=states, skip_checks=True)
        return states

    def _until_signal(self, index: int, before: Array, warm: Array, strides: Strides) -> Array:
        """Repeat the strides of a scene that MuJoCo gave up, and return its states (k, 1, 13) before the signal."""
        (model,), data = self.models.at([index]), self.data[0]
        mujoco.mj_resetData(model, data)
        mujoco.mj_setState(model, data, before, FULL)
        data.time -= model.opt.timestep
        data.qacc_warmstart[:] = warm
        try:
            Stepper(model, data, self.joints[index].rows, self.forces[index]).advance(strides)
        except EngineDiverged as signal:
            self.signals[index] = str(signal)
            return np.asarray(signal.states[0, :-1])
        raise AssertionError("a rollout of several scenes gave up one that is stepped alone without a warning")


def threads() -> int:
    """Return the number of processors that this process may use, or fewer if the variable OMP_NUM_THREADS says so.

    Schedulers, and processes that start several workers, use this variable to divide the processors. Its value may be a list of
    numbers for nested levels, of which only the first is used; a value that is not a positive integer is ignored.
    """
    processors = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    wanted = os.environ.get("OMP_NUM_THREADS", "").partition(",")[0].strip()
    return min(processors, int(wanted)) if wanted.isascii() and wanted.isdigit() and int(wanted) else processors
