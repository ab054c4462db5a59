"""Run an ensemble of a case: plan it, cut it into chunks, have them carried out, and compact their files.

The folder of an ensemble has `header.json`, the case, and the files of the chunks that are done. In the end the tables
`runs/ENGINE/CASE/`, `members/CASE/`, `truths/CASE/` and `trajectories/ENGINE/CASE/` replace the files of the chunks. Work that
was interrupted, for whatever reason, is resumed from the files of the chunks.
"""

import contextlib
import time
from collections.abc import Iterator, Mapping, Sequence
from datetime import date
from functools import partial
from pathlib import Path
from typing import Any

from filelock import FileLock, Timeout

from bodycheck.adapters.contract import Engine
from bodycheck.casefile.content import Case
from bodycheck.environments.subprocesses import MEMORY_LIMIT_BYTES
from bodycheck.errors import BadFolder, BadInput, Failed
from bodycheck.files import writing
from bodycheck.running import campaign, robot_notices
from bodycheck.running.campaign import Advance
from bodycheck.running.members import chunk_files, chunks
from bodycheck.running.members.chunks import Chunk, Receipt, Share, Source, Work
from bodycheck.running.members.executors import Executor
from bodycheck.running.plan import plan
from bodycheck.studies.ensemble import header as headers
from bodycheck.studies.ensemble.execution import result_tables
from bodycheck.studies.ensemble.execution.carrying import carry_out
from bodycheck.studies.ensemble.header import EnsembleHeader

#: The number of members whose trajectories are kept as a sample.
SAMPLE = 100

#: The most blocks of members in an ensemble: those of the largest ensemble of a case file, if its cases are of usual length.
MOST_BLOCKS = 1_000_000

#: The longest time (s) that files of workers on other machines may take to appear here, such as on a network.
PATIENCE_S = 60.0

#: The interval (s) at which these files are looked for.
INTERVAL_S = 0.2


def _no_progress(done: str, count: int = 1, /) -> None:
    pass


def run(
    case: Case,
    source: Source,
    records: Mapping[str, Engine],
    integrators: Sequence[str],
    timesteps: Sequence[float],
    folder: Path,
    executor: Executor,
    progress: Advance = _no_progress,
    command: Sequence[str] = (),
    missing: Mapping[str, str] | None = None,
    limit: float = campaign.TIME_LIMIT_S,
    memory: int = MEMORY_LIMIT_BYTES,
    blocks: int | None = None,
) -> Path:
    """Run all members of an ensemble with all methods, and return the folder of the results.

    If the same ensemble was interrupted in the folder, it is resumed, and finished blocks are not repeated. If the executor
    carries out only a share of the chunks, it leaves their files for `result_tables.gather`.

    Parameters
    ----------
    case
        The case from which the members are made.
    source
        The source of the numbers in which the members differ.
    records
        The records of the engines by the names by which they were asked for.
    integrators, timesteps
        Spellings of methods, and time steps (s). If empty: all methods, and 2 ms with the time steps in the expectations.
    folder
        The folder for the results. Workers on other machines must see it at the same path.
    executor
        The executor of the chunks.
    progress
        A function that is called after each chunk, with the number of runs.
    command, missing
        The words of the command, and the engines that cannot be used with the reasons, for the header.
    limit, memory
        The time limit (s) and the memory limit (bytes) of one call of an engine or of the reference. A call treats a block of
        members. If it exceeds a limit, it is repeated with parts of the block, until one member alone exceeds the limit.
    blocks
        The number of blocks in a chunk. By default, a chunk takes 10 to 60 s in most engines. The rows do not depend on this
        number.

    Raises
    ------
    BadInput
        If nothing can be run as asked, or a member is no valid case.
    BadFolder
        If the folder contains something else, or another process is writing to it.
    Failed
        If a cluster does not carry out all chunks; finished chunks are kept.
    """
    shares = planned(case, records, integrators, timesteps)
    plain = campaign.header(command, records, missing or {}, robots=robot_notices.as_loaded([case]))
    head = headers.of(plain, case, source, shares, limit, memory, SAMPLE)
    if source.size > MOST_BLOCKS * head["block"]:  # all blocks are enumerated before the first is run
        raise BadInput(
            f"{case.name}: {source.size} members, of which {head['block']} are treated at once; allowed: at most "
            f"{MOST_BLOCKS * head['block']}. There can be more with fewer samples and steps"
        )
    folder = folder.resolve()
    with _held(folder, executor):
        head = headers.begin(folder, head, case)
        everything = cut(work_of(head, case, source), case, shares, blocks, executor.chunks)
        _carry_out_what_is_left(folder, head, everything, executor, progress)
    return folder


