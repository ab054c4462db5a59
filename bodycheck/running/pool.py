"""Calls in processes of their own, so that one that crashes, exits, hangs or eats memory takes nothing with it.

A worker process makes one call after another. It has a pipe of its own, so that what befalls it is felt by no other.
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

#: Bytes that one call may take.
MEMORY = 4 << 30

#: Seconds after which it is looked whether processes that say nothing still live.
SILENCE = 1.0

#: Seconds that the end of a process may take.
FAREWELL = 10.0


def call_all(
    function: Callable[[Argument], Result], arguments: Sequence[Argument], jobs: int, limit: float, memory: int = MEMORY
) -> Generator[tuple[Argument, Result | Crashed | TimedOut], None, None]:
    """function(argument) for every argument, as they finish, in `jobs` processes.

    A call that takes longer than `limit` seconds is killed; one that wants more than `memory` bytes is given none, where the
    system can (`limits`). An error that it raises, `SystemExit` too, or the death of its process, is its result.
    A call in whose process others had been made before it died is made again in a fresh one: it may have died of theirs.

    The function must be importable by name, arguments and results picklable. To be iterated by one thread: the processes end
    with it. Raises RuntimeError where no process can be started.
    """
    waiting = deque(range(len(arguments)))
    suspects: deque[int] = deque()
    workers: list[_Worker] = []
    try:
        while waiting or suspects or workers:
            while len(workers) < jobs and sum(worker.fresh for worker in workers) < len(waiting) + len(suspects):
                workers.append(_start(function, memory))
            wait([worker.connection for worker in workers], _time_to_look(workers))
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
    function: Callable[[Argument], Result], limit: float, memory: int = MEMORY
) -> Iterator[Callable[[Argument], Result | Crashed | TimedOut]]:
    """What calls the function as `call_all` does, for arguments that come one by one: its process is kept between calls."""
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
    """What became of a call. reusable: whether its process can make another."""

    result: Any
    reusable: bool
    died: bool = False


@dataclass(eq=False)
class _Worker:
    """A process and this end of its pipe. place: of the argument of its call; None until it is ready for the first."""

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
        with contextlib.suppress(OSError):  # it is dead, as will be seen
            self.connection.send(argument)

    def stop(self) -> None:
        self.process.kill()
        self.process.join()
        self.connection.close()


def _start(function: Callable[[Any], Any], memory: int) -> _Worker:
    context = multiprocessing.get_context("spawn")
    ours, theirs = context.Pipe()
    # Daemonic, so that the end of a program that has lost sight of them does not wait for them.
    process = context.Process(target=_work, args=(function, theirs, memory), daemon=True)
    process.start()
    theirs.close()
    return _Worker(process, ours)


def _wait(worker: _Worker, limit: float) -> _Answer:
    while (answer := _answer(worker, limit)) is None:
        wait([worker.connection], _time_to_look([worker]))
    return answer


def _time_to_look(workers: Sequence[_Worker]) -> float:
    nearest = min(worker.deadline for worker in workers) - time.monotonic()
    return max(0.0, min(SILENCE, nearest))


def _answer(worker: _Worker, limit: float) -> _Answer | None:
    """What there is to say of a worker's call; None while it goes on."""
    ended = not worker.process.is_alive()  # asked first: what it has sent before its end counts
    try:
        if worker.connection.poll():
            return _Answer(*worker.connection.recv())
    except (EOFError, OSError):
        ended = True
    except Exception as error:
        return _Answer(Crashed(f"its result cannot be read: {crash(error).reason}"), reusable=False)
    if ended:
        return _Answer(Crashed(_death(worker.process)), reusable=False, died=True)
    if time.monotonic() > worker.deadline:
        return _Answer(TimedOut(limit), reusable=False)
    return None


def _death(process: BaseProcess) -> str:
    # Not by join, which waits without limit for a process that has closed all its files and goes on.
    patience = time.monotonic() + FAREWELL
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
    """What a worker does: it says that it is ready, and answers calls."""
    limits.die_with_parent()
    limits.allow_memory(memory)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent's to answer
    os.dup2(2, 1)  # what an engine prints goes to stderr: stdout is for results
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
    except Exception as error:  # it cannot be pickled
        connection.send((crash(error), False))


def _call(function: Callable[[Any], Any], argument: Any) -> Any:
    try:
        with limits.limited_memory():
            return function(argument)
    except BaseException as error:
        return crash(error)
