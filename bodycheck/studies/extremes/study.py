"""Run cases at increasingly extreme values along their axes, to find where methods become wrong or fail.

Every run is made in a separate process and recorded when it ends, so that an interrupted study can be resumed.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from bodycheck.adapters.contract import Engine, Method
from bodycheck.adapters.method import DEFAULT_TIMESTEP
from bodycheck.adapters.offers import chosen
from bodycheck.casefile.axes import AXES, default_axes
from bodycheck.casefile.content import Case
from bodycheck.processes import pool
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.reference.errors import NotModelled, OutOfReach
from bodycheck.reference.mechanisms.mechanism import AnyScene, alone
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truth import truth
from bodycheck.reference.truths import NoTruth, Truth
from bodycheck.results import resumption
from bodycheck.results.header import Header
from bodycheck.results.journal import Journal
from bodycheck.results.key import RunKey
from bodycheck.results.outcome import Completed, Outcome, Run
from bodycheck.results.records import is_lost
from bodycheck.running import plan
from bodycheck.running.engines import home
from bodycheck.running.simulation import run
from bodycheck.studies.extremes.diagnosis import Diagnosis, diagnose, drifts
from bodycheck.studies.extremes.rows import NOTHING, RECORDS, Limit, Row
from bodycheck.studies.extremes.stability import bracket, stable, turning

if TYPE_CHECKING:  # the processes of the runs import this module, and need no tables
    from bodycheck.running.campaign import Advance

#: Time limit (s) of one run, about three times the duration of a million steps in Python.
TIME_LIMIT_S = 60.0

#: The key of a trial: the run, the axis and the value.
TrialKey = tuple[RunKey, str, float]

#: The key of a search: the case and the method over all time steps, and the spin (rad/s).
SearchKey = tuple[RunKey, float]

#: A function that returns the truth of a scene at times (s), or why there is none.
TruthOf = Callable[[tuple[AnyScene, Array]], Truth | NoTruth | Crashed | TimedOut]


@dataclass(frozen=True)
class Point:
    """A case that is changed to a value on one of its axes, and the time step (s) with which it is run.

    The time step is None where each method has its default time step, or that of an alias.
    """

    case: Case
    axis: str
    value: float
    timestep: float | None


@dataclass(frozen=True)
class Trial:
    """A run of a method at a point of an axis."""

    point: Point
    engine: str
    method: Method

    @property
    def key(self) -> TrialKey:
        return RunKey(self.point.case.name, self.engine, self.method), self.point.axis, self.point.value


@dataclass(frozen=True)
class Search:
    """A search for the largest stable step of a method at a spin (rad/s)."""

    case: Case
    engine: str
    method: Method
    spin: float

    @property
    def key(self) -> SearchKey:
        return RunKey(self.case.name, self.engine, self.method), self.spin


@dataclass(frozen=True)
class Probe:
    """A run of a search for the largest stable step. `product` is spin times time step (rad)."""

    search: Search
    product: float


@dataclass(frozen=True)
class Study:
    """The trials and the searches of a study."""

    trials: tuple[Trial, ...]
    searches: tuple[Search, ...]

    @property
    def size(self) -> int:
        return len(self.trials) + len(self.searches)

    @property
    def methods(self) -> tuple[tuple[str, Method], ...]:
        """The name of the engine and the method of each trial."""
        return tuple((trial.engine, trial.method) for trial in self.trials)


def points(case: Case) -> Iterator[Point]:
    """Yield a point for every value of every axis of a case, changing one axis of the given case at a time.

    If the case has both spins and time steps, every spin is combined with every time step. The axis `steps` counts
    steps of 2 ms.
    """
    values = dict(case.extremes)
    timesteps = values.pop("timestep", ())
    for name, tried in values.items():
        for value in tried:
            for timestep in (name == "spin" and timesteps) or (DEFAULT_TIMESTEP if name == "steps" else None,):
                yield Point(AXES[name].varied(case, value), name, value, timestep)
    if "spin" not in values:
        yield from (Point(case, "timestep", timestep, timestep) for timestep in timesteps)


def with_axes(case: Case) -> Case:
    """Return a case with the axes of a case without a table [extremes], unless it has one."""
    return case if case.extremes else replace(case, extremes=default_axes(case))


def prepare(cases: Sequence[Case], engines: Mapping[str, Engine], integrators: Sequence[str]) -> Study:
    """Return the trials at every point of the cases' axes, and the searches for stability limits at every spin of an axis.

    Parameters
    ----------
    cases
        The cases; those without axes get default ones.
    engines
        The records of the engines by name.
    integrators
        Spellings of methods, and aliases; all that the engines offer if it is empty.

    Raises
    ------
    BadInput
        If no engine has an integrator, or if there is nothing to run.
    """
    cases = tuple(map(with_axes, cases))
    plan.check(cases, engines, integrators, (DEFAULT_TIMESTEP,))
    trials = tuple(
        Trial(point, name, method)
        for case in cases
        for point in points(case)
        for name, engine in engines.items()
        for method in dict.fromkeys(_methods(point, engine, integrators))
    )
    searches = tuple(
        Search(case, name, Method.parse(integrator, 0.0), spin)
        for case in cases
        if isinstance(case.scene, Scene) and case.scene.plane is None
        for spin in dict(case.extremes).get("spin", ())
        for name, engine in engines.items()
        for integrator in chosen(engine, case.scene, integrators)
        if Method.parse(integrator, 0.0).accuracy is None  # with error control, the engine chooses stable steps
    )
    plan.refuse_nothing(trials, engines, integrators)
    return Study(trials, searches)


def _methods(point: Point, engine: Engine, integrators: Sequence[str]) -> Iterator[Method]:
    if point.timestep is None:
        yield from plan.methods_in(point.case, engine, integrators, ())
        return
    for integrator in chosen(engine, point.case.scene, integrators):
        yield Method.parse(integrator, point.timestep)


def suits(case: Case) -> bool:
    """Return whether a case has axes, that is, a table [extremes]."""
    return bool(case.extremes)


@contextmanager
def results(
    study: Study, folder: Path, head: Header, jobs: int, progress: "Advance", limit: float = TIME_LIMIT_S
) -> Iterator[tuple[list[Row], list[Limit]]]:
    """Make the runs of a study, and provide its rows and limits in the order of the study.

    If the folder contains the same study and it was interrupted, its recorded runs are not repeated. The study counts as
    interrupted until the context ends.

    Parameters
    ----------
    study
        The trials and searches.
    folder
        The folder for the records.
    head
        The header of the records.
    jobs
        The number of processes.
    progress
        A function that is called with a text after each trial and search.
    limit
        The time limit of one run (s).

    Raises
    ------
    BadJournal
        If another process is writing to the folder.
    """
    with resumption.opened(folder / RECORDS, head, limit, study, lost=lambda record: is_lost(record.get("row", {}))) as log:
        versions = head["engines"]
        rows = _rows(study, log, versions, jobs, limit, progress)
        limits = _limits(study, log, versions, jobs, limit, progress)
        yield rows, limits


def follow(scene: AnyScene, times: Array) -> Truth | NoTruth:
    """Return the truth of a scene even for long times, or the reason why there is none.

    In flight, the truth is the closed form with its own error bound. Its cost does not depend on the times. It is not checked
    by integration, because an integration would have to follow up to a million turns.
    """
    try:
        return truth(scene, times, vouched=False)
    except NotModelled as error:
        return NoTruth(f"the reference does not model {error}")
    except (OutOfReach, ValueError, OverflowError) as error:  # the latter two are raised if a closed form overflows
        return NoTruth(f"the reference cannot follow: {error}")


def _rows(study: Study, log: Journal, versions: Mapping[str, str], jobs: int, limit: float, progress: "Advance") -> list[Row]:
    recorded = [Row(**record["row"]) for record in log.records if record["record"] == "run"]
    rows = {(RunKey.of_row(asdict(row)), row.axis, row.value): row for row in recorded}
    if rows:
        progress("", len(rows))
    left = [trial for trial in study.trials if trial.key not in rows]
    flying = pool.Workers(_try, jobs, limit, group=lambda trial: trial.engine, home=home)
    with flying, pool.Workers(_follow, 1, limit, kept=1) as following:
        for trial, answer in flying.map(left):
            row = _row(trial, versions[trial.engine], answer, following.call)
            log.add({"record": "run", "row": asdict(row)})
            rows[trial.key] = row
            progress(f"{row.case} · {row.engine} {row.integrator} · {row.axis} {row.value:.10g}")
    return [rows[trial.key] for trial in study.trials]


def _limits(
    study: Study, log: Journal, versions: Mapping[str, str], jobs: int, limit: float, progress: "Advance"
) -> list[Limit]:
    """Make the searches in parallel, with a separate process for each of their runs, and return the limits they find."""
    probes: dict[SearchKey, dict[float, bool]] = {search.key: {} for search in study.searches}
    for record in log.records:
        if record["record"] == "probe":
            case, engine, integrator, spin = record["search"]
            probes[RunKey(case, engine, Method.parse(integrator, 0.0)), spin][record["product"]] = record["stable"]
    brackets = {search: bracket(probes[search.key]) for search in study.searches}
    while left := [Probe(search, product) for search, known in brackets.items() for product in known.following]:
        with pool.Workers(_probe, jobs, limit, group=lambda probe: probe.search.engine, home=home) as workers:
            for probe, answer in workers.map(left):
                # A run that crashes its process or exceeds the time limit counts as unstable.
                is_stable = probes[probe.search.key][probe.product] = answer is True
                search = probe.search
                names = (search.case.name, search.engine, search.method.name, search.spin)
                if isinstance(answer, bool):
                    log.add({"record": "probe", "search": names, "product": probe.product, "stable": is_stable})
        for search in {probe.search for probe in left}:
            brackets[search] = bracket(probes[search.key])
            if not brackets[search].following:
                progress(f"{search.case.name} · {search.engine} {search.method.name} · stability at {search.spin:g} rad/s")
    return [_limit(search, versions[search.engine], known.stable, known.unstable) for search, known in brackets.items()]


def _try(trial: Trial) -> Run:
    return run(trial.point.case, trial.engine, trial.method)


def _follow(asked: tuple[AnyScene, Array]) -> Truth | NoTruth:
    return follow(*asked)


def _probe(probe: Probe) -> bool:
    search = probe.search
    case = turning(search.case, search.spin)
    outcome = run(case, search.engine, search.method.at(probe.product / search.spin)).outcome
    return stable(alone(case.scene), outcome)


def _row(trial: Trial, version: str, answer: Run | Crashed | TimedOut, truth_of: TruthOf) -> Row:
    point = trial.point
    scene = point.case.scene
    if isinstance(answer, Run):
        diagnosis = diagnose(scene, answer.outcome, _truth_of(scene, answer.outcome, truth_of))
        if point.axis == "steps":
            diagnosis = replace(diagnosis, detail="; ".join([diagnosis.detail, *drifts(scene, answer.outcome)]))
    else:
        diagnosis = Diagnosis(answer.status, NOTHING, answer.reason)
    method = (trial.engine, version, trial.method.name, trial.method.timestep)
    return Row(point.case.name, *method, point.axis, point.value, diagnosis.status, diagnosis.engine_said, diagnosis.detail)


def _truth_of(scene: AnyScene, outcome: Outcome, truth_of: TruthOf) -> Truth | NoTruth:
    """Return the truth of a scene at the instants of a run, or the reason why there is none."""
    if not isinstance(outcome, Completed):
        return NoTruth("the run did not end")
    truth = truth_of((scene, outcome.trajectory.t))
    return NoTruth(f"the reference: {truth.reason}") if isinstance(truth, Crashed | TimedOut) else truth


def _limit(search: Search, version: str, largest: float | None, smallest: float | None) -> Limit:
    def timestep(product: float | None) -> float | None:
        return None if product is None else product / search.spin

    method = (search.engine, version, search.method.name)
    return Limit(search.case.name, *method, search.spin, timestep(largest), largest, timestep(smallest))
