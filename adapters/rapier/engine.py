"""The adapter of Rapier: each simulation is a world with one body, stepped in a Python loop.

The docstring of the package describes the integrator, the settings that are switched off, and the frames that Rapier uses.
"""

import math
from collections.abc import Callable, Sequence
from importlib.metadata import version
from typing import Any

import numpy as np
import rapier3d
from rapier3d.loaders import urdf as loader

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
from bodycheck.adapters.links import Link, state_in, urdf, velocity_of, velocity_to_origin
from bodycheck.adapters.mechanisms import at_centres
from bodycheck.adapters.pair_coefficients import Coefficients
from bodycheck.adapters.rapier import INSTALLATION, mechanisms, sensing, touching
from bodycheck.adapters.rapier.robots import read_robot as read_robot
from bodycheck.adapters.rapier.robots import step_robot as step_robot
from bodycheck.adapters.rapier.sensing import lacking as lacking
from bodycheck.adapters.rapier.worlds import World, add_plane, check, collider, moving, new_world, rows, seen, unlimited
from bodycheck.adapters.stepping import Loop, Normalised
from bodycheck.adapters.touching import lying_shape, touching_bodies
from bodycheck.reference.inertia import along_principal_axes
from bodycheck.reference.kinematics import conjugate, rotate
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.requirements import touches
from bodycheck.reference.scene import Body, Scene
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array

#: The option that keeps Rapier's settings, and the option that selects a friction cone at each contact.
OPTIONS = {"settings": choice("engine"), "friction": choice("coulomb", kinds=frozenset({"plane", "contact"}))}
PLAIN, ENGINE_SETTINGS, COULOMB = (f"symplectic-euler{options}" for options in ("", ":settings=engine", ":friction=coulomb"))

#: The methods of bodies that touch. Rapier's own settings come first: its contacts and joints are made for four substeps.
WITH_COULOMB = (ENGINE_SETTINGS, PLAIN, COULOMB)

#: The parameters of a world that sets none.
PARAMETERS = Usage(
    ENGINE_SETTINGS, 1 / 60, "https://docs.rs/rapier3d/latest/rapier3d/dynamics/struct.IntegrationParameters.html"
)

engine = Engine(
    name="rapier",
    distribution=INSTALLATION.distribution,
    version=version(INSTALLATION.distribution),
    integrators=(Integrator(PLAIN, order=1, evaluations=1, options=OPTIONS),),
    models=frozenset(
        {"gravity", "translation", "rotation", "contact", "friction", "drag", *mechanisms.MODELS, *touching.MODELS}
    ),
    variants={**dict.fromkeys(sorted(KINDS), (ENGINE_SETTINGS, PLAIN)), "plane": WITH_COULOMB, "contact": WITH_COULOMB},
    precision="float32",
    defaults={"timestep": f"{rapier3d.IntegrationParameters().dt:.6g} s"},
    roles={"default": dict.fromkeys(sorted(KINDS), PARAMETERS)},
    combines={"friction": "mean", "restitution": "mean"},
    reads=("step",),
)

interface_loads, contact_terms = touching.interface_loads, touching.contact_terms


#: The functions of Rapier that steps call from Python.
calls = (
    (rapier3d.PhysicsWorld, "step"),
    *((rapier3d.RigidBody, name) for name in ("reset_forces", "reset_torques", "add_force", "add_force_at_point")),
)


def prepare(scenes: Sequence[AnyScene], method: Method) -> Simulation:
    """Return the simulation of one scene, as `Adapter.prepare` does."""
    (scene,) = scenes
    if touches(scene):
        return touching.prepare(scene, method)
    if isinstance(scene, Mechanism):
        return jointed(scene, method)
    return alone(scene, built(scene, method))


def alone(scene: Scene, world: World) -> Normalised:
    """Return the simulation of a single body in its world."""
    stepped = resisted_step(scene.drag) if scene.drag else step
    return Normalised(Loop(world, stepped, seen, lambda seen: in_body_frame(scene, rows(seen))))


def prepare_sensing(scene: AnyScene, sensors: Sequence[Sensor], method: Method) -> SensingSimulation:
    """Return the simulation of a scene with sensors, as `Sensing.prepare_sensing` does."""
    simulation: Normalised
    joints: list[Any] = []
    if touches(scene):
        together = touching.built(scene, method)
        world, bodies = together.world, [each.body for each in together.worlds]
        places = [turned(touching_bodies(scene)[sensor.body].body, sensor) for sensor in sensors]
        simulation = touching.simulated(scene, together)
    elif isinstance(scene, Mechanism):
        world, bodies, joints = placed(scene, method)
        places = [np.array(sensor.position) for sensor in sensors]
        simulation = held_together(scene, world, bodies)
    else:
        single = built(scene, method)
        world, bodies = single.world, [single.body]
        places = [turned(scene.body, sensor) for sensor in sensors]
        simulation = alone(scene, single)
    readers = [
        sensing.reader(scene, sensor, point, (world, bodies, joints), method.timestep)
        for sensor, point in zip(sensors, places, strict=True)
    ]
    return SensingSimulation(simulation, lambda: tuple(read() for read in readers))


