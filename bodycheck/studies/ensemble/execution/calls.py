"""The calls in a worker process of the reference about a block of members: draw it, compute its truths, and judge runs.

Each answer follows from the question alone. The members and the truths of the last block are kept, because several questions
are about the same block.
"""

import time
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from numpy.typing import NDArray

from bodycheck.casefile.case import Case, parse_stored
from bodycheck.errors import BadInput
from bodycheck.figures.columns import FIGURES, distance_from_ideal
from bodycheck.judging import members as judging
from bodycheck.reference.flight.flights import Flights, flights
from bodycheck.reference.scenes import Scenes
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truths import NoTruth, Truth
from bodycheck.results.outcome import Completed, Unsupported
from bodycheck.running.instants import sampling_times
from bodycheck.running.members.blocks import Flown
from bodycheck.running.members.chunk_workers import Role
from bodycheck.running.members.chunks import Work
from bodycheck.running.members.member_runs import Stored
from bodycheck.studies.ensemble.drawing import members
from bodycheck.studies.ensemble.execution import truths

#: Most failed runs of a method in a block whose trajectories are kept.
MOST_FAILURES = 20


@dataclass(frozen=True, eq=False)
class Drawing:
    """The question for the members of a block."""

    work: Work
    block: range


@dataclass(frozen=True, eq=False)
class Drawn:
    """The members of a block.

    Attributes
    ----------
    columns
        The drawn numbers (m,) by the names of their columns.
    members
        The members: scenes in free flight, or cases.
    """

    columns: Mapping[str, Array]
    members: Scenes | tuple[Case, ...]


@dataclass(frozen=True)
class Refused:
    """A member is no valid case; the text says which and why."""

    text: str


@dataclass(frozen=True, eq=False)
class TruthTable:
    """The question for the stored columns (m,) of the truths of a block, for runs with a sampling."""

    work: Work
    block: range
    sampling: float


@dataclass(frozen=True, eq=False)
class Judging:
    """The question for the rows of the runs of a block with one method."""

    work: Work
    block: range
    flown: Flown | Stored


@dataclass(frozen=True, eq=False)
class Judged:
    """The rows of the runs of a block with one method.

    Attributes
    ----------
    columns
        The columns (m,) that differ between members.
    failures
        The number of runs that failed.
    worst
        The distance from the ideal value and the member of the worst run, by the name of the figure.
    trajectories
        The trajectories of the first failures, of the worst members and of the members of the sample, by member.
    sampled
        The members whose trajectories are kept whatever other blocks have: the first failures, and the members of the sample.
    seconds
        The time (s) in which the truths of the block were computed; 0 if they were kept from an earlier answer.
    """

    columns: dict[str, Any]
    failures: int
    worst: dict[str, tuple[float, int]]
    trajectories: dict[int, Trajectory]
    sampled: frozenset[int]
    seconds: float


def answer(question: Drawing | TruthTable | Judging) -> Drawn | dict[str, Any] | Judged | Refused:
    """Answer a question; `Refused` if a member is no valid case."""
    try:
        match question:
            case Drawing(work, block):
                return _drawn(work, block)
            case TruthTable(work, block, sampling):
                of_block, _ = _truths(work, block, sampling)
                return truths.columns(case_of(work.case), _drawn(work, block).columns, block, sampling, of_block)
            case Judging(work, block, flown):
                return _judged(work, block, flown.read() if isinstance(flown, Stored) else flown)
    except BadInput as error:
        return Refused(str(error))


@lru_cache(maxsize=1)
def case_of(text: str) -> Case:
    """Return the case in the text of a chunk."""
    return parse_stored(text, "the case of the ensemble")


def times_of(text: str, sampling: float) -> Array:
    """Return the times (n,), in s, at which runs of the case in a text with a sampling are sampled."""
    return sampling_times(case_of(text).instants, sampling)


class _Last:
    """The last value that was computed, and its key."""

    def __init__(self) -> None:
        self.key: object = None
        self.value: Any = None


_last_drawn, _last_truths = _Last(), _Last()


def _drawn(work: Work, block: range) -> Drawn:
    if _last_drawn.key != (key := (work.identity, block)):
        values = work.source.values(block.start, len(block))
        scenes = members.scenes(case_of(work.case), values, block.start)
        _last_drawn.value = Drawn(_columns(values), scenes if isinstance(scenes, Scenes) else tuple(scenes))
        _last_drawn.key = key
    drawn: Drawn = _last_drawn.value
    return drawn


