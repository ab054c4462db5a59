"""The adapter of MuJoCo Warp; the docstring of the package describes its scenes, methods and frames."""

from collections.abc import Sequence
from typing import Any

import mujoco_warp as mjw
import numpy as np
import warp as wp
from mujoco import MjData, MjModel, mj_forward

from bodycheck.adapters.contract import (
    KINDS,
    Engine,
    Integrator,
    Kind,
    Method,
    Role,
    SceneUnsupported,
    SensingSimulation,
    Usage,
    single_bodies,
)
from bodycheck.adapters.links import Link
from bodycheck.adapters.mujoco import contact, options, single
from bodycheck.adapters.mujoco import engine as mujoco
from bodycheck.adapters.mujoco.driving import indices
from bodycheck.adapters.mujoco.mechanism_xml import SOFT
from bodycheck.adapters.mujoco.mechanisms import MODELS, begin, described, seen_states
from bodycheck.adapters.mujoco.models import Joints, compiled_model
from bodycheck.adapters.mujoco.sensing import (
    begun,
    description_of_body,
    description_of_mechanism,
    description_of_touching,
    reading_pushed,
)
from bodycheck.adapters.mujoco_warp import INSTALLATION, file_motion, graphs, robots, sensing, touching
from bodycheck.adapters.mujoco_warp.drag import resist
from bodycheck.adapters.stepping import InTurn, Loop, Taking
from bodycheck.adapters.touching import Pushed, lying_shape, touching_bodies
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.requirements import touches
from bodycheck.reference.scene import Scene
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array

#: MuJoCo's options of a contact. Pads are left out, because MuJoCo Warp reserves memory for few contacts, and `noslip`, because
#: MuJoCo Warp has no noslip solver.
OPTIONS = {key: option for key, option in contact.OPTIONS.items() if key not in ("pads", "noslip")}


def integrators() -> tuple[Integrator, ...]:
    """Return MuJoCo's integrators with the orders that it claims; those that MuJoCo Warp lacks are offered for no scene."""
    here = {member.name for member in mjw.IntegratorType}
    return tuple(
        Integrator(
            integrator.name,
            integrator.order,
            integrator.evaluations,
            integrator.kinds if integrator.name.upper() in here else frozenset(),
            OPTIONS,
        )
        for integrator in mujoco.engine.integrators
    )


def defaults() -> dict[str, str]:
    """Return MuJoCo Warp's defaults, which apply to a model without an element `option`."""
    option = mjw.put_model(MjModel.from_xml_string("<mujoco/>")).opt
    return {
        "integrator": options.available()[int(option.integrator)],
        "timestep": f"{option.timestep.numpy()[0]:g} s",
        "tolerance": f"{option.tolerance.numpy()[0]:g} of the constraint solver",
    }


def roles() -> dict[Role, dict[Kind, Usage]]:
    """Return the method of the first steps in MuJoCo Warp's documentation, which recommends no integrator."""
    option = mjw.put_model(MjModel.from_xml_string("<mujoco/>")).opt
    name, timestep = options.available()[int(option.integrator)], float(f"{option.timestep.numpy()[0]:g}")
    usual = Usage(name, timestep, f"{options.DOCUMENTATION}/mjwarp/index.html#minimal-example", reads_timestep=True)
    return {"default": dict.fromkeys(KINDS, usual)}


engine = Engine(
    name="mujoco_warp",
    distribution=INSTALLATION.distribution,
    version=str(mjw.__version__),
    integrators=integrators(),
    models=frozenset({"gravity", "translation", "rotation", "contact", "friction", "drag"}) | MODELS | touching.MODELS,
    variants={"plane": ("Euler:cone=elliptic",), "contact": ("Euler:cone=elliptic",)},
    precision="float32",
    device=graphs.DEVICE,
    batch=2,
    defaults=defaults(),
    roles=roles(),
    soft=SOFT,
    reads=("step", "forward"),
)

calls = graphs.CALLS

read_robot, step_robot, contact_law = robots.read_robot, robots.step_robot, mujoco.contact_law

