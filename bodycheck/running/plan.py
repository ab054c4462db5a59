"""What to run: which cases through which engines with which methods."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

from bodycheck.adapters import offers
from bodycheck.adapters.contract import Adapter, Engine, Method
from bodycheck.adapters.method import DEFAULT_TIMESTEP
from bodycheck.casefile.case import Case
from bodycheck.casefile.expectation import REFINEMENTS
from bodycheck.casefile.values import MAX_STEPS
from bodycheck.errors import BadInput
from bodycheck.running.key import RunKey
from bodycheck.suggestion import did_you_mean


@dataclass(frozen=True)
class Task:
    """One run to be made."""

    case: Case
    engine: str
    method: Method

    @property
    def key(self) -> RunKey:
        """Which run it is."""
        return RunKey(self.case.name, self.engine, self.method)


#: From cases, adapters by the engine's name, spellings of methods and time steps (s) to what is to be run.
Plan = Callable[[Sequence[Case], Mapping[str, Adapter], Sequence[str], Sequence[float]], tuple[Task, ...]]


def plan(
    cases: Sequence[Case], engines: Mapping[str, Adapter], integrators: Sequence[str], timesteps: Sequence[float]
) -> tuple[Task, ...]:
    """Every case x engine x method x time step, each once.

    Parameters
    ----------
    cases
        The cases.
    engines
        Adapters by the engine's name.
    integrators
        Spellings of methods; all that an engine offers where there are none.
    timesteps
        s; where there are none, 2 ms and what the expectations of a case ask for.

    Raises
    ------
    BadInput
        For a method that no engine has, for an expectation of a method that its engine does not have, for a time step that
        cannot be run, and where there is nothing to run.
    """
    check(cases, engines, integrators, timesteps or (DEFAULT_TIMESTEP,))
    tasks = tuple(
        Task(case, engine, method)
        for case in cases
        for engine, adapter in engines.items()
        for method in dict.fromkeys(_methods(case, engine, adapter.engine, integrators, timesteps))
    )
    refuse_nothing(tasks, engines, integrators)
    return tasks


def check(
    cases: Sequence[Case], engines: Mapping[str, Adapter], integrators: Sequence[str], timesteps: Sequence[float]
) -> None:
    """Raises `BadInput` for the spelling of a method that no engine has, and for a time step (s) that cannot be run."""
    for spelling in integrators:
        check_method(spelling, [adapter.engine for adapter in engines.values()])
    for case, timestep in product(cases, timesteps):
        if not 0 < timestep <= case.duration <= timestep * MAX_STEPS:
            least = case.duration / MAX_STEPS
            raise BadInput(
                f"{case.name}: time step {timestep:g} s: must be positive, at most its duration, {case.duration:g} s, and at "
                f"least {least:g} s, which makes {MAX_STEPS:.0e} steps"
            )


def check_method(spelling: str, engines: Sequence[Engine]) -> None:
    """Raises `BadInput` for the spelling of a method that none of the engines has, with what is allowed."""
    method = Method.parse(spelling, 0.0)
    if not engines or any(offers.knows(engine, spelling) for engine in engines):
        return
    for engine in engines:
        if offers.integrator_of(engine, method) is not None:
            offers.check(engine, method)  # it has the integrator, and so says what is wrong with the options
    known = "; ".join(f"{engine.name}: {', '.join(offers.listed(engine))}" for engine in engines)
    meant = did_you_mean(spelling, [name for engine in engines for name in offers.listed(engine)])
    raise BadInput(f"no engine has an integrator {method.integrator!r}; there are: {known}{meant}")


def refuse_nothing(tasks: Sequence[object], engines: Mapping[str, Adapter], integrators: Sequence[str]) -> None:
    """Raises `BadInput` where there are no tasks."""
    if not tasks:
        raise BadInput(f"nothing to run: no case has a scene for which {', '.join(engines)} offer {', '.join(integrators)}")


def _methods(case: Case, name: str, engine: Engine, integrators: Sequence[str], timesteps: Sequence[float]) -> Iterator[Method]:
    for spelling in offers.chosen(engine, case.scene, integrators):
        yield from (Method.parse(spelling, timestep) for timestep in timesteps or (DEFAULT_TIMESTEP,))
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
