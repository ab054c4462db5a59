"""Mechanisms in Brax's pipeline `generalized`, which computes in the coordinates of joints.

The model is the XML of the adapter of MuJoCo. MuJoCo computes the poses of bodies from Brax's coordinates, which have the same
layout as MuJoCo's. An effort is the input of a motor of the joint. Brax ignores the rest position of a spring, so the constant
force that it adds is an input of the motor too. See `align_slides` for slides. Rigid stops are the limits of MuJoCo's XML,
whose law Brax shares; it exerts no force at elastic ones, which need the smallest impedance. Brax refuses ball joints, and has
neither loops nor dry friction. Bodies on fixed joints are not offered, for the same reason as several links; see
`bodycheck.adapters.brax`.
"""

import warnings
from dataclasses import replace
from typing import Any
from xml.etree import ElementTree

import jax
import mujoco
import numpy as np
from brax.generalized import pipeline
from brax.io import mjcf
from jax import numpy as jnp

from bodycheck.adapters.contract import Engine, Method, SceneUnsupported
from bodycheck.adapters.mjx.compiled import Compiled, check_precision, strider
from bodycheck.adapters.mujoco.contact import numbers_written
from bodycheck.adapters.mujoco.driving import indices
from bodycheck.adapters.mujoco.mechanisms import begin, described, seen_states
from bodycheck.adapters.mujoco.models import compiled_model
from bodycheck.adapters.stepping import Taking
from bodycheck.reference.kinematics import multiply, rotate
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.trajectory import Array

#: The features of mechanisms that Brax models; see `Engine.models`.
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
        "massless bodies",
        "controllers",
        "rigid stops",
    }
)


def pushed(mechanism: Mechanism) -> list[int]:
    """Return the joints with a motor: driven ones, and those with an effort or a spring that rests elsewhere than at zero."""
    acting = [bool(joint.effort or (joint.stiffness and joint.rest)) for joint in mechanism.joints]
    return [index for index, acts in enumerate(acting) if acts or index in mechanism.driven]


def for_brax(xml: str, mechanism: Mechanism) -> str:
    """Return the XML of a mechanism for Brax. Raises `SceneUnsupported` for a slide on a body that turns.

    The frames of bodies on slides have the axes of the world, each joint in which an effort acts has a motor, and each
    body has a shape, because Brax needs one.
    """
    root = ElementTree.fromstring(xml)
    align_slides(root)
    actuators = ElementTree.SubElement(root, "actuator")
    for index in pushed(mechanism):
        ElementTree.SubElement(actuators, "motor", joint=mechanism.joints[index].name)
    for body in root.iter("body"):
        ElementTree.SubElement(body, "geom", type="sphere", size="0.1", contype="0", conaffinity="0")
    return ElementTree.tostring(root, encoding="unicode")


def stepped(system_and_inputs: tuple[Any, Any], state: Any) -> Any:
    """Return the state one step after a state; the first argument contains Brax's system and the inputs of its motors."""
    system, inputs = system_and_inputs
    return pipeline.step(system, state, inputs)


#: The functions that take strides of a mechanism, which JAX compiles once for each structure of a system.
TAKE = strider(stepped, lambda state: jnp.concatenate([state.q, state.qd]))
START = jax.jit(pipeline.init)


def prepare(engine: Engine, mechanism: Mechanism, method: Method) -> Compiled | Taking:
    """Return the simulation of a mechanism, as `Adapter.prepare` does. Raises `SceneUnsupported`."""
    check_precision(engine)
    if method.integrator != "generalized":
        raise SceneUnsupported(f"{method.integrator} holds joints by iterations, and only generalized has their coordinates")
    _, xml = described(mechanism, replace(method, integrator="Euler"))
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
        acting = [mechanism.joints[index] for index in pushed(mechanism)]
        inputs = jnp.array([joint.effort + joint.stiffness * joint.rest for joint in acting])
        state = START(system, jnp.array(start.qpos), jnp.array(start.qvel))
        steps = Compiled(TAKE.one, (system, inputs), state, seen_states(mechanism, xml), len(mechanism.bodies))
        return driven(steps, plain, mechanism) if mechanism.driven else steps


