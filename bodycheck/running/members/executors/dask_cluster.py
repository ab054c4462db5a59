"""Carry out chunks on a cluster of Dask: any that exists, or one of worker processes on this machine.

Few chunks are submitted at a time, and what comes back are receipts, so that neither the scheduler nor this process needs more
memory for more members. A chunk whose worker is lost is carried out again elsewhere; it may then be carried out twice, which
leaves the same file. The processes of engines are started by the workers without Python's multiprocessing, so that workers may
be daemonic, as they are by default.
"""

import contextlib
import logging
import math
import os
import secrets
import threading
import time
from collections.abc import Generator, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from bodycheck.errors import BadInput, Failed
from bodycheck.results import versions
from bodycheck.running.members.chunk_workers import ChunkWorkers
from bodycheck.running.members.chunks import Chunk, Receipt
from bodycheck.running.members.executors import CHUNKS_EACH, Perform

if TYPE_CHECKING:
    from distributed import Client, Future

#: The address that stands for a cluster on this machine.
LOCAL = "local"

#: Time limit for reaching the scheduler, and for its answers (s).
CONNECT_S = 30.0

#: Submitted chunks for each thread of the workers, so that no thread waits for the next one; and the least number in all.
AHEAD, LEAST_WINDOW = 2, 4

#: A number of workers of a cluster for which there are chunks enough.
MANY_WORKERS = 50

#: Interval (s) at which the scheduler is asked for its workers.
INTERVAL_S = 10.0

#: How often a chunk is submitted again after Dask has given it up, because several workers were lost that had it. The loss may
#: be the fault of another chunk, or of the machine.
ATTEMPTS = 5


#: The worker processes of the threads of a worker of Dask, by the numbers of these threads, which Dask starts and ends.
_workers: dict[int, ChunkWorkers] = {}


class ClusterLost(Failed):
    """The connection to the scheduler was lost; the text says what to do."""


@dataclass(frozen=True)
class Cluster:
    """The executor of a cluster of Dask.

    Attributes
    ----------
    address
        The address of the scheduler, such as tcp://10.0.0.1:8786, or `LOCAL` for a cluster that is started on this machine.
    jobs
        The number of workers of a cluster on this machine.
    whole
        It carries out all chunks.
    """

    address: str
    jobs: int
    whole: bool = True

    @property
    def chunks(self) -> int:
        """The smallest number of chunks that keeps it evenly busy. The size of a cluster that is not local is not known."""
        return CHUNKS_EACH * (self.jobs if self.address == LOCAL else MANY_WORKERS)

    def __call__(self, perform: Perform, chunks: Sequence[Chunk]) -> Generator[Receipt, None, None]:
        """Carry out chunks, as `Executor` says.

        Raises
        ------
        BadInput
            Dask is not installed, the scheduler cannot be reached, or a worker has other versions of what the rows depend on.
        ClusterLost
            The scheduler was lost.
        Failed
            A chunk was given up.
        """
        if not chunks:
            return
        with _client(self.address, self.jobs) as client:
            _check_workers(client)
            yield from _receipts(client, self.address, perform, chunks)
            with contextlib.suppress(Exception):  # a worker that is gone has no processes any more
                client.run(_end_workers, on_error="ignore")


@contextlib.contextmanager
def _client(address: str, jobs: int) -> "Iterator[Client]":
    try:
        from distributed import Client, LocalCluster
    except ModuleNotFoundError as error:
        raise BadInput("--dask needs Dask: pip install 'bodycheck[scale]'") from error
    with contextlib.ExitStack() as stack:
        stack.callback(_restore, dict(os.environ))
        where: Any = address
        if address == LOCAL:
            # The memory limit of Dask counts the worker alone, which needs little; the processes of engines have their own.
            options = {"threads_per_worker": 1, "memory_limit": 0, "silence_logs": logging.ERROR}
            # Any free port, because another cluster may have the usual one.
            page = "127.0.0.1:0"
            where = stack.enter_context(LocalCluster(n_workers=jobs, processes=True, dashboard_address=page, **options))
        try:
            client = Client(where, timeout=CONNECT_S, set_as_default=False)
        except (OSError, ValueError) as error:  # a time-out is an OSError
            raise BadInput(f"--dask {address}: the scheduler cannot be reached: {error}") from error
        stack.callback(_close, client)
        yield client


