"""The adapter of PhysX by SAPIEN: each simulation is a scene with one body, stepped in a Python loop.

The docstring of the package describes the integrators, the settings that are switched off, and the frames that PhysX uses.
"""

import math
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from typing import Any

import numpy as np

from bodycheck.adapters.attitudes import in_body_frame
from bodycheck.adapters.contract import (
    KINDS,
    Engine,
    Integrator,
    Method,
    SensingSimulation,
    Simulation,
    Usage,
    choice,
    states,
)
from bodycheck.adapters.links import Link, velocity_of, velocity_to_origin
from bodycheck.adapters.mechanisms import at_centres
from bodycheck.adapters.sapien import INSTALLATION
from bodycheck.adapters.stepping import Loop, Normalised, Taking, several
from bodycheck.adapters.touching import half_lengths, lying_shape, plane_of, touching_bodies
from bodycheck.reference.inertia import along_principal_axes
from bodycheck.reference.kinematics import conjugate, multiply, normalise, rotate
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.scene import Body, Brick, Plane, Scene, State
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array

with warnings.catch_warnings():
    # SAPIEN warns if it finds no Vulkan, which only its renderer needs.
    warnings.simplefilter("ignore")
    import sapien
    from sapien import physx

    from bodycheck.adapters.sapien import mechanisms, sensing
    from bodycheck.adapters.sapien.links import first_link, load, place, switch_off
    from bodycheck.adapters.sapien.robots import read_robot as read_robot
    from bodycheck.adapters.sapien.robots import step_robot as step_robot

#: The rotation that turns the x axis, which is the normal of PhysX's planes and the axis of its cylinders, to the z axis.
X_TO_Z = (math.sqrt(0.5), 0.0, -math.sqrt(0.5), 0.0)

OPTIONS = {"settings": choice("engine")}
SOLVERS = ("PGS", "TGS")


#: The method of the example with which SAPIEN's tutorial begins, which sets a time step and nothing else.
HELLO_WORLD = Usage(
    "TGS:settings=engine", 0.01, "https://github.com/haosulab/SAPIEN/blob/3.0.0dev/python/py_package/example/hello_world.py"
)


def defaults() -> dict[str, str]:
    """Return the solver and the time step of a new PhysX scene."""
    solver = "TGS" if physx.get_scene_config().enable_tgs else "PGS"
    return {"integrator": solver, "timestep": f"{physx.PhysxCpuSystem().timestep:.6g} s"}


engine = Engine(
    name="sapien",
    distribution=INSTALLATION.distribution,
    version=version(INSTALLATION.distribution),
    integrators=tuple(Integrator(name, order=1, evaluations=1, options=OPTIONS) for name in SOLVERS),
    models=frozenset({"gravity", "translation", "rotation", "contact", "friction", "drag"}) | mechanisms.MODELS,
    variants=dict.fromkeys(sorted(KINDS), tuple(f"{name}:settings=engine" for name in SOLVERS)),
    precision="float32",
    defaults=defaults(),
    roles={"default": dict.fromkeys(sorted(KINDS), HELLO_WORLD)},
    reads=("step",),
)

lacking = sensing.lacking

#: The functions of SAPIEN that steps call from Python.
calls = ((physx.PhysxCpuSystem, "step"), (physx.PhysxRigidDynamicComponent, "add_force_torque"))


@dataclass(frozen=True, eq=False)
class World:
    """A scene of SAPIEN, the PhysX scene in it, and its body, which is the component of an entity."""

    scene: "sapien.Scene"
    system: "physx.PhysxCpuSystem"
    entity: "sapien.Entity"
    body: "physx.PhysxRigidDynamicComponent"


def prepare(scenes: Sequence[AnyScene], method: Method) -> Simulation:
    """Return the simulation of one scene, as `Adapter.prepare` does."""
    (scene,) = scenes
    if isinstance(scene, Mechanism):
        simulation, _ = jointed(scene, method)
        return simulation
    return single(scene, built(scene, method))


