"""Plan runs: which cases are run in which engines with which methods."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import product

from bodycheck.adapters import offers
from bodycheck.adapters.contract import Engine, Kind, Method, kind_of
from bodycheck.adapters.method import DEFAULT_TIMESTEP
from bodycheck.casefile.content import Case
from bodycheck.casefile.expectation import REFINEMENTS
from bodycheck.errors import BadInput
from bodycheck.running.instants import check_timestep, method_of
from bodycheck.running.tasks import Task as Task
from bodycheck.suggestion import did_you_mean

#: The reasons why an engine has no task for a case, by the kind of its scene.
NO_METHOD: dict[Kind, str] = {
    "flight": "no method for free flight",
    "drag": "no method for drag",
    "plane": "no method for a body that slides on a plane",
    "mechanism": "no method for mechanisms",
    "contact": "no method for bodies that touch",
}

#: A function that returns the tasks for cases, engines by name, spellings of methods, and time steps (s).
Plan = Callable[[Sequence[Case], Mapping[str, Engine], Sequence[str], Sequence[float]], tuple[Task, ...]]


def plan(
    cases: Sequence[Case], engines: Mapping[str, Engine], integrators: Sequence[str], timesteps: Sequence[float]
) -> tuple[Task, ...]:
    """Return one task for every case, engine, method and time step.

    Parameters
    ----------
    cases
        The cases.
    engines
        The records of the engines by name.
    integrators
        Spellings of methods; if empty, all methods that each engine offers.
    timesteps
        Time steps (s); if empty, the default time step of each method, and the time steps of the case's expectations.

    Raises
    ------
    BadInput
        If no engine has a method, an engine does not have the method of an expectation, a time step is not possible, or there
        is nothing to run.
    """
    check(cases, engines, integrators, timesteps or (DEFAULT_TIMESTEP,))
    tasks = tuple(
        Task(case, name, method)
        for case in cases
        for name, engine in engines.items()
        for method in dict.fromkeys(_methods(case, name, engine, integrators, timesteps))
    )
    refuse_nothing(tasks, engines, integrators)
    return tasks


def check(cases: Sequence[Case], engines: Mapping[str, Engine], integrators: Sequence[str], timesteps: Sequence[float]) -> None:
    """Raise `BadInput` for a method that no engine has, and for a time step that is not possible.

    Parameters
    ----------
    cases
        The cases.
    engines
        The records of the engines by name.
    integrators
        Spellings of methods.
    timesteps
        Time steps (s).
    """
    for spelling in integrators:
        check_method(spelling, list(engines.values()))
    for case, timestep in product(cases, timesteps):
        check_timestep(case, timestep)


def check_method(spelling: str, engines: Sequence[Engine]) -> None:
    """Raise `BadInput`, which names the allowed methods, for the spelling of a method that no engine has."""
    method = Method.parse(spelling, 0.0)
    if not engines or any(offers.knows(engine, spelling) for engine in engines):
        return
    for engine in engines:
        if offers.integrator_of(engine, method) is not None:
            offers.check(engine, method)  # raises `BadInput` with the fault of the options
    known = "; ".join(f"{engine.name}: {', '.join(offers.listed(engine))}" for engine in engines)
    meant = did_you_mean(spelling, [name for engine in engines for name in offers.listed(engine)])
    raise BadInput(f"no engine has an integrator {method.integrator!r}; there are: {known}{meant}")


def refuse_nothing(tasks: Sequence[object], engines: Mapping[str, Engine], integrators: Sequence[str]) -> None:
    """Raise `BadInput` if there are no tasks."""
    if not tasks:
        raise BadInput(f"nothing to run: no case has a scene for which {', '.join(engines)} offer {', '.join(integrators)}")


def without_method(cases: Sequence[Case], engines: Mapping[str, Engine], tasks: Sequence[Task]) -> dict[str, dict[str, str]]:
    """Return for each engine the cases without a task, because it has none of the requested methods, with the reasons."""
    planned = {(task.engine, task.case.name) for task in tasks}
    return {
        name: {case.name: NO_METHOD[kind_of(case.scene)] for case in cases if (name, case.name) not in planned}
        for name in engines
    }


def _methods(case: Case, name: str, engine: Engine, integrators: Sequence[str], timesteps: Sequence[float]) -> Iterator[Method]:
    for spelling in offers.chosen(engine, case.scene, integrators):
        yield from (method_of(engine, case, spelling, timestep) for timestep in timesteps or (None,))
    if timesteps:
        return
    asked = {Method.parse(spelling, 0.0).name for spelling in integrators}
    for expectation in case.expectations:
        if expectation.engine == name and (not asked or expectation.method.name in asked):
            try:
                offers.check(engine, expectation.method)
            except BadInput as error:
                raise BadInput(f"{case.name}: expect: integrator: {error}") from error
            finer = REFINEMENTS if expectation.needs_order else ()
            yield from (expectation.method.at(expectation.method.timestep / by) for by in (1, *finer))
