"""Call functions in worker processes, so that a call that crashes, exits, hangs or exhausts memory affects nothing else.

A worker process makes one call after another. Every worker has its own pipe, so that the failure of one does not affect others.
"""

import contextlib
import math
import multiprocessing
import os
import signal
import time
from collections import deque
from collections.abc import Callable, Generator, Iterator, Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Any, NamedTuple, TypeVar

from bodycheck.running import limits
from bodycheck.running.outcome import Crashed, TimedOut, crash

Argument = TypeVar("Argument")
Result = TypeVar("Result")

#: Default memory limit of one call.
MEMORY_LIMIT_BYTES = 4 << 30

#: Interval at which silent processes are checked for being alive.
POLL_INTERVAL_S = 1.0

#: Time limit for the end of a process.
SHUTDOWN_TIMEOUT_S = 10.0


def call_all(
    function: Callable[[Argument], Result],
    arguments: Sequence[Argument],
    jobs: int,
    limit: float,
    memory: int = MEMORY_LIMIT_BYTES,
) -> Generator[tuple[Argument, Result | Crashed | TimedOut], None, None]:
    """Yield every argument with the result of function(argument), in the order in which the calls finish.

    The result of a call that raises an exception, including `SystemExit`, or whose process dies is `Crashed`. If a process dies
    after earlier calls, the last call is repeated in a new process, because an earlier call may have caused the failure.

    The generator must be iterated by one thread; the processes end with that thread.

    Parameters
    ----------
    function
        The function. It must be importable by name, and its arguments and results must be picklable.
    arguments
        The arguments of the calls.
    jobs
        The number of processes.
    limit
        The time limit of one call (s). A call that exceeds it is killed, and its result is `TimedOut`.
    memory
        The memory limit of one call (bytes), where the operating system supports it (see `limits`).

    Raises
    ------
    RuntimeError
        If no process can be started.
    """
    waiting = deque(range(len(arguments)))
    suspects: deque[int] = deque()
    workers: list[_Worker] = []
    try:
        while waiting or suspects or workers:
            while len(workers) < jobs and sum(worker.fresh for worker in workers) < len(waiting) + len(suspects):
                workers.append(_start(function, memory))
            wait([worker.connection for worker in workers], _poll_timeout(workers))
            for worker in tuple(workers):
                place, answer = worker.place, _answer(worker, limit)
                if answer is None:
                    continue
                if answer.died and place is None:
                    raise RuntimeError(f"no process can be started: {answer.result.reason}")
                unclear = answer.died and worker.calls > 1
                if unclear and place is not None:
                    suspects.append(place)
                queue = suspects if worker.fresh and suspects else waiting
                if answer.reusable and queue:
                    worker.call(following := queue.popleft(), arguments[following], limit)
                else:
                    workers.remove(worker)
                    worker.stop()
                if place is not None and not unclear:
                    yield arguments[place], answer.result
    finally:
        for worker in workers:
            worker.stop()


@contextlib.contextmanager
def caller(
    function: Callable[[Argument], Result], limit: float, memory: int = MEMORY_LIMIT_BYTES
) -> Iterator[Callable[[Argument], Result | Crashed | TimedOut]]:
    """Provide a function that calls `function` in a worker process, which is kept between calls.

    Failures, limits and parameters are those of `call_all`.
    """
    workers: list[_Worker] = []

    def call(argument: Argument) -> Result | Crashed | TimedOut:
        while True:
            if not workers:
                workers.append(_start(function, memory))
                if (ready := _wait(workers[0], limit)).died:
                    raise RuntimeError(f"no process can be started: {ready.result.reason}")
            worker = workers[0]
            worker.call(0, argument, limit)
            answer = _wait(worker, limit)
            if not answer.reusable:
                workers.remove(worker)
                worker.stop()
            if not answer.died or worker.calls == 1:
                result: Result | Crashed | TimedOut = answer.result
                return result

    try:
        yield call
    finally:
        for worker in workers:
            worker.stop()