def prepare_sensing(scene: AnyScene, sensors: Sequence[Sensor], method: Method) -> SensingSimulation:
    """Return the simulation of a scene with sensors, as `Sensing.prepare_sensing` does."""
    if isinstance(scene, Mechanism):
        jointed_simulation, links = jointed(scene, method)
        return SensingSimulation(jointed_simulation, sensing.of_joints(scene, links, sensors))
    world = built(scene, method)
    return SensingSimulation(single(scene, world), sensing.of_contacts(world.system, world.body, sensors))


def single(scene: Scene, world: World) -> Normalised:
    """Return the simulation of a single body in its world."""
    stepped = resisted_step(scene.drag) if scene.drag else step
    return Normalised(Loop(world, stepped, seen, lambda seen: in_body_frame(scene, rows(seen))))


def jointed(mechanism: Mechanism, method: Method) -> tuple[Normalised | Taking, list[Any]]:
    """Return the simulation of a mechanism, and the links of its bodies. Raises `SceneUnsupported`."""
    system = new_system(mechanism.gravity, method)
    whole = sapien.Scene([system])
    links = mechanisms.built(whole, mechanism, method)

    def step(whole: "sapien.Scene") -> "sapien.Scene":
        system.step()
        return whole  # the state keeps the scene, and with it the links, alive

    simulation = Normalised(Loop(whole, step, lambda _: mechanisms.seen(links), lambda seen: at_centres(mechanism, seen)))
    if not mechanism.driven:
        return simulation, links
    joints = mechanisms.Driven(mechanism, links)
    return Taking(simulation, joints.state, joints.apply), links


def prepare_links(links: Sequence[Link], scene: Scene, method: Method) -> Normalised:
    """Return the simulation of a free body that is made of links, as `Links.prepare_links` does."""
    system = new_system(scene.gravity, method)
    whole = sapien.Scene([system])
    loaded = load(whole, links)
    if method.option("settings") != "engine":
        switch_off(loaded)
    body, initial = first_link(loaded), scene.initial
    centre = body.cmass_local_pose.p
    spin = rotate(np.array(initial.quaternion), np.array(initial.angular_velocity))
    place(loaded, sapien.Pose(initial.position, initial.quaternion), velocity_of(centre, initial), spin.tolist())
    world = World(whole, system, body.entity, body)
    return Normalised(Loop(world, step, seen, lambda seen: velocity_to_origin(rows(seen), centre)))


def rows(seen: Array) -> Array:
    """Return the rows (n, 13) of states from rows (n, 13) of `seen`. Quaternions may have any norm, which they keep."""
    spin = rotate(conjugate(normalise(seen[:, 3:7])), seen[:, 10:])
    return states(seen[:, :3], seen[:, 3:7], seen[:, 7:10], spin)


def seen(world: World) -> Array:
    """Return position, quaternion w x y z, velocity and angular velocity (13,), all in the world frame."""
    pose, body = world.entity.pose, world.body
    return np.concatenate([pose.p, pose.q, body.linear_velocity, body.angular_velocity], dtype=np.float64)


def step(world: World) -> World:
    """Take a time step."""
    world.system.step()
    return world


def resisted_step(drag: float) -> Callable[[World], World]:
    """Return a function that takes a time step with the drag -c |v| v, c in kg/m, at the centre of mass.

    The velocity v is the velocity at the start of the step: the order of a motion with drag is one, whatever PhysX's order is.
    """

    def resisted(world: World) -> World:
        velocity = world.body.linear_velocity
        speed = math.hypot(*velocity.tolist())
        world.body.add_force_torque(-drag * speed * velocity, (0, 0, 0))
        return step(world)

    return resisted


def built(scene: Scene, method: Method) -> World:
    """Return a world with the body of a scene in its initial state. Raises `SceneUnsupported`."""
    shape = collision_shape(scene) if scene.plane is not None else None
    system = new_system(scene.gravity, method)
    whole = sapien.Scene([system])
    if scene.plane is not None:
        add_plane(whole, scene.plane)
    entity, body = moving(whole, scene.body, along_principal_axes(scene).initial, shape, method)
    return World(whole, system, entity, body)