def _restore(environment: dict[str, str]) -> None:
    """Give this process its environment again. Dask leaves variables for its workers in it, which later ones would inherit."""
    os.environ.clear()
    os.environ.update(environment)


def _close(client: "Client") -> None:
    """Disconnect from a scheduler that may be lost, without a word of Dask about what it did not do to the end."""
    before = logging.root.manager.disable
    logging.disable(logging.CRITICAL)
    try:
        with contextlib.suppress(Exception):
            client.close(timeout=1.0)
    finally:
        logging.disable(before)


def _check_workers(client: "Client") -> None:
    """Raise `BadInput` if a worker that is there has other versions than this process. Others are checked with their chunks."""
    versions_of_workers: dict[str, Any] = client.run(versions.here, on_error="return")
    for worker, theirs in versions_of_workers.items():
        if isinstance(theirs, BaseException):
            raise BadInput(f"the worker {worker} cannot carry out chunks: {type(theirs).__name__}: {theirs}")
        versions.check(versions.here(), theirs, f"the worker {worker}")


@dataclass
class _Submitted:
    """A chunk that was submitted, and how often."""

    chunk: Chunk
    attempts: int = 1


@dataclass
class _Window:
    """The number of chunks to submit at a time. The scheduler is asked now and then, because workers come and go."""

    client: "Client"
    size: int = LEAST_WINDOW
    asked: float = -math.inf

    def __call__(self) -> int:
        if time.monotonic() > self.asked + INTERVAL_S:
            self.size = max(LEAST_WINDOW, AHEAD * sum(self.client.nthreads().values()))
            self.asked = time.monotonic()
        return self.size


def _receipts(client: "Client", address: str, perform: Perform, chunks: Sequence[Chunk]) -> Generator[Receipt, None, None]:
    from distributed import KilledWorker, as_completed

    waiting, session, window = iter(chunks), secrets.token_hex(4), _Window(client)
    submitted: dict[Future, _Submitted] = {}
    completed = as_completed(loop=client.loop)

    def submit(one: _Submitted) -> None:
        key = f"bodycheck-{session}-{one.chunk.number}-{one.chunk.first}-{one.attempts}"
        future = client.submit(_carry_out, perform, one.chunk, key=key, pure=False)
        submitted[future] = one
        completed.add(future)

    def fill() -> None:
        while len(submitted) < window():
            if (chunk := next(waiting, None)) is None:
                return
            submit(_Submitted(chunk))

    with _losing(address):
        fill()
    while submitted:
        with _losing(address):
            future = next(completed)
            one = submitted.pop(future)
            if future.cancelled():
                raise _lost(address)
            error = future.exception()
            receipt = future.result() if error is None else None
        if error is None:
            assert isinstance(receipt, Receipt)
            yield receipt
        elif not isinstance(error, KilledWorker):
            raise error
        elif one.attempts == ATTEMPTS:
            raise Failed(
                f"{one.chunk.name}: given up after {ATTEMPTS} attempts, because the workers were lost each time; the last "
                f"was {error.last_worker.address}. Its log, or the log of the queue, shows the reason, often the memory limit "
                "of the job. Finished chunks are kept: run the same command again to resume"
            )
        else:
            with _losing(address):
                submit(_Submitted(one.chunk, one.attempts + 1))
        with _losing(address):
            fill()


def _carry_out(perform: Perform, chunk: Chunk) -> Receipt:
    """Carry out a chunk in a thread of a worker of Dask."""
    return perform(chunk, _workers.setdefault(threading.get_ident(), ChunkWorkers()))


def _end_workers() -> None:
    """End the processes of all threads of a worker of Dask, which must not be in use."""
    while _workers:
        _workers.popitem()[1].close()


@contextlib.contextmanager
def _losing(address: str) -> Iterator[None]:
    """Turn what Dask raises within the context when its scheduler is gone into `ClusterLost`."""
    from distributed import CancelledError
    from distributed.comm import CommClosedError

    try:
        yield
    except (CancelledError, CommClosedError, TimeoutError, OSError) as error:
        raise _lost(address) from error
    except RuntimeError as error:
        if "client" not in str(error).lower():
            raise
        raise _lost(address) from error


def _lost(address: str) -> ClusterLost:
    return ClusterLost(
        f"--dask {address}: the scheduler was lost. Finished chunks are kept: start a new scheduler and new workers, since the "
        "workers of a lost scheduler end, and run the same command again to resume"
    )
