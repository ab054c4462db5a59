"""Plan runs of contact scenes at the defaults of engines and with every method that they offer, and make rows of the runs."""

from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import lru_cache
from typing import Any

from bodycheck.adapters.contract import Engine, Method
from bodycheck.adapters.method import DEFAULT_TIMESTEP
from bodycheck.adapters.offers import offered
from bodycheck.adapters.roles import aliases, spelled
from bodycheck.casefile.content import Case
from bodycheck.judging.judgement import Verdict
from bodycheck.judging.schemes.run_classes import TRUTHS_KEPT
from bodycheck.reference.truths import NoTruth, Truth
from bodycheck.results.outcome import Completed
from bodycheck.results.store import Results
from bodycheck.running.instants import default_timestep
from bodycheck.running.plan import Task, check, refuse_nothing
from bodycheck.running.roles import method_in_role, methods_of, refuse_timesteps
from bodycheck.studies.contact.rows import ContactRow, Setting
from bodycheck.studies.contact.sheet import SUBJECTS, truth_error, unit_of

#: The time steps with which methods are tried, as multiples of the time step of the engine's default method.
REFINEMENTS = (1.0, 0.25)

#: A function from the name of a case and a time step (s) to the truth, or to the reason why there is none.
Truths = Callable[[str, float], Truth | NoTruth]


def default_method(engine: Engine, case: Case) -> Method | None:
    """Return the default method of an engine for a case, with its time step; None if the engine has none."""
    return method_in_role(engine, case, "default")


def with_contact(engine: Engine, case: Case) -> list[str]:
    """Return the spellings of an engine's methods for a case, except those with the option `model`, which replaces contacts."""
    return [name for name in offered(engine, case.scene) if Method.parse(name, 0.0).option("model") is None]


def plan(
    cases: Sequence[Case], engines: Mapping[str, Engine], integrators: Sequence[str], timesteps: Sequence[float]
) -> tuple[Task, ...]:
    """Return the tasks: each method that an engine offers for a case, at two time steps, and its default method.

    The time steps are that of the default method and a quarter of it; 2 ms and a quarter of it if the engine has no default
    method.

    Parameters
    ----------
    cases
        The cases.
    engines
        The records of the engines by name.
    integrators
        Spellings of methods that are run in addition to the methods that an engine offers, and aliases, whose methods have
        their own time steps.
    timesteps
        Time steps (s) that replace the two time steps of an engine; none if it is empty.

    Raises
    ------
    BadInput
        If no engine has a method, a time step is not possible, or there is nothing to run.
    """
    refuse_timesteps(integrators, timesteps)
    check(cases, engines, integrators, timesteps)
    tasks: dict[Task, None] = {}
    for case in cases:
        for name, engine in engines.items():
            usual = default_method(engine, case)
            step = DEFAULT_TIMESTEP if usual is None else usual.timestep
            spellings = (*with_contact(engine, case), *spelled(integrators))
            methods = [
                *([usual] if usual is not None else []),
                *methods_of(engine, case, aliases(integrators)),
                *(method for one in spellings for method in _over(engine, case, one, timesteps, step)),
            ]
            tasks |= dict.fromkeys(Task(case, name, method) for method in methods)
    refuse_nothing(tuple(tasks), engines, integrators)
    return tuple(tasks)


def _over(engine: Engine, case: Case, spelling: str, timesteps: Sequence[float], step: float) -> Iterator[Method]:
    """Yield a method at the named time steps (s); if there are none, at a step (s) and its refinements.

    A method with error control has its default largest step instead of a step and its refinements.
    """
    method = Method.parse(spelling, 0.0)
    largest = () if method.accuracy is None else (default_timestep(engine, case, method),)
    yield from map(method.at, timesteps or largest or [step * part for part in REFINEMENTS])


def evaluate(results: Results, engines: Mapping[str, Engine], verdicts: Sequence[Verdict]) -> list[ContactRow]:
    """Return the rows of every case and engine: the figures at the defaults, then the best value of each figure.

    results, verdicts: the results of the tasks of `plan`, and the verdicts on them.
    """
    by_engine: dict[tuple[str, str], list[Verdict]] = defaultdict(list)
    for verdict in verdicts:
        by_engine[verdict.run.case, verdict.run.engine].append(verdict)
    truths = lru_cache(TRUTHS_KEPT)(results.truth)
    return [
        row
        for (name, engine), of_case in by_engine.items()
        for row in rows_of(results.cases[name], engines[engine], of_case, truths)
    ]


def measurements(verdicts: Sequence[Verdict]) -> list[dict[str, Any]]:
    """Return a row of results for each run. A completed run without any figure of the sheet is no measurement."""
    none = {"status": "not-measured", "reason": "the run has no figure of the sheet"}
    return [one.row() | (none if isinstance(one.outcome, Completed) and not figures_of(one) else {}) for one in verdicts]


def rows_of(case: Case, engine: Engine, verdicts: Sequence[Verdict], truths: Truths) -> list[ContactRow]:
    """Return the rows of one case and engine from the verdicts on the runs of all methods."""
    default = default_method(engine, case)
    usual = [verdict for verdict in verdicts if default is not None and verdict.run.method == default]
    rows = [row for verdict in usual for row in _told(case, verdict, "defaults", figures_of(verdict), truths)]
    best: dict[str, tuple[float, Verdict]] = {}
    for verdict in verdicts:
        for figure, value in figures_of(verdict).items():
            if figure not in best or value < best[figure][0]:
                best[figure] = value, verdict
    for figure in (name for name in SUBJECTS if name in best):
        rows += _told(case, best[figure][1], "best", (figure,), truths)
    return rows


def figures_of(verdict: Verdict) -> dict[str, float]:
    """Return the values of the sheet's figures in a run, in the order of the sheet; empty if the run did not complete."""
    if verdict.discrepancy is None:
        return {}
    values = verdict.discrepancy.maxima()
    return {name: values[name] for name in SUBJECTS if name in values}


def _told(
    case: Case, verdict: Verdict, setting: Setting, figures: Mapping[str, float] | Sequence[str], truths: Truths
) -> list[ContactRow]:
    """Return the rows of one run: one for each figure, or a row without a figure if it did not complete."""
    run = verdict.run
    head = (run.engine, run.version, run.method.name, run.method.timestep, case.name, setting)
    if not isinstance(verdict.outcome, Completed) or verdict.discrepancy is None:
        return [ContactRow(*head, "", None, "", None, None, verdict.outcome.status)]
    truth, values = truths(case.name, run.method.sampling), verdict.discrepancy.maxima()
    rows = []
    for figure in figures:
        known = SUBJECTS[figure](case, truth) if isinstance(truth, Truth) else None
        bound = truth_error(figure, known, values)
        exact = None if known is None else known[0]
        rows.append(ContactRow(*head, figure, values[figure], unit_of(figure), exact, bound, verdict.outcome.status))
    return rows


def reasons(results: Results, engines: Mapping[str, Engine]) -> dict[tuple[str, str], str]:
    """Return the reasons why default methods did not complete a case, by the names of engine and case."""
    why = {}
    for run in results.runs():
        default = default_method(engines[run.engine], results.cases[run.case])
        if run.method == default and run.outcome.reason:
            why[run.engine, run.case] = run.outcome.reason
    return why
