"""Carry out all or some chunks on this machine, in threads with worker processes for an engine and the reference."""

import threading
from collections.abc import Generator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import ExitStack
from dataclasses import dataclass

from bodycheck.errors import BadInput
from bodycheck.running.members.chunk_workers import ChunkWorkers
from bodycheck.running.members.chunks import Chunk, Receipt
from bodycheck.running.members.executors import CHUNKS_EACH, Perform


@dataclass(frozen=True)
class Own:
    """The executor of this machine.

    Attributes
    ----------
    jobs
        The number of chunks that are carried out at the same time.
    whole
        It carries out all chunks.
    """

    jobs: int
    whole: bool = True

    @property
    def chunks(self) -> int:
        """The smallest number of chunks that keeps it evenly busy."""
        return CHUNKS_EACH * self.jobs

    def __call__(self, perform: Perform, chunks: Sequence[Chunk]) -> Generator[Receipt, None, None]:
        """Carry out chunks, as `Executor` says.

        If another chunk fails, or the generator is closed, the current calls of all threads are stopped, and nothing further is
        written.
        """
        cancelled, thread = threading.Event(), threading.local()
        with ExitStack() as workers_of_threads:

            def begin() -> None:
                thread.workers = workers_of_threads.enter_context(ChunkWorkers(cancelled))

            def carry_out(chunk: Chunk) -> Receipt:
                return perform(chunk, thread.workers)

            with ThreadPoolExecutor(self.jobs, initializer=begin) as threads:
                try:
                    for future in as_completed([threads.submit(carry_out, chunk) for chunk in chunks]):
                        yield future.result()
                finally:
                    cancelled.set()
                    threads.shutdown(wait=False, cancel_futures=True)


@dataclass(frozen=True)
class Shard:
    """The executor of one of several jobs of a queue, such as a SLURM array.

    Attributes
    ----------
    number, count
        The number of the job, from 1, and the number of jobs. The executor carries out the chunks k with k mod `count` =
        `number` - 1.
    jobs
        The number of chunks that are carried out at the same time on the machine of the job.
    whole
        False, because it carries out only a share.
    """

    number: int
    count: int
    jobs: int
    whole: bool = False

    @property
    def chunks(self) -> int:
        """The smallest number of chunks that keeps all jobs evenly busy."""
        return CHUNKS_EACH * self.count

    @classmethod
    def parse(cls, text: str, jobs: int) -> "Shard":
        """Return the executor that an option gives as `NUMBER/OF`. Raises `BadInput` for any other text."""
        first, slash, second = text.partition("/")
        number, count = (int(part) if part.isascii() and part.isdecimal() else 0 for part in (first, second))
        if not slash or not 1 <= number <= count:
            raise BadInput(f"--shard {text}: read {text!r}; allowed: I/N with 1 <= I <= N, such as 3/20")
        return cls(number, count, jobs)

    def __call__(self, perform: Perform, chunks: Sequence[Chunk]) -> Generator[Receipt, None, None]:
        """Carry out its share of chunks, as `Executor` says."""
        yield from Own(self.jobs)(perform, [chunk for chunk in chunks if chunk.number % self.count == self.number - 1])
