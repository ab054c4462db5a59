"""The methods behind the aliases `default` and `recommended` in a case: each with the time step that belongs to it."""

from collections.abc import Collection, Iterator, Mapping, Sequence

from bodycheck.adapters import offers
from bodycheck.adapters.contract import Engine, Kind, Method, Role, Usage, kind_of
from bodycheck.adapters.roles import ALIASES, LACKING, alias, aliases, usage
from bodycheck.casefile.content import Case
from bodycheck.errors import BadInput
from bodycheck.running.instants import check_timestep, default_timestep

#: The kinds of scenes in words.
KINDS: dict[Kind, str] = {
    "flight": "free flight",
    "drag": "drag",
    "plane": "a body that slides on a plane",
    "mechanism": "mechanisms",
    "contact": "bodies that touch",
}

#: The text between the roles of a method that has both.
BOTH = ", "


def method_of(engine: Engine, case: Case, integrator: str, timestep: float | None) -> Method:
    """Return the method with a spelling or an alias in a case.

    Parameters
    ----------
    engine
        The record of the engine.
    case
        The case.
    integrator
        The spelling of the method, or an alias.
    timestep
        The time step (s); None for the time step of the alias, or the default time step of the method.

    Raises
    ------
    BadInput
        If the engine has no such method, the time step is not possible, or it is named beside an alias.
    """
    if (role := alias(integrator)) is None:
        method = Method.parse(integrator, 0.0)
        offers.check(engine, method)
        method = method.at(default_timestep(engine, case, method) if timestep is None else timestep)
    else:
        refuse_timesteps((integrator,), () if timestep is None else (timestep,))
        if (named := method_in_role(engine, case, role)) is None:
            raise BadInput(f"--integrator {role}: {engine.name} {without(engine, role, KINDS[kind_of(case.scene)])}")
        method = named
    check_timestep(case, method.timestep)
    return method


def method_in_role(engine: Engine, case: Case, role: Role) -> Method | None:
    """Return the method of a role in a case, with its time step; None if the engine's record names none for the scene."""
    named = usage(engine, kind_of(case.scene), role)
    return None if named is None else Method.parse(named.method, 0.0).at(_timestep(engine, case, named))


def _timestep(engine: Engine, case: Case, named: Usage) -> float:
    """Return the time step (s) of a method: the one in the file of a robot model, if the engine reads it, or its own."""
    if named.reads_timestep and case.timestep is not None:
        return case.timestep
    if named.timestep is not None:
        return named.timestep
    return default_timestep(engine, case, Method.parse(named.method, 0.0))


def methods_of(engine: Engine, case: Case, roles: Collection[Role] = ALIASES) -> tuple[Method, ...]:
    """Return the methods of some roles in a case, each once."""
    methods = (method_in_role(engine, case, role) for role in roles)
    return tuple(dict.fromkeys(method for method in methods if method is not None))


def roles_of(engine: Engine, case: Case, method: Method) -> str:
    """Return the roles of a method in a case, as the column `role` has them; empty if it has none."""
    named = ((role, method_in_role(engine, case, role)) for role in ALIASES)
    return BOTH.join(role for role, one in named if one is not None and one.name == method.name and one.is_at(method.timestep))


def without(engine: Engine, role: Role, kinds: str) -> str:
    """Return what an engine lacks without a method of a role, as a predicate. kinds: the kinds of scenes, in words."""
    return f"has no {role} method for {kinds}" if engine.roles.get(role) else LACKING[role]


def refuse_timesteps(integrators: Sequence[str], timesteps: Sequence[float]) -> None:
    """Raise `BadInput` if time steps are named beside an alias, whose method has its own time step."""
    if timesteps and (named := aliases(integrators)):
        raise BadInput(
            f"--timestep {timesteps[0]:g} beside --integrator {named[0]}: this method has its own time step; leave out "
            "--timestep, or spell the method"
        )


def lacking(cases: Sequence[Case], records: Mapping[str, Engine], integrators: Sequence[str]) -> Iterator[str]:
    """Yield a sentence for each engine that has no method of a named alias, or none for scenes of the cases.

    records: the records of the engines by name.
    """
    kinds = dict.fromkeys(kind_of(case.scene) for case in cases)
    for name, record in records.items():
        for role in aliases(integrators):
            if absent := [KINDS[kind] for kind in kinds if usage(record, kind, role) is None]:
                yield f"{name} {without(record, role, ', '.join(absent))}"
