"""Call functions in worker processes, so that a call that crashes, exits, hangs or exhausts memory affects nothing else.

A worker process makes one call after another, all of them of one group, so that an engine shares no process with another
engine or with the truth. Every worker has its own channel, so that the failure of one does not affect others, and answers carry
the number of their call. A process whose state a call has changed makes no other call, and what an engine starts ends with its
worker.
"""

import contextlib
import pickle
import signal
import subprocess
import time
from collections import Counter, deque
from collections.abc import Callable, Generator, Hashable, Iterator, Sequence
from dataclasses import dataclass
from multiprocessing.connection import wait
from typing import Any, NamedTuple, TypeVar

from bodycheck.environments.subprocesses import MEMORY_LIMIT_BYTES
from bodycheck.running import channel, guard
from bodycheck.running.interpreter import HERE, Interpreter
from bodycheck.running.outcome import Crashed, TimedOut, crash

Argument = TypeVar("Argument")
Result = TypeVar("Result")

#: Interval at which silent processes are checked for being alive.
POLL_INTERVAL_S = 1.0

#: Interval at which the rest of a message is sent that a socket did not take at once.
SENDING_INTERVAL_S = 0.01

#: Time limit for the end of a process.
SHUTDOWN_TIMEOUT_S = 10.0


@dataclass(frozen=True)
class Home:
    """Where the processes of a group live, and how they are prepared for its calls.

    Parameters
    ----------
    interpreter
        The interpreter of the processes.
    prepare
        Called with the group, once in each process before the first call, such as to import an engine; None for nothing. What
        it changes in the process stays. If it fails, all calls of the group have its failure as their result.
    limit
        The time limit of the preparation (s).
    """

    interpreter: Interpreter = HERE
    prepare: Callable[[Any], object] | None = None
    limit: float = 300.0


def _one_group(argument: object) -> None:
    """All calls belong to one group."""


def _here(group: object) -> Home:
    """All processes live in this interpreter."""
    return Home()


