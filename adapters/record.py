"""Check the record of an engine, which may come from another package and hold anything."""

from typing import get_args

from bodycheck.adapters.contract import KINDS, Engine, Integrator, Option, Varied
from bodycheck.adapters.method import MAX_NAME_LENGTH, is_name

#: All that engines may let differ between scenes that they step together.
VARIED = frozenset(get_args(Varied))

#: What `is_name` demands of a name.
RULE = f"text of 1 to {MAX_NAME_LENGTH} printable characters that begins with a letter or digit"


def fault_of(engine: object) -> str | None:
    """Return what is wrong with the record of an engine, as a clause without a subject's name; None if it is complete."""
    if not isinstance(engine, Engine):
        return f"its record is of the type {type(engine).__name__}, not Engine"
    for key in ("name", "distribution", "version"):
        if not _is_name(getattr(engine, key)):
            return f"its {key} is {_shown(getattr(engine, key))}, not {RULE}"
    if not isinstance(engine.integrators, tuple) or not all(isinstance(own, Integrator) for own in engine.integrators):
        return f"its integrators are {_shown(engine.integrators)}, not a tuple of Integrator"
    if type(engine.models) is not frozenset or not all(type(name) is str for name in engine.models):
        return f"its models are {_shown(engine.models)}, not a frozenset of names"
    if type(engine.batch) is not int or engine.batch < 1:
        return f"its batch is {_shown(engine.batch)}, not an integer of at least 1"
    if type(engine.varies) is not frozenset or not engine.varies <= VARIED:
        return f"its varies is {_shown(engine.varies)}, not a frozenset of {', '.join(sorted(VARIED))}"
    return next(
        (fault for own in engine.integrators if (fault := _fault_of_integrator(own)) is not None), _fault_of_variants(engine)
    )


def _fault_of_integrator(own: Integrator) -> str | None:
    if not _is_name(own.name):
        return f"an integrator is named {_shown(own.name)}, not by {RULE}"
    if not set(own.kinds) <= KINDS:
        return f"its integrator {own.name} is for the kinds {_shown(own.kinds)}; allowed: {', '.join(sorted(KINDS))}"
    if not all(_is_name(key) and isinstance(option, Option) for key, option in own.options.items()):
        return f"its integrator {own.name} has the options {_shown(own.options)}, not values of the type Option by their names"
    if type(own.demonstrates) is not str or not own.demonstrates.isprintable():
        return f"its integrator {own.name} demonstrates {_shown(own.demonstrates)}, not text of printable characters"
    return None


def _fault_of_variants(engine: Engine) -> str | None:
    for kind, spellings in engine.variants.items():
        if kind not in KINDS or not all(_is_name(spelling) for spelling in spellings):
            return f"its variants for {_shown(kind)} are {_shown(spellings)}, not spellings of methods"
    return None


def _is_name(value: object) -> bool:
    return type(value) is str and is_name(value)


def _shown(value: object) -> str:
    """Return a short description of a value in printable characters."""
    text = ascii(value)
    return text if len(text) <= 80 else f"{text[:80]}…"
