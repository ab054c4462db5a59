"""Search for the largest time step of every method that keeps an error on a case, and measure the cost of this time step.

Every run is made in a worker process of its engine and recorded when it ends, so that an interrupted search can be resumed.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path

from bodycheck.adapters.contract import Engine, Method
from bodycheck.adapters.offers import chosen, integrator_of
from bodycheck.casefile.content import Case
from bodycheck.errors import BadInput
from bodycheck.figures.columns import FIGURES, LIMITED, most_possible
from bodycheck.figures.revisions import REVISIONS
from bodycheck.judging import judgement
from bodycheck.processes import pool
from bodycheck.processes.failures import TimedOut
from bodycheck.reports.quantities import bound
from bodycheck.results import resumption
from bodycheck.results.header import Header
from bodycheck.results.journal import Journal, Record
from bodycheck.results.key import RunKey
from bodycheck.results.outcome import Completed, Diverged, Unsupported
from bodycheck.results.records import is_lost
from bodycheck.results.store import Results
from bodycheck.running import engines, plan
from bodycheck.running.campaign import Advance
from bodycheck.running.instants import default_timestep
from bodycheck.running.plan import Task
from bodycheck.running.tasks import group, perform
from bodycheck.studies.recommend import measuring
from bodycheck.studies.recommend.measuring import answer_of, priced
from bodycheck.studies.recommend.rows import RECORDS, Asked, Probe, Recommendation, key_of
from bodycheck.studies.recommend.search import LARGEST_ORDER, Range, following
from bodycheck.studies.timesteps import FINE_ACCURACIES, MOST_PERIODS, control_period, decimal, fastest_spin
from bodycheck.suggestion import did_you_mean

#: Short names of figures. The second figure is for scenes with friction or drag, in which the first figure does not exist.
SHORT_NAMES = {
    "attitude": ("attitude_error",),
    "position": ("position_error",),
    "energy": ("energy_drift", "energy_error"),
    "angular_momentum": ("angular_momentum_drift", "angular_momentum_error"),
}

#: The least and the largest number of steps of a run, which limit the range of time steps. The longest run takes seconds in
#: Python.
LEAST_STEPS, MOST_STEPS = 10, 100_000

#: Rotation of the body (rad) during the time step at which a search begins. Most methods fail near it.
FIRST_TURN = 1.0

#: The place of 1e-4, the accuracy at which a search begins, among `FINE_ACCURACIES`, from 1.
FIRST_ACCURACY = FINE_ACCURACIES.index(1e-4) + 1

#: If this many completed runs do not show the figure, the search ends. For example, a bounce is seen only if two samples lie on
#: its arc, which a large step may prevent.
MOST_UNSEEN = 4

#: Time limit (s) of one run, more than ten times the duration of `MOST_STEPS` steps in Python.
TIME_LIMIT_S = 60.0


@dataclass(frozen=True)
class Search:
    """The search for the time step of a method, with the version of its engine.

    `method` has the time step 0. With error control, the search is for the accuracy; the method has its largest step, and any
    accuracy.
    """

    engine: str
    version: str
    method: Method
    within: Range

    @property
    def key(self) -> RunKey:
        """The key of the engine and the method, over all cases, time steps and accuracies."""
        return key_of(self.engine, self.method)


@dataclass(frozen=True)
class Study:
    """The case, the figure that is limited, the limit in the figure's unit, and a search for each method."""

    case: Case
    figure: str
    error: float
    searches: tuple[Search, ...]

    @property
    def asked(self) -> Asked:
        """The question of the study."""
        return Asked(self.case.name, self.case.duration, self.figure, self.error, periods_of(self.case))


def periods_of(case: Case) -> int:
    """Return the number of periods of controllers in a case; 1 if there are none, or if steps should not divide them."""
    period = control_period(case.scene)
    number = 1 if period is None else decimal(case.duration) / period
    return int(number) if number == int(number) and number <= MOST_PERIODS else 1


