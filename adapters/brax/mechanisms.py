"""Mechanisms in Brax's pipeline `generalized`, which computes in the coordinates of joints.

The model is the XML of the adapter of MuJoCo, which computes the poses of bodies from Brax's coordinates, whose layout is
MuJoCo's. A constant effort is the input of a motor of the joint, and so is what the rest position adds to the force of a
spring, which Brax does not know. Slides are written as the module `slides` says. Brax refuses ball joints, and has neither
loops nor dry friction. Bodies on fixed joints are not offered for the reason for which several links are refused; see
`bodycheck.adapters.brax`.
"""

import warnings
from typing import Any
from xml.etree import ElementTree

import jax
import mujoco
from brax.generalized import pipeline
from brax.io import mjcf
from jax import numpy as jnp

from bodycheck.adapters.brax.slides import align_slides
from bodycheck.adapters.contract import Engine, Method, SceneUnsupported
from bodycheck.adapters.mjx.compiled import Compiled, check_precision, strider
from bodycheck.adapters.mujoco.compiling import compiled_model
from bodycheck.adapters.mujoco.mechanism_xml import document
from bodycheck.adapters.mujoco.mechanisms import begin, states_of
from bodycheck.reference.mechanisms.mechanism import Joint, Mechanism

#: What Brax models of mechanisms; see `Engine.models`.
MODELS = frozenset(
    {
        "mechanisms",
        "revolute joints",
        "prismatic joints",
        "planar joints",
        "universal joints",
        "armature",
        "joint damping",
        "joint springs",
        "joint efforts",
    }
)


def pushed(joint: Joint) -> bool:
    """Return whether a constant force acts in a joint."""
    return bool(joint.effort or (joint.stiffness and joint.rest))


def for_brax(xml: str, mechanism: Mechanism) -> str:
    """Return the XML of a mechanism for Brax. Raises `SceneUnsupported` for a slide on a body that turns.

    Bodies on slides are along the axes of the world, each joint in which a constant force acts has a motor, and each body has a
    shape, which Brax needs.
    """
    root = ElementTree.fromstring(xml)
    align_slides(root)
    actuators = ElementTree.SubElement(root, "actuator")
    for joint in mechanism.joints:
        if pushed(joint):
            ElementTree.SubElement(actuators, "motor", joint=joint.name)
    for body in root.iter("body"):
        ElementTree.SubElement(body, "geom", type="sphere", size="0.1", contype="0", conaffinity="0")
    return ElementTree.tostring(root, encoding="unicode")


def stepped(given: tuple[Any, Any], state: Any) -> Any:
    """Return the state after one step, from Brax's system with the inputs of its motors, and the state."""
    system, inputs = given
    return pipeline.step(system, state, inputs)


#: Takes strides of a mechanism; compiled once for each structure of a system.
TAKE = strider(stepped, lambda state: jnp.concatenate([state.q, state.qd]))
START = jax.jit(pipeline.init)


def prepare(engine: Engine, mechanism: Mechanism, method: Method) -> Compiled:
    """Return the simulation of a mechanism, as `Adapter.prepare` does. Raises `SceneUnsupported`."""
    check_precision(engine)
    if method.integrator != "generalized":
        raise SceneUnsupported(f"{method.integrator} holds joints by iterations, and only generalized has their coordinates")
    xml = document(mechanism, method.timestep, "Euler", {})
    plain = compiled_model(xml)
    with warnings.catch_warnings():
        # Brax warns at each model that it is no longer developed, and MJX that Brax uses names of older releases.
        warnings.simplefilter("ignore")
        try:
            system = mjcf.loads(for_brax(xml, mechanism))
            mjcf.validate_model(system.mj_model)
        except (ValueError, NotImplementedError, RuntimeError) as error:
            raise SceneUnsupported(f"Brax refuses the model: {' '.join(str(error).split())}") from error
        system = system.replace(mj_model=None)
        start = mujoco.MjData(plain)
        begin(plain, start, mechanism)
        inputs = jnp.array([joint.effort + joint.stiffness * joint.rest for joint in mechanism.joints if pushed(joint)])
        state = START(system, jnp.array(start.qpos), jnp.array(start.qvel))
        states = states_of(plain, [body.name for body in mechanism.bodies])
        return Compiled(TAKE.one, (system, inputs), state, states, len(mechanism.bodies))
