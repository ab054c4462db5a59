"""The worker processes of a thread that carries out chunks: one for its current engine and one for the reference.

The processes are kept from chunk to chunk, because an import takes as long as many members. A thread has one engine at a time,
so that the memory of a machine does not depend on the number of engines. Processes end with the thread that started them.
"""

import threading
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Self, TypeVar

from bodycheck.files.temporary import temporary_folder
from bodycheck.processes import pool
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.running import engines

#: Environment variables that make the libraries of a worker process use one thread, because there is one worker process for
#: each processor.
ONE_THREAD = tuple((name, "1") for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"))


@dataclass(frozen=True)
class Role:
    """The task of worker processes.

    Attributes
    ----------
    function
        The function that they call.
    prepare
        A function that is called with the engine, or None, once in each process, and imports everything that calls need. An
        import in the first call would count as a change of the process, which would then not be used again.
    """

    function: Callable[[Any], Any]
    prepare: Callable[[Any], object]

    def home(self, engine: str | None) -> pool.Home:
        """Return the home of the processes of an engine, or of the reference (None). Each process uses one thread."""
        home = engines.home(engine)
        variables = tuple(pair for pair in home.interpreter.variables if pair[0] not in dict(ONE_THREAD))
        interpreter = replace(home.interpreter, variables=(*variables, *ONE_THREAD))
        return replace(home, interpreter=interpreter, prepare=self.prepare)


class ChunkWorkers:
    """The worker processes of a thread, and a temporary folder in which they leave files for each other.

    The object is a context manager. At the end of the context, the processes end and the folder is removed.

    Parameters
    ----------
    cancelled
        An event that is set when the work of the thread is no longer needed.
    """

    def __init__(self, cancelled: threading.Event | None = None) -> None:
        self._cancelled = cancelled or threading.Event()
        self._workers: dict[bool, tuple[object, pool.Workers[Any, Any]]] = {}
        self._stack = ExitStack()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

    def close(self) -> None:
        """End the processes and remove the folder."""
        for _, workers in self._workers.values():
            workers.close()
        self._workers.clear()
        self._stack.close()

    def check(self) -> None:
        """Raise `Cancelled` if the work of the thread is no longer needed."""
        if self._cancelled.is_set():
            raise pool.Cancelled

    def call(self, role: Role, engine: str | None, limit: float, memory: int, argument: Any) -> Any:
        """Make a call in the process of an engine, or of the reference (None), and return the result.

        A process of another engine, or with another role or other limits, is ended first. limit, memory: the limits of the
        call, in s and bytes. Raises `Cancelled` if the work is no longer needed.
        """
        wanted = (role, engine, limit, memory)
        present, workers = self._workers.get(engine is None, (None, None))
        if workers is None or present != wanted:
            if workers is not None:
                workers.close()
            workers = self._new(*wanted)
            self._workers[engine is None] = wanted, workers
        return workers.call(argument)

    def call_apart(self, role: Role, engine: str | None, limit: float, memory: int, argument: Any) -> Any:
        """Make a call as `call` does, in a new process that makes no other call."""
        with self._new(role, engine, limit, memory) as workers:
            return workers.call(argument)

    @cached_property
    def folder(self) -> Path:
        """The temporary folder."""
        return self._stack.enter_context(temporary_folder())

    def _new(self, role: Role, engine: str | None, limit: float, memory: int) -> pool.Workers[Any, Any]:
        return pool.Workers(role.function, 1, limit, memory, lambda _: engine, role.home, kept=1, cancelled=self._cancelled)


Result = TypeVar("Result")

#: The smallest fraction of the full time limit for a call about several of the items; a call about a single item has the full
#: limit.
LEAST_PART = 1 / 16


def in_halves(
    attempt: Callable[[int, int], Result | Crashed | TimedOut], first: int, last: int
) -> list[tuple[range, Result | Crashed | TimedOut]]:
    """Return the results of calls about ranges of items, in the order of the items, each with its range.

    The first call is about all items. If a call fails, its range is halved, until only single items fail.

    Parameters
    ----------
    attempt
        Function that makes a call about the items from one index up to another one, which is excluded.
    first, last
        The range of all items; the last index is excluded.
    """
    result = attempt(first, last)
    if last - first == 1 or not isinstance(result, Crashed | TimedOut):
        return [(range(first, last), result)]
    middle = (first + last) // 2
    return [*in_halves(attempt, first, middle), *in_halves(attempt, middle, last)]


def limit_of(part: int, whole: int, limit: float) -> float:
    """Return the time limit (s) of a call about `part` of `whole` items, from the limit of a call about all of them.

    A call that exceeds its limit is halved further, so that a small limit costs time but changes no result.
    """
    return limit if part == 1 else limit * max(LEAST_PART, part / whole)
