"""The worker processes of a thread that carries out chunks: one for its present engine and one for the reference.

They are kept from chunk to chunk, because an import takes as long as many members. A thread has one engine at a time, so that
the memory of a machine does not depend on the number of engines. Processes end with the thread that started them.
"""

import threading
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from bodycheck.files.temporary import temporary_folder
from bodycheck.processes import pool
from bodycheck.running import engines

#: Variables that make the libraries of a worker process use one thread, as there is a worker process for each processor.
ONE_THREAD = tuple((name, "1") for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"))

#: A function that makes a call in a worker process, and returns its result, `Crashed` or `TimedOut`.
Call = Callable[[Any], Any]


@dataclass(frozen=True)
class Role:
    """The task of worker processes.

    Attributes
    ----------
    function
        The function that they call.
    prepare
        A function that is called with the engine, or None, once in each process, and imports all that calls need: what the
        first call imported would count as a change of its process, which would not be used again.
    """

    function: Call
    prepare: Call

    def home(self, engine: str | None) -> pool.Home:
        """Return where the processes of an engine live, or of the reference (None), which use one thread each."""
        found = engines.home(engine)
        variables = tuple(pair for pair in found.interpreter.variables if pair[0] not in dict(ONE_THREAD))
        interpreter = replace(found.interpreter, variables=(*variables, *ONE_THREAD))
        return replace(found, interpreter=interpreter, prepare=self.prepare)


class Abandoned(Exception):
    """Nobody waits any more for what a thread does."""


@dataclass
class _Crew:
    """The callers of a thread, for its engine and for the reference, each with what it was made for and its end; its folder.

    `ended` is set when nobody waits any more for what the thread does.
    """

    ended: threading.Event = field(default_factory=threading.Event)
    callers: dict[bool, tuple[object, Call, ExitStack]] = field(default_factory=dict)
    folder: Path | None = None
    stack: ExitStack = field(default_factory=ExitStack)

    def end(self) -> None:
        self.stack.close()
        for _, _, stack in self.callers.values():
            stack.close()
        self.callers.clear()


#: The crews of the threads of this process, by the numbers of the threads.
_crews: dict[int, _Crew] = {}


def begin(ended: threading.Event) -> None:
    """Register the event that cancels this thread's work."""
    _crews[threading.get_ident()] = _Crew(ended)


def check() -> None:
    """Raise `Abandoned` if nobody waits any more for what this thread does."""
    if (crew := _crews.get(threading.get_ident())) is not None and crew.ended.is_set():
        raise Abandoned


def call(role: Role, engine: str | None, limit: float, memory: int) -> Call:
    """Return a function that makes calls in this thread's process of an engine, or of the reference (None).

    The process of another engine ends. limit, memory: those of one call, in s and bytes. Raises `Abandoned`.
    """
    check()
    crew = _crews.setdefault(threading.get_ident(), _Crew())
    wanted = (role, engine, limit, memory)
    if (found := crew.callers.get(engine is None)) is not None:
        if found[0] == wanted:
            return found[1]
        found[2].close()
    stack = ExitStack()
    made: Call = stack.enter_context(single(role, engine, limit, memory))
    crew.callers[engine is None] = wanted, made, stack
    return made


def single(role: Role, engine: str | None, limit: float, memory: int) -> Any:
    """Return a context that provides the function of `call` with a process of its own, which ends with the context.

    Raises `Abandoned`.
    """
    check()
    return pool.caller(role.function, limit, memory, group=lambda argument: engine, home=role.home)


def folder() -> Path:
    """Return a temporary folder of this thread, in which its processes leave files for each other."""
    crew = _crews.setdefault(threading.get_ident(), _Crew())
    if crew.folder is None:
        crew.folder = crew.stack.enter_context(temporary_folder())
    return crew.folder


def end_own() -> None:
    """End the processes of this thread."""
    if (crew := _crews.pop(threading.get_ident(), None)) is not None:
        crew.end()


def end_all() -> None:
    """End the processes of all threads of this process, which must not be in use."""
    while _crews:
        _crews.popitem()[1].end()
