"""Audit methods: make every probe of each method in a process of its engine, and judge the findings.

Every probe of a method is a separate call, whose answer is recorded when it ends. Therefore an interrupted audit can be
resumed, and a probe whose process dies does not affect the other probes.
"""

import math
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bodycheck.adapters.contract import Engine, Kind, Method
from bodycheck.adapters.roles import is_of
from bodycheck.casefile.case import Case, load
from bodycheck.judging.discrepancy import compare
from bodycheck.processes import pool
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.reference.mechanisms.mechanism import AnyScene
from bodycheck.reference.truths import Truth
from bodycheck.results import resumption
from bodycheck.results.header import Header
from bodycheck.results.outcome import Completed, Run
from bodycheck.running.engines import home
from bodycheck.running.plan import Task, check, methods_in, refuse_nothing
from bodycheck.running.roles import method_in_role, refuse_timesteps
from bodycheck.running.tasks import TruthTask, perform
from bodycheck.studies.audit import classes, nondeterminism
from bodycheck.studies.audit.calls import Call, Found, make
from bodycheck.studies.audit.probe import KIND_OF, OF_LONG_RUNS, Finding, Property
from bodycheck.studies.audit.probes import PROBES, SCENES, long_run
from bodycheck.studies.audit.probes.friction import sliding
from bodycheck.studies.audit.probes.permutation import TREE
from bodycheck.studies.audit.rows import FINDINGS, PROPERTIES, RECORDS, Classes, Facts, Fault, Row, Status, read_classes

if TYPE_CHECKING:
    from bodycheck.running.campaign import Advance

#: Time limit (s) of one probe, which may make many flights in an engine that compiles code for each of them.
TIME_LIMIT_S = 300.0

#: The shipped case that every method runs to show the effect of its properties, and the name of this run in the records.
FLIP = "intermediate-axis-flip"


@dataclass(frozen=True)
class Planned:
    """A method to audit.

    Parameters
    ----------
    engine, method
        The name of the engine, and the method.
    kinds
        The kinds of scene, among those of the probes, for which the engine offers the method.
    """

    engine: str
    method: Method
    kinds: frozenset[Kind]


@dataclass(frozen=True)
class Plan:
    """The methods to audit.

    Parameters
    ----------
    engines
        The records of the engines by name.
    methods
        The methods with the kinds of scene for which they are offered, in the order of the table.
    integrators
        The spellings of methods that the user named.
    flip
        The case `FLIP`, which every method of free flight runs to show the effect of its properties.
    long_runs
        The engines and methods that take very many steps.
    """

    engines: Mapping[str, Engine]
    methods: tuple[Planned, ...]
    integrators: tuple[str, ...]
    flip: Case
    long_runs: tuple[tuple[str, Method], ...] = ()

    @property
    def probes(self) -> tuple[Call, ...]:
        """The calls of all probes of all methods."""
        names = (*PROBES, nondeterminism.NAME)
        long_runs = tuple(_call(engine, method, long_run.NAME) for engine, method in self.long_runs)
        return long_runs + tuple(
            _call(one.engine, one.method, name)
            for one in self.methods
            for name in names
            if SCENES.get(name, "flight") in one.kinds
        )

    @property
    def elsewhere(self) -> tuple[Call, ...]:
        """The calls that repeat the flight of nondeterminism in other processes, with the methods in reverse order."""
        return tuple(_call(*method, nondeterminism.ELSEWHERE) for method in reversed(self.in_flight))

    @property
    def flips(self) -> tuple[Task, ...]:
        """The runs of the flip by all methods of free flight."""
        return tuple(Task(self.flip, engine, method) for engine, method in self.in_flight)

    @property
    def in_flight(self) -> tuple[tuple[str, Method], ...]:
        """The engines and methods that are offered in free flight."""
        return tuple((one.engine, one.method) for one in self.methods if "flight" in one.kinds)

    @property
    def size(self) -> int:
        """The number of all calls and runs, including the runs by which methods are classed."""
        return len(self.probes) + len(self.elsewhere) + len(self.flips) + len(classes.tasks(self.engines, self.integrators))


@dataclass(frozen=True)
class Audit:
    """The results of an audit.

    Parameters
    ----------
    rows
        The rows in the order of the plan.
    faults
        The probes that gave no answer.
    classes
        The classes of equal methods.
    """

    rows: tuple[Row, ...]
    faults: tuple[Fault, ...]
    classes: Classes


#: The answers to the calls of a method, or their faults, by the name of the probe.
Answers = dict[str, Found | Fault]