def driven(steps: Compiled, plain: Any, mechanism: Mechanism) -> Taking:
    """Return the simulation of a mechanism whose driven joints take efforts, from MuJoCo's model."""
    in_q, in_v = indices(plain, mechanism)
    system, inputs = steps.system
    constant, acting = np.array(inputs), pushed(mechanism)
    in_inputs = [acting.index(index) for index in mechanism.driven]

    def state() -> tuple[Array, Array]:
        q, v = np.array(steps.state.q, dtype=np.float64), np.array(steps.state.qd, dtype=np.float64)
        return q[in_q], v[in_v]

    def apply(efforts: Array) -> None:
        given = constant.copy()
        given[in_inputs] += efforts
        steps.system = (system, jnp.array(given))

    return Taking(steps, state, apply)


UNTURNED = "1 0 0 0"


def align_slides(root: ElementTree.Element) -> None:
    """Turn the frames of all bodies on slides, in MuJoCo's XML of a mechanism, to the axes of the world.

    In each step, Brax's pipeline `generalized` converts the axes of hinges to the world frame, but not the axes of slides: it
    displaces a body along the axis in the body's frame, and computes inertia and forces as if the axis had the same components
    in the world frame. Both agree if the frame of the slide has the axes of the world. A frame that keeps its attitude can be
    replaced by such a frame, by expressing the axes, the inertia and the child bodies along the axes of the world. The frame
    of a slide on a body that turns cannot be replaced.

    Coordinates and motion stay the same. Raises `SceneUnsupported` for a slide on a body that turns.
    """
    for world in root.iter("worldbody"):
        _align(world, turns=False)


def _align(parent: ElementTree.Element, turns: bool) -> None:
    """Align the bodies in a body. `turns` is whether this body rotates; if not, its frame already has the axes of the world."""
    for body in parent.findall("body"):
        kinds = {joint.get("type"): joint for joint in body.findall("joint")}
        if "slide" in kinds:
            order = [joint.get("type") for joint in body.findall("joint")]
            if turns or "hinge" in order[: len(order) - order[::-1].index("slide")]:
                raise SceneUnsupported(
                    f"{kinds['slide'].get('name')} slides on a body that turns, and Brax does not turn the axes of slides"
                )
            turn_content(body, numbers(body.get("quat", UNTURNED)))
            body.set("quat", UNTURNED)
        _align(body, turns or "hinge" in kinds)


def turn_content(body: ElementTree.Element, attitude: Array) -> None:
    """Rotate the content of a body's element by the attitude (4,), w x y z, that is removed from the body's frame.

    The axes of joints, the inertia, and the poses of child bodies are rotated. If the attitude is no rotation, the element
    stays unchanged.
    """
    if not attitude[1:].any():
        return
    for joint in body.findall("joint"):
        joint.set("axis", numbers_written(*rotate(attitude, numbers(joint.get("axis", "")))))
    for child in body.findall("body"):
        child.set("pos", numbers_written(*rotate(attitude, numbers(child.get("pos", "")))))
        child.set("quat", numbers_written(*multiply(attitude, numbers(child.get("quat", UNTURNED)))))
    for inertial in body.findall("inertial"):
        inertial.set("pos", numbers_written(*rotate(attitude, numbers(inertial.get("pos", "")))))
        turned = rotate(attitude, rotate(attitude, tensor_of(inertial)).T)
        inertial.attrib.pop("diaginertia", None)
        inertial.set("fullinertia", numbers_written(*np.diag(turned), turned[0, 1], turned[0, 2], turned[1, 2]))


def tensor_of(inertial: ElementTree.Element) -> Array:
    """Return the inertia tensor (3, 3), kg m^2, of an `inertial` element, along the axes of the body."""
    if (full := inertial.get("fullinertia")) is None:
        return np.diag(numbers(inertial.get("diaginertia", "")))
    xx, yy, zz, xy, xz, yz = numbers(full)
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def numbers(text: str) -> Array:
    """Return the numbers in the text of an attribute."""
    return np.array(text.split(), dtype=float)
