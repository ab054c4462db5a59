"""Carry out chunks on this machine: threads, each with a worker process for an engine and one for the reference."""

import queue
import threading
import time
from collections.abc import Generator, Sequence
from dataclasses import dataclass

from bodycheck.running.members import chunk_workers
from bodycheck.running.members.chunks import Chunk, Receipt
from bodycheck.running.members.executors import CHUNKS_EACH, Perform

#: How long (s) threads have for the calls that they are at when nobody waits for them any more. After it they are left alone.
ENDING_S = 5.0


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

        Where another chunk has failed, or the generator is closed, a thread ends after the call that it is at, and writes
        nothing.
        """
        waiting: queue.SimpleQueue[Chunk] = queue.SimpleQueue()
        for chunk in chunks:
            waiting.put(chunk)
        answers: queue.SimpleQueue[Receipt | BaseException] = queue.SimpleQueue()
        ended = threading.Event()

        def work() -> None:
            chunk_workers.begin(ended)
            try:
                while not ended.is_set():
                    answers.put(perform(waiting.get_nowait()))
            except queue.Empty:
                pass
            except BaseException as error:
                answers.put(error)
            finally:
                chunk_workers.end_own()

        threads = [threading.Thread(target=work, daemon=True) for _ in range(min(self.jobs, len(chunks)))]
        for thread in threads:
            thread.start()
        try:
            for _ in chunks:
                answer = answers.get()
                if isinstance(answer, BaseException):
                    raise answer
                yield answer
        finally:
            ended.set()
            deadline = time.monotonic() + ENDING_S
            for thread in threads:
                thread.join(max(0.0, deadline - time.monotonic()))
