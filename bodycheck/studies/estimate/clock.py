"""The processor time that is left for the runs of one engine."""

import math
import time
from dataclasses import dataclass, field

from bodycheck.adapters.contract import Method
from bodycheck.processes import pool
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.running import refining
from bodycheck.running.refining import Call, Ended, Motion
from bodycheck.studies.estimate.method import NoTime

#: The most wall time of a call in terms of the processor time that is left for it, before it counts as hanging.
PATIENCE = 20.0


@dataclass(eq=False)
class Clock:
    """The processor time that is left for the runs of one engine, and the processes that make them.

    The time of this process counts too, since it compares the runs. That of other programs does not, so that the same steps are
    tried on a machine that is busy.

    Attributes
    ----------
    workers
        The processes that make the runs.
    budget
        The processor time (s) that there is, as it is told to users.
    end
        The reading of `now` at which the time is used up.
    runs, in_workers
        The number of runs, and the processor time (s) that workers used for them.
    per_step
        The smallest processor time (s) of a step of each method.
    """

    workers: "pool.Workers[Call, refining.Timed]"
    budget: float
    end: float = 0.0
    runs: int = 0
    in_workers: float = 0.0
    per_step: dict[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.end = self.now + self.budget

    @property
    def now(self) -> float:
        """The processor time (s) that was used up to now, from an arbitrary start."""
        return time.process_time() + self.in_workers

    def ask(self, call: Call, steps: int, method: Method | None = None) -> refining.Answer:
        """Return the answer to a call. Raises `NoTime` if the time is too short for the run."""
        left = self.end - self.now
        needed = self.per_step.get("" if method is None else method.name, 0.0) * steps
        if needed > left or left <= 0:
            raise NoTime(self.told)
        self.workers.limit = PATIENCE * max(1.0, left)
        outcome = self.workers.call(call)
        self.runs += 1
        if isinstance(outcome, TimedOut):
            self.in_workers += left
            raise NoTime(self.told)
        if isinstance(outcome, Crashed):
            return Ended(outcome.status, outcome.reason)
        self.in_workers += outcome.seconds
        if isinstance(outcome.answer, Motion) and method is not None:
            per_step = outcome.seconds / max(1, outcome.answer.steps)
            self.per_step[method.name] = min(self.per_step.get(method.name, math.inf), per_step)
        return outcome.answer

    @property
    def told(self) -> str:
        """The number of runs that were made in the time, as a sentence without a full stop."""
        return f"the processor time of {self.budget:g} s is used up after {self.runs} runs"
