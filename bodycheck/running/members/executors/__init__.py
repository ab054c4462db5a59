"""Executors: they carry out the chunks of an ensemble somewhere and yield the receipts, in any order.

All executors have the same signature, and the rows do not depend on the executor. `own` uses threads and processes of this
machine, for all chunks or for the share of one of several jobs of a queue; `dask_cluster` uses any cluster that Dask runs on.
"""

from collections.abc import Callable, Generator, Sequence
from typing import Protocol

from bodycheck.running.members.chunk_workers import ChunkWorkers
from bodycheck.running.members.chunks import Chunk, Receipt

#: The number of chunks for each processor or job, if there are enough members, so that none waits long for the last chunk.
CHUNKS_EACH = 4

#: A function that carries out a chunk, with the worker processes of its thread. It can be pickled.
Perform = Callable[[Chunk, ChunkWorkers], Receipt]


class Executor(Protocol):
    """An object that carries out chunks."""

    @property
    def whole(self) -> bool:
        """True if the executor carries out all chunks, and not only a share of them."""
        ...

    @property
    def chunks(self) -> int:
        """The smallest number of chunks that keeps it evenly busy, if there are enough members."""
        ...

    def __call__(self, perform: Perform, chunks: Sequence[Chunk]) -> Generator[Receipt, None, None]:
        """Carry out chunks, and yield the receipt of each as soon as it is done.

        Raises any exception of the function. No further chunks begin after an exception, or after the generator is closed.
        """
        ...
