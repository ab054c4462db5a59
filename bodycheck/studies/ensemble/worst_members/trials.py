"""Try cases: run them with one method of an engine, and compare the runs with the truth, in worker processes.

The engine and the truths have separate processes. Cases are tried in blocks. If a block ends its process, it is divided until
the case that causes this is alone. A block that takes too long is not divided, so that a case that hangs costs the limit once.
"""

import contextlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from bodycheck.adapters.method import Method
from bodycheck.casefile.content import Case
from bodycheck.judging.discrepancy import compare
from bodycheck.judging.expectation_writer import floors
from bodycheck.processes import pool
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.reference.errors import NotModelled, OutOfReach
from bodycheck.reference.truth import truth
from bodycheck.results.outcome import Completed, Run, Unsupported
from bodycheck.running import engines
from bodycheck.running.campaign import TIME_LIMIT_S
from bodycheck.running.members.chunk_workers import in_halves
from bodycheck.running.simulation import run


@dataclass(frozen=True)
class Tried:
    """The outcome of a trial of a case.

    Attributes
    ----------
    status, reason
        The status of its run, and the reason for it.
    figures
        The figures of the run by name; none unless the status is ok.
    floors
        The values below which the figures are only rounding, by name.
    version
        The version of the engine; empty if its process died.
    """

    status: str
    reason: str = ""
    figures: dict[str, float] = field(default_factory=dict)
    floors: dict[str, float] = field(default_factory=dict)
    version: str = ""


@dataclass(frozen=True)
class _Runs:
    """The runs of some cases that the process of an engine makes in one call."""

    engine: str
    method: Method
    cases: tuple[Case, ...]


@dataclass(frozen=True)
class _Comparisons:
    """The runs whose figures the process of the truths computes in one call."""

    runs: tuple[tuple[Case, Run], ...]


#: A function that tries cases with a method of an engine.
Trials = Callable[[str, Method, Sequence[Case]], list[Tried]]


@contextlib.contextmanager
def trials(limit: float = TIME_LIMIT_S) -> Iterator[Trials]:
    """Provide a function that tries cases, whose processes are kept until the context ends. limit: the time (s) for a block."""
    with pool.Workers(_carry_out, 1, limit, group=_group, home=engines.home, kept=1) as workers:

        def tried(engine: str, method: Method, cases: Sequence[Case]) -> list[Tried]:
            runs = _asked(workers.call, lambda some: _Runs(engine, method, tuple(some)), cases)
            flown = [(index, one) for index, one in enumerate(runs) if isinstance(one, Run)]
            pairs = [(cases[index], one) for index, one in flown]
            compared = _asked(workers.call, lambda some: _Comparisons(tuple(some)), pairs)
            figures = dict(zip((index for index, _ in flown), compared, strict=True))
            answers = [figures.get(index, one) for index, one in enumerate(runs)]
            return [one if isinstance(one, Tried) else Tried(one.status, one.reason) for one in answers]

        yield tried


def _asked(ask: Callable[[Any], Any], question: Callable[[Sequence[Any]], Any], items: Sequence[Any]) -> list[Any]:
    """Return the answers about some items, which are asked for together, and in halves if the process dies."""

    def attempt(first: int, last: int) -> Any:
        answer = ask(question(items[first:last]))
        return [answer] * (last - first) if isinstance(answer, TimedOut) else answer

    answers: list[Any] = []
    for _, answer in in_halves(attempt, 0, len(items)) if items else ():
        answers += [answer] if isinstance(answer, Crashed | TimedOut) else answer
    return answers


def _group(question: _Runs | _Comparisons) -> str | None:
    return question.engine if isinstance(question, _Runs) else None


def _carry_out(question: _Runs | _Comparisons) -> list[Run] | list[Tried]:
    """Answer a question; a worker process calls this."""
    if isinstance(question, _Runs):
        return [run(case, question.engine, question.method) for case in question.cases]
    return [_compared(case, case_run) for case, case_run in question.runs]


def _compared(case: Case, case_run: Run) -> Tried:
    outcome = case_run.outcome
    if not isinstance(outcome, Completed):
        return Tried(outcome.status, outcome.reason, version=case_run.version)
    try:
        exact = truth(case.scene, outcome.trajectory.t, vouched=False)
    except (NotModelled, OutOfReach) as error:
        return Tried(Unsupported.status, str(error), version=case_run.version)
    figures = compare(exact, case_run).maxima()
    return Tried(outcome.status, "", figures, floors(exact, figures), case_run.version)
