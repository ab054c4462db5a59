"""Make the tables of an ensemble from the files of its chunks, in one folder or in the folders of several jobs.

Rows are copied block by block in the order of the plan. The worst members are found on the way. Their truths are then compared
with witnesses, and their trajectories are kept.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
from numpy.typing import NDArray

from bodycheck.casefile.case import parse_stored
from bodycheck.errors import BadFolder, BadInput
from bodycheck.figures.columns import ALWAYS_TABLED, FIGURES, distance_from_ideal
from bodycheck.files import reading, writing
from bodycheck.processes import pool
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.results import versions
from bodycheck.running.members import chunk_files, compaction
from bodycheck.running.members.chunk_files import (
    MAX_BYTES,
    MEMBERS,
    RUN_SCHEMA,
    RUNS,
    TRAJECTORIES,
    TRAJECTORY_SCHEMA,
    TRUTH_SCHEMA,
    TRUTHS,
    ChunkFile,
)
from bodycheck.running.members.chunks import Share
from bodycheck.studies.ensemble import header as headers
from bodycheck.studies.ensemble.execution.calls import failed_runs, worst_member
from bodycheck.studies.ensemble.execution.truths import VOUCHER, Vouching, vouch
from bodycheck.studies.ensemble.header import EnsembleHeader

#: Most failed runs of a method whose trajectories are kept.
MOST_FAILURES = 100

#: The number of comparisons with witnesses for each process, whose start takes as long as these.
VOUCHED_EACH = 16

Where = Mapping[int, tuple[ChunkFile, int]]


@dataclass
class Remarkable:
    """The remarkable members of an ensemble.

    Attributes
    ----------
    worst
        The largest distance from the ideal value and the first member that has it, by the engine, the index of the method, and
        the name of the figure.
    failed
        The first members that failed, by the engine and the index of the method.
    """

    worst: dict[tuple[str, int, str], tuple[float, int]] = field(default_factory=dict)
    failed: dict[tuple[str, int], list[int]] = field(default_factory=dict)

    def members(self, engine: str, method: int) -> set[int]:
        """Return the members that are the worst in a figure of a method."""
        return {
            member
            for (of_engine, of_method, _), (_, member) in self.worst.items()
            if (of_engine, of_method) == (engine, method)
        }


def runs_of(files: Sequence[ChunkFile], head: EnsembleHeader, engine: str, kind: str = RUNS) -> Where:
    """Return the file and the row group of each block of an engine, by its first member."""
    engine_files = [file for file in files if file.kind == kind and file.engine == chunk_files.folder_of(engine)]
    return chunk_files.blocks(engine_files, head["members"], head["block"])


def done(files: Sequence[ChunkFile], head: EnsembleHeader, share: Share) -> set[int]:
    """Return the first members of the blocks of an engine for which all files exist."""
    kinds = [RUNS, TRAJECTORIES, *([MEMBERS, TRUTHS] if share.truths_of else [])]
    return set.intersection(*(set(runs_of(files, head, share.engine, kind)) for kind in kinds))


def compact(folder: Path, head: EnsembleHeader, sources: Sequence[Path], jobs: int) -> None:
    """Write the tables of an ensemble and its header, and remove the files of chunks in its folder.

    Parameters
    ----------
    folder
        The folder for the tables.
    head
        The header of the ensemble.
    sources
        The folders with the files of its chunks.
    jobs
        The number of processes in which truths are compared with witnesses.

    Raises
    ------
    BadFolder
        If members are missing, or a file is damaged.
    """
    files = [file for source in sources for file in chunk_files.found(source, head["identity"])]
    shares = [headers.share_of(share) for share in head["shares"]]
    _refuse_missing(files, head, shares)
    notable = Remarkable()
    schema = _measured(files, head, shares)
    for share in shares:
        into = folder / RUNS / chunk_files.folder_of(share.engine) / head["case"]
        where = runs_of(files, head, share.engine)
        compaction.write(_watched(where, head["block"], share, notable), schema, into, folder)
    _write_members(folder, head, files, shares[0])
    _write_truths(folder, head, files, shares, notable, jobs)
    for share in shares:
        into = folder / TRAJECTORIES / chunk_files.folder_of(share.engine) / head["case"]
        compaction.write(_kept(files, head, share, notable), TRAJECTORY_SCHEMA, into, folder)
    headers.write(folder, {**head, "complete": True})
    compaction.remove(folder / chunk_files.CHUNKS, folder)


def _refuse_missing(files: Sequence[ChunkFile], head: EnsembleHeader, shares: Sequence[Share]) -> None:
    """Raise `BadFolder`, naming members that were not run, if there are any."""
    for share in shares:
        there = done(files, head, share)
        absent = [first for first in range(0, head["members"], head["block"]) if first not in there]
        if absent:
            last = min(absent[0] + head["block"], head["members"]) - 1
            more = f" and {len(absent) - 1} further blocks of members" if len(absent) > 1 else ""
            raise BadFolder(
                f"members {absent[0]} to {last}{more} were not run in {share.engine}: run the jobs again that did not come to "
                "their end; they go on where they stopped"
            )


def _measured(files: Sequence[ChunkFile], head: EnsembleHeader, shares: Sequence[Share]) -> Any:
    """Return the schema of runs, without the figures that no run has."""
    present = set(ALWAYS_TABLED)
    for share in shares:
        for path in dict.fromkeys(file.path for file, _ in runs_of(files, head, share.engine).values()):
            metadata = pq.read_metadata(pa.BufferReader(reading.content(path, MAX_BYTES)))
            for group in (metadata.row_group(index) for index in range(metadata.num_row_groups)):
                columns = (group.column(index) for index in range(group.num_columns))
                present |= {one.path_in_schema for one in columns if _has_values(one, group.num_rows)}
    return pa.schema([field for field in RUN_SCHEMA if field.name not in FIGURES or field.name in present])


def _has_values(column: Any, rows: int) -> bool:
    """Return whether a column of a row group may have values, by its statistics; True if it has none."""
    return column.statistics is None or column.statistics.null_count != rows


def _watched(where: Where, block: int, share: Share, notable: Remarkable) -> Iterator[Any]:
    """Yield the tables of runs of an engine, and note its remarkable members."""
    count = len(share.methods)
    for table in chunk_files.tables(where, RUN_SCHEMA, block, count):
        member = table["member"].to_numpy()
        bad = failed_runs(table["status"].combine_chunks(), table["passed"].combine_chunks())
        for index in range(count):
            method_rows = slice(index, None, count)  # the methods of a member follow each other
            failures = notable.failed.setdefault((share.engine, index), [])
            failures += member[method_rows][bad[method_rows]][: MOST_FAILURES - len(failures)].tolist()
        for name in FIGURES:
            if table[name].null_count == len(table):
                continue
            values = distance_from_ideal(name, table[name].to_numpy())
            for index in range(count):
                _note(notable.worst, (share.engine, index, name), values[index::count], member[index::count])
        yield table


def _note(
    worst: dict[tuple[str, int, str], tuple[float, int]], key: tuple[str, int, str], values: Any, members: NDArray[np.int64]
) -> None:
    """Note the worst of some members, if it is worse than the member noted so far; NaN is no value."""
    extreme = worst_member(values, members)
    if extreme is not None and (key not in worst or extreme[0] > worst[key][0]):
        worst[key] = extreme


def _write_members(folder: Path, head: EnsembleHeader, files: Sequence[ChunkFile], share: Share) -> None:
    schema = chunk_files.member_schema(head["drawn"])
    where = runs_of(files, head, share.engine, MEMBERS)
    compaction.write(chunk_files.tables(where, schema, head["block"]), schema, folder / MEMBERS / head["case"], folder)


def _write_truths(
    folder: Path, head: EnsembleHeader, files: Sequence[ChunkFile], shares: Sequence[Share], notable: Remarkable, jobs: int
) -> None:
    """Compare the truths of the worst members with witnesses, and write all truths."""
    vouched = dict(_vouched(head, files, shares, notable, jobs))

    def tables() -> Iterator[Any]:
        for share in shares:
            if share.truths_of:
                where = runs_of(files, head, share.engine, TRUTHS)
                for table in chunk_files.tables(where, TRUTH_SCHEMA, head["block"], len(share.truths_of)):
                    yield _replaced(table, vouched)

    compaction.write(tables(), TRUTH_SCHEMA, folder / TRUTHS / head["case"], folder)


def _vouched(
    head: EnsembleHeader, files: Sequence[ChunkFile], shares: Sequence[Share], notable: Remarkable, jobs: int
) -> Iterator[tuple[tuple[float, int], dict[str, Any]]]:
    """Yield the truths of the worst members, compared with witnesses, by sampling and member."""
    wanted: dict[tuple[float, int], None] = {}
    for (engine, index, _), (_, member) in notable.worst.items():
        share = next(share for share in shares if share.engine == engine)
        wanted[share.methods[index].sampling, member] = None
    where = runs_of(files, head, shares[0].engine, MEMBERS)
    schema = chunk_files.member_schema(head["drawn"])
    questions = []
    for sampling, member in wanted:
        first = member - member % head["block"]
        (table,) = chunk_files.tables({first: where[first]}, schema, head["block"])
        drawn = {name: table[name][member - first].as_py() for name in head["drawn"]}
        questions.append(Vouching(head["text"], drawn, member, sampling))
    jobs = min(jobs, -(-len(questions) // VOUCHED_EACH))
    with pool.Workers(vouch, jobs, head["limit"], head["memory"], lambda _: None, VOUCHER.home) as workers:
        for question, answer in workers.map(questions):
            if not isinstance(answer, Crashed | TimedOut):
                yield (question.sampling, question.member), answer


def _replaced(table: Any, vouched: Mapping[tuple[float, int], Mapping[str, Any]]) -> Any:
    """Return a table of truths, with the values that later comparisons with witnesses have changed."""
    first, last = pc.min_max(table["member"]).as_py().values()
    if not any(first <= member <= last for _, member in vouched):
        return table
    rows = [row | vouched.get((row["timestep"], row["member"]), {}) for row in table.to_pylist()]
    return pa.Table.from_pylist(rows, schema=table.schema)


def _kept(files: Sequence[ChunkFile], head: EnsembleHeader, share: Share, notable: Remarkable) -> Iterator[Any]:
    """Yield the trajectories of an engine that are kept: of failures, of the worst members and of a sample."""
    where = runs_of(files, head, share.engine)
    reasons = {
        (method.name, method.timestep): _reasons(head, share.engine, index, notable)
        for index, method in enumerate(share.methods)
    }
    for path in dict.fromkeys(file.path for file, _ in where.values()):
        beside = path.with_name(path.name.replace(f".{RUNS}.", f".{TRAJECTORIES}."))
        block_starts = {first for first, (file, _) in where.items() if file.path == path}
        try:
            table = pq.read_table(pa.BufferReader(reading.content(beside, MAX_BYTES))).replace_schema_metadata(None)
            if not table.schema.equals(TRAJECTORY_SCHEMA):
                raise ValueError("it has other columns")
            rows = zip(*(table[name].to_pylist() for name in ("integrator", "timestep", "member")), strict=True)
            why = [
                reasons[integrator, timestep].get(member, "") if member - member % head["block"] in block_starts else ""
                for integrator, timestep, member in rows
            ]
        except (OSError, pa.ArrowException, ValueError, KeyError, TypeError) as error:
            raise BadFolder(f"{beside}: damaged: {error}; remove it and the file of runs beside it") from error
        labelled = table.set_column(table.schema.get_field_index("kept"), "kept", pa.array(why, pa.string()))
        yield labelled.filter(pc.not_equal(labelled["kept"], ""))


def _reasons(head: EnsembleHeader, engine: str, method: int, notable: Remarkable) -> dict[int, str]:
    """Return why the trajectories of members are kept, in words, by member."""
    words_by_member: dict[int, list[str]] = {}
    for word, members in (
        ("failed", notable.failed.get((engine, method), [])),
        ("worst", sorted(notable.members(engine, method))),
        ("sample", range(0, head["members"], head["sample"])),
    ):
        for member in members:
            words_by_member.setdefault(member, []).append(word)
    return {member: ", ".join(words) for member, words in words_by_member.items()}


def case_of(head: EnsembleHeader) -> Any:
    """Return the case of an ensemble, from its header."""
    return parse_stored(head["text"], head["case"])


def gather(folders: Sequence[Path], out: Path, jobs: int = 1) -> Path:
    """Make the tables of an ensemble from the chunks in some folders, and return the folder of the tables.

    Parameters
    ----------
    folders
        The folders that jobs with `--shard` wrote.
    out
        The folder for the tables, which may be one of these.
    jobs
        The number of processes in which truths are compared with witnesses.

    Raises
    ------
    BadFolder
        If a folder has no chunks of an ensemble, or chunks of another one, members are missing, or a file is damaged.
    BadInput
        If no folder is given.
    """
    if not folders:
        raise BadInput("gather: give the folders that the jobs wrote")
    heads = {folder: headers.read(folder) for folder in folders}
    head = heads[folders[0]]
    for folder, other in heads.items():
        if other["complete"]:
            raise BadFolder(f"{folder}: complete already; give the folders of jobs that carried out a share of the chunks")
        _refuse_other(folders[0], head, folder, other)
    writing.make_folder(out)
    headers.begin(out, head, case_of(head))
    compact(out, head, list(dict.fromkeys(folder.resolve() for folder in folders)), jobs)
    return out


def _refuse_other(first: Path, head: EnsembleHeader, folder: Path, other: EnsembleHeader) -> None:
    """Raise `BadFolder`, with the difference, if two folders are not of the same ensemble."""
    if other["identity"] == head["identity"]:
        return
    try:
        versions.check(_versions(head), _versions(other), f"{folder}: it")
    except versions.OtherVersion as error:
        raise BadFolder(str(error).replace("this command", str(first))) from error
    named = {"case": "case", "text": "text of the case", "members": "number of members", "shares": "methods or engines"}
    different = next((words for key, words in named.items() if other.get(key) != head.get(key)), "drawn numbers or limits")
    raise BadFolder(f"{folder}: is not of the same ensemble as {first}: the {different} differ")


def _versions(head: EnsembleHeader) -> dict[str, str]:
    return {"bodycheck": head["bodycheck"], **head["packages"], **head["engines"]}
