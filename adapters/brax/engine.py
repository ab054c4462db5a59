"""The adapter of Brax; see `bodycheck.adapters.brax`."""

import contextlib
import inspect
import io
import warnings
from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache, partial
from importlib import metadata
from typing import Any

import jax
from jax import numpy as jnp

from bodycheck.adapters.brax import INSTALLATION
from bodycheck.adapters.contract import (
    KINDS,
    Engine,
    Integrator,
    Kind,
    Method,
    SceneUnsupported,
    SensingSimulation,
    Usage,
    single_bodies,
)
from bodycheck.adapters.links import Link
from bodycheck.adapters.mjx.compiled import Compiled, check_precision, device, strider
from bodycheck.adapters.mujoco.contact import body_geoms, numbers_written
from bodycheck.adapters.mujoco.models import inertial, welded
from bodycheck.adapters.stepping import Taking
from bodycheck.adapters.touching import lying_shape
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.scene import Plane, Scene
from bodycheck.reference.sensors.sensor import Sensor

# MJX prints that the package of its other backend, Warp, is not installed, and old packages that Brax imports give warnings.
with contextlib.redirect_stdout(io.StringIO()), warnings.catch_warnings():
    warnings.simplefilter("ignore")
    from brax import math
    from brax.envs.base import PipelineEnv
    from brax.generalized import pipeline as generalized
    from brax.io import mjcf
    from brax.positional import pipeline as positional
    from brax.spring import pipeline as spring

    from bodycheck.adapters.brax import mechanisms, robots, sensing

XML = """
<mujoco>
  <compiler balanceinertia="false" inertiafromgeom="false"/>
  <option timestep="{timestep!r}" integrator="Euler"/>
  {default}
  <worldbody>
    {plane}
    <body name="body">
      <freejoint/>
      {inertial}
      {shapes}
    </body>
  </worldbody>
</mujoco>
"""

INERTIAL = '<inertial pos="0 0 0" mass="{mass!r}" quat="{axes}" diaginertia="{moments}"/>'

#: The friction of the body and of the plane, with MuJoCo's defaults for torsion and rolling, which Brax does not use.
DEFAULT = '<default><geom friction="{friction!r} 0.005 0.0001"/></default>'

#: Brax does not load a model without a shape; this one touches nothing.
TOUCHES_NOTHING = '<geom type="sphere" size="1" contype="0" conaffinity="0"/>'

PIPELINES = {"generalized": generalized, "positional": positional, "spring": spring}


def defaults() -> dict[str, str]:
    """Return the pipeline of Brax's environments, and the time step of MuJoCo, whose XML Brax reads."""
    return {
        "integrator": str(inspect.signature(PipelineEnv).parameters["backend"].default),
        "timestep": f"{mjcf.mujoco.MjOption().timestep:g} s",
    }


#: Why bodies that roll, bounce or bear each other are `unsupported`.
ENDED: dict[Kind, str] = {"contact": "belongs to an engine whose authors no longer develop its physics"}

#: The pipeline of Brax's environments, at the time step of a model that sets none.
ENVIRONMENT = Usage("generalized", 0.002, "https://github.com/google/brax/blob/main/brax/envs/base.py", reads_timestep=True)

engine = Engine(
    name="brax",
    distribution=INSTALLATION.distribution,
    version=metadata.version(INSTALLATION.distribution),
    # The pipelines themselves call their schemes semi-implicit Euler.
    integrators=tuple(
        Integrator(name, 1, 1, KINDS if name == "generalized" else KINDS - {"mechanism"}, refuses=ENDED) for name in PIPELINES
    ),
    models=frozenset({"gravity", "translation", "rotation", "contact", "friction", "drag"}) | mechanisms.MODELS,
    device=device(),
    batch=2,
    defaults=defaults(),
    roles={"default": dict.fromkeys(sorted(KINDS), ENVIRONMENT)},
    reads=("step",),
)


read_robot, lacking = robots.read_robot, sensing.lacking


def prepare(scenes: Sequence[AnyScene], method: Method) -> Compiled | Taking:
    """Return the simulation of one or more scenes, as `Adapter.prepare` does."""
    if isinstance(scenes[0], Mechanism):
        return mechanisms.prepare(engine, scenes[0], method)
    bodies = single_bodies(scenes)
    (xml,) = {description(scene, method.timestep) for scene in bodies}
    return started(xml, bodies, method)


def prepare_sensing(scene: AnyScene, sensors: Sequence[Sensor], method: Method) -> SensingSimulation:
    """Return the simulation of a scene with sensors, as `Sensing.prepare_sensing` does."""
    simulation = prepare([scene], method)
    steps = simulation.simulation if isinstance(simulation, Taking) else simulation
    assert isinstance(steps, Compiled)
    return SensingSimulation(simulation, partial(sensing.read, scene, sensors, steps))


