"""Select and check methods for any adapter, and build simulations of one or several scenes.

The functions replace code that every adapter would otherwise repeat. They find which methods an engine offers for a scene,
which parts of a method it does not know, and which requirements of a scene it does not model.
"""

from collections import defaultdict
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

from bodycheck.adapters.contract import (
    Adapter,
    Engine,
    Integrator,
    Kind,
    Method,
    Option,
    SceneUnsupported,
    Sensing,
    SensingSimulation,
    Simulation,
    kind_of,
    single_bodies,
)
from bodycheck.adapters.method import DRIVEN, SENSORS
from bodycheck.adapters.roles import ALIASES, resolved
from bodycheck.adapters.scheduling import driven
from bodycheck.adapters.stepping import InTurn
from bodycheck.errors import BadInput
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.requirements import missing, requirements, touches
from bodycheck.reference.scene import Scene
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.suggestion import did_you_mean


def offered(engine: Engine, scene: AnyScene) -> tuple[str, ...]:
    """Return the spellings of the methods that are run on a scene if the user names none: integrators, then variants.

    An integrator without options that is one of the variants is where it is among them.
    """
    kind = kind_of(scene)
    variants = engine.variants.get(kind, ())
    names = (integrator.name for integrator in engine.integrators if kind in integrator.kinds)
    return (*(name for name in names if name not in variants), *variants)


def listed(engine: Engine) -> tuple[str, ...]:
    """Return the spellings of all methods that are run on at least one kind of scene if the user names none."""
    variants = [name for those in engine.variants.values() for name in those]
    names = [integrator.name for integrator in engine.integrators if integrator.kinds and integrator.name not in variants]
    return tuple(dict.fromkeys((*names, *variants)))


def chosen(engine: Engine, scene: AnyScene, named: Sequence[str]) -> tuple[str, ...]:
    """Return the spellings of the methods to run on a scene.

    Parameters
    ----------
    engine
        The engine that runs the scene.
    scene
        The scene; it decides which methods the engine offers.
    named
        Spellings of methods that the user named, and aliases. If it is empty, all offered methods are returned.

    Returns
    -------
    The named methods that the engine offers for the scene, and the methods behind the named aliases. A method whose options
    are not offered if none is named is included if the engine has its integrator and its options for the scene.
    """
    plain = offered(engine, scene)
    if not named:
        return plain
    names = [Method.parse(spelling, 0.0) for spelling in resolved(engine, kind_of(scene), named)]
    wanted = dict.fromkeys(method.name for method in names)
    others = [method for method in names if method.options and method.name not in plain and knows(engine, method.name)]
    fitting = [method.name for method in others if not_offered(engine, scene, method) is None]
    return (*(name for name in plain if name in wanted), *dict.fromkeys(fitting))


def demonstrations(engine: Engine) -> dict[str, str]:
    """Return the phrases in `Integrator.demonstrates`, keyed by integrator, of the integrators that exist for demonstration."""
    return {integrator.name: integrator.demonstrates for integrator in engine.integrators if integrator.demonstrates}


def integrator_of(engine: Engine, method: Method) -> Integrator | None:
    """Return the integrator of a method; None if the adapter does not know it."""
    return next((integrator for integrator in engine.integrators if integrator.name == method.integrator), None)


def options_of(engine: Engine, integrator: Integrator) -> Mapping[str, Option]:
    """Return the options of an integrator: its own, those of driven mechanisms if the engine takes efforts, and of sensors."""
    driven, sensing = "controllers" in engine.models, "forward" in engine.reads
    return {**integrator.options, **(DRIVEN if driven else {}), **(SENSORS if sensing else {})}


def knows(engine: Engine, spelling: str) -> bool:
    """Return whether an engine has the integrator of a method and accepts its options and their values."""
    try:
        check(engine, Method.parse(spelling, 0.0))
    except BadInput:
        return False
    return True


def check(engine: Engine, method: Method) -> None:
    """Raise `BadInput`, naming what is allowed, if an engine lacks the integrator, an option or a value of a method."""
    integrator = integrator_of(engine, method)
    if integrator is None:
        spellings = listed(engine)
        names = [*(each.name for each in engine.integrators), *ALIASES]
        meant = did_you_mean(method.integrator, names)
        raise BadInput(f"{engine.name} has no integrator {method.integrator!r}; there are: {', '.join(spellings)}{meant}")
    options = options_of(engine, integrator)
    for key, value in method.options:
        if key not in options:
            allowed = ", ".join(options) or "none"
            meant = did_you_mean(key, options)
            raise BadInput(f"{engine.name} {integrator.name} has no option {key!r}; allowed: {allowed}{meant}")
        _check_value(engine, options[key], f"{integrator.name}:{key}={value}", value)