def prepare(engines: Mapping[str, Engine], integrators: Sequence[str], timestep: float | None, *, long: bool = False) -> Plan:
    """Return the methods to audit.

    Parameters
    ----------
    engines
        The records of the engines by name.
    integrators
        Spellings of methods, and aliases; all that the engines offer in free flight, for a sliding box and for a mechanism if
        it is empty.
    timestep
        The time step (s); None for 2 ms, or the time step of an alias.
    long
        Whether the default method of each engine takes very many steps.

    Raises
    ------
    BadInput
        If no engine has an integrator, the time step is not possible, or there is nothing to audit.
    """
    flip = load(FLIP)
    timesteps = () if timestep is None else (timestep,)
    refuse_timesteps(integrators, timesteps)
    check([flip], engines, integrators, timesteps)
    scenes: Mapping[Kind, AnyScene] = {"flight": flip.scene, "plane": sliding(0.0, turned=False), "mechanism": TREE}
    methods: list[Planned] = []
    for name, engine in engines.items():
        kinds: dict[str, set[Kind]] = defaultdict(set)
        # The answers are keyed by the spelling of the method, so that a method behind an alias is not audited at 2 ms too.
        by_spelling: dict[str, Method] = {}
        for kind, scene in scenes.items():
            for method in methods_in(replace(flip, scene=scene), engine, integrators, timesteps):
                by_spelling[method.name] = method
                kinds[method.name].add(kind)
        methods += [Planned(name, method, frozenset(kinds[spelling])) for spelling, method in by_spelling.items()]
    refuse_nothing(methods, engines, integrators)
    long_runs = tuple(
        (name, usual)
        for name, engine in engines.items()
        if long and (usual := method_in_role(engine, flip, "default")) is not None
    )
    return Plan(engines, tuple(methods), tuple(integrators), flip, long_runs)


def facts(engines: Mapping[str, Engine]) -> dict[str, Facts]:
    """Return the statements of engines about themselves, by the name of the engine."""
    return {name: Facts(engine.precision, dict(engine.defaults)) for name, engine in engines.items()}


@contextmanager
def results(
    planned: Plan, folder: Path, head: Header, jobs: int, progress: "Advance", limit: float = TIME_LIMIT_S
) -> Iterator[Audit]:
    """Make the probes of a plan, and provide their results.

    If the folder contains the same audit and it was interrupted, its recorded probes are not repeated. The audit counts as
    interrupted until the context ends.

    Parameters
    ----------
    planned
        The methods.
    folder
        The folder for the records.
    head
        The header of the records.
    jobs
        The number of processes.
    progress
        A function that is called with a text after each probe.
    limit
        The time limit of one probe (s).

    Raises
    ------
    BadJournal
        If another process is writing to the folder.
    """
    recorded_facts = {name: asdict(engine_facts) for name, engine_facts in facts(planned.engines).items()}
    work = (planned.methods, planned.integrators, planned.flip, planned.long_runs, tuple(PROBES))
    with resumption.opened(folder / RECORDS, head, limit, work, lost=_is_fault, what="audit", facts=recorded_facts) as log:
        answers = _read(log.records)
        if log.records:
            progress("", sum(map(len, answers.values())))
        for call, outcome in _missing(planned, answers, jobs, limit):
            log.add({"record": "probe", **asdict(call), **_recorded(outcome)})
            answers[call.engine, call.integrator][call.probe] = outcome
            progress(f"{call.engine} {call.integrator} · {call.probe}")
        same_methods = next((read_classes(record) for record in log.records if record["record"] == "classes"), None)
        if same_methods is None:
            same_methods = classes.measure(planned.engines, jobs, planned.integrators, progress)
            log.add({"record": "classes", **asdict(same_methods)})
        yield Audit(*judged(planned, answers), same_methods)


def judged(planned: Plan, answers: Mapping[tuple[str, str], Answers]) -> tuple[tuple[Row, ...], tuple[Fault, ...]]:
    """Return the rows and faults of a plan from the answers to the calls of each method, by engine and integrator."""
    rows: list[Row] = []
    faults: list[Fault] = []
    for one in planned.methods:
        looked_for = [name for name in PROPERTIES if name not in OF_LONG_RUNS and KIND_OF.get(name, "flight") in one.kinds]
        given = {name: answer for name, answer in answers[one.engine, one.method.name].items() if name != long_run.NAME}
        faults += [answer for answer in given.values() if isinstance(answer, Fault)]
        rows += _rows(planned.engines[one.engine], one.engine, one.method, given, looked_for)
    for engine, method in planned.long_runs:
        answer = answers[engine, method.name][long_run.NAME]
        faults += [answer] if isinstance(answer, Fault) else []
        rows += _rows(planned.engines[engine], engine, method, {long_run.NAME: answer}, OF_LONG_RUNS)
    return tuple(rows), tuple(faults)


def status_of(engine: Engine, method: Method, finding: Finding) -> Status:
    """Return the status of a finding: "default" or "deviates" for a property that was found, and otherwise its verdict.

    A property that was found is a default in two cases:

    - the engine itself states that it has this property, so that all its methods have it;
    - the user gets the method without choosing anything; see `_is_of_engine`.
    """
    if finding.verdict != "found":
        return finding.verdict
    in_single_precision = finding.property == "single-precision" and engine.precision == "float32"
    is_stated = finding.property in engine.defaults or in_single_precision
    return "default" if is_stated or _is_of_engine(engine, method) else "deviates"


