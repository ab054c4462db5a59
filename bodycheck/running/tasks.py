"""The tasks of worker processes: make a run, compute truths, cross-check a truth, and compute where a body stops.

A process of an engine needs nothing of the reference, and a process of the reference needs no engine. Each imports only what it
needs.
"""

import contextlib
import math
import sys
from dataclasses import dataclass

from bodycheck.adapters import registry
from bodycheck.adapters.contract import Method
from bodycheck.casefile.content import Case
from bodycheck.reference.certified import Certificate
from bodycheck.reference.errors import Cause, NotModelled, OutOfReach
from bodycheck.reference.planar import Stop
from bodycheck.reference.scene import Plane
from bodycheck.reference.sensors.readings import SensorTruth
from bodycheck.reference.truths import NoTruth, Truth
from bodycheck.results.key import RunKey
from bodycheck.results.outcome import Run

#: What leaves a part of a robot's file out, on the command line and in a case.
OPTIONS: dict[Cause, str] = {
    "dry friction": '--ignore friction, or ignore = ["friction"]',
    "stops": '--ignore limits, or use without "limits"',
    "controllers": '--ignore actuators, or use without "actuators"',
    "followers": '--ignore mimic, or ignore = ["mimic"]',
}


@dataclass(frozen=True)
class Task:
    """One run to be made."""

    case: Case
    engine: str
    method: Method

    @property
    def key(self) -> RunKey:
        """The key of the run."""
        return RunKey(self.case.name, self.engine, self.method)


@dataclass(frozen=True)
class TruthTask:
    """The task of computing the truths for the runs of a case with some samplings (`Method.sampling`), all at once."""

    case: Case
    samplings: tuple[float, ...]


#: The answer to a truth task: the truths by sampling, or the reason why there are none.
Truths = dict[float, Truth] | NoTruth


@dataclass(frozen=True)
class StopTask:
    """The task of computing where the body of a case stops if a law of friction acts on its plane."""

    case: Case
    law: Plane


@dataclass(frozen=True)
class Question:
    """The truth of a case, or its certificate, at some times (s) or at the case's instants.

    limit: the time (s) after which a proof ends at an earlier instant.
    """

    case: Case
    times: tuple[float, ...] | None
    certified: bool
    limit: float = math.inf


@dataclass(frozen=True, eq=False)
class SensorQuestion:
    """The truth of the sensors of a case, at the instants of a truth of it."""

    case: Case
    truth: Truth


def group(argument: TruthTask | Task) -> str | None:
    """Return the group of tasks that share processes: the name of the engine, or None for truths."""
    return argument.engine if isinstance(argument, Task) else None


def perform_run(task: Task) -> Run:
    """Make the run of a task."""
    from bodycheck.running.simulation import run

    return run(task.case, task.engine, task.method)


def perform_stop(task: StopTask) -> Stop | None:
    """Compute where the body of a task stops under its law of friction; None if the reference finds no stop."""
    from bodycheck.running import truths

    return truths.stop_under(task.case, task.law)


def perform(argument: TruthTask | Task) -> Run | Truths:
    """Make the run or compute the truths of a task; `NoTruth` if the reference has none."""
    if isinstance(argument, Task):
        return perform_run(argument)
    from bodycheck.running import truths

    try:
        return truths.of_runs(argument.case, argument.samplings)
    except (NotModelled, OutOfReach) as error:
        return NoTruth(f"{error}{_advice(argument.case, error)}")


def answer(question: Question) -> Truth | Certificate | NoTruth:
    """Compute the requested truth or cross-check; `NoTruth` if the reference has none."""
    from bodycheck.running import truths

    try:
        if question.certified:
            return truths.certify(question.case, question.times, question.limit)
        return truths.truth(question.case, question.times)
    except NotModelled as error:
        return NoTruth(f"unsupported: the reference does not model {error}{_advice(question.case, error)}")
    except OutOfReach as error:
        return NoTruth(f"the reference cannot follow this motion: {error}{_advice(question.case, error)}")


def _advice(case: Case, error: NotModelled | OutOfReach) -> str:
    """Return a clause on the option that may give a robot's file a truth by leaving out what it has none for; else nothing."""
    if case.robot is None or error.cause is None:
        return ""
    return f"; there may be a truth without {error.cause}: {OPTIONS[error.cause]} in [model] of a case"


def answer_sensors(question: SensorQuestion) -> tuple[SensorTruth, ...] | NoTruth:
    """Compute the truth of the sensors of a case; `NoTruth` if the reference cannot follow what they read."""
    from bodycheck.reference.sensors.truth import sensor_truth

    try:
        return sensor_truth(question.truth, question.case.sensors)
    except OutOfReach as error:
        return NoTruth(f"the reference cannot follow what sensors read: {error}")


def leave_out_sympy(group: None) -> None:
    """Keep heyoka from importing SymPy into a process of truths, which does not need it and would start much later."""
    sys.modules.setdefault("sympy", None)  # type: ignore[arg-type]


def import_engine(name: str) -> None:
    """Import an engine. If that raises an exception, each call raises it again."""
    with contextlib.suppress(registry.EngineMissing):
        registry.load(name)
