"""Carry out chunks on a cluster of Dask: an existing cluster, or a new cluster of worker processes on this machine.

Few chunks are submitted at a time, and only receipts are returned, so that neither the scheduler nor this process needs more
memory for more members. A chunk whose worker is lost is carried out again elsewhere; if it is then carried out twice, the
result is the same file. The processes of engines are started by the workers without Python's multiprocessing, so that workers
may be daemonic, as they are by default.
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

#: The address that stands for a new cluster on this machine.
LOCAL = "local"

#: Time limit for reaching the scheduler, and for its answers (s).
CONNECT_S = 30.0

#: The number of submitted chunks for each thread of the workers, so that no thread waits for its next chunk, and the smallest
#: total number.
AHEAD, LEAST_WINDOW = 2, 4

#: The number of workers of an external cluster for which there are always enough chunks.
MANY_WORKERS = 50

#: Interval (s) at which the number of workers is requested from the scheduler.
INTERVAL_S = 10.0

#: The number of times that a chunk is submitted before it is given up. Dask gives up a chunk if several workers that had it are
#: lost. The cause may be another chunk, or the machine.
ATTEMPTS = 5


#: The worker processes of the threads of a worker of Dask, by the numbers of the threads, which Dask starts and ends.
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
        True, because it carries out all chunks.
    """

    address: str
    jobs: int
    whole: bool = True

    @property
    def chunks(self) -> int:
        """The smallest number of chunks that keeps it evenly busy. The size of an external cluster is not known."""
        return CHUNKS_EACH * (self.jobs if self.address == LOCAL else MANY_WORKERS)

    def __call__(self, perform: Perform, chunks: Sequence[Chunk]) -> Generator[Receipt, None, None]:
        """Carry out chunks, as `Executor` says.

        Raises
        ------
        BadInput
            Dask is not installed, the scheduler cannot be reached, or a worker has other versions of packages that the rows
            depend on.
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
            with contextlib.suppress(Exception):  # a lost worker has no processes any more
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
            # The memory limit of Dask counts only the worker, which needs little; the processes of engines have their own
            # limits.
            options = {"threads_per_worker": 1, "memory_limit": 0, "silence_logs": logging.ERROR}
            # Use any free port, because another cluster may have the usual port.
            page = "127.0.0.1:0"
            where = stack.enter_context(LocalCluster(n_workers=jobs, processes=True, dashboard_address=page, **options))
        try:
            client = Client(where, timeout=CONNECT_S, set_as_default=False)
        except (OSError, ValueError) as error:  # a time-out is an OSError
            raise BadInput(f"--dask {address}: the scheduler cannot be reached: {error}") from error
        stack.callback(_close, client)
        yield client


def _restore(environment: dict[str, str]) -> None:
    """Restore the environment of this process. Dask leaves variables for its workers in it, which others would inherit."""
    os.environ.clear()
    os.environ.update(environment)


def _close(client: "Client") -> None:
    """Disconnect from a scheduler that may be lost, without messages of Dask about unfinished work."""
    before = logging.root.manager.disable
    logging.disable(logging.CRITICAL)
    try:
        with contextlib.suppress(Exception):
            client.close(timeout=1.0)
    finally:
        logging.disable(before)


def _check_workers(client: "Client") -> None:
    """Raise `BadInput` if a present worker has other versions than this process. Later workers check with their chunks."""
    versions_of_workers: dict[str, Any] = client.run(versions.here, on_error="return")
    for worker, theirs in versions_of_workers.items():
        if isinstance(theirs, BaseException):
            raise BadInput(f"the worker {worker} cannot carry out chunks: {type(theirs).__name__}: {theirs}")
        versions.check(versions.here(), theirs, f"the worker {worker}")


@dataclass
class _Submitted:
    """A submitted chunk, and the number of its submissions."""

    chunk: Chunk
    attempts: int = 1


@dataclass
class _Window:
    """The number of chunks to submit at a time. It asks the scheduler from time to time, because workers come and go."""

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
    """Convert the exceptions of Dask for a lost scheduler within the context to `ClusterLost`."""
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
