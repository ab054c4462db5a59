"""Chunks and their receipts. A chunk is consecutive members of an ensemble that one engine runs with all its methods.

Members are processed in aligned blocks, and a chunk consists of whole blocks, so that no row depends on how an ensemble is cut
into chunks. A chunk contains everything that a worker needs, wherever it runs, and is small enough to be sent there.
"""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import date
from typing import Any, Protocol

from bodycheck.adapters.method import Method
from bodycheck.casefile.content import Case
from bodycheck.reference.trajectory import Array

#: The possible numbers of members in a block: the first for a case of usual length, the others, which divide the first, for
#: longer cases.
BLOCK_SIZES = (1000, 500, 200, 100, 50, 20, 10, 5, 2, 1)

#: The largest number of states of all members of a block, with one method: 26 MiB.
MOST_STATES = 1 << 18

#: The largest number of steps of all members of a block, with one method: some minutes for an engine that is stepped from
#: Python.
MOST_STEPS = 1 << 21

#: Steps of all members and methods in a chunk: 10 to 60 s for a compiled engine.
CHUNK_STEPS = 1 << 22

#: The largest number of blocks in a chunk, whose rows are in memory until they are written.
MOST_BLOCKS = 100


class Source(Protocol):
    """The source of the numbers in which members differ. It can be pickled, and gives the same numbers on every machine."""

    @property
    def origin(self) -> object:
        """The distributions of the numbers, or a table whose attribute `digest` identifies its content."""
        ...

    @property
    def size(self) -> int:
        """The number of members."""
        ...

    @property
    def names(self) -> Sequence[str]:
        """The names of the numbers, one for each component of a vector, such as "initial.velocity.0"."""
        ...

    def values(self, first: int, count: int) -> Mapping[str, Array]:
        """Return the numbers of some members by the path of the key, as arrays (count,) or (count, k)."""
        ...


@dataclass(frozen=True, eq=False)
class Work:
    """The data that all chunks of an ensemble have in common.

    Attributes
    ----------
    identity
        A digest of everything that determines the rows.
    case
        The text of the case file.
    source
        The numbers in which members differ.
    block
        The number of members in a block.
    sample
        The trajectories of members whose number is a multiple of this are kept.
    versions
        The versions of bodycheck and of the packages that the rows depend on, which every worker must have.
    today
        The day for deciding whether known discrepancies are still tolerated, which is the same for all rows.
    limit, memory
        The time limit (s) and the memory limit (bytes) of one call of an engine or of the reference.
    """

    identity: str
    case: str
    source: Any
    block: int
    sample: int
    versions: Mapping[str, str]
    today: date
    limit: float
    memory: int


@dataclass(frozen=True)
class Share:
    """The share of an engine in an ensemble.

    Attributes
    ----------
    engine, version
        The name and the version of the engine.
    methods
        Its methods, in the order of the plan.
    truths_of
        The samplings (`Method.sampling`) for which its chunks write the truths, so that each truth is written once; not empty
        if the chunks also write the members.
    """

    engine: str
    version: str
    methods: tuple[Method, ...]
    truths_of: tuple[float, ...] = ()


@dataclass(frozen=True, eq=False)
class Chunk:
    """Consecutive members of an ensemble for one engine.

    Attributes
    ----------
    work, share
        The work and the engine's share that the chunk belongs to.
    number
        The number of the chunk in the whole plan, from 0. If a chunk is cut into pieces, these have the same number.
    first, count
        The first member and the number of members.
    """

    work: Work
    share: Share
    number: int
    first: int
    count: int

    @property
    def blocks(self) -> tuple[range, ...]:
        """The members of each block."""
        end = self.first + self.count
        return tuple(range(first, min(end, first + self.work.block)) for first in range(self.first, end, self.work.block))

    @property
    def name(self) -> str:
        """The engine and the members in words."""
        return f"{self.share.engine} · members {self.first} to {self.first + self.count - 1}"

    @property
    def rows(self) -> int:
        """The number of runs."""
        return self.count * len(self.share.methods)


@dataclass(frozen=True)
class Receipt:
    """The outcome of a chunk. It is small, whatever the size of the chunk.

    Attributes
    ----------
    name
        The engine and the members in words.
    engine, first, count
        The name of the engine, the first member and the number of members.
    rows, failed
        The number of runs, and of those that failed.
    seconds
        The times (s) of the whole chunk, of the stepping of the engine, and of the truths.
    digest
        A digest of the rows without measured times.
    """

    name: str
    engine: str
    first: int
    count: int
    rows: int
    failed: int
    seconds: float
    engine_seconds: float
    truth_seconds: float
    digest: str


def block_size(case: Case, timesteps: Collection[float]) -> int:
    """Return the number of members in a block of a case, so that the numbers of states and steps are limited.

    timesteps: the time steps (s) of the runs.
    """
    steps = max(case.duration / timestep for timestep in timesteps)
    most = min(MOST_STATES / case.samples, MOST_STEPS / max(1.0, steps))
    return next((size for size in BLOCK_SIZES if size <= most), 1)


def blocks_of_chunk(case: Case, share: Share, block: int) -> int:
    """Return the number of blocks in a chunk of an engine, from the steps of its methods, so that all workers agree."""
    steps = sum(case.duration / method.timestep for method in share.methods)
    return int(min(MOST_BLOCKS, max(1, CHUNK_STEPS // (block * max(1.0, steps)))))


def cut(work: Work, share: Share, blocks: int, number: int = 0) -> list[Chunk]:
    """Return the chunks of an engine, each with `blocks` blocks, numbered from `number`."""
    size = blocks * work.block
    firsts = range(0, work.source.size, size)
    return [
        Chunk(work, share, number + index, first, min(size, work.source.size - first)) for index, first in enumerate(firsts)
    ]


def left(chunk: Chunk, done: Collection[int]) -> Iterator[Chunk]:
    """Yield the remaining blocks of a chunk, as chunks of consecutive blocks.

    done: the first members of the blocks that are done.
    """
    piece: list[range] = []
    for block in (*chunk.blocks, None):
        if block is not None and block.start not in done:
            piece.append(block)
        elif piece:
            yield replace(chunk, first=piece[0].start, count=piece[-1].stop - piece[0].start)
            piece = []
