"""Plan runs: which cases are run in which engines with which methods."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import product

from bodycheck.adapters import offers
from bodycheck.adapters.contract import Engine, Kind, Method, Role, kind_of
from bodycheck.adapters.method import DEFAULT_TIMESTEP
from bodycheck.adapters.roles import ALIASES, LACKING, alias, aliases, spelled
from bodycheck.casefile.content import Case
from bodycheck.casefile.expectation import REFINEMENTS
from bodycheck.errors import BadInput
from bodycheck.running.instants import check_timestep, default_timestep
from bodycheck.running.roles import KINDS, methods_of, refuse_timesteps
from bodycheck.running.tasks import Task as Task
from bodycheck.suggestion import did_you_mean

#: The reasons why an engine has no task for a case, by the kind of its scene.
NO_METHOD: dict[Kind, str] = {kind: f"no method for {words}" for kind, words in KINDS.items()}

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
        Spellings of methods, and aliases; if empty, all methods that each engine offers.
    timesteps
        Time steps (s); if empty, the default time step of each method, and the time steps of the case's expectations. The
        method of an alias has its own time step.

    Raises
    ------
    BadInput
        If no engine has a method, an engine does not have the method of an expectation, a time step is not possible or named
        beside an alias, or there is nothing to run.
    """
    return _tasks(cases, engines, integrators, timesteps, ())


def plan_with_roles(
    cases: Sequence[Case], engines: Mapping[str, Engine], integrators: Sequence[str], timesteps: Sequence[float]
) -> tuple[Task, ...]:
    """Return the tasks of `plan`; if no method and no time step is named, also those of each engine's own methods.

    These are the default and the recommended method of the engine, with their own time steps, as far as the duration of the
    case allows them. Raises `BadInput` as `plan` does.
    """
    return _tasks(cases, engines, integrators, timesteps, () if integrators or timesteps else ALIASES)


def _tasks(
    cases: Sequence[Case],
    engines: Mapping[str, Engine],
    integrators: Sequence[str],
    timesteps: Sequence[float],
    roles: Sequence[Role],
) -> tuple[Task, ...]:
    """Return the tasks of `plan`, and those of the methods of some roles whose steps are not longer than the case."""
    refuse_timesteps(integrators, timesteps)
    check(cases, engines, integrators, timesteps or (DEFAULT_TIMESTEP,))
    tasks: dict[Task, None] = {}
    for case in cases:
        for name, engine in engines.items():
            also = (method for method in methods_of(engine, case, roles) if method.timestep <= case.duration)
            methods = (*_methods(case, name, engine, integrators, timesteps), *also)
            tasks |= dict.fromkeys(Task(case, name, method) for method in methods)
    refuse_nothing(tuple(tasks), engines, integrators)
    return tuple(tasks)


def methods_in(case: Case, engine: Engine, integrators: Sequence[str], timesteps: Sequence[float]) -> Iterator[Method]:
    """Yield the methods of an engine in a case, with their time steps; those of aliases come last.

    Parameters
    ----------
    case, engine
        The case, and the record of the engine.
    integrators
        Spellings of methods, and aliases; if empty, all methods that the engine offers.
    timesteps
        Time steps (s); if empty, the default time step of each method.

    Raises
    ------
    BadInput
        If the time step of an alias is not possible in the case.
    """
    spellings = spelled(integrators)
    for spelling in offers.chosen(engine, case.scene, spellings) if spellings or not integrators else ():
        method = Method.parse(spelling, 0.0)
        yield from (method.at(timestep) for timestep in timesteps or (default_timestep(engine, case, method),))
    for method in methods_of(engine, case, aliases(integrators)):
        check_timestep(case, method.timestep)
        yield method


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
    """Raise `BadInput`, which names the allowed methods, for a method that no engine has. spelling: may be an alias."""
    if (role := alias(spelling)) is not None:
        if engines and not any(engine.roles.get(role) for engine in engines):
            raise BadInput(f"--integrator {role}: {'; '.join(f'{engine.name} {LACKING[role]}' for engine in engines)}")
        return
    method = Method.parse(spelling, 0.0)
    if not engines or any(offers.knows(engine, spelling) for engine in engines):
        return
    for engine in engines:
        if offers.integrator_of(engine, method) is not None:
            offers.check(engine, method)  # raises `BadInput` with the fault of the options
    known = "; ".join(f"{engine.name}: {', '.join(offers.listed(engine))}" for engine in engines)
    meant = did_you_mean(spelling, [*ALIASES, *(name for engine in engines for name in offers.listed(engine))])
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
    yield from methods_in(case, engine, integrators, timesteps)
    if timesteps:
        return
    behind_aliases = methods_of(engine, case, aliases(integrators))
    asked = {Method.parse(spelling, 0.0).name for spelling in spelled(integrators)}
    for expectation in case.expectations:
        wanted = expectation.method
        if expectation.engine == name and (
            not integrators or wanted.name in asked or any(expectation.concerns(name, method) for method in behind_aliases)
        ):
            try:
                offers.check(engine, wanted)
            except BadInput as error:
                raise BadInput(f"{case.name}: expect: integrator: {error}") from error
            finer = REFINEMENTS if expectation.needs_order else ()
            yield from (wanted.at(wanted.timestep / by) for by in (1, *finer))
