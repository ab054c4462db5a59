"""Call functions in worker processes, so that a call that crashes, exits, hangs or exhausts memory affects nothing else.

A worker process makes one call after another, all of them of one group, so that an engine shares no process with another
engine or with the truth. Every worker has its own channel, so that the failure of one does not affect others, and answers carry
the number of their call. A process whose state a call has changed makes no other call, and what an engine starts ends with its
worker.
"""

import contextlib
import math
import multiprocessing
import os
import pickle
import signal
import socket
import time
from collections import deque
from collections.abc import Callable, Generator, Hashable, Iterator, Sequence
from dataclasses import dataclass
from multiprocessing.connection import wait
from multiprocessing.process import BaseProcess
from typing import Any, NamedTuple, TypeVar

from bodycheck.running import channel, guard, limits
from bodycheck.running.outcome import Crashed, TimedOut, crash
from bodycheck.running.process_state import state, threads

Argument = TypeVar("Argument")
Result = TypeVar("Result")

#: Default memory limit of one call.
MEMORY_LIMIT_BYTES = 4 << 30

#: Interval at which silent processes are checked for being alive.
POLL_INTERVAL_S = 1.0

#: Interval at which the rest of a message is sent that a socket did not take at once.
SENDING_INTERVAL_S = 0.01

#: Time limit for the end of a process.
SHUTDOWN_TIMEOUT_S = 10.0


def _one_group(argument: object) -> None:
    """All calls belong to one group."""


def call_all(
    function: Callable[[Argument], Result],
    arguments: Sequence[Argument],
    jobs: int,
    limit: float,
    memory: int = MEMORY_LIMIT_BYTES,
    group: Callable[[Argument], Hashable] = _one_group,
) -> Generator[tuple[Argument, Result | Crashed | TimedOut], None, None]:
    """Yield every argument with the result of function(argument), in the order in which the calls finish.

    The result of a call that raises an exception, including `SystemExit`, or whose process dies is `Crashed`. If a process dies
    after earlier calls, the last call is repeated in a new process, because an earlier call may have caused the failure.

    The generator must be iterated by one thread; the processes end with that thread. Raises `RuntimeError` if no process can be
    started.

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
    group
        What a call belongs to; calls of different groups are made in different processes.
    """
    queue = _Queue(list(map(group, arguments)))
    workers: list[_Worker] = []
    try:
        while queue or workers:
            while len(workers) < jobs and sum(worker.fresh for worker in workers) < len(queue):
                workers.append(_start(function, memory))
            wait([worker.channel.socket for worker in workers], _poll_timeout(workers))
            for worker in tuple(workers):
                place, answer = worker.place, _answer(worker, limit)
                if answer is None:
                    continue
                if answer.died and place is None:
                    raise RuntimeError(f"no process can be started: {answer.result.reason}")
                unclear = answer.died and worker.calls > 1
                if unclear and place is not None:
                    queue.suspects.append(place)
                following = queue.following(worker, workers) if answer.reusable else None
                if following is not None:
                    worker.call(following, arguments[following], limit)
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
    function: Callable[[Argument], Result],
    limit: float,
    memory: int = MEMORY_LIMIT_BYTES,
    group: Callable[[Argument], Hashable] = _one_group,
) -> Iterator[Callable[[Argument], Result | Crashed | TimedOut]]:
    """Provide a function that calls `function` in the worker process of the call's group, which is kept between calls.

    Failures, limits and parameters are those of `call_all`.
    """
    with crew(function, 1, limit, memory, group) as call_each:
        yield lambda argument: call_each([argument])[0]


@contextlib.contextmanager
def crew(
    function: Callable[[Argument], Result],
    jobs: int,
    limit: float,
    memory: int = MEMORY_LIMIT_BYTES,
    group: Callable[[Argument], Hashable] = _one_group,
) -> Iterator[Callable[[Sequence[Argument]], list[Result | Crashed | TimedOut]]]:
    """Provide a function that calls `function` with each of some arguments and returns the results in their order.

    Each group has one worker process, which is kept between calls and makes the calls of its group in turn. Those of different
    groups are made at the same time, at most `jobs` of them. Failures, limits and parameters are those of `call_all`.
    """
    workers: dict[Hashable, _Worker] = {}

    def call_each(arguments: Sequence[Argument]) -> list[Result | Crashed | TimedOut]:
        waiting: dict[Hashable, deque[int]] = {}
        for place, argument in enumerate(arguments):
            waiting.setdefault(group(argument), deque()).append(place)
        results: dict[int, Result | Crashed | TimedOut] = {}
        busy: dict[Hashable, _Worker] = {}

        def call(own: Hashable, worker: _Worker) -> None:
            place = waiting[own][0]
            worker.call(place, arguments[place], limit)

        while waiting:
            for own in [own for own in waiting if own not in busy][: jobs - len(busy)]:
                if own in workers:
                    call(own, workers[own])
                else:
                    workers[own] = _start(function, memory)
                busy[own] = workers[own]
            wait([worker.channel.socket for worker in busy.values()], _poll_timeout(list(busy.values())))
            for own, worker in tuple(busy.items()):
                if (answer := _answer(worker, limit)) is None:
                    continue
                if worker.fresh:
                    if answer.died:
                        raise RuntimeError(f"no process can be started: {answer.result.reason}")
                    call(own, worker)
                    continue
                del busy[own]
                if not answer.reusable:
                    workers.pop(own).stop()
                # If a process dies after earlier calls, one of these may be the cause: the call is repeated in a new one.
                if not answer.died or worker.calls == 1:
                    results[waiting[own].popleft()] = answer.result
                    if not waiting[own]:
                        del waiting[own]
        return [results[place] for place in range(len(arguments))]

    try:
        yield call_each
    finally:
        for worker in workers.values():
            worker.stop()


