"""Run many members of an ensemble with one method of an engine, in this process, and find runs that may have failed.

Members in free flight are `Scenes`, which an engine with batching steps together. Any other member is a separate case and is
run alone, as `simulation.run` does.
"""

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bodycheck.adapters import offers, registry, stepping
from bodycheck.adapters.contract import Adapter, Method, Signals, Strides
from bodycheck.adapters.engine_name import in_words
from bodycheck.casefile.content import Case
from bodycheck.processes.process_state import TO_NEAREST, rounding
from bodycheck.reference.kinematics import geodesic_angle
from bodycheck.reference.scene import Scene
from bodycheck.reference.scenes import Scenes
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.results.outcome import Completed, Diverged, Outcome
from bodycheck.running import simulation
from bodycheck.running.simulation import UNIT_TOLERANCE
from bodycheck.running.state_checks import DIVERGED_ENERGY_RATIO, START_TOLERANCE
from bodycheck.running.states import rows_of, steps_to, trajectory_of

#: Factor on a limit: a number that is computed for all members at once and is below the reduced limit is certainly below the
#: limit in a single run, whose sums are rounded in another order.
CERTAIN = 0.99

#: The effects that scenes in free flight can require of a model.
OF_FLIGHT = frozenset({"gravity", "translation", "rotation"})


@dataclass(frozen=True, eq=False)
class Flown:
    """The runs of m members with one method of an engine, before they are judged.

    Attributes
    ----------
    engine, version
        The name of the engine and its version.
    names
        The names of the members' cases.
    method
        The method.
    times
        The times (n,), in s, of the states.
    steps
        The numbers of steps (m,) that the engine took to the end.
    states
        The states (m, n, 13), in the columns of `Simulation.advance`; NaN in the rows of members in `ended`.
    norm_error
        The largest deviations (m,) from 1 of the norms of quaternions, before the adapter normalised them; 0 if it does not.
    wall_time
        The wall time (s) of stepping, of all members together.
    ended
        The outcomes of the runs without rows in `states`, by the indices of their members.
    """

    engine: str
    version: str
    names: tuple[str, ...]
    method: Method
    times: Array
    steps: Strides
    states: Array
    norm_error: Array
    wall_time: float
    ended: Mapping[int, Outcome]

    def __len__(self) -> int:
        return len(self.names)

    def trajectory(self, k: int) -> Trajectory | None:
        """Return the states of a member; None if its engine returned none."""
        match self.ended.get(k):
            case None:
                return trajectory_of(self.times, self.states[k])
            case Completed() | Diverged() as outcome:
                return outcome.trajectory
            case _:
                return None


@dataclass(frozen=True)
class NormError:
    """The norm errors of one member from a simulation that normalises its quaternions; see `contract.Normalising`."""

    quaternion_norm_error: float


def fly(engine: str, method: Method, members: Scenes | Sequence[Case], times: Array, names: Sequence[str] = ()) -> Flown:
    """Run members with a method of an engine. An exception of the engine only ends the run that raises it.

    Parameters
    ----------
    engine
        The name of the engine.
    method
        The method, which the engine has.
    members
        The members: scenes in free flight, or cases. Cases are run one by one, each at its own instants.
    times
        The times (n,), in s, at which a run of a scene is sampled; those of a case follow from the case.
    names
        The names of the cases of scenes, for messages; by default the indices of the scenes.

    Raises
    ------
    EngineMissing
        If the engine is not installed or has no adapter.
    """
    if not isinstance(members, Scenes):
        return _cases_flown(engine, method, members)
    adapter, called = registry.load(engine), tuple(names) or tuple(map(str, range(len(members))))
    scenes = [members.scene(index) for index in range(len(members))]
    rows = _together(adapter, scenes, method, times) or _one_by_one(adapter, engine, scenes, method, times, called)
    version = adapter.engine.version
    return Flown(
        *(engine, version, called, method, times, rows.steps, rows.states, rows.norm_error, rows.wall_time, rows.ended)
    )


def doubtful(scenes: Scenes, trajectory: Trajectory, kinetic_energy: Array, off: Array) -> NDArray[np.bool_]:
    """Return which runs (m,) may not have completed by `simulation.outcome_of`; all others have certainly completed.

    Parameters
    ----------
    scenes
        The m scenes.
    trajectory
        Their states, whose arrays have the axes (m, n).
    kinetic_energy
        The kinetic energy (m, n), J, of these states.
    off
        Their `norm_deviations` (m, n).
    """
    last = float(trajectory.t[-1])
    speed = _length(scenes.velocity) + scenes.gravity * last
    momentum = _length(scenes.moments * scenes.angular_velocity)
    most = scenes.mass * speed**2 / 2 + momentum**2 / (2 * scenes.moments.min(axis=-1))
    parts = (trajectory.position, trajectory.quaternion, trajectory.velocity, trajectory.angular_velocity)
    # A comparison with NaN is false, but a position that is not a number changes neither the energy nor the norm.
    sound = np.isfinite(trajectory.position).all(axis=(1, 2))
    sound &= (kinetic_energy <= CERTAIN * DIVERGED_ENERGY_RATIO * most[:, None]).all(axis=-1)
    sound &= (off <= UNIT_TOLERANCE).all(axis=-1)
    sound &= np.logical_or.reduce([(part[:, -1] != part[:, 0]).any(axis=-1) for part in parts])
    return np.asarray(~(sound & _begins(scenes, trajectory)))


