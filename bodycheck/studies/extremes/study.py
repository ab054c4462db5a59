"""Where methods stop being right, and where they stop being methods: cases pushed along their axes until they break.

Every run is made in a process of its own and journalled as it is done, so that a study that was killed is gone on with.
"""

import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import asdict, dataclass, fields, replace
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

import numpy as np

from bodycheck.adapters.contract import Adapter, Method
from bodycheck.adapters.method import DEFAULT_TIMESTEP
from bodycheck.adapters.offers import chosen
from bodycheck.casefile.case import Case
from bodycheck.errors import BadInput
from bodycheck.reference.errors import NotModelled, OutOfReach
from bodycheck.reference.observables import observe
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truth import Backend, NoTruth, Truth, distance, truth
from bodycheck.running import csv_tables, journal, plan, pool
from bodycheck.running.header import Header
from bodycheck.running.key import RunKey
from bodycheck.running.outcome import Completed, Crashed, Outcome, TimedOut
from bodycheck.running.simulation import run
from bodycheck.studies.extremes.diagnosis import Diagnosis, diagnose, states
from bodycheck.studies.extremes.growth import growth
from bodycheck.studies.extremes.points import Point, points
from bodycheck.studies.extremes.rows import NOTHING, Limit, Row
from bodycheck.studies.extremes.stability import bracket, stable, turning
from bodycheck.studies.extremes.symptoms import energy_change

if TYPE_CHECKING:  # the processes of the runs import this module, and need no tables
    from bodycheck.running.campaign import Advance

#: Seconds that one run may take: some three times what a million steps in Python do.
TIME_LIMIT = 60.0

RECORDS = "extremes.jsonl"


#: Which run, along which axis, at which value.
TrialKey = tuple[RunKey, str, float]

#: Which method on which case, with any time step, at which spin (rad/s).
SearchKey = tuple[RunKey, float]


@dataclass(frozen=True)
class Trial:
    """A run at a point of an axis."""

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
    """A run of a search. product: of spin and step (rad)."""

    search: Search
    product: float


@dataclass(frozen=True)
class Study:
    """What is to be done."""

    trials: tuple[Trial, ...]
    searches: tuple[Search, ...]

    @property
    def size(self) -> int:
        return len(self.trials) + len(self.searches)


def prepare(cases: Sequence[Case], engines: Mapping[str, Adapter], integrators: Sequence[str]) -> Study:
    """Every method of every engine at every point of the cases' axes; limits of stability at every spin of an axis.

    Raises `BadInput` for a case that has no axes, for an integrator that no engine has, and where there is nothing to do.
    """
    if axisless := [case.name for case in cases if not case.extremes]:
        raise BadInput(f"{', '.join(axisless)}: no axes to push along; a case has them in its table [extremes]")
    plan.check(cases, engines, integrators, (DEFAULT_TIMESTEP,))
    trials = tuple(
        Trial(point, engine, Method.parse(integrator, point.timestep))
        for case in cases
        for point in points(case)
        for engine, adapter in engines.items()
        for integrator in chosen(adapter.engine, point.case.scene, integrators)
    )
    searches = tuple(
        Search(case, engine, Method.parse(integrator, 0.0), spin)
        for case in cases
        if case.scene.plane is None
        for spin in dict(case.extremes).get("spin", ())
        for engine, adapter in engines.items()
        for integrator in chosen(adapter.engine, case.scene, integrators)
    )
    plan.refuse_nothing(trials, engines, integrators)
    return Study(trials, searches)


@contextmanager
def results(
    study: Study, folder: Path, head: Header, jobs: int, progress: "Advance", limit: float = TIME_LIMIT
) -> Iterator[tuple[list[Row], list[Limit]]]:
    """Do what is to be done in `jobs` processes, journalled in the folder, and give the rows in the order of the study.

    What an interrupted study of the same has in that folder is not done again. The study counts as interrupted until the
    context ends. limit: seconds that one run may take. Raises `BadJournal` for a folder in which another process is at it.
    """
    with journal.resume(folder / RECORDS, {**head, "identity": _identity(study, head, limit)}) as log:
        if log.records:
            print(f"bodycheck: going on with the interrupted study in {folder}", file=sys.stderr)
        versions = head["engines"]
        rows = _rows(study, log, versions, jobs, limit, progress)
        limits = _limits(study, log, versions, jobs, limit, progress)
        yield rows, limits


def follow(scene: Scene, times: Array) -> Truth | NoTruth:
    """The truth of a scene however far it goes, or why there is none.

    In flight it is the closed form, whose cost is the same near and far, without the witnesses that would have to be integrated
    over every one of a million turns: the bound of its error is its own.
    """
    try:
        return truth(scene, times, ALONE)
    except NotModelled as error:
        return NoTruth(f"the reference does not model {error}")
    except (OutOfReach, ValueError, OverflowError) as error:  # the last two where a closed form runs out of numbers
        return NoTruth(f"the reference cannot follow: {error}")


