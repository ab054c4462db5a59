"""What to run: which cases through which engines with which methods."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

from bodycheck.adapters.contract import Adapter, Method
from bodycheck.casefile.case import Case
from bodycheck.casefile.expectation import REFINEMENTS
from bodycheck.casefile.grammar import MOST_STEPS
from bodycheck.casefile.suggestion import did_you_mean
from bodycheck.errors import BadInput
from bodycheck.running.simulation import DEFAULT_TIMESTEP, base


@dataclass(frozen=True)
class Task:
    """One run to be made."""

    case: Case
    engine: str
    method: Method


#: From cases, engines by name, integrators and time steps (s) to what is to be run.
Plan = Callable[[Sequence[Case], Mapping[str, Adapter], Sequence[str], Sequence[float]], tuple[Task, ...]]


def plan(
    cases: Sequence[Case], engines: Mapping[str, Adapter], integrators: Sequence[str], timesteps: Sequence[float]
) -> tuple[Task, ...]:
    """Every case x engine x integrator x time step (s), each once.

    Without integrators all that an engine offers are run. Without time steps it is 2 ms, and what the expectations of a case
    ask for besides. Raises `BadInput` for an integrator that no engine has and for a time step that cannot be run.
    """
    check(cases, engines, integrators, timesteps or (DEFAULT_TIMESTEP,))
    tasks = tuple(
        Task(case, engine, method)
        for case in cases
        for engine, adapter in engines.items()
        for method in dict.fromkeys(_methods(case, engine, adapter.integrators(case.scene), integrators, timesteps))
    )
    refuse_nothing(tasks, engines, integrators)
    return tasks


def check(
    cases: Sequence[Case], engines: Mapping[str, Adapter], integrators: Sequence[str], timesteps: Sequence[float]
) -> None:
    """Raises `BadInput` for an integrator that no engine has and for a time step (s) that cannot be run."""
    offered = {name: adapter.integrators() for name, adapter in engines.items()}
    for integrator in integrators:
        if not any(base(integrator) in map(base, those) for those in offered.values()):
            known = "; ".join(f"{engine}: {', '.join(those)}" for engine, those in offered.items())
            meant = did_you_mean(integrator, [name for those in offered.values() for name in those])
            raise BadInput(f"no engine has an integrator {integrator!r}; there are: {known}{meant}")
    for case, timestep in product(cases, timesteps):
        if not 0 < timestep <= case.duration <= timestep * MOST_STEPS:
            least = case.duration / MOST_STEPS
            raise BadInput(
                f"{case.name}: time step {timestep:g} s: must be positive, at most its duration, {case.duration:g} s, and at "
                f"least {least:g} s, which makes {MOST_STEPS:.0e} steps"
            )


def refuse_nothing(tasks: Sequence[object], engines: Mapping[str, Adapter], integrators: Sequence[str]) -> None:
    """Raises `BadInput` where there are no tasks."""
    if not tasks:
        raise BadInput(f"nothing to run: no case has a scene for which {', '.join(engines)} offer {', '.join(integrators)}")


def chosen(offered: Sequence[str], integrators: Sequence[str]) -> tuple[str, ...]:
    """Of the integrators that an engine offers for a scene, those that were asked for; all where none was.

    One with options of the user's own is among them where the engine has the integrator.
    """
    listed = [integrator for integrator in offered if not integrators or integrator in integrators]
    optional = [integrator for integrator in integrators if integrator not in offered and base(integrator) in offered]
    return (*listed, *optional)


def _methods(
    case: Case, engine: str, offered: Sequence[str], integrators: Sequence[str], timesteps: Sequence[float]
) -> Iterator[Method]:
    for integrator in chosen(offered, integrators):
        yield from (Method(integrator, timestep) for timestep in timesteps or (DEFAULT_TIMESTEP,))
    if not timesteps:
        for expectation in case.expectations:
            if expectation.engine == engine and (not integrators or expectation.integrator in integrators):
                finer = REFINEMENTS if expectation.needs_order else ()
                yield from (Method(expectation.integrator, expectation.timestep / by) for by in (1, *finer))
