"""Run the scene of a file, or of a case, with several time steps in engines, and estimate the errors of the runs."""

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from pathlib import Path

import numpy as np

from bodycheck.adapters.contract import Engine, Method
from bodycheck.adapters.engine_name import in_words
from bodycheck.adapters.file_motion import Controls, FileFacts, FileRun
from bodycheck.adapters.offers import chosen, integrator_of
from bodycheck.adapters.robot_reading import RobotFile
from bodycheck.casefile.content import Case
from bodycheck.errors import BadInput
from bodycheck.figures.columns import FIGURES
from bodycheck.figures.definition import Comparison
from bodycheck.processes import pool
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truths import Truth
from bodycheck.results import resumption
from bodycheck.results.header import Header
from bodycheck.results.records import typed
from bodycheck.robots.elements import printable
from bodycheck.running import engines as engine_homes
from bodycheck.running import refining
from bodycheck.running.campaign import Advance
from bodycheck.running.instants import default_timestep
from bodycheck.running.refining import AskFile, Call, Ended, Motion, RunCase, RunFile
from bodycheck.running.tasks import Question, answer
from bodycheck.studies.estimate import factors, rating, showing, solver
from bodycheck.studies.estimate.clock import Clock
from bodycheck.studies.estimate.limits import Limit, Spread, between, causes_of, limit_of
from bodycheck.studies.estimate.method import NoTime, Refined, Subject, refined, searched
from bodycheck.studies.estimate.quantities import ANGLES, AT_END, NAMED, PLACES, SHORT, USUAL
from bodycheck.studies.estimate.rating import Head
from bodycheck.studies.estimate.rows import (
    NO_TIME,
    RECORDS,
    UNSUPPORTED,
    About,
    EstimateRow,
    Estimates,
    OfEngine,
    Solver,
    joined,
)
from bodycheck.studies.estimate.spellings import UnknownMethod, check
from bodycheck.studies.timesteps import control_period
from bodycheck.suggestion import did_you_mean

#: The processor time (s) for all runs of a file in one engine, and that for its start before them: some engines compile code
#: then.
TIME_BUDGET_S, START_S = 30.0, 120.0

#: The duration (s) of the runs of a file, and the number of instants at which errors are compared.
DURATION_S, SAMPLES = 1.0, 101


@dataclass(frozen=True, eq=False)
class Asked:
    """The question of a study.

    Attributes
    ----------
    name
        The name of the file or of the case.
    duration
        The duration of the runs (s).
    error
        The error that is allowed.
    quantities
        The quantities of the rows.
    compared
        The quantities that are compared with the error.
    integrators
        The spellings of the methods; all that an engine offers if it is empty.
    case
        The case; None for a file.
    file
        The copy of the file that engines read; None for a case.
    keyframe, controls
        The keyframe in which the runs of a file start, and their controls.
    samples
        The number of instants.
    blind
        Whether the truth of a case is not used.
    identity
        A digest of the contents of the files.
    path, packages
        The path of the file itself, and the folders in which its packages may be found; None for a case.
    lines
        The file and the line of the element that starts at a line of the copy.
    """

    name: str
    duration: float
    error: float
    quantities: tuple[str, ...]
    compared: tuple[str, ...]
    integrators: tuple[str, ...] = ()
    case: Case | None = None
    file: RobotFile | None = None
    keyframe: str = ""
    controls: Controls | None = None
    samples: int = SAMPLES
    blind: bool = True
    identity: str = ""
    path: Path | None = None
    packages: tuple[Path, ...] = ()
    lines: Mapping[int, str] = field(default_factory=dict)

    @property
    def instants(self) -> Array:
        """The instants (samples,), s, at which errors are compared."""
        return np.linspace(0.0, self.duration, self.samples)


