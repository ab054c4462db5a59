"""Carry out a chunk of an ensemble: worker processes fly its members and judge their runs, and its files are written.

An engine and the reference never share a process. A block whose call fails, because a process dies or exceeds its time, is
flown again in halves, until the members that cause this are alone. The judgement is always about a whole block, so that no row
depends on how a block was halved.
"""

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from bodycheck.adapters.method import Method
from bodycheck.errors import BadInput, Failed
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.trajectory import Trajectory
from bodycheck.results import versions
from bodycheck.results.trajectory_files import STATE_COLUMNS
from bodycheck.running import engines
from bodycheck.running.members import chunk_files
from bodycheck.running.members.blocks import Flown
from bodycheck.running.members.chunk_files import (
    MEMBERS,
    RUN_SCHEMA,
    RUNS,
    TRAJECTORIES,
    TRAJECTORY_SCHEMA,
    TRUTH_SCHEMA,
    TRUTHS,
)
from bodycheck.running.members.chunk_workers import ChunkWorkers, in_halves, limit_of
from bodycheck.running.members.chunks import Chunk, Receipt
from bodycheck.running.members.member_runs import FLYING, Flight, Stored, joined
from bodycheck.studies.ensemble.execution.calls import (
    JUDGE,
    Drawing,
    Drawn,
    Judged,
    Judging,
    Refused,
    TruthTable,
    case_of,
    times_of,
)


@dataclass
class _Output:
    """The tables to write for a chunk, and the contents of its receipt.

    Attributes
    ----------
    tables
        The tables of each block, by kind.
    kept
        The trajectories that are kept, by the index of the method and the member.
    worst
        The worst member so far, with the distance from the ideal value, by the index of the method and the figure.
    always
        The keys of trajectories in `kept` that are kept whether their members are the worst or not.
    failed, engine_seconds, truth_seconds
        As in `Receipt`.
    """

    tables: dict[str, list[Any]] = field(default_factory=lambda: {kind: [] for kind in chunk_files.KINDS})
    kept: dict[tuple[int, int], Trajectory] = field(default_factory=dict)
    worst: dict[tuple[int, str], tuple[float, int]] = field(default_factory=dict)
    always: set[tuple[int, int]] = field(default_factory=set)
    failed: int = 0
    engine_seconds: float = 0.0
    truth_seconds: float = 0.0

    def keep(self, index: int, rows: Judged) -> None:
        """Keep the trajectories of a block with a method, given by its index, and drop those that are no longer the worst."""
        self.kept |= {(index, member): motion for member, motion in rows.trajectories.items()}
        self.always |= {(index, member) for member in rows.sampled}
        for name, extreme in rows.worst.items():
            if (index, name) not in self.worst or extreme[0] > self.worst[index, name][0]:
                self.worst[index, name] = extreme
        wanted = self.always | {(method, member) for (method, _), (_, member) in self.worst.items()}
        self.kept = {key: motion for key, motion in self.kept.items() if key in wanted}


def carry_out(chunk: Chunk, workers: ChunkWorkers, folder: Path) -> Receipt:
    """Carry out a chunk, and write its files into the folder of the ensemble, in place of files of an earlier attempt.

    Raises
    ------
    BadInput
        If a member is no valid case, or this machine has other versions than the command.
    NotWritten
        If a file cannot be written.
    Failed
        If the reference fails or does not finish.
    Cancelled
        If nobody waits for the result any more.
    """
    start = time.perf_counter()
    _check_versions(chunk)
    output = _Output()
    for block in chunk.blocks:
        _add_block(output, chunk, workers, block)
    output.tables[TRAJECTORIES] = [_trajectories(chunk, output)]
    workers.check()
    for kind in (TRUTHS, MEMBERS, TRAJECTORIES, RUNS):  # a chunk is done once its file of runs exists
        if output.tables[kind]:
            chunk_files.write(folder, chunk, kind, output.tables[kind])
    return Receipt(
        chunk.name,
        chunk.share.engine,
        chunk.first,
        chunk.count,
        chunk.rows,
        output.failed,
        time.perf_counter() - start,
        output.engine_seconds,
        output.truth_seconds,
        chunk_files.digest(output.tables[RUNS]),
    )


def _check_versions(chunk: Chunk) -> None:
    """Raise `BadInput` unless this machine has the versions of the command."""
    name = chunk.share.engine
    versions.check(chunk.work.versions, versions.here(), "a worker")
    records, faults = engines.describe([name])
    if name in faults:
        raise BadInput(f"a worker cannot use {name}: {faults[name].reason}")
    versions.check({name: chunk.share.version}, {name: records[name].version}, "a worker")


