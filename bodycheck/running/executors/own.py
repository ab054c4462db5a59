"""Carry out chunks on this machine: threads, each with a worker process for an engine and one for the reference."""

import queue
import threading
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from bodycheck.running import crews
from bodycheck.running.chunks import Chunk, Receipt
from bodycheck.running.executors import CHUNKS_EACH, Perform


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
        """The number of chunks from which on it is evenly busy."""
        return CHUNKS_EACH * self.jobs

    def __call__(self, perform: Perform, chunks: Sequence[Chunk]) -> Iterator[Receipt]:
        """Carry out chunks, as `Executor` says. A thread ends with the chunk that it is at when another one has failed."""
        waiting: queue.SimpleQueue[Chunk] = queue.SimpleQueue()
        for chunk in chunks:
            waiting.put(chunk)
        answers: queue.SimpleQueue[Receipt | BaseException] = queue.SimpleQueue()
        ended = threading.Event()

        def work() -> None:
            try:
                while not ended.is_set():
                    answers.put(perform(waiting.get_nowait()))
            except queue.Empty:
                pass
            except BaseException as error:
                answers.put(error)
            finally:
                crews.end_own()

        threads = [threading.Thread(target=work, daemon=True) for _ in range(min(self.jobs, len(chunks)))]
        for thread in threads:
            thread.start()
        try:
            for _ in chunks:
                answer = answers.get()
                if isinstance(answer, BaseException):
                    raise answer
                yield answer
            for thread in threads:
                thread.join()
        finally:
            ended.set()
