"""The adapter of PhysX by SAPIEN: each simulation is a scene with one body, stepped in a Python loop.

The docstring of the package describes the integrators, the settings that are switched off, and the frames that PhysX uses.
"""

import math
import warnings
from collections.abc import Callable, Sequence
from functools import partial
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
)
from bodycheck.adapters.links import Link, velocity_of, velocity_to_origin
from bodycheck.adapters.mechanisms import at_centres
from bodycheck.adapters.pair_coefficients import Coefficients
from bodycheck.adapters.sapien import INSTALLATION
from bodycheck.adapters.stepping import Loop, Normalised, Taking
from bodycheck.adapters.touching import lying_shape
from bodycheck.reference.inertia import along_principal_axes
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.requirements import free_bodies_touch
from bodycheck.reference.scene import Scene
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array

with warnings.catch_warnings():
    # SAPIEN warns if it finds no Vulkan, which only its renderer needs.
    warnings.simplefilter("ignore")
    import sapien
    from sapien import physx

    from bodycheck.adapters.sapien import file_motion, gripping, mechanisms, sensing, touching
    from bodycheck.adapters.sapien.links import first_link, load, place, switch_off
    from bodycheck.adapters.sapien.robots import read_robot as read_robot
    from bodycheck.adapters.sapien.robots import step_robot as step_robot
    from bodycheck.adapters.sapien.worlds import World, add_plane, collision_shape, moving, new_system, rows, seen

OPTIONS = {"settings": choice("engine"), **touching.OPTIONS}
SOLVERS = ("PGS", "TGS")

#: The methods with SAPIEN's own damping, limits and sleeping.
ENGINE_SETTINGS = tuple(f"{name}:settings=engine" for name in SOLVERS)

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
    models=frozenset(
        {
            "gravity",
            "translation",
            "rotation",
            "contact",
            "friction",
            "drag",
            *mechanisms.MODELS,
            *touching.MODELS,
            *gripping.MODELS,
        }
    ),
    variants={**dict.fromkeys(sorted(KINDS), ENGINE_SETTINGS), "contact": (*ENGINE_SETTINGS, *touching.BOUNCING)},
    precision="float32",
    defaults=defaults(),
    roles={"default": dict.fromkeys(sorted(KINDS), HELLO_WORLD)},
    combines={"friction": "mean", "restitution": "mean"},
    reads=("step",),
)

lacking, interface_loads, contact_terms = sensing.lacking, touching.interface_loads, touching.contact_terms
file_facts, run_file = partial(file_motion.file_facts, SOLVERS), partial(file_motion.run_file, SOLVERS)

#: The functions of SAPIEN that steps call from Python.
calls = ((physx.PhysxCpuSystem, "step"), (physx.PhysxRigidDynamicComponent, "add_force_torque"))


def prepare(scenes: Sequence[AnyScene], method: Method) -> Simulation:
    """Return the simulation of one scene, as `Adapter.prepare` does."""
    (scene,) = scenes
    if free_bodies_touch(scene):
        return touching.prepare(scene, method)
    if isinstance(scene, Mechanism):
        simulation, _ = jointed(scene, method)
        return simulation
    return single(scene, built(scene, method))


def prepare_sensing(scene: AnyScene, sensors: Sequence[Sensor], method: Method) -> SensingSimulation:
    """Return the simulation of a scene with sensors, as `Sensing.prepare_sensing` does."""
    if free_bodies_touch(scene):
        bodies = touching.built(scene, method)
        components = [world.body for world in bodies.worlds]
        return SensingSimulation(touching.simulated(scene, bodies), sensing.of_contacts(bodies.system, components, sensors))
    if isinstance(scene, Mechanism):
        jointed_simulation, links = jointed(scene, method)
        return SensingSimulation(jointed_simulation, sensing.of_joints(scene, links, sensors))
    world = built(scene, method)
    return SensingSimulation(single(scene, world), sensing.of_contacts(world.system, [world.body], sensors))


def single(scene: Scene, world: World) -> Normalised:
    """Return the simulation of a single body in its world."""
    stepped = resisted_step(scene.drag) if scene.drag else step
    return Normalised(Loop(world, stepped, seen, lambda seen: in_body_frame(scene, rows(seen))))


def jointed(mechanism: Mechanism, method: Method) -> tuple[Normalised | Taking, list[Any]]:
    """Return the simulation of a mechanism, and the links of its bodies. Raises `SceneUnsupported`."""
    system = new_system(mechanism.gravity, method)
    whole = sapien.Scene([system])
    links = mechanisms.built(whole, mechanism, method, lambda builders: gripping.add_shapes(builders, mechanism, method))

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
    plane = scene.plane
    given = None if plane is None else Coefficients(plane.friction, plane.restitution)
    shape = None if given is None else collision_shape(lying_shape(scene), scene.body.axes, given)
    system = new_system(scene.gravity, method)
    whole = sapien.Scene([system])
    if given is not None:
        add_plane(whole, 0.0, given)
    entity, body = moving(whole, scene.body, along_principal_axes(scene).initial, shape, method)
    return World(whole, system, entity, body)


def contact_load(scene: Scene, method: Method, steps: int) -> Array:
    """Return the normal force (n,), in N, between body and plane in each of n steps, as `ContactLoad.contact_load` does."""
    world, load = built(scene, method), np.zeros(steps)
    for number in range(steps):
        step(world)
        points = [point for contact in world.system.get_contacts() for point in contact.points]
        load[number] = sum(abs(float(point.impulse @ point.normal)) for point in points) / method.timestep
    return load