def _carry_out_what_is_left(
    folder: Path, head: EnsembleHeader, everything: Sequence[Chunk], executor: Executor, progress: Advance
) -> None:
    """Carry out the unfinished parts of the chunks of an ensemble, and compact all files if the executor carries out all."""
    done = _done(folder, head)
    pieces = [piece for chunk in everything for piece in chunks.left(chunk, done.get(chunk.share.engine, ()))]
    if there := sum(chunk.rows for chunk in everything) - sum(piece.rows for piece in pieces):
        progress("", there)
    with contextlib.closing(executor(partial(carry_out, folder=folder), pieces)) as receipts:
        for index, receipt in enumerate(receipts):
            if index == 0:
                _await(folder, head, [receipt])
            progress(receipt.name, receipt.rows)
    if executor.whole:
        _await(folder, head, pieces)
        result_tables.compact(folder, head, [folder], executor_jobs(executor))


def size(source: Source, shares: Sequence[Share]) -> int:
    """Return the number of runs of an ensemble. shares: the shares of the engines, as `planned` returns them."""
    return source.size * sum(len(share.methods) for share in shares)


def planned(
    case: Case, records: Mapping[str, Engine], integrators: Sequence[str], timesteps: Sequence[float]
) -> tuple[Share, ...]:
    """Return the shares of the engines in an ensemble, in the order of the plan. Parameters and exceptions: see `run`."""
    methods: dict[str, list[Any]] = {}
    for task in plan([case], records, integrators, timesteps):
        methods.setdefault(task.engine, []).append(task.method)
    shares, known = [], set[float]()
    for engine, engine_methods in methods.items():
        new = tuple(dict.fromkeys(method.sampling for method in engine_methods if method.sampling not in known))
        known |= set(new)
        shares.append(Share(engine, records[engine].version, tuple(engine_methods), new))
    return tuple(shares)


def work_of(head: EnsembleHeader, case: Case, source: Source) -> Work:
    """Return the work of an ensemble, which all of its chunks share."""
    versions = {"bodycheck": head["bodycheck"], **head["packages"]}
    today = date.fromisoformat(head["today"])
    return Work(
        head["identity"], case.text, source, head["block"], head["sample"], versions, today, head["limit"], head["memory"]
    )


def cut(work: Work, case: Case, shares: Sequence[Share], blocks: int | None, least: int) -> list[Chunk]:
    """Return all chunks of an ensemble, engine by engine, numbered from 0.

    blocks: see `run`. least: the least number of chunks of each engine, if there are enough blocks.
    """
    all_chunks: list[Chunk] = []
    for share in shares:
        every = -(-work.source.size // work.block)
        size = blocks or max(1, min(chunks.blocks_of_chunk(case, share, work.block), every // least))
        all_chunks += chunks.cut(work, share, size, number=len(all_chunks))
    return all_chunks


def executor_jobs(executor: Executor) -> int:
    """Return the number of processes that may be used on this machine after the chunks are carried out."""
    return int(getattr(executor, "jobs", 1))


@contextlib.contextmanager
def _held(folder: Path, executor: Executor) -> Iterator[None]:
    """Keep other processes from writing to a folder, unless it is shared by jobs that each carry out a share."""
    writing.make_folder(folder)
    if not executor.whole:
        yield
        return
    lock = FileLock(folder / f"{headers.FILE}.lock")
    try:
        lock.acquire(timeout=0)
    except Timeout as error:
        raise BadFolder(f"{folder}: another process is writing to it") from error
    try:
        yield
    finally:
        Path(lock.lock_file).unlink(missing_ok=True)
        lock.release()


def _done(folder: Path, head: EnsembleHeader) -> dict[str, set[int]]:
    """Return the first members of the blocks that are done, by engine."""
    files = chunk_files.found(folder, head["identity"])
    return {share["engine"]: result_tables.done(files, head, headers.share_of(share)) for share in head["shares"]}


def _await(folder: Path, head: EnsembleHeader, pieces: Sequence[Chunk | Receipt]) -> None:
    """Wait until the files of chunks that were carried out appear. Raises `Failed` if they do not appear."""
    wanted = {
        (engine_of(piece), first) for piece in pieces for first in range(piece.first, piece.first + piece.count, head["block"])
    }
    deadline = time.monotonic() + PATIENCE_S
    while True:
        there = {(engine, first) for engine, firsts in _done(folder, head).items() for first in firsts}
        if wanted <= there:
            return
        if time.monotonic() > deadline:
            raise Failed(
                f"{folder}: workers have written the files of {len(wanted - there)} blocks of members that are not seen here; "
                "the folder must be one that this machine and all workers share, at the same path"
            )
        time.sleep(INTERVAL_S)


def engine_of(piece: Chunk | Receipt) -> str:
    """Return the engine of a chunk or of its receipt."""
    return piece.engine if isinstance(piece, Receipt) else piece.share.engine