def _is_of_engine(engine: Engine, method: Method) -> bool:
    """Return whether a user of the engine who chooses nothing gets the settings of this method, apart from the time step.

    This holds for the engine's default method, and for methods with the engine's own settings (`settings=engine`). It also
    holds for the only integrator that the engine has for free flight, if the adapter has nothing to switch off in it.
    """
    if is_of(engine, method.name, "default"):
        return True
    if method.options:
        return method.option("settings") == "engine"
    integrators = {integrator.name: integrator for integrator in engine.integrators if "flight" in integrator.kinds}
    if method.integrator not in integrators or "settings" in integrators[method.integrator].options:
        return False
    return len(integrators) == 1


def _call(engine: str, method: Method, probe: str) -> Call:
    return Call(engine, method.name, method.timestep, probe)


def _missing(
    planned: Plan, answers: Mapping[tuple[str, str], Answers], jobs: int, limit: float
) -> Iterator[tuple[Call, Found | Fault]]:
    """Make the calls that have no answer yet, and yield each with its answer.

    The calls and runs of the second pass are made in other processes than the calls of the first pass.
    """
    first = [call for call in planned.probes if call.probe not in answers[call.engine, call.integrator]]
    second = [call for call in planned.elsewhere if call.probe not in answers[call.engine, call.integrator]]
    flips = [task for task in planned.flips if FLIP not in answers[task.engine, task.method.name]]
    truths = _truths(planned, tuple(dict.fromkeys(task.method.sampling for task in flips)), limit) if flips else {}
    passes: tuple[list[Call | Task], ...] = ([*first], [*second, *flips])
    for left in passes:
        with pool.Workers(make, jobs, limit, group=lambda one: one.engine, home=home) as workers:
            for asked, answer in workers.map(left):
                call = asked if isinstance(asked, Call) else _call(asked.engine, asked.method, FLIP)
                match answer:
                    case Found():
                        yield call, answer
                    case Crashed() | TimedOut() | Run(outcome=Crashed() | TimedOut()):
                        lost = answer.outcome if isinstance(answer, Run) else answer
                        yield call, Fault(call.engine, call.integrator, call.probe, lost.reason)
                    case Run():
                        yield call, Found(attitude_error=_attitude_error(truths.get(answer.method.sampling), answer))


def _truths(planned: Plan, samplings: tuple[float, ...], limit: float) -> dict[float, Truth]:
    """Return the truths of the flip for its runs, by sampling; empty if their computation failed."""
    with pool.Workers(perform, 1, limit) as workers:
        computed = workers.call(TruthTask(planned.flip, samplings))
    return computed if isinstance(computed, dict) else {}


def _attitude_error(truth: Truth | None, run: Run) -> float | None:
    """Return the largest attitude error (rad) of a run; None if the run did not complete or there is no truth."""
    if truth is None or not isinstance(run.outcome, Completed):
        return None
    return compare(truth, run).maxima().get("attitude_error")


def _rows(engine: Engine, name: str, method: Method, answers: Answers, looked_for: Iterable[Property]) -> list[Row]:
    """Return the rows of a method: one for each finding of its probes, and one for each property without a finding.

    looked_for: the properties that the probes of the method look for.
    """
    findings = [finding for answer in answers.values() if isinstance(answer, Found) for finding in answer.findings]
    flights = {
        when: states for answer in answers.values() if isinstance(answer, Found) for when, states in answer.flights.items()
    }
    if len(flights) > 1:
        findings.append(nondeterminism.judged(flights))
    silent = "; ".join(f"{one.probe}: {one.reason}" for one in answers.values() if isinstance(one, Fault))
    for missing in looked_for:
        if missing not in {finding.property for finding in findings}:
            findings.append(Finding(missing, silent or "no probe looks for it", "not-probed"))
    flip = answers.get(FLIP)
    error = flip.attitude_error if isinstance(flip, Found) else None
    rows = []
    for finding in sorted(findings, key=lambda one: PROPERTIES.index(one.property)):
        status = status_of(engine, method, finding)
        rows.append(
            Row(
                *(name, engine.version, method.name, method.timestep, finding.property),
                *(_finite(finding.value), finding.unit, finding.expected, status, finding.probe),
                attitude_error=error if status in FINDINGS else None,
            )
        )
    return rows


def _finite(value: float | None) -> float | None:
    return value if value is not None and math.isfinite(value) else None


def _recorded(answer: Found | Fault) -> dict[str, Any]:
    return {"fault": answer.reason} if isinstance(answer, Fault) else {"found": asdict(answer)}


def _is_fault(record: Mapping[str, Any]) -> bool:
    return "fault" in record


def _read(recorded: Iterable[Mapping[str, Any]]) -> dict[tuple[str, str], Answers]:
    """Return the recorded answers and faults, by engine and integrator."""
    answers: dict[tuple[str, str], Answers] = defaultdict(dict)
    for record in recorded:
        if record["record"] == "classes":
            continue
        engine, integrator, probe = record["engine"], record["integrator"], record["probe"]
        if "fault" in record:
            answers[engine, integrator][probe] = Fault(engine, integrator, probe, record["fault"])
        else:
            stored = record["found"]
            findings = tuple(Finding(**finding) for finding in stored["findings"])
            answers[engine, integrator][probe] = Found(findings, stored["flights"], stored["attitude_error"])
    return answers