class _Answer(NamedTuple):
    """The result of a call. `reusable` says whether its process can make another call, and `died` whether it is dead."""

    result: Any
    reusable: bool
    died: bool = False


@dataclass(eq=False)
class _Worker:
    """A worker process and this end of its pipe. `place` is the index of the present argument; None before the first call."""

    process: BaseProcess
    connection: "Connection[Any, Any]"
    place: int | None = None
    calls: int = 0
    deadline: float = math.inf

    @property
    def fresh(self) -> bool:
        return self.calls == 0

    def call(self, place: int, argument: Any, limit: float) -> None:
        self.place, self.calls, self.deadline = place, self.calls + 1, time.monotonic() + limit
        with contextlib.suppress(OSError):  # the process is dead, which `_answer` will find
            self.connection.send(argument)

    def stop(self) -> None:
        self.process.kill()
        self.process.join()
        self.connection.close()


def _start(function: Callable[[Any], Any], memory: int) -> _Worker:
    context = multiprocessing.get_context("spawn")
    ours, theirs = context.Pipe()
    # The process is daemonic, so that the end of the program does not wait for it.
    process = context.Process(target=_work, args=(function, theirs, memory), daemon=True)
    process.start()
    theirs.close()
    return _Worker(process, ours)


def _wait(worker: _Worker, limit: float) -> _Answer:
    while (answer := _answer(worker, limit)) is None:
        wait([worker.connection], _poll_timeout([worker]))
    return answer


def _poll_timeout(workers: Sequence[_Worker]) -> float:
    nearest = min(worker.deadline for worker in workers) - time.monotonic()
    return max(0.0, min(POLL_INTERVAL_S, nearest))


def _answer(worker: _Worker, limit: float) -> _Answer | None:
    """Return the answer to a worker's call; None while the call is running."""
    ended = not worker.process.is_alive()  # checked first, so that an answer sent before the end is still read
    try:
        if worker.connection.poll():
            return _Answer(*worker.connection.recv())
    except (EOFError, OSError):
        ended = True
    except Exception as error:
        return _Answer(Crashed(f"its result cannot be read: {crash(error).reason}"), reusable=False)
    if ended:
        return _Answer(Crashed(_cause_of_death(worker.process)), reusable=False, died=True)
    if time.monotonic() > worker.deadline:
        return _Answer(TimedOut(limit), reusable=False)
    return None


def _cause_of_death(process: BaseProcess) -> str:
    # `join` would wait without limit for a process that has closed all its files but continues.
    patience = time.monotonic() + SHUTDOWN_TIMEOUT_S
    while (exitcode := process.exitcode) is None:
        if time.monotonic() > patience:
            return "its process closed its pipe"
        time.sleep(0.01)
    if exitcode >= 0:
        return f"its process exited with code {exitcode}"
    try:
        return f"its process died of signal {signal.Signals(-exitcode).name}"
    except ValueError:  # a real-time signal
        return f"its process died of signal {-exitcode}"


def _work(function: Callable[[Any], Any], connection: "Connection[Any, Any]", memory: int) -> None:
    """Run the loop of a worker process: report that it is ready, then answer calls."""
    limits.die_with_parent()
    limits.allow_memory(memory)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent handles interrupts
    os.dup2(2, 1)  # output of engines goes to stderr, because stdout is for results
    try:
        connection.send((None, True))
        while True:
            _reply(connection, _call(function, connection.recv()))
    except (EOFError, ConnectionError):
        return  # the parent is gone


def _reply(connection: "Connection[Any, Any]", result: Any) -> None:
    try:
        connection.send((result, not limits.keeps_much()))
    except ConnectionError:
        raise
    except Exception as error:  # the result cannot be pickled
        connection.send((crash(error), False))


def _call(function: Callable[[Any], Any], argument: Any) -> Any:
    try:
        with limits.limited_memory():
            return function(argument)
    except BaseException as error:
        return crash(error)