def _columns(values: Mapping[str, Array]) -> dict[str, Array]:
    """Return drawn values, arrays (m,) and (m, k), as arrays (m,) by the names of columns."""
    columns = {}
    for key, array in values.items():
        if array.ndim == 1:
            columns[key] = array
        else:
            columns |= {f"{key}.{component}": array[:, component] for component in range(array.shape[1])}
    return columns


def _truths(work: Work, block: range, sampling: float) -> tuple[Flights | tuple[Truth | NoTruth, ...], float]:
    """Return the truths of a block, with a-priori bounds alone, and the time (s) of their computation; 0 if they were kept."""
    if _last_truths.key == (key := (work.identity, block, sampling)):
        return _last_truths.value, 0.0
    start = time.perf_counter()
    scenes = _drawn(work, block).members
    _last_truths.key = None  # the next value replaces the kept one
    if isinstance(scenes, Scenes):
        _last_truths.value = flights(scenes, times_of(work.case, sampling))
    else:
        _last_truths.value = tuple(truths.of_case(case, sampling) for case in scenes)
    _last_truths.key = key
    return _last_truths.value, time.perf_counter() - start


def _judged(work: Work, block: range, flown: Flown) -> Judged:
    case, scenes = case_of(work.case), _drawn(work, block).members
    of_block, seconds = _truths(work, block, flown.method.sampling)
    if isinstance(scenes, Scenes) and isinstance(of_block, Flights):
        columns = judging.judged(scenes, of_block, flown, flown.method, case.expectations, work.today)
        columns |= _costs_together(columns["status"], flown)
    else:
        assert not isinstance(scenes, Scenes)
        assert not isinstance(of_block, Flights)
        columns = judging.one_by_one(scenes, of_block, flown, work.today)
        columns |= _costs_each(columns["status"], flown)
    bad = failed_runs(pa.array(columns["status"], pa.string()), pa.array(columns["passed"], pa.bool_()))
    distances = ((name, distance_from_ideal(name, columns[name])) for name in FIGURES)
    worst = {
        name: extreme for name, figure_distances in distances if (extreme := worst_member(figure_distances, block)) is not None
    }
    sample = {member for member in block if member % work.sample == 0}
    sampled = sample | {block[index] for index in np.flatnonzero(bad)[:MOST_FAILURES].tolist()}
    wanted = sorted(sampled | {member for _, member in worst.values()})
    motions = {member: flown.trajectory(member - block.start) for member in wanted}
    kept = {member: _copied(motion) for member, motion in motions.items() if motion is not None}
    return Judged(columns, int(bad.sum()), worst, kept, frozenset(sampled), seconds)


def _copied(motion: Trajectory) -> Trajectory:
    """Return a copy of a trajectory, because a view of the arrays of a block would be sent with the whole arrays."""
    return Trajectory(*(np.array(getattr(motion, name)) for name in motion.__dataclass_fields__))


def _costs_together(status: Any, flown: Flown) -> dict[str, Any]:
    """Return steps and wall times (m,) of completed runs that were stepped together: each has an equal share of the time."""
    completed = status == Completed.status
    steps = np.full(len(status), None, dtype=object)
    steps[completed] = flown.steps[completed].tolist()
    return {"steps": steps, "wall_time": np.where(completed, flown.wall_time / len(status), np.nan)}


def _costs_each(status: Any, flown: Flown) -> dict[str, Any]:
    """Return steps and wall times (m,) of completed runs that were stepped one by one."""
    steps, wall_times = np.full(len(status), None, dtype=object), np.full(len(status), np.nan)
    for index, outcome in flown.ended.items():
        if isinstance(outcome, Completed) and status[index] == Completed.status:
            steps[index], wall_times[index] = outcome.steps, outcome.wall_time
    return {"steps": steps, "wall_time": wall_times}


def failed_runs(status: pa.Array, passed: pa.Array) -> NDArray[np.bool_]:
    """Return flags (n,) of the runs that failed: their status is neither ok nor unsupported, or they have not passed."""
    fine = pc.is_in(status, value_set=pa.array([Completed.status, Unsupported.status]))
    return np.asarray(~fine.to_numpy(zero_copy_only=False) | ~passed.fill_null(True).to_numpy(zero_copy_only=False))


def worst_member(distances: Array, members: Any) -> tuple[float, int] | None:
    """Return the largest of the distances (n,) of some members (n,) from the ideal value, and the first member with it.

    None if all are NaN, which is no value.
    """
    if np.isnan(distances).all():
        return None
    index = int(np.nanargmax(distances))
    return float(distances[index]), int(members[index])


#: The role of worker processes of the reference.
JUDGE = Role(answer, truths.prepare)