def _add_block(output: _Output, chunk: Chunk, workers: ChunkWorkers, block: range) -> None:
    """Fly and judge a block with all methods, and add its tables and trajectories to the output."""
    work, share = chunk.work, chunk.share
    drawn: Drawn = _ask(chunk, workers, Drawing(work, block))
    judged: list[Judged] = []
    for index, method in enumerate(share.methods):
        flown = _flown(chunk, workers, block, drawn, method)
        rows: Judged = _ask(chunk, workers, Judging(work, block, flown))
        output.keep(index, rows)
        output.engine_seconds += flown.wall_time
        output.truth_seconds += rows.seconds
        output.failed += rows.failures
        judged.append(rows)
    constant = {"engine": share.engine, "version": share.version}
    spellings: list[dict[str, str | float]] = [
        {"integrator": method.name, "timestep": method.timestep} for method in share.methods
    ]
    columns = [rows.columns for rows in judged]
    output.tables[RUNS].append(_table(chunk, block, columns, spellings, constant, RUN_SCHEMA))
    if share.truths_of:
        columns = [_ask(chunk, workers, TruthTable(work, block, sampling)) for sampling in share.truths_of]
        steps: list[dict[str, str | float]] = [{"timestep": sampling} for sampling in share.truths_of]
        output.tables[TRUTHS].append(_table(chunk, block, columns, steps, {}, TRUTH_SCHEMA))
        schema = chunk_files.member_schema(work.source.names)
        output.tables[MEMBERS].append(_table(chunk, block, [dict(drawn.columns)], [{}], {}, schema))


def _ask(chunk: Chunk, workers: ChunkWorkers, question: Drawing | TruthTable | Judging) -> Any:
    """Ask the worker process of the reference. Raises `BadInput` for a member that is no valid case, and `Failed`."""
    work = chunk.work
    answer = workers.call(JUDGE, None, work.limit, work.memory, question)
    if isinstance(answer, Refused):
        raise BadInput(answer.text)
    if isinstance(answer, Crashed | TimedOut):
        members = f"members {question.block.start} to {question.block.stop - 1}"
        raise Failed(f"the reference fails for {members} of {case_of(work.case).name}: {answer.reason}")
    return answer


def _flown(chunk: Chunk, workers: ChunkWorkers, block: range, drawn: Drawn, method: Method) -> Flown | Stored:
    """Return the outcomes of the runs of a block. Runs that end their process or do not finish are isolated by halving."""
    work, share = chunk.work, chunk.share
    name = case_of(work.case).name
    names = tuple(f"{name}-{member}" for member in block)
    times, file = times_of(work.case, method.sampling), workers.folder / "states.npy"
    flight = Flight(share.engine, share.version, method, drawn.members, times, names, file)

    def attempt(first: int, last: int) -> Flown | Stored | Crashed | TimedOut:
        if last - first == len(block):
            runs = workers.call(FLYING, share.engine, work.limit, work.memory, flight)
        else:
            limit = limit_of(last - first, len(block), work.limit)
            runs = workers.call_apart(FLYING, share.engine, limit, work.memory, flight.part(first, last))
        assert isinstance(runs, Flown | Stored | Crashed | TimedOut)
        return runs

    return joined(flight, in_halves(attempt, 0, len(block)))


def _table(
    chunk: Chunk,
    block: range,
    columns: Sequence[Mapping[str, Any]],
    each_row: Sequence[Mapping[str, str | float]],
    constant: Mapping[str, str],
    schema: Any,
) -> Any:
    """Return the table of a block, in which the rows of a member follow each other.

    Parameters
    ----------
    chunk, block
        The chunk and the members.
    columns
        The columns (m,) by name, for each of the rows of a member.
    each_row
        The values that each of these rows has for all members.
    constant
        The values that all rows have.
    schema
        The columns of the table.
    """
    m, each = len(block), len(columns)
    together: dict[str, Any] = {"case": case_of(chunk.work.case).name, **constant}
    together["member"] = np.repeat(np.asarray(block), each)
    together |= {name: [one[name] for one in each_row] * m for name in each_row[0]}
    for name in columns[0]:
        together[name] = np.stack([one[name] for one in columns], axis=1).ravel()
    return chunk_files.table(together, schema)


def _trajectories(chunk: Chunk, output: _Output) -> Any:
    """Return the table of the trajectories that are kept, in the order of members and methods."""
    parts: dict[str, list[Any]] = {field.name: [] for field in TRAJECTORY_SCHEMA}
    case = case_of(chunk.work.case)
    names = [body.name for body in case.scene.bodies] if isinstance(case.scene, Mechanism) else [""]
    for index, member in sorted(output.kept, key=lambda key: (key[1], key[0])):
        motion, method = output.kept[index, member], chunk.share.methods[index]
        labels: dict[str, Any] = {"case": case.name, "engine": chunk.share.engine, "integrator": method.name}
        labels |= {"timestep": method.timestep, "member": member, "kept": ""}
        for body, name in enumerate(names):
            body_motion = motion.body(body) if isinstance(case.scene, Mechanism) else motion
            states = np.hstack(
                [body_motion.position, body_motion.quaternion, body_motion.velocity, body_motion.angular_velocity]
            )
            for column, value in {**labels, "body": name}.items():
                parts[column] += [value] * len(body_motion)
            for column, values in {"t": body_motion.t, **dict(zip(STATE_COLUMNS, states.T, strict=True))}.items():
                parts[column] += values.tolist()
    return chunk_files.table(parts, TRAJECTORY_SCHEMA)
