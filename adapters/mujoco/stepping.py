"""Step a MuJoCo model by `mujoco.rollout`, a loop in C, or by `mj_step` with releases that lack it.

Both take the same steps, and stop at the first warning that MuJoCo gives.
"""

from collections.abc import Iterator
from contextlib import contextmanager

import mujoco
import numpy as np

from bodycheck.adapters.contract import EngineDiverged, EngineReset, Strides, single
from bodycheck.adapters.mujoco.models import Force, Joints
from bodycheck.reference.trajectory import Array

#: Steps per rollout. A rollout returns every state, so this bounds the memory; a call costs as much time as about 30 steps.
STEPS_PER_ROLLOUT = 8192

#: The warnings of MuJoCo by name.
WARNINGS = {
    name.removeprefix("mjWARN_"): kind for name, kind in mujoco.mjtWarning.__members__.items() if name.startswith("mjWARN_")
}
#: The warnings after which MuJoCo resets the simulation.
RESET_WARNINGS = {mujoco.mjtWarning.mjWARN_BADQPOS, mujoco.mjtWarning.mjWARN_BADQVEL, mujoco.mjtWarning.mjWARN_BADQACC}

try:
    from mujoco.rollout import Rollout as Pool
except ImportError:  # older than MuJoCo 3.2.7
    Pool = None


def stepping(model: mujoco.MjModel, data: mujoco.MjData, joints: Joints, force: Force | None) -> "Rollouts | Steps":
    """Return a simulation that steps a model from the state in its data by the fastest way of the installed MuJoCo.

    Parameters
    ----------
    model, data
        MuJoCo's compiled model and its data, which hold the initial state.
    joints
        The joints of the body, which convert states to rows of the contract.
    force
        An external force; None if there is none.
    """
    return Steps(model, data, joints, force) if Pool is None else Rollouts(model, data, joints, force)


@contextmanager
def external_force(force: Force | None) -> Iterator[None]:
    """Apply an external force to everything that is stepped in this context, and silence MuJoCo's log file."""
    mujoco.set_mjcb_passive(force)
    try:
        with quiet():
            yield
    finally:
        mujoco.set_mjcb_passive(None)


@contextmanager
def quiet() -> Iterator[None]:
    """Keep MuJoCo from writing its warnings to a log file in the working directory."""
    mujoco.set_mju_user_warning(lambda text: None)
    try:
        yield
    finally:
        mujoco.set_mju_user_warning(None)


def warnings(data: mujoco.MjData) -> dict[str, mujoco.mjtWarning]:
    """Return the warnings that MuJoCo has given, by name."""
    return {name: kind for name, kind in WARNINGS.items() if data.warning[kind].number}


def refuse_warnings(data: mujoco.MjData, time: float) -> None:
    """Raise `EngineDiverged` if MuJoCo has given a warning; `time` (s) is the time of the warning, for the message."""
    if given := warnings(data):
        # After a bad state MuJoCo resets to the initial state; contacts that exceed its buffers are dropped with a warning.
        signal, answer = (
            (EngineReset, "reset itself after") if RESET_WARNINGS & set(given.values()) else (EngineDiverged, "warned of")
        )
        raise signal(f"MuJoCo {answer} {', '.join(given)} at t = {time:.6g} s")


class Rollouts:
    """A MuJoCo model and its data, advanced by `mujoco.rollout`."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, joints: Joints, force: Force | None) -> None:
        self.model, self.data, self.joints, self.force = model, data, joints, force
        self.pool = Pool(nthread=0)
        # Row 0 is the current state, the other rows are those of one rollout. Filling them allocates the memory before the
        # first step is timed.
        self.states = np.full((STEPS_PER_ROLLOUT + 1, mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)), 0.0)
        mujoco.mj_getState(model, data, self.states[0], mujoco.mjtState.mjSTATE_FULLPHYSICS)

    def advance(self, strides: Strides) -> Array:
        """Return the states (1, n, 1, 13) after each of n strides, as `Simulation.advance` does."""
        ends = np.cumsum(strides)
        columns = slice(1, 1 + self.model.nq + self.model.nv)
        rows = np.empty((len(strides), self.model.nq + self.model.nv))
        done = 0
        while True:
            count = min(STEPS_PER_ROLLOUT, int(ends[-1]) - done)
            if count:
                self._step(count)
            first, last = np.searchsorted(ends, (done, done + count + 1))
            rows[first:last] = self.states[ends[first:last] - done, columns]
            # After a warning the clock of a rollout stands still, and after a reset it jumps back.
            clock = self.states[: count + 1, 0]
            try:
                refuse_warnings(self.data, float(clock.max()))
            except EngineDiverged as signal:
                sound = done + int(np.argmax(np.diff(clock, append=clock[-1]) <= 0))
                before = rows[: np.searchsorted(ends, sound, side="right")]
                signal.states = single(self.joints.rows(np.vstack([before, self.states[count, None, columns]])[: len(rows)]))
                raise
            self.states[0] = self.states[count]
            done += count
            if done == ends[-1]:
                return single(self.joints.rows(rows))

    def _step(self, count: int) -> None:
        start, following = self.states[0], self.states[1 : count + 1]
        with external_force(self.force):
            self.pool.rollout(
                self.model,
                self.data,
                start[None],
                nstep=count,
                initial_warmstart=self.data.qacc_warmstart[None],
                state=following[None],
            )


class Steps:
    """A MuJoCo model and its data, advanced by `mj_step` with one call per stride."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, joints: Joints, force: Force | None) -> None:
        self.model, self.data, self.joints, self.force = model, data, joints, force

    def advance(self, strides: Strides) -> Array:
        """Return the states (1, n, 1, 13) after each of n strides, as `Simulation.advance` does."""
        data, nq = self.data, self.model.nq
        rows = np.empty((len(strides), nq + self.model.nv))
        with external_force(self.force):
            for place, stride in enumerate(strides.tolist()):
                before = self._state()
                if stride:
                    mujoco.mj_step(self.model, data, stride)
                try:
                    if warnings(data):
                        self._find_warning(before, stride)
                except EngineDiverged as signal:
                    rows[place, :nq], rows[place, nq:] = data.qpos, data.qvel
                    signal.states = single(self.joints.rows(rows[: place + 1]))
                    raise
                rows[place, :nq], rows[place, nq:] = data.qpos, data.qvel
        return single(self.joints.rows(rows))

    def _state(self) -> tuple[float, Array, Array, Array]:
        data = self.data
        return data.time, data.qpos.copy(), data.qvel.copy(), data.qacc_warmstart.copy()

    def _find_warning(self, before: tuple[float, Array, Array, Array], stride: int) -> None:
        """Repeat a stride in which MuJoCo gave a warning, and raise `EngineDiverged` at the step of the warning."""
        data = self.data
        mujoco.mj_resetData(self.model, data)
        data.time, data.qpos[:], data.qvel[:], data.qacc_warmstart[:] = before
        for _ in range(stride):
            time = data.time
            mujoco.mj_step(self.model, data)
            refuse_warnings(data, max(time, data.time))
