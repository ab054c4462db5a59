"""What to run: which cases through which engines with which methods."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from bodycheck.adapters.contract import Adapter, Method
from bodycheck.case import Case
from bodycheck.errors import BadInput
from bodycheck.grammar import MOST_STEPS
from bodycheck.simulation import DEFAULT_TIMESTEP, base


@dataclass(frozen=True)
class Task:
    """One run to be made."""

    case: Case
    engine: str
    method: Method


def plan(
    cases: Sequence[Case], engines: Mapping[str, Adapter], integrators: Sequence[str], timesteps: Sequence[float]
) -> tuple[Task, ...]:
    """Every case x engine x integrator x time step (s), each once.

    Without integrators all that an engine offers are run. Without time steps it is 2 ms, and what the expectations of a case
    ask for besides. Raises `BadInput` for an integrator that no engine has and for a time step that cannot be run.
    """
    offered = {name: adapter.integrators() for name, adapter in engines.items()}
    for integrator in integrators:
        if not any(base(integrator) in map(base, those) for those in offered.values()):
            known = "; ".join(f"{engine}: {', '.join(those)}" for engine, those in offered.items())
            raise BadInput(f"no engine has an integrator {integrator!r}; there are: {known}")
    for timestep in timesteps:
        if not all(0 < timestep <= case.duration <= timestep * MOST_STEPS for case in cases):
            raise BadInput(
                f"time step {timestep:g} s: must be positive, at most a case's duration, at least its {MOST_STEPS:.0e}th"
            )
    tasks = tuple(
        Task(case, engine, method)
        for case in cases
        for engine, adapter in engines.items()
        for method in dict.fromkeys(_methods(case, engine, adapter.integrators(case.scene), integrators, timesteps))
    )
    if not tasks:
        raise BadInput(f"nothing to run: no case has a scene for which {', '.join(engines)} offer {', '.join(integrators)}")
    return tasks


def _methods(
    case: Case, engine: str, offered: Sequence[str], integrators: Sequence[str], timesteps: Sequence[float]
) -> Iterator[Method]:
    def wanted(integrator: str) -> bool:
        return not integrators or integrator in integrators

    # A method with options of the user's own is run where the engine has the integrator for this scene.
    optional = [integrator for integrator in integrators if integrator not in offered and base(integrator) in offered]
    for integrator in [*filter(wanted, offered), *optional]:
        yield from (Method(integrator, timestep) for timestep in timesteps or (DEFAULT_TIMESTEP,))
    if not timesteps:
        for expectation in case.expectations:
            if expectation.engine == engine and wanted(expectation.integrator):
                yield Method(expectation.integrator, expectation.timestep)
