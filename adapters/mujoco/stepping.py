"""Step a MuJoCo model by `mujoco.rollout`, a loop in C that returns every state, or by one call of `mj_step` a stride.

Both take the same steps, and stop at the first warning that MuJoCo gives. Releases before 3.2.7 lack rollouts.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import lru_cache
from typing import Any

import mujoco
import numpy as np

from bodycheck.adapters.contract import EngineDiverged, EngineReset, Strides, single
from bodycheck.adapters.mujoco.models import Force
from bodycheck.reference.trajectory import Array

#: The number of steps of a rollout, and of steps between checks for MuJoCo's warnings. A rollout returns every state, so this
#: number bounds the memory; a call costs as much time as about 30 steps.
STEPS_PER_ROLLOUT = 8192

#: The number of steps per sample from which one call of `mj_step` per sample is cheaper than a rollout, which copies every
#: state.
STEPS_WORTH_A_CALL = 5

#: The warnings of MuJoCo by name.
WARNINGS = {
    name.removeprefix("mjWARN_"): kind for name, kind in mujoco.mjtWarning.__members__.items() if name.startswith("mjWARN_")
}
#: The warnings after which MuJoCo resets the simulation.
RESET_WARNINGS = {mujoco.mjtWarning.mjWARN_BADQPOS, mujoco.mjtWarning.mjWARN_BADQVEL, mujoco.mjtWarning.mjWARN_BADQACC}

try:
    from mujoco.rollout import Rollout as Rollout
except ImportError:  # older than MuJoCo 3.2.7
    Rollout = None

#: The functions of MuJoCo that steps call from Python. The time of the Python functions that a step in turn calls, drag and
#: friction as external forces, counts as MuJoCo's time.
CALLS: tuple[tuple[Any, str], ...] = ((mujoco, "mj_step"), *(((Rollout, "rollout"),) if Rollout is not None else ()))


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
    if given_warnings := warnings(data):
        # After a bad state MuJoCo resets to the initial state; contacts that exceed its buffers are dropped with a warning.
        signal, answer = (
            (EngineReset, "reset itself after")
            if RESET_WARNINGS & set(given_warnings.values())
            else (EngineDiverged, "warned of")
        )
        raise signal(f"MuJoCo {answer} {', '.join(given_warnings)} at t = {time:.6g} s")


@lru_cache(maxsize=4)
def scratch(count: int) -> Array:
    """Return an array (count,) for the states of one rollout at a time, allocated before the first step is timed.

    All simulations of the process share it, because a thousand arrays would need a gigabyte.
    """
    return np.full(count, 0.0)


class Stepper:
    """A MuJoCo model and its data, which holds the current state, with the fastest way to advance it.

    Parameters
    ----------
    model, data
        MuJoCo's compiled model and its data, which hold the initial state.
    rows
        Converts n states (n, nq + nv) to rows (n, 13), or (n, bodies, 13), of the contract.
    force
        An external force; None if there is none.
    """

    def __init__(
        self, model: mujoco.MjModel, data: mujoco.MjData, rows: Callable[[Array], Array], force: Force | None = None
    ) -> None:
        self.model, self.data, self.rows, self.force = model, data, rows, force
        self.pool: Any = None if Rollout is None else Rollout(nthread=0)
        # Row 0 is the state before a rollout, and the other rows are the states of the rollout.
        size = 0 if Rollout is None else mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)
        self.states = scratch((STEPS_PER_ROLLOUT + 1) * size).reshape(STEPS_PER_ROLLOUT + 1, size)

    def advance(self, strides: Strides) -> Array:
        """Return the states (1, n, bodies, 13) after each of n strides, as `Simulation.advance` does."""
        # A rollout sets the applied forces to zero, unless they are passed for every step.
        pushed = bool(self.data.qfrc_applied.any())
        dense = self.pool is not None and not pushed and int(strides.sum()) < STEPS_WORTH_A_CALL * len(strides)
        with external_force(self.force):
            rows = self._by_rollouts(strides) if dense else self._by_strides(strides)
        return single(self.rows(rows))

    def _by_rollouts(self, strides: Strides) -> Array:
        """Return the coordinates and velocities (n, nq + nv) after each of n strides."""
        ends = np.cumsum(strides)
        columns = slice(1, 1 + self.model.nq + self.model.nv)
        rows = np.empty((len(strides), self.model.nq + self.model.nv))
        mujoco.mj_getState(self.model, self.data, self.states[0], mujoco.mjtState.mjSTATE_FULLPHYSICS)
        done = 0
        while True:
            count = min(STEPS_PER_ROLLOUT, int(ends[-1]) - done)
            if count:
                self._roll_out(count)
            first, last = np.searchsorted(ends, (done, done + count + 1))
            rows[first:last] = self.states[ends[first:last] - done, columns]
            # After a warning the clock of a rollout stands still, and after a reset it jumps back.
            clock = self.states[: count + 1, 0]
            try:
                refuse_warnings(self.data, float(clock.max()))
            except EngineDiverged as signal:
                sound = done + int(np.argmax(np.diff(clock, append=clock[-1]) <= 0))
                before = rows[: np.searchsorted(ends, sound, side="right")]
                signal.states = single(self.rows(np.vstack([before, self.states[count, None, columns]])[: len(rows)]))
                raise
            self.states[0] = self.states[count]
            done += count
            if done == ends[-1]:
                mujoco.mj_setState(self.model, self.data, self.states[0], mujoco.mjtState.mjSTATE_FULLPHYSICS)
                return rows

    def _roll_out(self, count: int) -> None:
        start, following = self.states[0], self.states[1 : count + 1]
        self.pool.rollout(
            self.model,
            self.data,
            start[None],
            nstep=count,
            initial_warmstart=self.data.qacc_warmstart[None],
            state=following[None],
        )

    def _by_strides(self, strides: Strides) -> Array:
        """Return the coordinates and velocities (n, nq + nv) after each of n strides."""
        rows = np.empty((len(strides), self.model.nq + self.model.nv))
        ends, first = np.cumsum(strides), 0
        while first < len(strides):
            # A few thousand steps, but at least one stride.
            last = max(first + 1, int(np.searchsorted(ends, ends[first] + STEPS_PER_ROLLOUT, side="right")))
            before = self._state()
            self._stride(strides[first:last], rows[first:last])
            if warnings(self.data):
                self._restore(before)
                self._find_warning(strides, rows, first)
            first = last
        return rows

    def _stride(self, strides: Strides, rows: Array) -> None:
        """Advance by n strides, and fill `rows` (n, nq + nv) with the coordinates and velocities after each stride."""
        step, model, data, nq = mujoco.mj_step, self.model, self.data, self.model.nq
        qpos, qvel = data.qpos, data.qvel  # a look-up costs as much time as the copy
        for row, stride in zip(rows, strides.tolist(), strict=True):
            if stride:
                step(model, data, stride)
            row[:nq] = qpos
            row[nq:] = qvel

    def _state(self) -> tuple[float, Array, Array, Array, Array]:
        data = self.data
        return data.time, data.qpos.copy(), data.qvel.copy(), data.qacc_warmstart.copy(), data.qfrc_applied.copy()

    def _restore(self, state: tuple[float, Array, Array, Array, Array]) -> None:
        """Restore a state with its applied forces, which a reset by MuJoCo clears, and clear all warnings."""
        data = self.data
        mujoco.mj_resetData(self.model, data)
        data.time, data.qpos[:], data.qvel[:], data.qacc_warmstart[:], data.qfrc_applied[:] = state

    def _find_warning(self, strides: Strides, rows: Array, first: int) -> None:
        """Repeat strides, from the index `first` on, in which MuJoCo gave a warning, to raise `EngineDiverged` at its step."""
        for index in range(first, len(strides)):
            before = self._state()
            self._stride(strides[index : index + 1], rows[index : index + 1])
            if not warnings(self.data):
                continue
            self._restore(before)
            try:
                for _ in range(strides[index]):
                    time = self.data.time
                    mujoco.mj_step(self.model, self.data)
                    refuse_warnings(self.data, max(time, self.data.time))
            except EngineDiverged as signal:
                rows[index] = np.concatenate([self.data.qpos, self.data.qvel])
                signal.states = single(self.rows(rows[: index + 1]))
                raise