def norm_deviations(trajectory: Trajectory) -> Array:
    """Return the deviations from 1 (..., n) of the norms of the quaternions of a trajectory."""
    return np.asarray(np.abs(np.hypot.reduce(trajectory.quaternion, axis=-1) - 1))


def _begins(scenes: Scenes, trajectory: Trajectory) -> NDArray[np.bool_]:
    """Return flags (m,): true if a trajectory certainly begins at the state of its scene, or begins after t = 0."""
    if trajectory.t[0] != 0:
        return np.ones(len(scenes), dtype=bool)
    pairs = (
        (trajectory.position[:, 0], scenes.position),
        (trajectory.velocity[:, 0], scenes.velocity),
        (trajectory.angular_velocity[:, 0], scenes.angular_velocity),
    )
    near = [_length(got - asked) <= CERTAIN * START_TOLERANCE * np.maximum(1.0, _length(asked)) for got, asked in pairs]
    turned = geodesic_angle(trajectory.quaternion[:, 0], scenes.quaternion)
    return np.asarray(np.logical_and.reduce([*near, turned <= CERTAIN * START_TOLERANCE]))


def _length(vectors: Array) -> Array:
    return np.asarray(np.hypot.reduce(vectors, axis=-1))


@dataclass(frozen=True, eq=False)
class _Rows:
    """The rows of all members in `Flown`, and the outcomes of the runs without rows."""

    steps: Strides
    states: Array
    norm_error: Array
    wall_time: float
    ended: dict[int, Outcome]


def _together(adapter: Adapter, scenes: Sequence[Scene], method: Method, times: Array) -> _Rows | None:
    """Return the runs of all scenes, made at once; None if the engine cannot do so, and each must be made separately."""
    record = adapter.engine
    if record.batch == 1 or len(scenes) == 1 or not record.models >= OF_FLIGHT or times[-1] == 0:
        return None
    if offers.not_offered(record, scenes[0], method) is not None:
        return None
    steps = steps_to(times, method)
    try:
        prepared = offers.prepare(adapter, scenes, method)
        with np.errstate(all="ignore"):  # runs that overflow are judged by their states
            start = time.perf_counter()
            returned = prepared.advance(np.diff(steps, prepend=0))
            wall_time = time.perf_counter() - start
        states = rows_of(returned, len(scenes), len(times))
    except (Exception, SystemExit):  # an engine may raise anything, perhaps only for some of the scenes
        return None
    signals = prepared.signals if isinstance(prepared, Signals) else {}
    ended: dict[int, Outcome] = {index: Diverged(text, "gave up") for index, text in signals.items()}
    if rounding() != TO_NEAREST:
        ended = dict.fromkeys(range(len(scenes)), simulation.OTHER_ROUNDING)
    taken = np.full(len(scenes), steps[-1])
    return _Rows(taken, states, stepping.norm_errors(prepared, len(scenes)), wall_time, ended)


def _one_by_one(
    adapter: Adapter, engine: str, scenes: Sequence[Scene], method: Method, times: Array, names: Sequence[str]
) -> _Rows:
    """Return the runs of scenes, each made separately."""
    states, norm_error = np.full((len(scenes), len(times), 13), np.nan), np.zeros(len(scenes))
    steps, ended, wall_time = np.zeros(len(scenes), dtype=np.int64), dict[int, Outcome](), 0.0
    for index, (scene, name) in enumerate(zip(scenes, names, strict=True)):
        try:
            outcome = simulation.outcome_in(adapter, engine, scene, method, times)
        except (Exception, SystemExit) as error:  # an engine may raise anything
            outcome = simulation.ended_by(error, in_words(engine, adapter.engine.version), name)
        outcome = simulation.where_rounded_to_nearest(outcome)
        if not isinstance(outcome, Completed):
            ended[index] = outcome
            continue
        motion = outcome.trajectory
        states[index] = np.hstack([motion.position, motion.quaternion, motion.velocity, motion.angular_velocity])
        norm_error[index] = outcome.quaternion_norm_error or 0.0
        steps[index] = outcome.steps
        wall_time += outcome.wall_time
    return _Rows(steps, states, norm_error, wall_time, ended)


def _cases_flown(engine: str, method: Method, cases: Sequence[Case]) -> Flown:
    """Return the runs of cases, each made separately; the outcomes of all of them are in `Flown.ended`."""
    runs = [simulation.run(case, engine, method) for case in cases]
    return Flown(
        engine=engine,
        version=registry.load(engine).engine.version,
        names=tuple(case.name for case in cases),
        method=method,
        times=np.empty(0),
        steps=np.zeros(len(cases), dtype=np.int64),
        states=np.empty((len(cases), 0, 13)),
        norm_error=np.zeros(len(cases)),
        wall_time=sum(run.outcome.wall_time for run in runs if isinstance(run.outcome, Completed)),
        ended={index: run.outcome for index, run in enumerate(runs)},
    )