file_facts, run_file = file_motion.file_facts, file_motion.run_file

lacking, contact_terms, interface_loads = mujoco.lacking, mujoco.contact_terms, touching.interface_loads


def prepare(scenes: Sequence[AnyScene], method: Method) -> Loop[Any] | InTurn | Taking | Pushed[Loop[Any]]:
    """Return the simulation of one or more scenes, as `Adapter.prepare` does.

    Bodies that do not rotate have a separate model for each attitude. These models are stepped one after another.
    """
    if touches(scenes[0]):
        return touching.prepare(scenes[0], method)
    if isinstance(scenes[0], Mechanism):
        return jointed(scenes[0], method)
    bodies = single_bodies(scenes)
    described = [described_by_mujoco(scene, method) for scene in bodies]
    xml, _ = described[0]
    if any(other != xml for other, _ in described):
        parts = zip(described, bodies, strict=True)
        return InTurn(
            [
                ((index,), stepped(*started(xml_of_scene, [joint], scene)))
                for index, ((xml_of_scene, joint), scene) in enumerate(parts)
            ]
        )
    return stepped(*started(xml, [joints for _, joints in described], bodies[0]))


def prepare_links(links: Sequence[Link], scene: Scene, method: Method) -> Loop[Any]:
    """Return the simulation of a free body that is made of links, as `Links.prepare_links` does."""
    xml, joints = single.description_of_links(links, scene, method)
    return stepped(*handed_over(xml, [joints]))


def stepped(model: Any, data: Any, rows: Any) -> Loop[Any]:
    """Return the simulation of a model and data of MuJoCo Warp; `rows` converts coordinates to rows of states."""
    qpos, qvel = data.qpos.numpy(), data.qvel.numpy()  # views of the arrays that are stepped
    graph = graphs.record(lambda: mjw.step(model, data))
    if data.nworld == 1:
        return Loop(graph, graphs.replay, seen=lambda graph: np.concatenate([qpos[0], qvel[0]]), rows=rows)
    return Loop(graph, graphs.replay, seen=lambda graph: np.hstack([qpos, qvel]), rows=rows)


def described_by_mujoco(scene: Scene, method: Method) -> tuple[str, Joints]:
    """Return the XML of a scene and the joints in it. Raises `SceneUnsupported`."""
    if scene.plane is not None:
        lying_shape(scene)
    return single.description(scene, method, single.model_of(scene, method))


def started(xml: str, joints: Sequence[Joints], scene: Scene) -> tuple[Any, Any, Any]:
    """Return MuJoCo Warp's model of scenes, their data in the initial states, and the conversion of coordinates to rows.

    Parameters
    ----------
    xml
        The XML of all scenes.
    joints
        The joints of each, with its initial state.
    scene
        One of the scenes, for its drag.

    Raises
    ------
    SceneUnsupported
        If MuJoCo or MuJoCo Warp refuses the model.
    """
    model, data, rows = handed_over(xml, joints)
    resist(model, scene.drag)
    return model, data, rows


def handed_over(xml: str, joints: Sequence[Joints]) -> tuple[Any, Any, Any]:
    """Return the same objects as `started`, without drag."""
    first = single.started(xml, joints[0])
    try:
        model = mjw.put_model(first.model)
    except NotImplementedError as error:
        raise SceneUnsupported(f"MuJoCo Warp refuses the model: {error}") from error
    # With room for no constraint at all (njmax = 0), most integrators of MuJoCo Warp 4.0.0 ignore all forces.
    data = mjw.put_data(first.model, first.data, nworld=len(joints))
    data.qpos.assign(np.array([joint.qpos for joint in joints]))
    data.qvel.assign(np.array([joint.qvel for joint in joints]))
    return model, data, first.rows