class _Queue:
    """The places of the calls that are to be made, by group, and of those that are repeated in a fresh process."""

    def __init__(self, groups: Sequence[Hashable]) -> None:
        self.groups = groups
        self.suspects: deque[int] = deque()
        self._waiting: dict[Hashable, deque[int]] = {}
        for place, group in enumerate(groups):
            self._waiting.setdefault(group, deque()).append(place)

    def __len__(self) -> int:
        return len(self.suspects) + sum(map(len, self._waiting.values()))

    def following(self, worker: "_Worker", workers: Sequence["_Worker"]) -> int | None:
        """Take and return the next call for one of the workers; None if it must not make any that is left.

        A fresh worker prefers a group that no other one serves, because every further process of a group costs its imports.
        """
        if worker.fresh and self.suspects:
            return self.suspects.popleft()
        served = {self.groups[other.place] for other in workers if other.place is not None}
        if worker.place is None:
            free = [group for group in self._waiting if group not in served] or list(self._waiting)
            group = min(free, key=lambda group: self._waiting[group][0], default=None)
        else:
            group = self.groups[worker.place]
        if group not in self._waiting:
            return None
        place = self._waiting[group].popleft()
        if not self._waiting[group]:
            del self._waiting[group]
        return place


class _Answer(NamedTuple):
    """The result of a call. `reusable` says whether its process can make another call, and `died` whether it is dead."""

    result: Any
    reusable: bool
    died: bool = False


@dataclass(eq=False)
class _Worker:
    """A worker process and this end of its channel. `place` is the index of the argument; None before the first call."""

    process: BaseProcess
    channel: channel.Parent
    place: int | None = None
    calls: int = 0
    deadline: float = math.inf

    @property
    def fresh(self) -> bool:
        return self.calls == 0

    def call(self, place: int, argument: Any, limit: float) -> None:
        self.place, self.calls, self.deadline = place, self.calls + 1, time.monotonic() + limit
        self.channel.send(self.calls, pickle.dumps(argument))

    def stop(self) -> None:
        guard.stop(self.process, SHUTDOWN_TIMEOUT_S)
        self.channel.close()


def _start(function: Callable[[Any], Any], memory: int) -> _Worker:
    context = multiprocessing.get_context("spawn")
    ours, theirs, mark = channel.pair()
    # The process is daemonic, so that the end of the program does not wait for it.
    content = pickle.dumps((_work, (function, mark, memory)))
    process = context.Process(target=guard.work, args=(content, theirs), daemon=True)
    process.start()
    theirs.close()
    return _Worker(process, ours)


def _poll_timeout(workers: Sequence[_Worker]) -> float:
    nearest = min(worker.deadline for worker in workers) - time.monotonic()
    longest = SENDING_INTERVAL_S if any(worker.channel.busy for worker in workers) else POLL_INTERVAL_S
    return max(0.0, min(longest, nearest))


def _answer(worker: _Worker, limit: float) -> _Answer | None:
    """Return the answer to a worker's call; None while the call is running. It does not wait."""
    ended = not worker.process.is_alive()  # checked first, so that an answer sent before the end is still read
    try:
        while True:
            more = worker.channel.read()
            for number, message in worker.channel.messages():
                if number == worker.calls:  # another number is that of an earlier call, which was answered twice
                    return _Answer(*pickle.loads(message))
            if not (ended and more):
                break
    except channel.Damaged:
        reason = "something other than bodycheck wrote into the channel of its process"
        return _Answer(Crashed(reason), reusable=False, died=True)
    except (Exception, SystemExit) as error:
        return _Answer(Crashed(f"its result cannot be read: {crash(error).reason}"), reusable=False)
    if ended or worker.channel.closed:
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


def _work(theirs: socket.socket, function: Callable[[Any], Any], mark: bytes, memory: int) -> None:
    """Run the loop of a worker process: report that it is ready, then answer calls."""
    limits.allow_memory(memory)
    limits.give_up_resource_tracker()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent handles interrupts
    os.dup2(2, 1)  # output of engines goes to stderr, because stdout is for results
    parent, own = channel.Worker(theirs, mark), os.getpid()
    if hasattr(os, "register_at_fork"):
        os.register_at_fork(after_in_child=parent.close)
    allowed: float = math.inf  # threads, until the first call has ended
    try:
        parent.send(0, pickle.dumps((None, True)))
        while True:
            number, argument = parent.receive()
            loaded, before = pickle.loads(argument), state()
            result = _call(function, loaded)
            if os.getpid() != own:  # the engine has made a copy of the process, and the copy must not answer
                os._exit(0)
            changed, allowed = state() != before or threads() > allowed, threads()
            parent.send(number, _pickled(result, reusable=not changed and not limits.keeps_much()))
    except (EOFError, ConnectionError):
        return  # the parent is gone


def _pickled(result: Any, reusable: bool) -> bytes:
    try:
        return pickle.dumps((result, reusable))
    except Exception as error:
        return pickle.dumps((crash(error), False))


def _call(function: Callable[[Any], Any], argument: Any) -> Any:
    try:
        with limits.limited_memory():
            return function(argument)
    except BaseException as error:
        return crash(error)
