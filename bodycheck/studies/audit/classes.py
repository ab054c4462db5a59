"""Find classes of equal methods over all engines: run every method on scenes that distinguish methods, and name each class."""

from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from bodycheck.adapters.contract import Engine, Kind, Method, kind_of
from bodycheck.adapters.offers import chosen
from bodycheck.casefile.content import Case
from bodycheck.judging.schemes.classes import Motion, classes
from bodycheck.judging.schemes.identification import identify
from bodycheck.judging.schemes.scheme_rounding import ROUNDOFF
from bodycheck.processes import pool
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.reference.mechanisms.mechanism import alone
from bodycheck.reference.scene import Body, Brick, Plane, Scene, State
from bodycheck.reference.truths import Truth
from bodycheck.results.key import RunKey
from bodycheck.results.outcome import Completed, Run
from bodycheck.running import campaign
from bodycheck.running.engines import home
from bodycheck.running.plan import Task
from bodycheck.running.tasks import TruthTask, group, perform
from bodycheck.studies.audit.rows import Classes, ClassRow, Unclassed

#: The flights begin at the origin, so that positions have all their digits.
_TUMBLING = State(velocity=(0.25, 0.125, 0.5), angular_velocity=(12.0, -9.0, 15.0))

_TURNED = State(quaternion=(0.5, 0.5, 0.5, 0.5), velocity=(0.25, 0.125, 0.5), angular_velocity=(-12.0, 15.0, 9.0))

_THROWN = State(quaternion=(0.5, 0.5, 0.5, 0.5), velocity=(8.0, 2.0, 4.0), angular_velocity=(-12.0, 15.0, 9.0))

#: A brick of 1 kg, which slides and spins on its largest face. Its moments are m (b^2 + c^2) / 3 and so on.
_BRICK = Brick((0.125, 0.25, 0.0625))

_LYING = Body(1.0, (0.06640625 / 3, 0.01953125 / 3, 0.078125 / 3), _BRICK)

_SLIDING = State(position=(0.0, 0.0, 0.0625), velocity=(1.5, 0.75, 0.0), angular_velocity=(0.0, 0.0, 8.0))

#: The name of a class whose scheme is not known; a number follows.
NOT_IDENTIFIED = "not identified"


@dataclass(frozen=True)
class Trial:
    """A scene by which methods are distinguished, with its time step (s)."""

    case: Case
    timestep: float

    @property
    def kind(self) -> Kind:
        """The kind of the scene."""
        return kind_of(self.case.scene)


def _trial(name: str, scene: Scene, timestep: float, steps: int) -> Trial:
    return Trial(Case(name, name, "", (), scene, steps * timestep, steps + 1, (), (), ""), timestep)


#: The scenes of all kinds. On the plane the time step is smaller, so that soft contacts are stable.
TRIALS = (
    _trial("tumbling", Scene(Body(1.0, (2.0, 2.5, 3.0)), _TUMBLING, gravity=64.0), 1 / 32, 8),
    _trial("tumbling-turned", Scene(Body(1.0, (3.0, 2.0, 2.5)), _TURNED, gravity=64.0), 1 / 32, 8),
    _trial("tumbling-drag", Scene(Body(1.0, (3.0, 2.0, 2.5)), _THROWN, gravity=8.0, drag=0.125), 1 / 32, 8),
    _trial("sliding-and-spinning", Scene(_LYING, _SLIDING, gravity=9.8125, plane=Plane(friction=0.5)), 1 / 512, 32),
)


@dataclass(frozen=True, eq=False)
class _Flown:
    """A completed run of a trial in an engine, and the truth of the scene."""

    trial: Trial
    engine: Engine
    run: Run
    motion: Motion
    truth: Truth | None


def tasks(engines: Mapping[str, Engine], integrators: Sequence[str] = ()) -> tuple[Task, ...]:
    """Return the runs by which methods are classed: the runs of all methods, or of the named methods, on every scene."""
    return tuple(
        Task(trial.case, name, Method.parse(spelling, trial.timestep))
        for trial in TRIALS
        for name, engine in engines.items()
        for spelling in chosen(engine, trial.case.scene, integrators)
    )


