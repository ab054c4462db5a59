"""Step a model of MuJoCo in MJX, in the precision of the process.

MuJoCo computes the poses and velocities of the bodies of a mechanism from MJX's coordinates, because the poses in MJX's data
belong to the start of the step.
"""

import contextlib
import io
from collections.abc import Sequence
from typing import Any

import jax
import mujoco
import numpy as np
from jax import numpy as jnp

from bodycheck.adapters.contract import Engine, Method, SceneUnsupported, kind_of
from bodycheck.adapters.links import Link
from bodycheck.adapters.mjx.compiled import Compiled, check_precision, strider
from bodycheck.adapters.mujoco import single
from bodycheck.adapters.mujoco.driving import indices
from bodycheck.adapters.mujoco.mechanisms import begin, described, seen_states
from bodycheck.adapters.mujoco.models import Joints, compiled_model
from bodycheck.adapters.stepping import InTurn, Taking
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array

with contextlib.redirect_stdout(io.StringIO()):  # MJX prints that the package of its other backend, Warp, is not installed
    from mujoco import mjx as mjx

#: The largest number of scenes that are stepped together; more scenes are stepped in groups. With 10,000 scenes, the threads of
#: XLA waited for each other for ever (JAX on two processors). With 1,000 scenes, the time per scene of a step is as short as
#: with any smaller number.
MOST_TOGETHER = 1000


def jointed(engine: Engine, mechanism: Mechanism, method: Method) -> Compiled | Taking:
    """Return the simulation of a mechanism. Raises as `prepare` does."""
    check_precision(engine)
    mechanism, xml = described(mechanism, method)
    compiled = compiled_model(xml)
    model, data = handed_over(compiled)
    start = mujoco.MjData(compiled)
    begin(compiled, start, mechanism)
    initial_values = {name: jnp.array(getattr(start, name)) for name in ("qpos", "qvel", "qfrc_applied")}
    states = seen_states(mechanism, xml)
    steps = Compiled(TAKE_COORDINATES.one, model, data.replace(**initial_values), states, len(mechanism.bodies))
    return driven(steps, compiled, mechanism) if mechanism.driven else steps


def driven(steps: Compiled, compiled: Any, mechanism: Mechanism, motors: Sequence[int] = ()) -> Taking:
    """Return the simulation of a mechanism whose driven joints take efforts, from MuJoCo's model.

    The efforts are applied forces, or the controls of motors, given by their numbers in the model.
    """
    in_q, in_v = indices(compiled, mechanism)
    name, places = ("ctrl", np.array(motors)) if motors else ("qfrc_applied", in_v)
    constant = np.array(getattr(steps.state, name))

    def state() -> tuple[Array, Array]:
        q, v = steps.state.qpos, steps.state.qvel
        return np.array(q, dtype=np.float64)[in_q], np.array(v, dtype=np.float64)[in_v]

    def apply(efforts: Array) -> None:
        forces = constant.copy()
        forces[places] += efforts
        steps.state = steps.state.replace(**{name: jax.device_put(forces, jax.devices()[0])})

    return Taking(steps, state, apply)


def unjointed(engine: Engine, scenes: Sequence[Scene], method: Method) -> Compiled | InTurn:
    """Return the simulation of one or more single bodies. Raises as `prepare` does."""
    described = [single.description(each, method, model_of(each)) for each in scenes]
    (xml,) = {xml for xml, _ in described}  # a free joint has the initial state in its coordinates
    drag, joints = drag_of(scenes[0], method), [joints_of_scene for _, joints_of_scene in described]
    if len(scenes) <= MOST_TOGETHER:
        return started(engine, xml, joints, drag)
    places = [range(len(scenes))[first : first + MOST_TOGETHER] for first in range(0, len(scenes), MOST_TOGETHER)]
    return InTurn([(part, started(engine, xml, [joints[index] for index in part], drag)) for part in places])


def model_of(scene: Scene) -> str:
    """Return the name of MuJoCo's model of a scene with a free joint."""
    return "six-coordinates" if scene.plane is None else "contact"


def drag_of(scene: Scene, method: Method) -> float | None:
    """Return the coefficient (kg/m) of the force of drag; None without drag, and with MuJoCo's fluid model."""
    return scene.drag if kind_of(scene) == "drag" and method.option("drag") != "fluid" else None


def prepare_links(engine: Engine, links: Sequence[Link], scene: Scene, method: Method) -> Compiled:
    """Return the simulation of a free body that is made of links, as `Links.prepare_links` does.

    Raises as `prepare` does.
    """
    xml, joints = single.description_of_links(links, scene, method)
    return started(engine, xml, [joints], None)


def started(engine: Engine, xml: str, joints: Sequence[Joints], drag: float | None) -> Compiled:
    """Return the simulation of an XML text, from the initial states of one or more free joints.

    `drag` is the coefficient of drag (kg/m), or None without a force of drag. Raises as `prepare` does.
    """
    check_precision(engine)
    model, data = handed_over(compiled_model(xml))
    qpos, qvel = jnp.array([joint.qpos for joint in joints]), jnp.array([joint.qvel for joint in joints])
    if len(joints) == 1:
        return Compiled(TAKE.one, (model, drag), data.replace(qpos=qpos[0], qvel=qvel[0]), lambda seen: seen[:, :13])
    several = jax.vmap(lambda qpos, qvel: data.replace(qpos=qpos, qvel=qvel))(qpos, qvel)
    return Compiled(TAKE.several, (model, drag), several, lambda seen: seen[..., :13])


def handed_over(compiled: Any) -> tuple[Any, Any]:
    """Return MJX's model and data for a model of MuJoCo. Raises `SceneUnsupported` if MJX refuses the model."""
    try:
        return mjx.put_model(compiled), mjx.make_data(compiled)
    except NotImplementedError as error:
        raise SceneUnsupported(f"MJX refuses the model: {error}") from error


def step(system: tuple[Any, Any], data: Any) -> Any:
    """Return MJX's data after one step of a system: a model, and a coefficient of drag (kg/m) or None without drag."""
    model, drag = system
    return mjx.step(model, resisted(data, drag))


def resisted(data: Any, drag: float | None) -> Any:
    """Return MJX's data with the force of drag at its velocity; `drag` is its coefficient (kg/m), or None without drag."""
    if drag is None:
        return data
    velocity = data.qvel[:3]
    force = -drag * jnp.linalg.norm(velocity) * velocity
    return data.replace(xfrc_applied=data.xfrc_applied.at[1, :3].set(force))


def stepped(model: Any, data: Any) -> Any:
    """Return MJX's data after one step of a model."""
    return mjx.step(model, data)


def seen(data: Any) -> Any:
    """Return the coordinates and velocities of a free joint, and the vertical force of all contacts in the last step (14,).

    For RK4 the force is that of the last stage.
    """
    return jnp.concatenate([data.qpos, data.qvel, data.qfrc_constraint[2:3]])


#: The functions that take strides of a free joint, which JAX compiles once for each structure of a model.
TAKE = strider(step, seen)

#: The functions that take strides of a mechanism, which JAX compiles once for each structure of a model.
TAKE_COORDINATES = strider(stepped, lambda data: jnp.concatenate([data.qpos, data.qvel]))


def contact_load(engine: Engine, scene: Scene, method: Method, steps: int) -> Array:
    """Return the normal force (n,), in N, in each of n steps; for RK4 it is the force of the last stage."""
    simulation = unjointed(engine, [scene], method)
    assert isinstance(simulation, Compiled)  # of one scene
    return simulation.seen(np.ones(steps, dtype=np.int64))[:, 13]