def prepare(case: Case, records: Mapping[str, Engine], integrators: Sequence[str], quantity: str, error: float) -> Study:
    """Return a search for every method of some engines.

    Parameters
    ----------
    case
        The case.
    records
        The records of the engines by name.
    integrators
        Spellings of methods; all that the engines offer if it is empty.
    quantity
        A key of `SHORT_NAMES`, or the name of a figure.
    error
        The largest allowed error, in the unit of the figure.

    Raises
    ------
    BadInput
        If the error is not positive, not finite, at least 1 for a relative figure, or so large that every method keeps it; if
        the figure does not exist, if no engine has a method, or if there is nothing to run.
    """
    figure = figure_of(case, quantity)
    if not 0 < error < math.inf:
        raise BadInput(f"--error {error:g}: must be positive and finite")
    if FIGURES[figure].in_unit == "relative" and error >= 1:
        raise BadInput(f"--error {error:g}: must be less than 1, because this figure is relative")
    if error >= (most := most_possible(figure, case.duration)):
        least = f"{FIGURES[figure].title.lower()} is at most {most:.4g} {FIGURES[figure].unit}".rstrip()
        raise BadInput(f"--error {error:g}: every method keeps it, because the {least}; allowed: less")
    plan.check([case], records, integrators, ())
    turns = fastest_spin(case.scene) * case.duration / FIRST_TURN
    fewest, first, most = (
        max(1, math.ceil(steps / periods_of(case)))
        for steps in (LEAST_STEPS, max(LEAST_STEPS, min(MOST_STEPS, turns)), MOST_STEPS)
    )
    methods = [
        (name, record, Method.parse(spelling, 0.0))
        for name, record in records.items()
        for spelling in chosen(record, case.scene, integrators)
    ]
    plan.refuse_nothing(methods, records, integrators)
    searches = {}
    for name, record, method in methods:
        integrator = integrator_of(record, method)
        within = Range(error, integrator.order if integrator is not None else None, first, fewest, most)
        if method.accuracy is not None:
            within = Range(error, LARGEST_ORDER, FIRST_ACCURACY, 2, len(FINE_ACCURACIES) - 1, beyond=3)
            method = method.over_accuracies.at(default_timestep(record, case, method))
        searches[name, method] = Search(name, record.version, method, within)
    return Study(case, figure, error, tuple(searches.values()))


def figure_of(case: Case, quantity: str) -> str:
    """Return the name of the figure that a short name or a figure's name denotes on a case.

    Raises `BadInput` if there is no such figure.
    """
    if quantity in SHORT_NAMES:
        first, *rest = SHORT_NAMES[quantity]
        return rest[0] if rest and not case.scene.conserves else first
    allowed = [name for name in LIMITED if name in FIGURES]
    if quantity not in allowed:
        names = [*SHORT_NAMES, *allowed]
        meant = did_you_mean(quantity, names)
        raise BadInput(f"--quantity {quantity!r}: there is no such figure; allowed: {', '.join(names)}{meant}")
    return quantity


def reused(earlier: Results, study: Study) -> list[Probe]:
    """Return probes made of stored runs: those of the study's case and methods, with the same versions of the engines.

    Runs whose time step does not divide the duration of the case are left out, since they end at another instant, and runs with
    error control with another largest step. Raises
    `BadInput` if the stored runs are not of the present case file, or were made by another version of bodycheck.
    """
    versions = {search.key: search.version for search in study.searches}
    largest_steps = {search.key: search.method.timestep for search in study.searches}
    same_case = earlier.cases.get(study.case.name)
    if same_case is None or same_case.text != study.case.text:
        raise BadInput(f"--reuse {earlier.folder}: has no runs of the case {study.case.name} as its file is now")
    if earlier.header["bodycheck"] != (now := version("bodycheck")):
        raise BadInput(f"--reuse {earlier.folder}: is of bodycheck {earlier.header['bodycheck']}, and this is {now}")
    probes = []
    for verdict in judgement.judge(earlier):
        run = verdict.run
        largest = largest_steps.get(method := key_of(run.engine, run.method))
        if run.case != study.case.name or versions.get(method) != run.version or study.asked.number(run.method) is None:
            continue
        if run.method.accuracy is not None and run.method.timestep != largest:
            continue
        figures = verdict.discrepancy.maxima() if verdict.discrepancy is not None else {}
        if figures or isinstance(verdict.outcome, Diverged):
            run_names = (run.engine, run.version, run.method.name, run.method.timestep, verdict.outcome.status)
            probes.append(Probe(*run_names, *measuring.figures_of(figures, study.figure), verdict.outcome.reason))
    return probes


