"""Plan runs of contact scenes with the methods of engines, search for the best settings, and make rows of all runs.

The runs of the plan, at the defaults and with recommended methods, are made first and kept with their trajectories. The search
and the probes then record figures alone.
"""

import math
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import lru_cache
from typing import Any, get_args

from bodycheck.adapters.contract import Engine, Method, Role, kind_of
from bodycheck.adapters.method import DEFAULT_TIMESTEP
from bodycheck.adapters.offers import not_offered, offered
from bodycheck.adapters.roles import aliases, spelled
from bodycheck.casefile.content import Case
from bodycheck.judging.judgement import Verdict
from bodycheck.judging.schemes.run_classes import TRUTHS_KEPT
from bodycheck.reference.truths import NoTruth, Truth
from bodycheck.results import resumption
from bodycheck.results.key import RunKey
from bodycheck.results.outcome import Completed
from bodycheck.results.store import Results
from bodycheck.running import engines as places
from bodycheck.running.instants import default_timestep
from bodycheck.running.plan import Task, check, refuse_nothing
from bodycheck.running.roles import method_in_role, methods_of, refuse_timesteps
from bodycheck.studies.contact.calls import ProbeCall, group, make
from bodycheck.studies.contact.measuring import Bench, Measured, Workers, is_lost, of_sheet
from bodycheck.studies.contact.probes import BY_NAME, PROBES
from bodycheck.studies.contact.rows import RECORDS, ContactRow, PropertyRow, Setting, SettingRow, Sheet
from bodycheck.studies.contact.search import Best, Errors, promising, search
from bodycheck.studies.contact.sheet import SUBJECTS, Group, group_of, searched, truth_error, unit_of

#: Time limit (s) of one run of the search and of one probe. Most take less than a second.
TIME_LIMIT_S = 20.0

#: The most steps of a run with the best method; in longer scenes, it has the first time step of its engine.
MOST_STEPS = 50_000

#: The roles of the settings that an engine's record names.
ROLES: Mapping[Setting, Role] = {"defaults": "default", "recommended": "recommended"}

#: A function from the name of a case and a time step (s) to the truth, or to the reason why there is none.
Truths = Callable[[str, float], Truth | NoTruth]

#: The method of each setting of an engine.
Settings = Mapping[Setting, Method]


def with_contact(engine: Engine, case: Case) -> list[str]:
    """Return the spellings of an engine's methods for a case, except those with the option `model`, which replaces contacts."""
    return [name for name in offered(engine, case.scene) if Method.parse(name, 0.0).option("model") is None]


def usual_methods(engine: Engine, case: Case) -> dict[Setting, Method]:
    """Return the default and the recommended method of an engine for a case, as far as its record names them."""
    methods = ((setting, method_in_role(engine, case, role)) for setting, role in ROLES.items())
    return {setting: method for setting, method in methods if method is not None}


def starts(engine: Engine, case: Case, integrators: Sequence[str], timesteps: Sequence[float]) -> tuple[Method, ...]:
    """Return the methods of an engine at which the search begins, each once, the default method first.

    They are the default and the recommended method, the first method that the engine offers if it has neither, and the named
    ones. Named time steps (s) are in addition to those of the engine.
    """
    first = [*usual_methods(engine, case).values()] or [
        Method.parse(spelling, DEFAULT_TIMESTEP) for spelling in with_contact(engine, case)[:1]
    ]
    named = [*methods_of(engine, case, aliases(integrators))]
    for spelling in spelled(integrators):
        method = Method.parse(spelling, 0.0)
        if not_offered(engine, case.scene, method) is None:
            steps = timesteps or (first[0].timestep if method.accuracy is None else default_timestep(engine, case, method),)
            named += [method.at(step) for step in steps]
    if timesteps and not integrators:
        named += [first[0].at(step) for step in timesteps]
    return tuple(dict.fromkeys((*first, *named)))


def plan(
    cases: Sequence[Case], engines: Mapping[str, Engine], integrators: Sequence[str], timesteps: Sequence[float]
) -> tuple[Task, ...]:
    """Return the tasks that are made before the search: the methods of `starts` in every case.

    Raises `BadInput` if no engine has a method, a time step is not possible, or there is nothing to run.
    """
    refuse_timesteps(integrators, timesteps)
    check(cases, engines, integrators, timesteps)
    tasks = tuple(
        Task(case, name, method)
        for case in cases
        for name, engine in engines.items()
        if with_contact(engine, case)
        for method in starts(engine, case, integrators, timesteps)
    )
    refuse_nothing(tasks, engines, integrators)
    return tasks


