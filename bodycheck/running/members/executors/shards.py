"""Carry out a share of the chunks, for one of several jobs of a queue such as a SLURM array."""

from collections.abc import Generator, Sequence
from dataclasses import dataclass

from bodycheck.errors import BadInput
from bodycheck.running.members.chunks import Chunk, Receipt
from bodycheck.running.members.executors import CHUNKS_EACH, Perform
from bodycheck.running.members.executors.own import Own


@dataclass(frozen=True)
class Shard:
    """The executor of one of several jobs.

    Attributes
    ----------
    number, of
        The number of the job, from 1, and the number of jobs. It carries out the chunks k with k mod `of` = `number` - 1.
    jobs
        The number of chunks that are carried out at the same time on the machine of the job.
    whole
        It carries out a share.
    """

    number: int
    of: int
    jobs: int
    whole: bool = False

    @property
    def chunks(self) -> int:
        """The smallest number of chunks that keeps all jobs evenly busy."""
        return CHUNKS_EACH * self.of

    @classmethod
    def parse(cls, text: str, jobs: int) -> "Shard":
        """Return the executor that an option gives as `NUMBER/OF`. Raises `BadInput`."""
        number, slash, of = text.partition("/")
        found = [int(part) if part.isascii() and part.isdecimal() else 0 for part in (number, of)]
        if not slash or not 1 <= found[0] <= found[1]:
            raise BadInput(f"--shard {text}: read {text!r}; allowed: I/N with 1 <= I <= N, such as 3/20")
        return cls(found[0], found[1], jobs)

    def __call__(self, perform: Perform, chunks: Sequence[Chunk]) -> Generator[Receipt, None, None]:
        """Carry out its share of chunks, as `Executor` says."""
        yield from Own(self.jobs)(perform, [chunk for chunk in chunks if chunk.number % self.of == self.number - 1])