@contextmanager
def results(
    study: Study,
    folder: Path,
    head: Header,
    jobs: int,
    progress: Advance = lambda done, count=1: None,
    known: Sequence[Probe] = (),
) -> Iterator[Recommendation]:
    """Make the searches of a study, and provide their results.

    If the folder contains the same study and it was interrupted, its recorded runs are not repeated. The study counts as
    interrupted until the context ends.

    Parameters
    ----------
    study
        The study.
    folder
        The folder for the records.
    head
        The header of the records.
    jobs
        The largest number of engines that run at the same time.
    progress
        A function that is called with a text after each search.
    known
        Probes of time steps that were measured before.

    Raises
    ------
    BadInput
        If the truth of the case has an error at least as large as the limit.
    BadJournal
        If another process is writing to the folder.
    Failed
        If the case has no truth.
    """
    case = study.case
    asked, work = study.asked, (study, tuple(known))
    with resumption.opened(folder / RECORDS, head, *work, lost=_is_lost, asked=asdict(asked), revisions=REVISIONS) as log:
        probes = [*known, *(Probe(**record["probe"]) for record in log.records)]
        with pool.Workers(perform, jobs, TIME_LIMIT_S, group=group, home=engines.home, kept=1) as workers:
            by_method = _search(study, probes, log, workers, progress)
        answers = priced(
            case,
            [
                answer_of(search.engine, search.version, search.method, by_method[search.key], asked, search.within)
                for search in study.searches
            ],
        )
        ordered = [probe for of_method in by_method.values() for probe in sorted(of_method, key=asked.place)]
        yield Recommendation(asked, tuple(answers), tuple(ordered))


def _is_lost(record: Record) -> bool:
    return is_lost(record["probe"])


def _search(
    study: Study, known: Sequence[Probe], log: Journal, workers: measuring.Workers, progress: Advance
) -> dict[RunKey, list[Probe]]:
    """Measure time steps until every search is done, and return all measured ones of each method.

    In each round, every search that is not done has one run or those of all neighbours of its answer, and the truths of all
    these runs are computed together.
    """
    case, asked = study.case, study.asked
    by_method: dict[RunKey, list[Probe]] = {search.key: [] for search in study.searches}
    for probe in known:
        by_method[probe.method].append(probe)
    left = list(study.searches)
    while left:
        numbers = {search.key: _following(search, by_method[search.key], asked) for search in left}
        for search in left:
            if not numbers[search.key]:
                progress(f"{search.engine} {search.method.name} · {len(by_method[search.key])} runs")
        left = [search for search in left if numbers[search.key]]
        runs = [(search, number) for search in left for number in numbers[search.key]]
        tasks = [Task(case, search.engine, asked.numbered(search.method, number)) for search, number in runs]
        for probe in measuring.probes(case, tasks, [search.version for search, _ in runs], study.figure, workers):
            _check_truth(probe, study)
            log.add({"record": "probe", "probe": asdict(probe)})
            by_method[probe.method].append(probe)
    return by_method


def _following(search: Search, probes: Sequence[Probe], asked: Asked) -> tuple[int, ...]:
    """Return the numbers of steps to be measured next; none if the search is done."""
    # A method that is not supported at one step is not supported at any, and a run that takes too long takes longer with a
    # smaller step.
    ended = any(probe.status in (Unsupported.status, TimedOut.status) for probe in probes)
    completed = [probe for probe in probes if probe.status == Completed.status]
    unmeasured = len(completed) >= MOST_UNSEEN and all(probe.error is None for probe in completed)
    return () if ended or unmeasured else following(asked.errors(probes), search.within)


def _check_truth(probe: Probe, study: Study) -> None:
    if probe.truth_error is not None and probe.truth_error >= study.error:
        raise BadInput(
            f"--error {study.error:g}: the truth of {study.case.name} has an error of up to {bound(probe.truth_error)} "
            f"{FIGURES[study.figure].unit} itself; ask for a larger one"
        )