def _check_value(engine: Engine, option: Option, written: str, value: str) -> None:
    if not option.accepts(value):
        meant = did_you_mean(value, option.allowed.replace(" or ", ", ").split(", "))
        raise BadInput(f"{engine.name} {written}: read {value!r}; allowed: {option.allowed}{meant}")


def not_offered(engine: Engine, scene: AnyScene, method: Method) -> str | None:
    """Return which part of a method an engine does not offer for a scene; None if it offers the whole method.

    The text is a predicate whose subject is the engine: "has no integrator 'RK4' for this scene".
    """
    return not_offered_for(engine, kind_of(scene), method)


def not_offered_for(engine: Engine, kind: Kind, method: Method) -> str | None:
    """Return which part of a method an engine does not offer for a kind of scene, as `not_offered` does."""
    integrator = integrator_of(engine, method)
    if integrator is None or kind not in integrator.kinds:
        return f"has no integrator {method.name!r} for this scene"
    if (reason := integrator.refuses.get(kind)) is not None:
        return f"does not model this scene: {integrator.name} {reason}"
    options = options_of(engine, integrator)
    idle = [f"{key}={value}" for key, value in method.options if kind not in options[key].kinds]
    return f"has no option {', '.join(idle)} of {integrator.name!r} for this scene" if idle else None


def not_modelled(engine: Engine, scene: AnyScene, method: Method) -> str | None:
    """Return which requirement of a scene an engine does not model with a method; None if it models all of them.

    The text is a predicate whose subject is the engine: "does not model drag".
    """
    models = engine.models
    if method.option("limits") == "effort":
        stops = [joint.stops for joint in scene.joints if joint.stops is not None] if isinstance(scene, Mechanism) else []
        if not stops:
            return f"has no use of the option limits={method.option('limits')} for a scene without limits"
        if any(each.rigid for each in stops):
            return "does not model rigid stops by efforts (limits=effort): efforts model elastic ones"
        models = models | {"elastic stops"}
    required = missing(scene, models)
    return f"does not model {required}" if required is not None else None


def prepare(adapter: Adapter, scenes: Sequence[AnyScene], method: Method) -> Simulation:
    """Return one simulation of one or more scenes; controllers drive the joints of a mechanism.

    An engine with batching steps several single bodies together if they differ only in their initial states and in the
    properties that `Engine.varies` names, and have the same requirements. All other scenes are stepped one after another.

    Raises `SceneUnsupported` if the adapter does, if the engine's record lacks a requirement of a scene, and for several scenes
    that include mechanisms or touching bodies.
    """
    if len(scenes) > 1 and any(isinstance(scene, Mechanism) or touches(scene) for scene in scenes):
        raise SceneUnsupported("mechanisms and bodies that touch are simulated one by one")
    groups = _groups(adapter.engine, scenes)
    for group in groups:
        if (lacking := not_modelled(adapter.engine, scenes[group[0]], method)) is not None:
            raise SceneUnsupported(f"{adapter.engine.name} {lacking}")
    if len(groups) == 1:
        return driven(adapter.prepare(scenes, method), scenes[0], method)
    return InTurn([(group, adapter.prepare([scenes[index] for index in group], method)) for group in groups])


def prepare_sensing(adapter: Sensing, scene: AnyScene, sensors: Sequence[Sensor], method: Method) -> SensingSimulation:
    """Return the simulation of one scene with sensors that the engine reads; controllers drive the joints of a mechanism.

    Raises `SceneUnsupported` as `prepare` does.
    """
    sensing = adapter.prepare_sensing(scene, sensors, method)
    return replace(sensing, simulation=driven(sensing.simulation, scene, method))


def _groups(engine: Engine, scenes: Sequence[AnyScene]) -> list[list[int]]:
    """Return the groups of scenes that are stepped together, each as a list of the indices of its scenes."""
    if engine.batch == 1 or len(scenes) == 1:
        return [[index] for index in range(len(scenes))]
    alike: dict[object, list[int]] = defaultdict(list)
    for index, scene in enumerate(single_bodies(scenes)):
        alike[_shared(scene, engine.varies)].append(index)
    return list(alike.values())


def _shared(scene: Scene, varies: Collection[str]) -> object:
    """Return the properties, as a hashable object, that all scenes of a group must share.

    The function takes about 2 us a scene. For a flight it does not compute the requirements, which follow from the body, the
    drag, and whether there are gravity and motion.
    """
    needs: object
    if scene.plane is None:
        needs = bool(scene.gravity) or any(scene.initial.velocity), any(scene.initial.angular_velocity)
    else:
        needs = scene.plane, requirements(scene)
    body = None if "body" in varies else scene.body
    return needs, body, bool(scene.gravity) if "gravity" in varies else scene.gravity, scene.drag