def prepare_links(links: Sequence[Link], scene: Scene, method: Method) -> Compiled:
    """Return the simulation of a free body that is made of links, as `Links.prepare_links` does."""
    xml = XML.format(
        timestep=method.timestep, default="", plane="", inertial=inertial(links[0]), shapes=TOUCHES_NOTHING + welded(links[1:])
    )
    return started(xml, [scene], method)


def started(xml: str, scenes: Sequence[Scene], method: Method) -> Compiled:
    """Return the simulation of an XML text, with the gravity, the drag and the initial states of scenes.

    Raises `SceneUnsupported` if Brax refuses the model.
    """
    check_precision(engine)
    name, scene = method.integrator, scenes[0]
    gravity, drag = jnp.array([0.0, 0.0, -scene.gravity]), scene.drag / scene.body.mass if scene.drag else None
    q = jnp.array([[*start.initial.position, *start.initial.quaternion] for start in scenes])
    qd = jnp.array([[*start.initial.velocity, *start.initial.angular_velocity] for start in scenes])
    with warnings.catch_warnings():
        # Brax warns at each model that it is no longer developed, and MJX that Brax uses names of older releases.
        warnings.simplefilter("ignore")
        system = loaded(xml)
        system_and_forces = system, gravity, drag
        if len(scenes) == 1:
            return Compiled(TAKE[name].one, system_and_forces, START[name](system, q[0], qd[0]), lambda seen: seen)
        starts = jax.vmap(START[name], in_axes=(None, 0, 0))(system, q, qd)
        return Compiled(TAKE[name].several, system_and_forces, starts, lambda seen: seen)


def description(scene: Scene, timestep: float) -> str:
    """Return the XML of a scene. Raises `SceneUnsupported` if the scene has a plane on which the body does not lie flat."""
    default, plane, geom = "", "", TOUCHES_NOTHING
    if scene.plane is not None:
        (geom,) = body_geoms(lying_shape(scene), 0)
        default, plane = DEFAULT.format(friction=scene.plane.friction), '<geom type="plane" size="0 0 1"/>'
    return XML.format(
        timestep=timestep,
        default=default,
        plane=plane,
        inertial=INERTIAL.format(
            mass=scene.body.mass, axes=numbers_written(*scene.body.axes), moments=numbers_written(*scene.body.moments)
        ),
        shapes=geom,
    )


@lru_cache(maxsize=8)
def loaded(xml: str) -> Any:
    """Return Brax's system of an XML text, without MuJoCo's model in it. Raises `SceneUnsupported` if Brax refuses the text.

    With MuJoCo's model in it, every system would have a different structure, so that no two systems could share compiled code.
    """
    try:
        system = mjcf.loads(xml)
        mjcf.validate_model(system.mj_model)
    except (ValueError, NotImplementedError) as error:
        raise SceneUnsupported(f"Brax refuses the model: {' '.join(str(error).split())}") from error
    return system.replace(mj_model=None)


def step(pipeline: Any, system_and_forces: tuple[Any, Any, Any], state: Any) -> Any:
    """Return the state of a pipeline after one step.

    Parameters
    ----------
    pipeline
        The module of the pipeline.
    system_and_forces
        The system, the acceleration of gravity (3,) in m/s^2, and the coefficient of drag over the mass (1/m) or None.
    state
        The state of the pipeline.
    """
    system, gravity, drag = system_and_forces
    if drag is not None:
        velocity = state.xd.vel[0]
        gravity = gravity - drag * jnp.linalg.norm(velocity) * velocity
    return pipeline.step(system.replace(gravity=gravity), state, jnp.zeros(0))


def seen(state: Any) -> Any:
    """Return the state (13,) of the first link in the columns of the contract."""
    pose, motion = state.x.take(0), state.xd.take(0)
    return jnp.concatenate([pose.pos, pose.rot, motion.vel, math.inv_rotate(motion.ang, pose.rot)])


#: For each pipeline, the functions that take its strides (TAKE) and that return its initial state (START). JAX compiles them
#: once for each structure of a system.
TAKE = {name: strider(partial(step, pipeline), seen) for name, pipeline in PIPELINES.items()}
START = {name: jax.jit(pipeline.init) for name, pipeline in PIPELINES.items()}


def contact_law(scene: Scene, method: Method) -> Plane | None:
    """Return the friction law of a method's contacts; None for `positional` and `spring`, which follow no law of the reference.

    Both compute the impulse of each contact as if it were the only one, and apply the mean of these impulses.
    """
    if scene.plane is None or method.integrator != "generalized":
        return None
    return replace(scene.plane, law="corners", pressure="balanced")