def contact_load(scene: Scene, method: Method, steps: int) -> Array:
    """Return the normal force (n,), in N, in each of n steps; for RK4 it is the force of the last stage."""
    xml, joints = described_by_mujoco(scene, method)
    model, data, _ = started(xml, [joints], scene)
    contacts = wp.array(np.arange(data.naconmax, dtype=np.int32))
    forces = wp.zeros(data.naconmax, dtype=wp.spatial_vector)

    def step() -> None:
        mjw.step(model, data)
        forces.zero_()
        mjw.contact_force(model, data, contacts, False, forces)

    graph, normal = graphs.record(step), forces.numpy()[:, 0]
    return np.array([normal.sum() for _ in range(steps) if graphs.replay(graph)], dtype=np.float64)


def jointed(mechanism: Mechanism, method: Method) -> Loop[Any] | Taking:
    """Return the simulation of a mechanism, whose poses MuJoCo computes after a step. Raises `SceneUnsupported`."""
    mechanism, xml = described(mechanism, method)
    compiled = compiled_model(xml)
    start = MjData(compiled)
    begin(compiled, start, mechanism)
    model, data = from_start(compiled, start)
    loop = stepped(model, data, seen_states(mechanism, xml))
    in_q, in_v = indices(compiled, mechanism)
    return driven(loop, data, in_q, in_v, data.qfrc_applied, in_v) if mechanism.driven else loop


def from_start(compiled: Any, start: Any) -> tuple[Any, Any]:
    """Return MuJoCo Warp's model and data for a model of MuJoCo and its initial data. Raises `SceneUnsupported`."""
    mj_forward(compiled, start)  # so that the data of MuJoCo Warp have room for the constraints
    try:
        model = mjw.put_model(compiled)
    except NotImplementedError as error:
        raise SceneUnsupported(f"MuJoCo Warp refuses the model: {error}") from error
    return model, mjw.put_data(compiled, start)


def driven(loop: Loop[Any], data: Any, in_q: Any, in_v: Any, forces: Any, places: Any) -> Taking:
    """Return the simulation of a mechanism whose driven joints take efforts.

    Parameters
    ----------
    loop, data
        Its simulation and MuJoCo Warp's data.
    in_q, in_v
        The indices (j,) of the driven joints in the coordinates and the velocities.
    forces, places
        Warp's array of the data that has their efforts, and their indices (j,) in it.
    """
    qpos, qvel, acting = data.qpos.numpy(), data.qvel.numpy(), forces.numpy()  # views of the arrays that are stepped
    constant = acting[0, places]

    def state() -> tuple[Array, Array]:
        return qpos[0, in_q].astype(np.float64), qvel[0, in_v].astype(np.float64)

    def apply(efforts: Array) -> None:
        acting[0, places] = constant + efforts

    return Taking(loop, state, apply)


def prepare_sensing(scene: AnyScene, sensors: Sequence[Sensor], method: Method) -> SensingSimulation:
    """Return the simulation of a scene with sensors, as `Sensing.prepare_sensing` does."""
    if touches(scene):
        bodies = touching_bodies(scene)
        model, data = touching.handed_over(bodies, description_of_touching(scene, bodies, sensors, method))
        pushed = touching.stepped(scene, bodies, method, model, data)
        return reading_pushed(pushed, sensing.reading(pushed, model, data, sensors, method))
    if not isinstance(scene, Mechanism):
        if scene.plane is not None:
            lying_shape(scene)
        xml, joints = description_of_body(scene, sensors, method, single.model_of(scene, method))
        model, data, rows = started(xml, [joints], scene)
        return sensing.reading(stepped(model, data, rows), model, data, sensors, method)
    mechanism, xml, with_sensors = description_of_mechanism(scene, sensors, method)
    compiled = compiled_model(with_sensors)
    model, data = from_start(compiled, begun(compiled, mechanism))
    simulation = stepped(model, data, seen_states(mechanism, xml))
    if mechanism.driven:
        motors = [compiled.actuator(mechanism.joints[joint].name).id for joint in mechanism.driven]
        actuated = driven(simulation, data, *indices(compiled, mechanism), data.ctrl, motors)
        return sensing.reading(actuated, model, data, sensors, method)
    return sensing.reading(simulation, model, data, sensors, method)
