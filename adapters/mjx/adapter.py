"""The parts of the adapter of MJX that do not depend on its precision: the record, and the choice of a simulation."""

from collections.abc import Sequence
from dataclasses import replace
from importlib import metadata
from typing import Literal

from bodycheck.adapters.contract import KINDS, Engine, Integrator, Method, choice, single_bodies
from bodycheck.adapters.mjx import touching
from bodycheck.adapters.mjx.compiled import Compiled, device
from bodycheck.adapters.mjx.simulation import jointed, unjointed
from bodycheck.adapters.mujoco import contact, options
from bodycheck.adapters.mujoco.mechanism_xml import SOFT
from bodycheck.adapters.mujoco.mechanisms import MODELS
from bodycheck.adapters.stepping import InTurn, Taking
from bodycheck.adapters.touching import Pushed
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.requirements import touches

#: The page with the first steps of MJX, which take MuJoCo's options. It recommends no integrator.
PAGE = f"{options.DOCUMENTATION}/mjx.html#minimal-example"

#: MuJoCo's contact options. MJX has no noslip solver, and finds no contacts by convex optimisation.
CONTACT_OPTIONS = {key: option for key, option in contact.OPTIONS.items() if key not in ("noslip", "multiccd")}


def record(name: str, distribution: str, precision: Literal["float64", "float32"]) -> Engine:
    """Return the record of MJX in one precision."""
    fluid = {"drag": choice("fluid", kinds=frozenset({"drag"}))}
    return Engine(
        name=name,
        distribution=distribution,
        version=metadata.version(distribution),
        integrators=(
            Integrator("Euler", order=1, evaluations=1, options={**CONTACT_OPTIONS, **fluid}),
            Integrator("RK4", order=4, evaluations=4, options={**CONTACT_OPTIONS, **fluid}),
            Integrator("implicitfast", order=1, evaluations=1, options=CONTACT_OPTIONS),
        ),
        models=frozenset({"gravity", "translation", "rotation", "contact", "friction", "drag"}) | MODELS | touching.MODELS,
        variants={
            "drag": ("Euler:drag=fluid", "RK4:drag=fluid"),
            "plane": ("Euler:cone=elliptic",),
            "contact": ("Euler:cone=elliptic",),
        },
        precision=precision,
        device=device(),
        batch=2,
        defaults=options.defaults(),
        soft=SOFT,
        roles={"default": dict.fromkeys(KINDS, replace(options.roles()["default"]["flight"], page=PAGE))},
        reads=("step", "forward"),
    )


def prepare(engine: Engine, scenes: Sequence[AnyScene], method: Method) -> Compiled | InTurn | Taking | Pushed[Compiled]:
    """Return the simulation of one or more scenes, as `Adapter.prepare` does.

    Raises `SceneUnsupported`, and `RuntimeError` in a process whose precision differs from the engine's.
    """
    if touches(scenes[0]):
        return touching.prepare(engine, scenes[0], method)
    if isinstance(scenes[0], Mechanism):
        return jointed(engine, scenes[0], method)
    return unjointed(engine, single_bodies(scenes), method)