@contextmanager
def evaluated(
    results: Results,
    engines: Mapping[str, Engine],
    verdicts: Sequence[Verdict],
    named: tuple[Sequence[str], Sequence[float]],
    jobs: int,
    quiet: bool,
) -> Iterator[Sheet]:
    """Search for the best settings, make the probes, and provide the rows of all tables.

    The study counts as interrupted until the context ends.

    Parameters
    ----------
    results, verdicts
        The results of the tasks of `plan`, and the verdicts on them.
    engines
        The records of the engines by name.
    named
        The spellings of methods and the time steps (s) that the user named.
    jobs
        The number of processes.
    quiet
        Whether no progress is shown.
    """
    cases = tuple(results.cases.values())
    work = (cases, sorted(engines), named, tuple(BY_NAME))
    with resumption.opened(results.folder / RECORDS, results.header, *work, lost=is_lost, what="search") as log:
        bench = Bench(results, engines, log, _workers(jobs), quiet)
        bench.recall()
        for verdict in verdicts:
            bench.runs[_key(verdict)] = _measured(verdict)
        sheets = []
        for name, engine in engines.items():
            # The processes of an engine keep what it has compiled from one stage of the search to the next, and end with it.
            with _workers(jobs) as workers:
                sheets.append(_of_engine(replace(bench, workers=workers), name, engine, cases, named))
        by_case = {case.name: number for number, case in enumerate(cases)}
        figures = sorted((row for sheet in sheets for row in sheet.figures), key=lambda row: by_case[row.scene])
        settings, properties = (
            [row for sheet in sheets for row in getattr(sheet, part)] for part in ("settings", "properties")
        )
        yield Sheet(figures, settings, properties)


def _workers(jobs: int) -> Workers:
    """Return worker processes, up to `jobs` of the engine and as many of truths, which live from stage to stage."""
    return Workers(make, jobs, TIME_LIMIT_S, group=group, home=places.home, kept=jobs)


def _of_engine(
    bench: Bench, name: str, engine: Engine, cases: Sequence[Case], named: tuple[Sequence[str], Sequence[float]]
) -> Sheet:
    """Return the rows of one engine: a search for each group of scenes, and the probes."""
    figures: list[ContactRow] = []
    settings: list[SettingRow] = []
    groups: dict[Group, list[Case]] = defaultdict(list)
    methods: dict[Group, dict[Setting, Method]] = {}
    for case in cases:
        if with_contact(engine, case):
            groups[group_of(case)].append(case)
    for group_name in [one for one in get_args(Group) if one in groups]:
        of_group = groups[group_name]
        scenes = searched(of_group, group_name)
        best = _searched(bench, name, engine, scenes, starts(engine, scenes[0], *named))
        listed = methods[group_name] = {**usual_methods(engine, scenes[0]), "best": best.method}
        in_cases = {case: {**listed, "best": _within_steps(best, case)} for case in of_group}
        tasks = [Task(case, name, method) for case, in_case in in_cases.items() for method in in_case.values()]
        bench.measure(tasks)
        bench.compute_truths(task for task in tasks if bench.runs[task.key].figures)
        figures += [row for case, in_case in in_cases.items() for row in _figures(bench, case, name, engine, in_case)]
        settings += _settings(bench, name, engine, group_name, scenes, listed, best)
    return Sheet(figures, settings, list(_properties(bench, name, engine, methods)))


def _within_steps(best: Best, case: Case) -> Method:
    """Return the best method, with the first time step if it would take more than `MOST_STEPS` steps in a case."""
    return best.method if case.duration <= MOST_STEPS * best.method.timestep else best.method.at(best.start.timestep)


def _searched(bench: Bench, name: str, engine: Engine, scenes: Sequence[Case], begin: Sequence[Method]) -> Best:
    """Search for the best method of an engine in some scenes of one kind."""

    def errors(method: Method, cases: Sequence[Case]) -> dict[str, float]:
        return _errors(bench, name, method, [case for case in cases if method.timestep <= case.duration])

    def measure(methods: Sequence[Method]) -> dict[Method, Errors]:
        """Measure methods in the scenes, the shortest first, as long as they are promising; named ones in all scenes."""
        ordered, left = sorted(scenes, key=lambda case: case.duration), list(methods)
        for number, case in enumerate(ordered):
            bench.measure([Task(case, name, method) for method in left if method.timestep <= case.duration])
            done = ordered[: number + 1]
            first = errors(begin[0], done)
            left = [method for method in left if method in begin or promising(errors(method, done), first)]
        return {method: errors(method, ordered if method in left else ()) for method in methods}

    return search(engine, kind_of(scenes[0].scene), begin, measure)


