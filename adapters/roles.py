"""The aliases `default` and `recommended`: the methods of an engine behind them, as its record `Engine.roles` names them."""

from collections.abc import Collection, Iterable
from typing import get_args

from bodycheck.adapters.contract import Engine, Kind, Method, Role, Usage

#: The aliases, which are allowed instead of spellings of methods.
ALIASES: tuple[Role, ...] = get_args(Role)

#: What an engine lacks that has no method of a role, as a predicate whose subject is the engine.
LACKING: dict[Role, str] = {
    "default": "has no default method: it has no stepper of its own, or its adapter names none",
    "recommended": "has no recommended method: its documentation recommends none, or its adapter names none",
}


def alias(spelling: str) -> Role | None:
    """Return the role of which a text is the alias; None for the spelling of a method."""
    return next((role for role in ALIASES if role == spelling), None)


def aliases(spellings: Iterable[str]) -> tuple[Role, ...]:
    """Return the aliases among spellings of methods, each once, in the order of `ALIASES`."""
    named = frozenset(spellings)
    return tuple(role for role in ALIASES if role in named)


def spelled(spellings: Iterable[str]) -> tuple[str, ...]:
    """Return the spellings of methods that are no aliases."""
    return tuple(spelling for spelling in spellings if spelling not in ALIASES)


def usage(engine: Engine, kind: Kind, role: Role) -> Usage | None:
    """Return the method of a role for a kind of scene; None if the engine's record names none."""
    return engine.roles.get(role, {}).get(kind)


def in_words(engine: Engine, role: Role) -> str:
    """Return the methods of a role with their time steps, each with the kinds of scene if these have different methods."""
    kinds: dict[str, list[str]] = {}
    for kind, one in engine.roles.get(role, {}).items():
        kinds.setdefault(f"{one.method} {_step_in_words(engine, one)}", []).append(kind)
    if len(kinds) == 1:
        return next(iter(kinds))
    return "; ".join(f"{method} ({', '.join(sorted(of_method))})" for method, of_method in kinds.items())


def pages(engine: Engine) -> tuple[str, ...]:
    """Return the addresses of the pages that show or recommend the methods of an engine, each once."""
    return tuple(dict.fromkeys(one.page for role in ALIASES for one in engine.roles.get(role, {}).values()))


def _step_in_words(engine: Engine, one: Usage) -> str:
    if one.timestep is not None:
        return f"{one.timestep:g} s"
    return "at most the sampling interval" if engine.largest_step is None else f"at most {engine.largest_step:g} s"


def is_of(engine: Engine, integrator: str, role: Role) -> bool:
    """Return whether the spelling of a method is that of a role for any kind of scene."""
    return integrator in {Method.parse(one.method, 0.0).name for one in engine.roles.get(role, {}).values()}


def resolved(engine: Engine, kind: Kind, spellings: Collection[str]) -> tuple[str, ...]:
    """Return spellings of methods in which each alias is replaced by the spelling of its method for a kind of scene.

    Aliases without a method for this kind are left out.
    """
    usages = (usage(engine, kind, role) for role in aliases(spellings))
    return tuple(dict.fromkeys((*spelled(spellings), *(one.method for one in usages if one is not None))))
