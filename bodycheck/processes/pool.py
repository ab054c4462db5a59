"""Call functions in worker processes, so that a call that crashes, exits, hangs or exhausts memory affects nothing else.

A worker process makes one call after another, all of them of one group, so that an engine shares no process with another
engine or with the truth. Every worker has its own channel, so that the failure of one does not affect others, and answers carry
the number of their call. A process whose state a call has changed makes no other call, and what an engine starts ends with its
worker.
"""

import pickle
import signal
import subprocess
import time
from collections import Counter, deque
from collections.abc import Callable, Generator, Hashable, Iterator, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass
from multiprocessing.connection import wait
from typing import Any, NamedTuple, TypeVar

from bodycheck.environments.subprocesses import MEMORY_LIMIT_BYTES
from bodycheck.processes import channel, guard
from bodycheck.processes.failures import Crashed, TimedOut, crash
from bodycheck.processes.interpreter import HERE, Interpreter

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
    """The interpreter of the processes of a group, and their preparation for its calls.

    Parameters
    ----------
    interpreter
        The interpreter of the processes.
    prepare
        Called with the group, once in each process before the first call, such as to import an engine; None for nothing. What
        it changes in the process stays. If it fails, all calls of the group have its failure as their result.
    limit
        The time limit of the preparation (s).
    watched
        Whether a process in which a call leaves a thread makes no other call. The libraries that compute truths start threads
        when they are first needed, which later calls do not notice.
    """

    interpreter: Interpreter = HERE
    prepare: Callable[[Any], object] | None = None
    limit: float = 300.0
    watched: bool = True


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
    with closing(_Calls(function, jobs, limit, memory, group, home).results(arguments)) as results:
        for place, result in results:
            yield arguments[place], result


@contextmanager
def caller(
    function: Callable[[Argument], Result],
    limit: float,
    memory: int = MEMORY_LIMIT_BYTES,
    group: Callable[[Argument], Hashable] = _one_group,
    home: Callable[[Any], Home] = _here,
) -> Iterator[Callable[[Argument], Result | Crashed | TimedOut]]:
    """Provide a function that calls `function` in the worker process of the call's group, which is kept between calls.

    Failures, limits and parameters are those of `call_all`. Several threads may each have a caller of their own at the same
    time; the processes of a caller end with the thread that made its first call.
    """
    with crew(function, 1, limit, memory, group, home) as call_each:
        yield lambda argument: call_each([argument])[0]


@contextmanager
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
    with closing(_Calls(function, jobs, limit, memory, group, home, kept={})) as calls:

        def call_each(arguments: Sequence[Argument]) -> list[Result | Crashed | TimedOut]:
            results = dict(calls.results(arguments))
            return [results[place] for place in range(len(arguments))]

        yield call_each


@dataclass(eq=False)
class _Calls:
    """The function and limits of calls, and the worker processes that are kept for further calls.

    `kept` has the idle worker of each group; a group then has one worker at most. It is None if a worker ends when there is no
    call left for it, and a group may then have as many workers as there are processes.
    """

    function: Callable[[Any], Any]
    jobs: int
    limit: float
    memory: int
    group: Callable[[Any], Hashable]
    home: Callable[[Any], Home]
    kept: "dict[Hashable, _Worker] | None" = None

    def results(self, arguments: Sequence[Any]) -> Generator[tuple[int, Any], None, None]:
        """Make the calls and yield the place of each argument with its result, in the order in which the calls finish."""
        queue = _Queue(list(map(self.group, arguments)), self.jobs if self.kept is None else 1)
        busy: list[_Worker] = []
        try:
            while queue or busy:
                yield from self._staff(queue, busy, arguments)
                wait([worker.channel.socket for worker in busy], _poll_timeout(busy))
                for worker in tuple(busy):
                    if (answer := _answer(worker)) is not None:
                        yield from self._settle(worker, answer, queue, busy, arguments)
        finally:
            for worker in busy:
                worker.stop()

    def close(self) -> None:
        """Stop the workers that were kept."""
        for worker in (self.kept or {}).values():
            worker.stop()

    def _staff(self, queue: "_Queue", busy: "list[_Worker]", arguments: Sequence[Any]) -> Iterator[tuple[int, Any]]:
        """Add workers to the busy ones while calls lack them, and yield the calls for which no process can be started."""
        while len(busy) < self.jobs and queue.wants(busy):
            following = queue.group_for(busy)
            if self.kept and following in self.kept:
                busy.append(self.kept.pop(following))
                self._continue(busy[-1], queue, arguments)
                continue
            try:
                busy.append(_start(following, self.home(following), self.memory))
            except OSError as error:
                yield from ((left, _no_process(error)) for left in queue.take(following))

    def _settle(
        self, worker: "_Worker", answer: "_Answer", queue: "_Queue", busy: "list[_Worker]", arguments: Sequence[Any]
    ) -> Iterator[tuple[int, Any]]:
        """Let a worker that has answered make its next call or dismiss it, and yield what is known of its calls by now."""
        place = worker.place
        if not (answer.reusable and self._continue(worker, queue, arguments)):
            busy.remove(worker)
            if answer.reusable and self.kept is not None:
                self.kept[worker.group] = worker
            else:
                worker.stop()
        if place is None:
            if not answer.reusable:  # its preparation failed
                yield from ((left, answer.result) for left in queue.take(worker.group))
        elif answer.died and worker.calls > 1:
            queue.repeat(place)
        else:
            yield place, answer.result

    def _continue(self, worker: "_Worker", queue: "_Queue", arguments: Sequence[Any]) -> bool:
        """Let a worker make the next call that it may make; return whether there is one."""
        if (place := queue.following(worker)) is None:
            return False
        worker.call(place, self.function, arguments[place], self.limit)
        return True


class _Queue:
    """The places of the calls that are to be made, by group, and of those that are repeated in a fresh process.

    A group is served by at most `most` workers at the same time.
    """

    def __init__(self, groups: Sequence[Hashable], most: int) -> None:
        self._groups, self._most = groups, most
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
        own = [worker for worker in workers if worker.group == group]
        left = len(self._suspects.get(group, ())) + len(self._waiting.get(group, ()))
        return len(own) < self._most and left > sum(worker.fresh for worker in own)


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
            process = home.interpreter.start(theirs, mark, memory, home.watched)
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