def measure(
    engines: Mapping[str, Engine],
    jobs: int,
    integrators: Sequence[str] = (),
    progress: Callable[[str], object] = lambda done: None,
    limit: float = campaign.TIME_LIMIT_S,
) -> Classes:
    """Run methods on the scenes that distinguish them, in processes of their engines, and return their classes.

    Parameters
    ----------
    engines
        The records of the engines by name.
    jobs
        The number of processes.
    integrators
        Spellings of methods; all that the engines offer if it is empty.
    progress
        A function that is called with a text after each of the runs that `tasks` returns.
    limit
        The time limit of one run (s).
    """
    planned = tasks(engines, integrators)
    truths: dict[str, Truth] = {}
    runs: dict[Task, Run] = {}
    wanted: list[TruthTask | Task] = [TruthTask(trial.case, (trial.timestep,)) for trial in TRIALS if trial.kind != "plane"]
    calls = [*wanted, *planned]
    with pool.Workers(perform, jobs, limit, group=group, home=home) as workers:
        for task, answer in workers.map(calls):
            match task, answer:
                case TruthTask(case), dict():
                    truths[case.name], *_ = answer.values()
                case Task(), Run():
                    runs[task] = answer
                case Task(case, engine, method), Crashed() | TimedOut():
                    runs[task] = Run(case.name, engine, engines[engine].version, method, answer)
            if isinstance(task, Task):
                progress(f"{task.engine} {task.method.name} · {task.case.name}")
    return classed([runs[task] for task in planned], truths, engines)


def classed(runs: Iterable[Run], truths: Mapping[str, Truth], engines: Mapping[str, Engine]) -> Classes:
    """Return the classes that follow from the runs of all trials.

    Parameters
    ----------
    runs
        The runs.
    truths
        The truths of the trials, by the name of the case. Trials on a plane need none, because no scheme is identified there.
    engines
        The records of the engines by name.
    """
    trials = {trial.case.name: trial for trial in TRIALS}
    by_kind: dict[Kind, list[Run]] = defaultdict(list)
    for run in runs:
        by_kind[trials[run.case].kind].append(run)
    rows: list[ClassRow] = []
    unclassed: list[Unclassed] = []
    for kind, kind_runs in by_kind.items():
        without = {
            _method(run): Unclassed(kind, run.engine, run.method.name, run.outcome.reason)
            for run in kind_runs
            if not isinstance(run.outcome, Completed)
        }
        flown = [
            _flown(run, trials[run.case], engines[run.engine], truths.get(run.case))
            for run in kind_runs
            if _method(run) not in without
        ]
        rows += _of_kind(kind, flown)
        unclassed += without.values()
    return Classes(tuple(rows), tuple(unclassed))


def _method(run: Run) -> RunKey:
    return run.key.over_cases.over_steps


def _flown(run: Run, trial: Trial, engine: Engine, truth: Truth | None) -> _Flown:
    assert isinstance(run.outcome, Completed)  # other runs are left out
    trajectory, roundoff = run.outcome.trajectory, ROUNDOFF[engine.precision]
    return _Flown(
        trial, engine, run, Motion(alone(trial.case.scene), trial.timestep, _method(run), trajectory, roundoff), truth
    )


def _of_kind(kind: Kind, flown: Sequence[_Flown]) -> Iterator[ClassRow]:
    equal_methods = sorted(classes(flight.motion for flight in flown), key=lambda same: -len(same.methods))
    schemes = [_scheme([flight for flight in flown if flight.motion.method in same.methods]) for same in equal_methods]
    for same, scheme, name in zip(equal_methods, schemes, _names(schemes), strict=True):
        for key in same.methods:
            flight = next(flight for flight in flown if flight.motion.method == key)
            yield ClassRow(
                kind, name, scheme, key.engine, flight.engine.version, key.method.name, same.distance, flight.trial.timestep
            )


def _scheme(flown: Sequence[_Flown]) -> str:
    """Return the scheme of a class: the first scheme identified in its runs, which are tried in the order of their precision.

    Runs in double precision come first. The result is empty if no scheme is identified.
    """
    for flight in sorted(flown, key=lambda flight: flight.motion.roundoff):
        identified = (
            None if flight.truth is None else identify(flight.trial.case, flight.run, flight.truth, flight.motion.roundoff)
        )
        if identified is not None and identified.scheme:
            return identified.scheme
    return ""


def _names(schemes: Sequence[str]) -> list[str]:
    """Return a name for each class: its scheme, with a number from the second class with the same scheme on.

    Classes without a scheme are called `NOT_IDENTIFIED`, always with a number.
    """
    seen: Counter[str] = Counter()
    names = []
    for scheme in schemes:
        seen[scheme] += 1
        numbered = f"{NOT_IDENTIFIED} {seen[scheme]}" if not scheme else f"{scheme} ({seen[scheme]})"
        names.append(scheme if scheme and seen[scheme] == 1 else numbered)
    return names