def quantities_of(quantity: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the quantities of rows for the option `--quantity`, and those that are compared with the allowed error.

    Raises `BadInput` for a quantity that is not estimated.
    """
    if not quantity:
        return tuple(name + end for name in USUAL for end in ("", AT_END)), PLACES
    name = SHORT.get(quantity, quantity)
    if name.removesuffix(AT_END) not in NAMED:
        allowed = [*SHORT, *NAMED, *(f"{one}{AT_END}" for one in NAMED)]
        raise BadInput(
            f"--quantity {quantity!r}: is not estimated; allowed: {', '.join(allowed)}{did_you_mean(quantity, allowed)}"
        )
    return (name,), (name.removesuffix(AT_END),)


class Refused(BadInput):
    """An engine refuses a file that it should be able to read; the text names the file and says what the engine said."""


@contextmanager
def results(
    asked: Asked,
    records: Mapping[str, Engine],
    folder: Path,
    head: Header,
    progress: Advance = lambda done, count=1: None,
) -> Iterator[Estimates]:
    """Run the scene in all engines, and provide the results.

    If the folder contains the same study and it was interrupted, the engines that are recorded there are not run again.

    Raises
    ------
    BadInput
        If the file has no such keyframe or actuator, no engine has a method that is named, or no engine can read the file.
    BadJournal
        If another process is writing to the folder.
    """
    about = About(asked.name, asked.duration, asked.error, asked.compared)
    work = (about, asked.quantities, asked.integrators, asked.identity, asked.keyframe)
    with resumption.opened(folder / RECORDS, head, *work, lost=lambda record: False, about=asdict(about)) as log:
        done = [typed(OfEngine, record["engine"]) for record in log.records if record["record"] == "engine"]
        limits: dict[str, Limit] = {}
        unknown: list[BadInput] = []
        refused: list[OfEngine] = []
        for name, record in records.items():
            if name not in {one.engine for one in done}:
                try:
                    of_engine, limit = _of_engine(asked, name, record)
                except (UnknownMethod, Refused) as error:
                    unknown.append(error)
                    refused += [_without(asked, name, record, UNSUPPORTED, str(error))] if isinstance(error, Refused) else []
                    progress(name)
                    continue
                log.add({"record": "engine", "engine": asdict(of_engine)})
                done.append(of_engine)
                limits |= {} if limit is None else {name: limit}
            progress(name)
        if unknown and not any(one.integrator for one in done):
            raise unknown[0]
        for of_engine in refused:
            log.add({"record": "engine", "engine": asdict(of_engine)})
            done.append(of_engine)
        apart = [typed(Spread, record["spread"]) for record in log.records if record["record"] == "spread"]
        spread = (
            apart[0]
            if apart
            else between(None if asked.case is None else asked.case.scene, asked.duration, asked.compared, limits)
        )
        if not apart:
            log.add({"record": "spread", "spread": spread})
        told = [typed(dict[str, str], record["causes"]) for record in log.records if record["record"] == "causes"]
        causes = told[0] if told else causes_of(asked.path, asked.packages, {name: records[name] for name in limits})
        if not told:
            log.add({"record": "causes", "causes": causes})
        yield joined(about, done, spread, causes)


def _of_engine(asked: Asked, name: str, record: Engine) -> tuple[OfEngine, Limit | None]:
    """Return the results of one engine, and its limit."""
    with pool.Workers(refining.timed, 1, TIME_BUDGET_S, group=refining.engine_of, home=engine_homes.home, kept=1) as workers:
        clock = Clock(workers, START_S)
        facts = _facts(asked, name, record, clock)
        if isinstance(facts, Ended):
            return _without(asked, name, record, *_verdict_of(facts)), None
        rows: list[EstimateRow] = []
        every: list[Refined] = []
        strictly: Solver | None = None
        clock.budget = TIME_BUDGET_S
        end = clock.now + TIME_BUDGET_S
        for index, spelling in enumerate(facts.methods):
            clock.end = clock.now + (end - clock.now) / (len(facts.methods) - index)
            method = Method.parse(spelling, 0.0).at(facts.method.timestep)
            of_method, known = _of_method(asked, name, record, clock, facts, method)
            rows += of_method
            every += [] if known is None else [known]
            if index == 0 and known is not None:
                strictly = solver.measured(_subject(asked, facts), known, facts.settings, partial(_made, asked, name, clock))
    finest = every[0].levels.levels[-1].motion if every and every[0].levels.levels else None
    kind = "" if finest is None else _kind(asked, facts, finest)
    apart = _from_truth(asked, finest)
    shown = None if asked.file is None else showing.animation(name, facts.method.timestep, every, asked.instants)
    of_engine = OfEngine(
        name, facts.method.name, facts.method.timestep, kind, tuple(rows), apart, showing.stored(shown), strictly
    )
    return of_engine, limit_of(asked.duration, every)


def _of_method(
    asked: Asked, name: str, record: Engine, clock: Clock, facts: FileFacts, method: Method
) -> tuple[list[EstimateRow], Refined | None]:
    """Return the rows of one method, and its runs."""
    subject = _subject(asked, facts)
    run = partial(_made, asked, name, clock)
    try:
        known = refined(subject, method, run, _claimed(record, method))
    except NoTime as error:
        return [_nothing(asked, name, record, method, NO_TIME, str(error))], None
    if isinstance(known, Ended):
        return [_nothing(asked, name, record, method, *_verdict_of(known))], None
    known = searched(subject, known, run)
    rows = rating.rows(Head(asked.name, name, record.version, method.name), subject, known, asked.quantities)
    return rows or [_nothing(asked, name, record, method, NO_TIME, known.out_of_time or clock.told)], known


def _claimed(record: Engine, method: Method) -> float:
    """Return the order that an engine claims for a method; infinite if it claims none."""
    integrator = integrator_of(record, method)
    return math.inf if integrator is None or integrator.order is None else float(integrator.order)


def _from_truth(asked: Asked, finest: Motion | None) -> dict[str, tuple[float, float]]:
    """Return the distance of a run from the truth of a case, and the bound of the truth's error, by quantities.

    Empty for a file, for a case whose truth is not used, and for one without a truth.
    """
    if asked.case is None or asked.blind or finest is None or finest.trajectory is None:
        return {}
    with pool.Workers(answer, 1, TIME_BUDGET_S, home=lambda group: engine_homes.home(None)) as workers:
        truth = workers.call(Question(asked.case, tuple(finest.t.tolist()), certified=False))
    if not isinstance(truth, Truth):
        return {}
    compared = Comparison(truth, finest.trajectory)
    apart = {}
    for name in (name for name in asked.compared if name in FIGURES):
        values, bound = FIGURES[name].compute(compared), FIGURES[FIGURES[name].bounded_by].compute(compared)
        if isinstance(values, np.ndarray) and isinstance(bound, np.ndarray) and not np.isnan(values).all():
            apart[name] = float(np.nanmax(values)), float(np.nanmax(bound))
    return apart


def _verdict_of(ended: Ended) -> tuple[str, str]:
    """Return the verdict and the reason for a method that an engine cannot run at all."""
    return (NO_TIME if ended.status == "timeout" else UNSUPPORTED), printable(ended.reason)


def _refusal(asked: Asked, record: Engine, reason: str) -> Refused:
    """Return the refusal of a file by an engine, with the line of the file in place of that of its copy."""
    assert asked.file is not None
    said = printable(reason).replace(Path(asked.file.path).name, asked.name)
    where = asked.name
    if (line := re.search(r",? \(?line (\d+)\)?", said)) and (source := asked.lines.get(int(line[1]))):
        said, where = said[: line.start()] + said[line.end() :], source
    return Refused(f"{where}: {in_words(record.name, record.version)} cannot read the file: {said}")


def _without(asked: Asked, name: str, record: Engine, verdict: str, reason: str) -> OfEngine:
    """Return the results of an engine that cannot run the scene at all."""
    return OfEngine(name, "", 0.0, "", (_nothing(asked, name, record, Method("", 0.0), verdict, reason),), {})


def _nothing(asked: Asked, name: str, record: Engine, method: Method, verdict: str, reason: str) -> EstimateRow:
    """Return the row of a method that was not run."""
    none = (None, None, None, None)
    return EstimateRow(
        *(asked.name, name, record.version, method.name, method.timestep, asked.quantities[0]),
        *none,
        verdict,
        reason,
        None,
        None,
    )


def _made(asked: Asked, name: str, clock: Clock, method: Method, times: Array, nudged: bool) -> Motion | Ended:
    """Make a run in an engine. Raises `NoTime`."""
    call: Call
    if asked.case is not None:
        call = RunCase(name, asked.case, method, times, nudged)
    else:
        assert asked.file is not None
        call = RunFile(name, asked.file, FileRun(method, times, asked.keyframe, asked.controls, nudged))
    answer = clock.ask(call, round(float(times[-1]) / method.timestep), method)
    assert not isinstance(answer, FileFacts)
    return answer


def _facts(asked: Asked, name: str, record: Engine, clock: Clock) -> FileFacts | Ended:
    """Return the contents of a file, or of a case, on which its runs depend. Raises `BadInput`."""
    if asked.case is not None:
        return _facts_of_case(asked.case, record, asked.integrators)
    assert asked.file is not None
    facts = clock.ask(AskFile(name, asked.file), 0)
    if not isinstance(facts, FileFacts):
        assert isinstance(facts, Ended)
        if facts.status == "refused":
            raise _refusal(asked, record, facts.reason)
        return facts
    if asked.keyframe and asked.keyframe not in facts.keyframes:
        raise BadInput(f"--keyframe {asked.keyframe!r}: {asked.name} has: {_listed(facts.keyframes)}")
    for actuator in () if asked.controls is None else asked.controls.names:
        if actuator not in facts.actuators:
            meant = did_you_mean(actuator, facts.actuators)
            there = _listed(facts.actuators)
            raise BadInput(f"--controls: there is no actuator {actuator!r} in {asked.name}; there are: {there}{meant}")
    for spelling in asked.integrators:
        check(spelling, name, asked.name, facts)
    return replace(facts, methods=asked.integrators or facts.methods)


def _listed(names: Sequence[str]) -> str:
    """Return a stranger's names on one line; "none" if there are none."""
    return ", ".join(map(printable, names)) or "none"


def _facts_of_case(case: Case, record: Engine, integrators: Sequence[str]) -> FileFacts | Ended:
    """Return the methods of an engine for a case, with the time step of the case or the engine's default."""
    spellings = [one for one in chosen(record, case.scene, integrators) if Method.parse(one, 0.0).accuracy is None]
    if not spellings:
        return Ended("unsupported", f"{record.name} has no method with a fixed time step for this scene")
    method = Method.parse(spellings[0], 0.0)
    step = case.timestep or default_timestep(record, case, method)
    period = control_period(case.scene)
    if period is not None:
        step = float(period / max(1, round(float(period) / step)))
    return FileFacts(method.at(min(step, case.duration)), tuple(spellings))


def _subject(asked: Asked, facts: FileFacts) -> Subject:
    """Return the scene as a method is refined on it."""
    held = np.empty(0)
    scene = None if asked.case is None else asked.case.scene
    if scene is not None and (period := control_period(scene)) is not None:
        held = np.array([float(period)])
    elif asked.controls is not None:
        inside = asked.controls.times[(asked.controls.times > 0) & (asked.controls.times < asked.duration)]
        held = np.ceil(inside / facts.method.timestep - 1e-6) * facts.method.timestep
    return Subject(
        asked.instants,
        scene,
        asked.error,
        asked.compared,
        partial(_kind, asked, facts),
        held,
        wanted=tuple(
            name for name in NAMED if name in ANGLES or name in {one.removesuffix(AT_END) for one in asked.quantities}
        ),
    )


def _kind(asked: Asked, facts: FileFacts, motion: Motion) -> factors.Kind:
    """Return the class of the scene."""
    if asked.case is not None:
        return factors.of_case(asked.case.scene)
    return factors.of_file(motion, facts.driven, facts.friction)
