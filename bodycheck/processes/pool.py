"""Call functions in worker processes, so that a call that crashes, exits, hangs or exhausts memory affects nothing else.

A worker process makes one call after another, all from one group, so that an engine shares no process with another engine or
with the truth. Every worker has its own channel, so that its failure does not affect others, and each answer carries the number
of its call. A process whose state a call has changed makes no other call. Processes that an engine starts end with their
worker.
"""

import pickle
import signal
import subprocess
import time
from collections import Counter, defaultdict, deque
from collections.abc import Callable, Generator, Hashable, Iterator, Sequence
from dataclasses import dataclass, field
from multiprocessing.connection import wait
from threading import Event
from typing import Any, Generic, NamedTuple, Self, TypeVar

from bodycheck.environments.subprocesses import MEMORY_LIMIT_BYTES
from bodycheck.processes import channel, guard
from bodycheck.processes.failures import Crashed, TimedOut, crash
from bodycheck.processes.interpreter import HERE, Interpreter

Argument = TypeVar("Argument")
Result = TypeVar("Result")

#: Interval (s) at which silent processes are checked for being alive.
POLL_INTERVAL_S = 1.0

#: Interval (s) at which the rest of a message is sent that a socket did not accept at once.
SENDING_INTERVAL_S = 0.01

#: Time limit (s) for the end of a process.
SHUTDOWN_TIMEOUT_S = 10.0


@dataclass(frozen=True)
class Home:
    """The interpreter of the processes of a group, and their preparation for its calls.

    Parameters
    ----------
    interpreter
        The interpreter of the processes.
    prepare
        Function that is called with the group once in each process before the first call, for example to import an engine; None
        for nothing. Its changes of the process stay. If it fails, its failure is the result of all calls of the group.
    limit
        The time limit of the preparation (s).
    watched
        Whether a process makes no other call after a call that leaves a thread. It is False for truths, whose libraries start
        threads when they are first needed; these do not affect later calls.
    """

    interpreter: Interpreter = HERE
    prepare: Callable[[Any], object] | None = None
    limit: float = 300.0
    watched: bool = True


def _one_group(argument: object) -> None:
    """Return the same group for all calls."""


def _here(group: object) -> Home:
    """Return this interpreter as the home of every group."""
    return Home()


class Cancelled(Exception):
    """The calls of some workers are not needed any more."""


@dataclass(eq=False)
class Workers(Generic[Argument, Result]):
    """Worker processes that call one function. As a context manager, it ends them at the end of the context.

    The result of a call that raises an exception, including `SystemExit`, or whose process dies is `Crashed`. If a process dies
    after earlier calls, the last call is repeated in a new process, because an earlier call may have caused the failure.

    One thread must make all calls; the processes end with that thread. Several threads may each have workers at the same time.

    Parameters
    ----------
    function
        The function. It must be importable by name, and its arguments and results must be picklable.
    jobs
        The number of processes that make calls at the same time.
    limit
        The time limit of one call (s). A call that exceeds it is killed, and its result is `TimedOut`.
    memory
        The memory limit of one call (bytes), where the operating system supports it (see `limits`).
    group
        The group of a call; calls of different groups are made in different processes.
    home
        The interpreter and the preparation of the processes of a group.
    kept
        The most processes of each group, which live until the context ends. If it is 0, a group uses any number of free
        processes, and a process ends when `map` has no further calls for it.
    cancelled
        An event that another thread sets when the calls are not needed any more.
    """

    function: Callable[[Argument], Result]
    jobs: int
    limit: float
    memory: int = MEMORY_LIMIT_BYTES
    group: Callable[[Argument], Hashable] = _one_group
    home: Callable[[Any], Home] = _here
    kept: int = 0
    cancelled: Event = field(default_factory=Event)
    _busy: "list[_Worker]" = field(default_factory=list, init=False)
    _idle: "defaultdict[Hashable, list[_Worker]]" = field(default_factory=lambda: defaultdict(list), init=False)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

    def close(self) -> None:
        """End all processes."""
        self._stop_busy()
        while self._idle:
            for worker in self._idle.popitem()[1]:
                worker.stop()

    def call(self, argument: Argument) -> Result | Crashed | TimedOut:
        """Call the function and return its result. Raises `Cancelled` if `cancelled` is set."""
        ((_, result),) = self.map([argument])
        return result

    def map(self, arguments: Sequence[Argument]) -> Generator[tuple[Argument, Result | Crashed | TimedOut], None, None]:
        """Yield every argument with the result of function(argument), in the order in which the calls finish.

        The generator must be finished or closed before the next call. Raises `Cancelled` at most `POLL_INTERVAL_S` after the
        event.
        """
        queue = _Queue(arguments, self.group, self.kept or self.jobs)
        try:
            while queue or self._busy:
                if self.cancelled.is_set():
                    raise Cancelled
                for index, result in self._step(queue):
                    yield arguments[index], result
        finally:
            self._stop_busy()

    def _step(self, queue: "_Queue[Argument]") -> Iterator[tuple[int, Any]]:
        """Start missing workers, wait for answers, and yield the index and the result of each finished call."""
        yield from self._staff(queue)
        wait([worker.channel.socket for worker in self._busy], _poll_timeout(self._busy))
        for worker in tuple(self._busy):
            if (answer := _answer(worker)) is not None:
                yield from self._settle(worker, answer, queue)

    def _staff(self, queue: "_Queue[Argument]") -> Iterator[tuple[int, Any]]:
        """Add busy workers while calls need them. Yield the calls for which no process can be started, as failed."""
        while len(self._busy) < self.jobs and queue.wants(self._busy):
            group = queue.group_for(self._busy)
            if self._idle[group]:
                self._busy.append(self._idle[group].pop())
                self._continue(self._busy[-1], queue)
                continue
            try:
                self._busy.append(_start(group, self.home(group), self.memory))
            except OSError as error:
                failure = Crashed(f"its process cannot be started: {error}")
                yield from ((index, failure) for index in queue.take(group))

    def _settle(self, worker: "_Worker", answer: "_Answer", queue: "_Queue[Argument]") -> Iterator[tuple[int, Any]]:
        """Let a worker that has answered make its next call, or dismiss it. Yield the calls that this answer ends."""
        index = worker.index
        if not (answer.reusable and self._continue(worker, queue)):
            self._busy.remove(worker)
            if answer.reusable and self.kept:
                self._idle[worker.group].append(worker)
            else:
                worker.stop()
        if index is None:
            if not answer.reusable:  # its preparation failed
                yield from ((left, answer.result) for left in queue.take(worker.group))
        elif answer.died and worker.calls > 1:
            queue.repeat(index)
        else:
            yield index, answer.result

    def _continue(self, worker: "_Worker", queue: "_Queue[Argument]") -> bool:
        """Let a worker make its next allowed call; return whether there is one."""
        if (index := queue.following(worker)) is None:
            return False
        worker.call(index, self.function, queue.arguments[index], self.limit)
        return True

    def _stop_busy(self) -> None:
        while self._busy:
            self._busy.pop().stop()


