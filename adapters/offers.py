"""What the core does once for all adapters: which methods an engine offers, what is misspelled, and several scenes."""

from collections.abc import Iterable, Sequence

import numpy as np

from bodycheck.adapters.contract import Adapter, Engine, Integrator, Method, Option, Simulation, Strides, kind_of
from bodycheck.errors import BadInput
from bodycheck.reference.requirements import missing
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array
from bodycheck.suggestion import did_you_mean


def offered(engine: Engine, scene: Scene) -> tuple[str, ...]:
    """The spellings of the methods that are run on a scene where none is asked for: integrators, then variants."""
    kind = kind_of(scene)
    return (*(own.name for own in engine.integrators if kind in own.kinds), *engine.variants.get(kind, ()))


def listed(engine: Engine) -> tuple[str, ...]:
    """The spellings of all methods that are run on any scene where none is asked for."""
    names = [own.name for own in engine.integrators if own.kinds]
    return tuple(dict.fromkeys((*names, *(name for those in engine.variants.values() for name in those))))


def chosen(engine: Engine, scene: Scene, asked: Sequence[str]) -> tuple[str, ...]:
    """Of the methods for a scene, the spellings of those that were asked for; all that are offered where none was.

    A method with options that are not offered unasked is among them where the engine offers its integrator for the scene.
    """
    plain = offered(engine, scene)
    if not asked:
        return plain
    names = [Method.parse(spelling, 0.0) for spelling in asked]
    wanted = dict.fromkeys(method.name for method in names)
    own = [method.name for method in names if method.options and method.name not in plain and method.integrator in plain]
    return (*(name for name in plain if name in wanted), *dict.fromkeys(name for name in own if knows(engine, name)))


def integrator_of(engine: Engine, method: Method) -> Integrator | None:
    """The integrator of a method; None where the adapter does not know it."""
    return next((own for own in engine.integrators if own.name == method.integrator), None)


def knows(engine: Engine, spelling: str) -> bool:
    """Whether an engine has the integrator and the options of a method, with these values."""
    try:
        check(engine, Method.parse(spelling, 0.0))
    except BadInput:
        return False
    return True


def check(engine: Engine, method: Method) -> None:
    """Raises `BadInput` for an integrator, an option or a value that an engine does not have, with what is allowed."""
    own = integrator_of(engine, method)
    if own is None:
        known = listed(engine)
        names = [integrator.name for integrator in engine.integrators]
        meant = did_you_mean(method.integrator, names)
        raise BadInput(f"{engine.name} has no integrator {method.integrator!r}; there are: {', '.join(known)}{meant}")
    for key, value in method.options:
        if key not in own.options:
            allowed = ", ".join(own.options) or "none"
            meant = did_you_mean(key, own.options)
            raise BadInput(f"{engine.name} {own.name} has no option {key!r}; allowed: {allowed}{meant}")
        _check_value(engine, own.options[key], f"{own.name}:{key}={value}", value)


def _check_value(engine: Engine, option: Option, written: str, value: str) -> None:
    try:
        option.read(value)
    except ValueError as error:
        meant = did_you_mean(value, option.allowed.replace(" or ", ", ").split(", "))
        raise BadInput(f"{engine.name} {written}: read {value!r}; allowed: {option.allowed}{meant}") from error


def not_offered(engine: Engine, scene: Scene, method: Method) -> str | None:
    """What of a method an engine does not have for a scene, as a predicate; None where it has all of it."""
    kind, own = kind_of(scene), integrator_of(engine, method)
    if own is None or kind not in own.kinds:
        return f"has no integrator {method.name!r} for this scene"
    idle = [f"{key}={value}" for key, value in method.options if kind not in own.options[key].kinds]
    return f"has no option {', '.join(idle)} of {own.name!r} for this scene" if idle else None


def not_modelled(engine: Engine, scene: Scene) -> str | None:
    """What a scene requires and an engine does not model, as a predicate; None where nothing is missing."""
    required = missing(scene, engine.models)
    return f"does not model {required}" if required is not None else None


def prepare(adapter: Adapter, scenes: Sequence[Scene], method: Method) -> Simulation:
    """A simulation of all scenes, those of an engine that steps one at a time one after another.

    Raises `SceneUnsupported`.
    """
    if len(scenes) == 1 or adapter.engine.batch > 1:
        return adapter.prepare(scenes, method)
    return OneByOne(adapter.prepare([scene], method) for scene in scenes)


class OneByOne:
    """Simulations of one scene each, advanced in turn."""

    def __init__(self, simulations: Iterable[Simulation]) -> None:
        self.simulations = tuple(simulations)

    def advance(self, strides: Strides) -> Array:
        return np.concatenate([simulation.advance(strides) for simulation in self.simulations])