def _errors(bench: Bench, name: str, method: Method, cases: Sequence[Case]) -> dict[str, float]:
    """Return the largest errors (m) of the position in the cases in which there is one."""
    figures = {case.name: bench.runs[Task(case, name, method).key].figures for case in cases}
    return {case: errors["position_error"] for case, errors in figures.items() if "position_error" in errors}


def _figures(bench: Bench, case: Case, name: str, engine: Engine, methods: Settings) -> Iterator[ContactRow]:
    """Yield the rows of a case: for each setting the figures, or a row without a figure if the run did not complete."""
    truths = lru_cache(TRUTHS_KEPT)(lambda sampling: bench.truth(case, sampling))
    for setting, method in methods.items():
        ran = bench.runs[Task(case, name, method).key]
        head = (name, engine.version, method.name, method.timestep, case.name, setting)
        if not ran.figures:
            yield ContactRow(*head, "", None, "", None, None, ran.status)
            continue
        truth = truths(method.sampling)
        for figure in (one for one in SUBJECTS if one in ran.figures):
            known = SUBJECTS[figure](case, truth) if isinstance(truth, Truth) else None
            bound = truth_error(figure, known, ran.figures)
            exact = None if known is None else known[0]
            yield ContactRow(*head, figure, ran.figures[figure], unit_of(figure), exact, bound, ran.status)


def _settings(
    bench: Bench, name: str, engine: Engine, group_name: Group, scenes: Sequence[Case], methods: Settings, best: Best
) -> Iterator[SettingRow]:
    for setting, method in methods.items():
        terms = (bench.runs[Task(case, name, method).key].contact_terms for case in scenes)
        value = best.scores.get(method, math.inf)
        error = value if math.isfinite(value) else None
        head = (name, engine.version, group_name, setting, method.name, method.timestep)
        yield SettingRow(*head, error, len(scenes), len(best.scores), min(filter(None, terms), key=len, default=""))


def _properties(bench: Bench, name: str, engine: Engine, by_group: Mapping[Group, Settings]) -> Iterator[PropertyRow]:
    """Yield the properties of the settings of an engine. Probes of a group without scenes use the settings of another group."""
    if not by_group:
        return
    methods = {group_name: by_group.get(group_name, next(iter(by_group.values()))) for group_name in PROBES}
    calls = {
        (setting, probe): ProbeCall(name, method, probe)
        for group_name, probes in PROBES.items()
        for setting, method in methods[group_name].items()
        for probe in probes
    }
    bench.probe(list(calls.values()))
    for (setting, _), call in calls.items():
        answer = bench.probes[call]
        head = (name, engine.version, setting, call.method.name, call.method.timestep)
        for one in () if isinstance(answer, str) else answer:
            yield PropertyRow(*head, one.name, one.condition, one.value, one.unit, one.expected, one.note)


def _key(verdict: Verdict) -> RunKey:
    return RunKey(verdict.run.case, verdict.run.engine, verdict.run.method)


def _measured(verdict: Verdict) -> Measured:
    """Return the figures of a run of the plan."""
    outcome = verdict.outcome
    if not isinstance(outcome, Completed) or verdict.discrepancy is None:
        return Measured(outcome.status, outcome.reason)
    return Measured(outcome.status, "", outcome.contact_terms, of_sheet(verdict.discrepancy.maxima()))


def measurements(verdicts: Sequence[Verdict]) -> list[dict[str, Any]]:
    """Return a row of results for each run. A completed run without any figure of the sheet is no measurement."""
    none = {"status": "not-measured", "reason": "the run has no figure of the sheet"}
    return [one.row() | (none if isinstance(one.outcome, Completed) and not _has_figures(one) else {}) for one in verdicts]


def _has_figures(verdict: Verdict) -> bool:
    return verdict.discrepancy is not None and any(name in SUBJECTS for name in verdict.discrepancy.maxima())


def reasons(results: Results, engines: Mapping[str, Engine]) -> dict[tuple[str, str], str]:
    """Return why the first methods of `starts` did not complete a case, by the names of engine and case."""
    why = {}
    for run in results.runs():
        first = starts(engines[run.engine], results.cases[run.case], (), ())[0]
        if run.method == first and run.outcome.reason:
            why[run.engine, run.case] = run.outcome.reason
    return why