class _Queue(Generic[Argument]):
    """The indices of the calls to be made, by group, and of the calls to be repeated in a fresh process.

    A group has at most `most` workers at the same time.
    """

    def __init__(self, arguments: Sequence[Argument], group: Callable[[Argument], Hashable], most: int) -> None:
        self.arguments, self._groups, self._most = arguments, list(map(group, arguments)), most
        self._waiting: dict[Hashable, deque[int]] = {}
        self._suspects: dict[Hashable, deque[int]] = {}
        for index, name in enumerate(self._groups):
            self._waiting.setdefault(name, deque()).append(index)

    def __bool__(self) -> bool:
        return bool(self._waiting or self._suspects)

    def wants(self, workers: "Sequence[_Worker]") -> bool:
        """Return whether any group lacks a worker for its remaining calls."""
        return any(self._lacks(group, workers) for group in (*self._suspects, *self._waiting))

    def group_for(self, workers: "Sequence[_Worker]") -> Hashable:
        """Return the group for a new worker: the first of the groups that lack workers and have the fewest."""
        served = Counter(worker.group for worker in workers)
        wanting = [group for group in (*self._suspects, *self._waiting) if self._lacks(group, workers)]
        return min(wanting, key=lambda group: served[group])

    def following(self, worker: "_Worker") -> int | None:
        """Take and return the next call for a worker; None if it must not make any of the remaining calls."""
        for calls in (self._suspects, self._waiting) if worker.fresh else (self._waiting,):
            if worker.group in calls:
                index = calls[worker.group].popleft()
                if not calls[worker.group]:
                    del calls[worker.group]
                return index
        return None

    def repeat(self, index: int) -> None:
        """Put a call back, so that it is made in a fresh process."""
        self._suspects.setdefault(self._groups[index], deque()).append(index)

    def take(self, group: Hashable) -> list[int]:
        """Take and return all calls of a group."""
        return [*self._suspects.pop(group, ()), *self._waiting.pop(group, ())]

    def _lacks(self, group: Hashable, workers: "Sequence[_Worker]") -> bool:
        serving = [worker for worker in workers if worker.group == group]
        left = len(self._suspects.get(group, ())) + len(self._waiting.get(group, ()))
        return len(serving) < self._most and left > sum(worker.fresh for worker in serving)


class _Answer(NamedTuple):
    """The result of a call, whether its process can make another call (`reusable`), and whether its process `died`."""

    result: Any
    reusable: bool
    died: bool = False


@dataclass(eq=False)
class _Worker:
    """A worker process of a group and this end of its channel.

    `index` is the index of the argument of its present call; None while it starts and is prepared. `number` is the number of
    the message that it has to answer, and `calls` is the number of calls that it was given.
    """

    process: "subprocess.Popen[bytes]"
    channel: channel.Parent
    group: Hashable
    home: Home
    limit: float
    deadline: float
    index: int | None = None
    number: int = 0
    calls: int = 0

    @property
    def fresh(self) -> bool:
        return self.calls == 0

    @property
    def to_prepare(self) -> bool:
        return self.number == 0 and self.home.prepare is not None

    def call(self, index: int, function: Callable[[Any], Any], argument: Any, limit: float) -> None:
        self.index, self.calls = index, self.calls + 1
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
            process = home.interpreter.start(theirs, mark, memory, home.watched)
    except OSError:
        ours.close()
        raise
    return _Worker(process, ours, group, home, home.limit, time.monotonic() + home.limit)


def _poll_timeout(workers: Sequence[_Worker]) -> float:
    nearest = min((worker.deadline for worker in workers), default=0.0) - time.monotonic()
    longest = SENDING_INTERVAL_S if any(worker.channel.busy for worker in workers) else POLL_INTERVAL_S
    return max(0.0, min(longest, nearest))


def _answer(worker: _Worker) -> _Answer | None:
    """Return the answer of a worker to its call or preparation; None while it is busy. This does not wait."""
    ended = worker.process.poll() is not None  # checked first, so that an answer sent before the end is still read
    try:
        while True:
            more = worker.channel.read()
            for number, message in worker.channel.messages():
                if number == worker.number:  # another number belongs to an earlier call, which was answered twice
                    if worker.to_prepare:
                        worker.prepare()
                        return None
                    answer = _Answer(*pickle.loads(message))
                    failed = worker.index is None and isinstance(answer.result, Crashed)
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