def write(rows: Iterable[Row], limits: Iterable[Limit], folder: Path) -> None:
    """Write extremes.csv and limits.csv into a folder."""
    csv_tables.write(folder / "extremes.csv", [field.name for field in fields(Row)], map(asdict, rows))
    csv_tables.write(folder / "limits.csv", [field.name for field in fields(Limit)], map(asdict, limits))


def _no_witness(scene: Scene, times: Array) -> NoReturn:
    raise OutOfReach("witnesses are not asked")


ALONE = Backend("none", _no_witness, _no_witness)


def _rows(
    study: Study, log: journal.Journal, versions: Mapping[str, str], jobs: int, limit: float, progress: "Advance"
) -> list[Row]:
    there = [Row(**record["row"]) for record in log.records if record["record"] == "run"]
    rows = {(RunKey.of_row(asdict(row)), row.axis, row.value): row for row in there}
    if rows:
        progress("", len(rows))
    left = [trial for trial in study.trials if trial.key not in rows]
    with closing(pool.call_all(_try, left, jobs, limit)) as answers:
        for trial, answer in answers:
            row = _row(trial, versions[trial.engine], answer)
            log.add({"record": "run", "row": asdict(row)})
            rows[trial.key] = row
            progress(f"{row.case} · {row.engine} {row.integrator} · {row.axis} {row.value:.10g}")
    return [rows[trial.key] for trial in study.trials]


def _limits(
    study: Study, log: journal.Journal, versions: Mapping[str, str], jobs: int, limit: float, progress: "Advance"
) -> list[Limit]:
    """The searches go on together, so that each of their runs has a process of its own."""
    probes: dict[SearchKey, dict[float, bool]] = {search.key: {} for search in study.searches}
    for record in log.records:
        if record["record"] == "probe":
            case, engine, integrator, spin = record["search"]
            probes[RunKey(case, engine, Method.parse(integrator, 0.0)), spin][record["product"]] = record["stable"]
    brackets = {search: bracket(probes[search.key]) for search in study.searches}
    while left := [Probe(search, product) for search, known in brackets.items() for product in known.following]:
        with closing(pool.call_all(_probe, left, jobs, limit)) as answers:
            for probe, answer in answers:
                # A run that kills its process, or that does not come to an end, is not stable either.
                held = probes[probe.search.key][probe.product] = answer is True
                search = probe.search
                names = (search.case.name, search.engine, search.method.name, search.spin)
                log.add({"record": "probe", "search": names, "product": probe.product, "stable": held})
        for search in {probe.search for probe in left}:
            brackets[search] = bracket(probes[search.key])
            if not brackets[search].following:
                progress(f"{search.case.name} · {search.engine} {search.method.name} · stability at {search.spin:g} rad/s")
    return [_limit(search, versions[search.engine], known.stable, known.unstable) for search, known in brackets.items()]


def _try(trial: Trial) -> tuple[Outcome, Truth | NoTruth]:
    point = trial.point
    outcome = run(point.case, trial.engine, trial.method).outcome
    if not isinstance(outcome, Completed):
        return outcome, NoTruth("the run did not end")
    return outcome, follow(point.case.scene, outcome.trajectory.t)


def _probe(probe: Probe) -> bool:
    search = probe.search
    case = turning(search.case, search.spin)
    outcome = run(case, search.engine, search.method.at(probe.product / search.spin)).outcome
    return stable(case.scene, outcome)


def _row(trial: Trial, version: str, answer: tuple[Outcome, Truth | NoTruth] | Crashed | TimedOut) -> Row:
    point = trial.point
    scene = point.case.scene
    if isinstance(answer, Crashed | TimedOut):
        found = Diagnosis(answer.status, NOTHING, answer.reason)
    else:
        found = diagnose(scene, *answer)
        if point.axis == "steps":
            found = replace(found, detail="; ".join([found.detail, *_drifts(scene, answer[0])]))
    method = (trial.engine, version, trial.method.name, point.timestep)
    return Row(point.case.name, *method, point.axis, point.value, found.status, found.engine_said, found.detail)


def _drifts(scene: Scene, outcome: Outcome) -> list[str]:
    """How what a flight conserves drifts with the steps, in words."""
    trajectory = states(outcome)
    if trajectory is None or not scene.conserves:
        return []
    with np.errstate(all="ignore"):
        momentum = observe(scene, trajectory).angular_momentum
        size = float(np.linalg.norm(momentum[0])) or 1.0
        return [
            f"drift of the energy of rotation {growth(np.abs(energy_change(scene, trajectory)))}",
            f"of the angular momentum {growth(distance(momentum, momentum[:1]) / size)}",
        ]


def _limit(search: Search, version: str, largest: float | None, smallest: float | None) -> Limit:
    def timestep(product: float | None) -> float | None:
        return None if product is None else product / search.spin

    method = (search.engine, version, search.method.name)
    return Limit(search.case.name, *method, search.spin, timestep(largest), largest, timestep(smallest))


def _identity(study: Study, head: Header, limit: float) -> str:
    """A fingerprint of all that decides on the results, wherever and by whatever command they are made."""
    versions = [head["bodycheck"], head["packages"], head["engines"]]
    return sha256(repr((versions, limit, study)).encode("utf-8")).hexdigest()