def call_all(
    function: Callable[[Argument], Result],
    arguments: Sequence[Argument],
    jobs: int,
    limit: float,
    memory: int = MEMORY_LIMIT_BYTES,
    group: Callable[[Argument], Hashable] = _one_group,
    home: Callable[[Any], Home] = _here,
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
    group
        What a call belongs to; calls of different groups are made in different processes.
    home
        Where the processes of a group live.
    """
    queue = _Queue(list(map(group, arguments)))
    workers: list[_Worker] = []
    try:
        while queue or workers:
            while len(workers) < jobs and queue.wants(workers):
                following = queue.group_for(workers)
                try:
                    workers.append(_start(following, home(following), memory))
                except OSError as error:
                    yield from ((arguments[left], _no_process(error)) for left in queue.take(following))
            wait([worker.channel.socket for worker in workers], _poll_timeout(workers))
            for worker in tuple(workers):
                place, answer = worker.place, _answer(worker)
                if answer is None:
                    continue
                if answer.reusable and (next_place := queue.following(worker)) is not None:
                    worker.call(next_place, function, arguments[next_place], limit)
                else:
                    workers.remove(worker)
                    worker.stop()
                if place is None:
                    if not answer.reusable:  # its preparation failed
                        yield from ((arguments[left], answer.result) for left in queue.take(worker.group))
                elif answer.died and worker.calls > 1:
                    queue.repeat(place)
                else:
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
    home: Callable[[Any], Home] = _here,
) -> Iterator[Callable[[Argument], Result | Crashed | TimedOut]]:
    """Provide a function that calls `function` in the worker process of the call's group, which is kept between calls.

    Failures, limits and parameters are those of `call_all`.
    """
    with crew(function, 1, limit, memory, group, home) as call_each:
        yield lambda argument: call_each([argument])[0]


@contextlib.contextmanager
def crew(
    function: Callable[[Argument], Result],
    jobs: int,
    limit: float,
    memory: int = MEMORY_LIMIT_BYTES,
    group: Callable[[Argument], Hashable] = _one_group,
    home: Callable[[Any], Home] = _here,
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
            worker.call(place, function, arguments[place], limit)

        def fail(own: Hashable, result: Crashed | TimedOut) -> None:
            results.update(dict.fromkeys(waiting.pop(own), result))

        while waiting:
            for own in [own for own in waiting if own not in busy][: jobs - len(busy)]:
                if own in workers:
                    call(own, workers[own])
                else:
                    try:
                        workers[own] = _start(own, home(own), memory)
                    except OSError as error:
                        fail(own, _no_process(error))
                        continue
                busy[own] = workers[own]
            wait([worker.channel.socket for worker in busy.values()], _poll_timeout(list(busy.values())))
            for own, worker in tuple(busy.items()):
                if (answer := _answer(worker)) is None:
                    continue
                if worker.place is None and answer.reusable:  # it is prepared
                    call(own, worker)
                    continue
                del busy[own]
                if not answer.reusable:
                    workers.pop(own).stop()
                if worker.place is None:
                    fail(own, answer.result)
                # If a process dies after earlier calls, one of these may be the cause: the call is repeated in a new one.
                elif not answer.died or worker.calls == 1:
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
        self._groups = groups
        self._waiting: dict[Hashable, deque[int]] = {}
        self._suspects: dict[Hashable, deque[int]] = {}
        for place, group in enumerate(groups):
            self._waiting.setdefault(group, deque()).append(place)

    def __bool__(self) -> bool:
        return bool(self._waiting or self._suspects)

    def wants(self, workers: "Sequence[_Worker]") -> bool:
        """Return whether there are more calls than workers that have not made any yet."""
        return any(self._lacks(group, workers) for group in (*self._suspects, *self._waiting))

    def group_for(self, workers: "Sequence[_Worker]") -> Hashable:
        """Return the group that another worker is to serve: the first that has fewest, as each costs its preparation."""
        served = Counter(worker.group for worker in workers)
        wanting = [group for group in (*self._suspects, *self._waiting) if self._lacks(group, workers)]
        return min(wanting, key=lambda group: served[group])

    def following(self, worker: "_Worker") -> int | None:
        """Take and return the next call for a worker; None if it must not make any that is left."""
        for calls in (self._suspects, self._waiting) if worker.fresh else (self._waiting,):
            if worker.group in calls:
                place = calls[worker.group].popleft()
                if not calls[worker.group]:
                    del calls[worker.group]
                return place
        return None

    def repeat(self, place: int) -> None:
        """Put a call back, to be made in a fresh process."""
        self._suspects.setdefault(self._groups[place], deque()).append(place)

    def take(self, group: Hashable) -> list[int]:
        """Take and return all calls of a group."""
        return [*self._suspects.pop(group, ()), *self._waiting.pop(group, ())]

    def _lacks(self, group: Hashable, workers: "Sequence[_Worker]") -> bool:
        left = len(self._suspects.get(group, ())) + len(self._waiting.get(group, ()))
        return left > sum(worker.fresh and worker.group == group for worker in workers)


class _Answer(NamedTuple):
    """The result of a call. `reusable` says whether its process can make another call, and `died` whether it is dead."""

    result: Any
    reusable: bool
    died: bool = False


@dataclass(eq=False)
class _Worker:
    """A worker process of a group and this end of its channel.

    `place` is the index of the argument of its present call; None while it starts and is prepared. `number` is that of the
    message which it is to answer, and `calls` how many calls it was given.
    """

    process: "subprocess.Popen[bytes]"
    channel: channel.Parent
    group: Hashable
    home: Home
    limit: float
    deadline: float
    place: int | None = None
    number: int = 0
    calls: int = 0

    @property
    def fresh(self) -> bool:
        return self.calls == 0

    @property
    def to_prepare(self) -> bool:
        return self.number == 0 and self.home.prepare is not None

    def call(self, place: int, function: Callable[[Any], Any], argument: Any, limit: float) -> None:
        self.place, self.calls = place, self.calls + 1
        self._send(function, argument, False, limit)

    def prepare(self) -> None:
        self._send(self.home.prepare, self.group, True, self.home.limit)

    def _send(self, function: Callable[[Any], Any] | None, argument: Any, preparing: bool, limit: float) -> None:
        self.number, self.limit, self.deadline = self.number + 1, limit, time.monotonic() + limit
        self.channel.send(self.number, pickle.dumps((function, argument, preparing)))

    def stop(self) -> None:
        guard.stop(self.process, SHUTDOWN_TIMEOUT_S)
        self.channel.close()


def _start(group: Hashable, home: Home, memory: int) -> _Worker:
    ours, theirs, mark = channel.pair()
    try:
        with theirs:
            process = home.interpreter.start(theirs, mark, memory)
    except OSError:
        ours.close()
        raise
    return _Worker(process, ours, group, home, home.limit, time.monotonic() + home.limit)


def _no_process(error: OSError) -> Crashed:
    return Crashed(f"its process cannot be started: {error}")


def _poll_timeout(workers: Sequence[_Worker]) -> float:
    nearest = min((worker.deadline for worker in workers), default=0.0) - time.monotonic()
    longest = SENDING_INTERVAL_S if any(worker.channel.busy for worker in workers) else POLL_INTERVAL_S
    return max(0.0, min(longest, nearest))


def _answer(worker: _Worker) -> _Answer | None:
    """Return the answer to a worker's call, or that it is prepared; None while it is busy. It does not wait."""
    ended = worker.process.poll() is not None  # checked first, so that an answer sent before the end is still read
    try:
        while True:
            more = worker.channel.read()
            for number, message in worker.channel.messages():
                if number == worker.number:  # another number is that of an earlier call, which was answered twice
                    if worker.to_prepare:
                        worker.prepare()
                        return None
                    answer = _Answer(*pickle.loads(message))
                    failed = worker.place is None and isinstance(answer.result, Crashed)
                    return answer._replace(reusable=answer.reusable and not failed)
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
        return _Answer(TimedOut(worker.limit), reusable=False)
    return None


def _cause_of_death(process: "subprocess.Popen[bytes]") -> str:
    # `join` would wait without limit for a process that has closed all its files but continues.
    patience = time.monotonic() + SHUTDOWN_TIMEOUT_S
    while (exitcode := process.poll()) is None:
        if time.monotonic() > patience:
            return "its process closed its pipe"
        time.sleep(0.01)
    if exitcode >= 0:
        return f"its process exited with code {exitcode}"
    try:
        return f"its process died of signal {signal.Signals(-exitcode).name}"
    except ValueError:  # a real-time signal
        return f"its process died of signal {-exitcode}"