def turned(body: Body, sensor: Sensor) -> Array:
    """Return the place (3,) of a sensor in the frame of Rapier's body, which is along the principal axes."""
    return rotate(conjugate(np.array(body.axes)), np.array(sensor.position))


def jointed(mechanism: Mechanism, method: Method) -> Normalised:
    """Return the simulation of a mechanism. Raises `SceneUnsupported`."""
    world, bodies, _ = placed(mechanism, method)
    return held_together(mechanism, world, bodies)


def placed(mechanism: Mechanism, method: Method) -> tuple["rapier3d.PhysicsWorld", list[Any], list[Any]]:
    """Return a world with a mechanism in its initial state, and Rapier's views of its bodies and of its joints."""
    world = new_world(mechanism.gravity, method)
    return world, *mechanisms.built(world, mechanism, lambda builder: unlimited(builder, method))


def held_together(mechanism: Mechanism, world: "rapier3d.PhysicsWorld", bodies: Sequence[Any]) -> Normalised:
    """Return the simulation of a mechanism in a world."""

    def step(_: None) -> None:
        world.step()
        mechanisms.check(bodies)

    return Normalised(Loop(None, step, lambda _: mechanisms.seen(bodies), lambda seen: at_centres(mechanism, seen)))


def prepare_links(links: Sequence[Link], scene: Scene, method: Method) -> Normalised:
    """Return the simulation of a free body that is made of links, as `Links.prepare_links` does."""
    world, initial = new_world(scene.gravity, method), scene.initial
    blueprint = loader.UrdfLoaderOptions(rigid_body_blueprint=unlimited(rapier3d.RigidBody.dynamic(), method))
    robot, _ = loader.UrdfRobot.from_str(urdf(links), blueprint)
    robot.append_transform(rapier3d.Isometry3(initial.position, rapier3d.Rotation3(*initial.quaternion)))
    # Rapier cannot set the velocity of a body in reduced coordinates.
    handles = robot.insert_using_impulse_joints(world.rigid_bodies, world.colliders, world.impulse_joints)
    bodies = [world.rigid_bodies[link.body] for link in handles.links]
    spin = rotate(np.array(initial.quaternion), np.array(initial.angular_velocity)).tolist()
    for body, link in zip(bodies, links, strict=True):
        body.recompute_mass_properties_from_colliders(world.colliders)
        frame = state_in((link.position, link.quaternion), initial)
        body.angvel, body.linvel = spin, velocity_of([*body.local_center_of_mass], frame)
    centre = [*bodies[0].local_center_of_mass]
    placed = World(world, bodies[0])
    return Normalised(Loop(placed, step, seen, lambda seen: velocity_to_origin(rows(seen), centre)))


def step(world: World) -> World:
    """Take a time step. Raises `EngineReset` if Rapier has taken the body out of the simulation."""
    world.world.step()
    check(world)
    return world


def resisted_step(drag: float) -> Callable[[World], World]:
    """Return a function that takes a time step with the drag -c |v| v at the centre of mass.

    `drag` is c (kg/m), and v is the velocity at the start of the step.
    """

    def resisted(world: World) -> World:
        velocity = world.body.linvel.to_tuple()
        braking = -drag * math.hypot(*velocity)
        world.body.reset_forces()
        world.body.add_force(tuple(braking * component for component in velocity))
        return step(world)

    return resisted


def built(scene: Scene, method: Method) -> World:
    """Return a world with the body of a scene in its initial state. Raises `SceneUnsupported`."""
    given = None if scene.plane is None else Coefficients(scene.plane.friction, 0.0)
    shape = None if given is None else collider(lying_shape(scene), scene.body.axes, given)
    world = new_world(scene.gravity, method)
    if given is not None:
        add_plane(world, 0.0, given)
    body = moving(scene.body, along_principal_axes(scene).initial)
    handle = world.add_body(unlimited(body, method), [shape] if shape is not None else None)
    return World(world, world.rigid_bodies[handle])


def contact_load(scene: Scene, method: Method, steps: int) -> Array:
    """Return the normal force (n,), in N, between body and plane in each of n steps, as `ContactLoad.contact_load` does."""
    world, load = built(scene, method), np.zeros(steps)
    for number in range(steps):
        step(world)
        pairs = world.world.narrow_phase.contact_pairs()
        points = [point for pair in pairs for manifold in pair.manifolds for point in manifold.points]
        load[number] = sum(point.impulse for point in points) / method.timestep
    return load