def moving(whole: Any, given: Body, initial: State, shape: Any, method: Method) -> tuple[Any, Any]:
    """Add a body to a scene of SAPIEN, from the initial state of its principal axes, and return its entity and its component.

    shape: the shape of the body; None if it touches nothing.
    """
    body = physx.PhysxRigidDynamicComponent()
    if shape is not None:
        body.attach(shape)
    body.set_mass(given.mass)
    body.set_cmass_local_pose(sapien.Pose())
    body.set_inertia(np.array(given.moments))
    entity = sapien.Entity()
    entity.add_component(body)
    whole.add_entity(entity)
    if method.option("settings") != "engine":
        switch_off(entity)
    spin = rotate(np.array(initial.quaternion), np.array(initial.angular_velocity))
    place(entity, sapien.Pose(initial.position, initial.quaternion), initial.velocity, spin)
    return entity, body


def prepare_boxes(scene: Mechanism, method: Method) -> Normalised:
    """Return the simulation of free boxes that touch, as `Boxes.prepare_boxes` does."""
    system, plane = new_system(scene.gravity, method), plane_of(scene)
    whole = sapien.Scene([system])
    add_plane(whole, plane)
    worlds = []
    for box in touching_bodies(scene):
        shape = physx.PhysxCollisionShapeBox(half_lengths(box), material(plane))
        worlds.append(World(whole, system, *moving(whole, box.body, box.start, shape, method)))
    return Normalised(several(system.step, worlds, seen, rows))


def new_system(gravity: float, method: Method) -> Any:
    """Return a PhysX scene with gravity (m/s^2). SAPIEN's settings of new scenes are global, and are restored afterwards."""
    former = physx.get_scene_config()
    config = physx.PhysxSceneConfig()
    config.gravity = np.array([0, 0, -gravity])
    config.enable_tgs = method.integrator == "TGS"
    physx.set_scene_config(config)
    try:
        system = physx.PhysxCpuSystem()
    finally:
        physx.set_scene_config(former)
    system.set_timestep(method.timestep)
    return system


def add_plane(whole: Any, plane: Plane) -> None:
    """Add the plane z = 0 to a scene."""
    ground = physx.PhysxRigidStaticComponent()
    ground.attach(physx.PhysxCollisionShapePlane(material(plane)))
    entity = sapien.Entity()
    entity.add_component(ground)
    entity.set_pose(sapien.Pose((0, 0, 0), X_TO_Z))
    whole.add_entity(entity)


def collision_shape(scene: Scene) -> Any:
    """Return the shape of a body that lies on the plane, in its principal axes. Raises `SceneUnsupported`."""
    shape = lying_shape(scene)
    assert scene.plane is not None
    axes = conjugate(np.array(scene.body.axes))
    if isinstance(shape, Brick):
        of_shape = physx.PhysxCollisionShapeBox(shape.semi_axes, material(scene.plane))
    else:
        of_shape = physx.PhysxCollisionShapeCylinder(shape.radius, shape.half_length, material(scene.plane))
        axes = multiply(axes, np.array(X_TO_Z))
    of_shape.set_local_pose(sapien.Pose((0, 0, 0), axes))
    return of_shape


def material(plane: Plane) -> Any:
    """Return a material with the coefficients of a plane.

    PhysX uses the mean of the coefficients of two bodies, so the bodies and the plane all get the plane's coefficients.
    """
    return physx.PhysxMaterial(plane.friction, plane.friction, plane.restitution)


def contact_load(scene: Scene, method: Method, steps: int) -> Array:
    """Return the normal force (n,), in N, between body and plane in each of n steps, as `ContactLoad.contact_load` does."""
    world, load = built(scene, method), np.zeros(steps)
    for number in range(steps):
        step(world)
        points = [point for contact in world.system.get_contacts() for point in contact.points]
        load[number] = sum(abs(float(point.impulse @ point.normal)) for point in points) / method.timestep
    return load
