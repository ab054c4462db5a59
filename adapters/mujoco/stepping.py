"""How a MuJoCo model is stepped: by a pool of rollouts, in C, or where a release has none by `mj_step`.

Both take the same steps and stop at the first warning that MuJoCo gives.
"""

from collections.abc import Iterator
from contextlib import contextmanager

import mujoco
import numpy as np

from bodycheck.adapters.contract import EngineDiverged, EngineReset, Strides, single
from bodycheck.adapters.mujoco.models import Force, Joints
from bodycheck.reference.trajectory import Array

#: Steps of one rollout. It returns every state, so this bounds the memory; a call costs as much as some 30 steps.
CHUNK = 8192

WARNINGS = {
    name.removeprefix("mjWARN_"): kind for name, kind in mujoco.mjtWarning.__members__.items() if name.startswith("mjWARN_")
}
RESETS = {mujoco.mjtWarning.mjWARN_BADQPOS, mujoco.mjtWarning.mjWARN_BADQVEL, mujoco.mjtWarning.mjWARN_BADQACC}

try:
    from mujoco.rollout import Rollout as Pool
except ImportError:  # older than MuJoCo 3.2.7
    Pool = None


def stepping(model: mujoco.MjModel, data: mujoco.MjData, joints: Joints, force: Force | None) -> "Rollouts | Steps":
    """A model as the installed MuJoCo can step it from where its data stand. force: from outside, where there is one."""
    return Steps(model, data, joints, force) if Pool is None else Rollouts(model, data, joints, force)


@contextmanager
def acting(force: Force | None) -> Iterator[None]:
    """In this context a force from outside acts on whatever is stepped, and MuJoCo is quiet."""
    mujoco.set_mjcb_passive(force)
    try:
        with quiet():
            yield
    finally:
        mujoco.set_mjcb_passive(None)


@contextmanager
def quiet() -> Iterator[None]:
    """Keeps MuJoCo from writing its warnings to a log file in the working directory."""
    mujoco.set_mju_user_warning(lambda text: None)
    try:
        yield
    finally:
        mujoco.set_mju_user_warning(None)


def warnings(data: mujoco.MjData) -> dict[str, mujoco.mjtWarning]:
    """What MuJoCo has warned of."""
    return {name: kind for name, kind in WARNINGS.items() if data.warning[kind].number}


def refuse_warnings(data: mujoco.MjData, time: float) -> None:
    """Raise `EngineDiverged` where MuJoCo has warned of anything up to a time (s): only its warnings tell."""
    if given := warnings(data):
        # It answers a bad state by starting over from the initial one, and drops what its buffers cannot hold.
        signal, answer = (EngineReset, "reset itself after") if RESETS & set(given.values()) else (EngineDiverged, "warned of")
        raise signal(f"MuJoCo {answer} {', '.join(given)} at t = {time:.6g} s")


class Rollouts:
    """A MuJoCo model and its data, advanced by `mujoco.rollout`."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, joints: Joints, force: Force | None) -> None:
        self.model, self.data, self.joints, self.force = model, data, joints, force
        self.pool = Pool(nthread=0)
        # Row 0 is the state at which the simulation stands, the rows below are those of one rollout. They are filled, so that
        # the memory is there before the first step.
        self.states = np.full((CHUNK + 1, mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)), 0.0)
        mujoco.mj_getState(model, data, self.states[0], mujoco.mjtState.mjSTATE_FULLPHYSICS)

    def advance(self, strides: Strides) -> Array:
        ends = np.cumsum(strides)
        columns = slice(1, 1 + self.model.nq + self.model.nv)
        rows = np.empty((len(strides), self.model.nq + self.model.nv))
        done = 0
        while True:
            count = min(CHUNK, int(ends[-1]) - done)
            if count:
                self._step(count)
            first, last = np.searchsorted(ends, (done, done + count + 1))
            rows[first:last] = self.states[ends[first:last] - done, columns]
            # A rollout stands still after a warning, and a reset turns its clock back.
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
        with acting(self.force):
            self.pool.rollout(
                self.model,
                self.data,
                start[None],
                nstep=count,
                initial_warmstart=self.data.qacc_warmstart[None],
                state=following[None],
            )


class Steps:
    """Likewise, advanced by `mj_step`, a stride a call."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, joints: Joints, force: Force | None) -> None:
        self.model, self.data, self.joints, self.force = model, data, joints, force

    def advance(self, strides: Strides) -> Array:
        data, nq = self.data, self.model.nq
        rows = np.empty((len(strides), nq + self.model.nv))
        with acting(self.force):
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
        """Take a stride in which MuJoCo has warned again, up to that step. Raises `EngineDiverged`."""
        data = self.data
        mujoco.mj_resetData(self.model, data)
        data.time, data.qpos[:], data.qvel[:], data.qacc_warmstart[:] = before
        for _ in range(stride):
            time = data.time
            mujoco.mj_step(self.model, data)
            refuse_warnings(data, max(time, data.time))
