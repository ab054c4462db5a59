"""Plan runs of cases with sensors: the default method of each engine, after a step and after the engine's forward pass."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from bodycheck.adapters.contract import Engine, Method
from bodycheck.adapters.offers import offered
from bodycheck.casefile.case import load, shipped
from bodycheck.casefile.content import Case
from bodycheck.errors import BadInput
from bodycheck.judging.judgement import Verdict
from bodycheck.results.outcome import Completed
from bodycheck.running.instants import default_timestep
from bodycheck.running.plan import Task, check, methods_in, refuse_nothing
from bodycheck.running.roles import method_in_role, refuse_timesteps

#: The option of a method that reads sensors after the engine's forward pass, and its value.
READS, FORWARD = "sensors", "forward"


def scenes() -> tuple[str, ...]:
    """Return the names of the shipped cases with sensors."""
    return tuple(name for name in shipped() if load(name).sensors)


def default_method(engine: Engine, case: Case) -> Method | None:
    """Return the default method of an engine for a case, or else the first that it offers; None if it offers none."""
    if (usual := method_in_role(engine, case, "default")) is not None:
        return usual
    spelling = next(iter(offered(engine, case.scene)), None)
    if spelling is None:
        return None
    method = Method.parse(spelling, 0.0)
    return method.at(default_timestep(engine, case, method))


def plan(
    cases: Sequence[Case], engines: Mapping[str, Engine], integrators: Sequence[str], timesteps: Sequence[float]
) -> tuple[Task, ...]:
    """Return the tasks: each method of an engine that reads sensors, and the same method with the engine's forward pass.

    Parameters
    ----------
    cases
        The cases.
    engines
        The records of the engines by name.
    integrators
        Spellings of methods, and aliases; if empty, the default method of each engine.
    timesteps
        Time steps (s); if empty, the default time step of each method.

    Raises
    ------
    BadInput
        If a case has no sensors, no engine reads sensors or has a method, a time step is not possible, or nothing is to be run.
    """
    refuse_timesteps(integrators, timesteps)
    check(cases, engines, integrators, timesteps)
    if without := [case.name for case in cases if not case.sensors]:
        raise BadInput(f"{without[0]}: has no sensors; allowed: cases with [[sensors]]")
    tasks: dict[Task, None] = {}
    for case in cases:
        for name, engine in engines.items():
            for method in _methods(case, engine, integrators, timesteps) if engine.reads else ():
                tasks |= dict.fromkeys(Task(case, name, each) for each in _read(engine, method))
    if not any(engine.reads for engine in engines.values()):
        raise BadInput(f"nothing to run: none of these engines reads sensors: {', '.join(engines)}")
    refuse_nothing(tuple(tasks), engines, integrators)
    return tuple(tasks)


def _methods(case: Case, engine: Engine, integrators: Sequence[str], timesteps: Sequence[float]) -> Iterator[Method]:
    """Yield the methods of an engine for a case, with their time steps."""
    if integrators:
        yield from methods_in(case, engine, integrators, timesteps)
    elif (usual := default_method(engine, case)) is not None:
        yield from (usual.at(timestep) for timestep in timesteps or (usual.timestep,))


def _read(engine: Engine, method: Method) -> Iterator[Method]:
    """Yield a method once for each time at which the engine reads sensors."""
    yield method
    if FORWARD in engine.reads and method.option(READS) is None:
        yield method.with_option(READS, FORWARD)


def measurements(verdicts: Sequence[Verdict]) -> list[dict[str, Any]]:
    """Return a row of results for each run. A completed run in which no sensor is read is no measurement."""
    none = {"status": "not-measured", "reason": "the engine reads none of the sensors"}
    return [one.row() | (none if isinstance(one.outcome, Completed) and not _reads(one.outcome) else {}) for one in verdicts]


def _reads(outcome: Completed) -> bool:
    """Return whether any sensor is read in a run."""
    return outcome.sensed is not None and not all(outcome.sensed.lacking)
