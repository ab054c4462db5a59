"""The adapter of Rapier: each simulation is a world with one body, stepped in a Python loop.

The docstring of the package describes the integrator, the settings that are switched off, and the frames that Rapier uses.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from typing import Any

import numpy as np
import rapier3d
from rapier3d.loaders import urdf as loader

from bodycheck.adapters.attitudes import in_body_frame
from bodycheck.adapters.contract import (
    KINDS,
    Engine,
    EngineReset,
    Integrator,
    Method,
    SensingSimulation,
    Simulation,
    Usage,
    choice,
    states,
)
from bodycheck.adapters.links import Link, state_in, velocity_of, velocity_to_origin
from bodycheck.adapters.mechanisms import at_centres
from bodycheck.adapters.rapier import INSTALLATION, mechanisms, sensing
from bodycheck.adapters.rapier.robots import read_robot as read_robot
from bodycheck.adapters.rapier.robots import step_robot as step_robot
from bodycheck.adapters.rapier.sensing import lacking as lacking
from bodycheck.adapters.stepping import Loop, Normalised, several
from bodycheck.adapters.touching import half_lengths, lying_shape, plane_of, touching_bodies
from bodycheck.adapters.urdf import urdf
from bodycheck.reference.inertia import along_principal_axes
from bodycheck.reference.kinematics import conjugate, normalise, rotate
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.scene import Body, Brick, Plane, Scene, State
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array

#: The largest number in single precision, by which Rapier says that there is no limit.
NO_LIMIT = float(np.finfo(np.float32).max)

#: The option that keeps Rapier's settings, and the option that selects a friction cone at each contact.
OPTIONS = {"settings": choice("engine"), "friction": choice("coulomb", kinds=frozenset({"plane"}))}
PLAIN, ENGINE_SETTINGS, COULOMB = (f"symplectic-euler{options}" for options in ("", ":settings=engine", ":friction=coulomb"))

#: The parameters of a world that sets none.
PARAMETERS = Usage(
    ENGINE_SETTINGS, 1 / 60, "https://docs.rs/rapier3d/latest/rapier3d/dynamics/struct.IntegrationParameters.html"
)

engine = Engine(
    name="rapier",
    distribution=INSTALLATION.distribution,
    version=version(INSTALLATION.distribution),
    integrators=(Integrator(PLAIN, order=1, evaluations=1, options=OPTIONS),),
    models=frozenset({"gravity", "translation", "rotation", "contact", "friction", "drag"}) | mechanisms.MODELS,
    # Rapier's own settings come first: its contacts and joints are made for four substeps.
    variants={**dict.fromkeys(sorted(KINDS), (ENGINE_SETTINGS, PLAIN)), "plane": (ENGINE_SETTINGS, PLAIN, COULOMB)},
    precision="float32",
    defaults={"timestep": f"{rapier3d.IntegrationParameters().dt:.6g} s"},
    roles={"default": dict.fromkeys(sorted(KINDS - {"contact"}), PARAMETERS)},
    reads=("step",),
)

#: The functions of Rapier that steps call from Python.
calls = (
    (rapier3d.PhysicsWorld, "step"),
    (rapier3d.RigidBody, "reset_forces"),
    (rapier3d.RigidBody, "add_force"),
)


@dataclass(frozen=True, eq=False)
class World:
    """A world of Rapier, and Rapier's view of the body in this world."""

    world: "rapier3d.PhysicsWorld"
    body: "rapier3d.RigidBody"


def prepare(scenes: Sequence[AnyScene], method: Method) -> Simulation:
    """Return the simulation of one scene, as `Adapter.prepare` does."""
    (scene,) = scenes
    if isinstance(scene, Mechanism):
        return jointed(scene, method)
    return alone(scene, built(scene, method))


def alone(scene: Scene, world: World) -> Normalised:
    """Return the simulation of a single body in its world."""
    stepped = resisted_step(scene.drag) if scene.drag else step
    return Normalised(Loop(world, stepped, seen, lambda seen: in_body_frame(scene, rows(seen))))


def prepare_sensing(scene: AnyScene, sensors: Sequence[Sensor], method: Method) -> SensingSimulation:
    """Return the simulation of a scene with sensors, as `Sensing.prepare_sensing` does."""
    if isinstance(scene, Mechanism):
        world, bodies, joints = placed(scene, method)
        places = [np.array(sensor.position) for sensor in sensors]
        simulation = held_together(scene, world, bodies)
    else:
        single = built(scene, method)
        world, bodies, joints = single.world, [single.body], []
        axes = conjugate(np.array(scene.body.axes))  # Rapier's body has its frame along the principal axes
        places = [rotate(axes, np.array(sensor.position)) for sensor in sensors]
        simulation = alone(scene, single)
    readers = [
        sensing.reader(scene, sensor, point, (world, bodies, joints), method.timestep)
        for sensor, point in zip(sensors, places, strict=True)
    ]
    return SensingSimulation(simulation, lambda: tuple(read() for read in readers))


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


def rows(seen: Array) -> Array:
    """Return the rows (n, 13) of states from rows (n, 13) of `seen`. Quaternions may have any norm, which they keep."""
    quaternion = seen[:, [6, 3, 4, 5]]
    return states(seen[:, :3], quaternion, seen[:, 7:10], rotate(conjugate(normalise(quaternion)), seen[:, 10:]))


def seen(world: World) -> Array:
    """Return position, quaternion x y z w, velocity and angular velocity (13,), all in the world frame."""
    body = world.body
    vectors = (body.translation, body.linvel, body.angvel)
    position, velocity, angular_velocity = (vector.to_tuple() for vector in vectors)
    return np.array([*position, *body.rotation.quaternion, *velocity, *angular_velocity])


def step(world: World) -> World:
    """Take a time step. Raises `EngineReset` if Rapier has taken the body out of the simulation."""
    world.world.step()
    check(world)
    return world


def check(world: World) -> None:
    """Raise `EngineReset` if Rapier has taken the body out of the simulation."""
    if not world.body.is_enabled:
        raise EngineReset("Rapier quarantined the body, because its state is no longer finite, and put it back")


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
    shape = collider(scene) if scene.plane is not None else None
    world = new_world(scene.gravity, method)
    if scene.plane is not None:
        world.add_collider(rapier3d.Collider.halfspace((0, 0, 1)).friction(scene.plane.friction))
    body = moving(scene.body, along_principal_axes(scene).initial)
    handle = world.add_body(unlimited(body, method), [shape] if shape is not None else None)
    return World(world, world.rigid_bodies[handle])


def moving(body: Body, initial: State) -> "rapier3d.RigidBodyBuilder":
    """Return the builder of a body without a shape, from the initial state of its principal axes."""
    spin = rotate(np.array(initial.quaternion), np.array(initial.angular_velocity)).tolist()
    return (
        rapier3d.RigidBody.dynamic()
        .position(rapier3d.Isometry3(initial.position, rapier3d.Rotation3(*initial.quaternion)))
        .linvel(initial.velocity)
        .angvel(spin)
        .additional_mass_properties(rapier3d.MassProperties((0, 0, 0), body.mass, body.moments))
    )


def prepare_boxes(scene: Mechanism, method: Method) -> Normalised:
    """Return the simulation of free boxes that touch, as `Boxes.prepare_boxes` does."""
    world, plane = new_world(scene.gravity, method), plane_of(scene)
    world.add_collider(with_coefficients(rapier3d.Collider.halfspace((0, 0, 1)), plane))
    boxes = touching_bodies(scene)
    shapes = [with_coefficients(rapier3d.Collider.cuboid(*half_lengths(box)), plane).density(0) for box in boxes]
    builders = [unlimited(moving(box.body, box.start), method) for box in boxes]
    handles = [world.add_body(body, [shape]) for body, shape in zip(builders, shapes, strict=True)]
    worlds = [World(world, world.rigid_bodies[handle]) for handle in handles]

    def step_all() -> None:
        world.step()
        for each in worlds:
            check(each)

    return Normalised(several(step_all, worlds, seen, rows))


def with_coefficients(shape: "rapier3d.ColliderBuilder", plane: Plane) -> "rapier3d.ColliderBuilder":
    """Return the builder of a shape with the friction and the restitution of a plane; Rapier uses the mean of two shapes'."""
    return shape.friction(plane.friction).restitution(plane.restitution)


def new_world(gravity: float, method: Method) -> "rapier3d.PhysicsWorld":
    """Return an empty world with gravity (m/s^2) and the settings of a method."""
    world = rapier3d.PhysicsWorld(gravity=(0, 0, -gravity))
    world.integration_parameters.dt = method.timestep
    if method.option("settings") != "engine":
        switch_off(world.integration_parameters)
    if method.option("friction") == "coulomb":
        world.integration_parameters.friction_model = rapier3d.FrictionModel.COULOMB
    return world


def unlimited(body: "rapier3d.RigidBodyBuilder", method: Method) -> "rapier3d.RigidBodyBuilder":
    """Return the builder of a body without sleeping and rotation limit, unless a method keeps Rapier's settings."""
    return body if method.option("settings") == "engine" else body.can_sleep(False).allow_fast_rotation(True)


def switch_off(parameters: "rapier3d.IntegrationParameters") -> None:
    """Switch off substeps, the speed limit and continuous collision detection; see the docstring of the package."""
    parameters.num_internal_pgs_iterations *= parameters.num_solver_iterations
    parameters.num_internal_stabilization_iterations *= parameters.num_solver_iterations
    parameters.num_solver_iterations = 1
    parameters.normalized_max_linear_velocity = NO_LIMIT
    parameters.max_ccd_substeps = 0


def collider(scene: Scene) -> "rapier3d.ColliderBuilder":
    """Return the massless shape of a body that lies on the plane, in its principal axes. Raises `SceneUnsupported`.

    Rapier uses the mean of the coefficients of friction of two bodies, so both have the coefficient of the plane.
    """
    shape = lying_shape(scene)
    assert scene.plane is not None
    axes = rapier3d.Rotation3(*scene.body.axes).inverse()
    if isinstance(shape, Brick):
        of_shape = rapier3d.Collider.cuboid(*shape.semi_axes)
    else:
        # The axis of Rapier's cylinders is y.
        of_shape = rapier3d.Collider.cylinder(shape.half_length, shape.radius)
        axes = axes * rapier3d.Rotation3.from_scaled_axis((math.pi / 2, 0, 0))
    return of_shape.rotation(axes.scaled_axis).density(0).friction(scene.plane.friction)


def contact_load(scene: Scene, method: Method, steps: int) -> Array:
    """Return the normal force (n,), in N, between body and plane in each of n steps, as `ContactLoad.contact_load` does."""
    world, load = built(scene, method), np.zeros(steps)
    for number in range(steps):
        step(world)
        pairs = world.world.narrow_phase.contact_pairs()
        points = [point for pair in pairs for manifold in pair.manifolds for point in manifold.points]
        load[number] = sum(point.impulse for point in points) / method.timestep
    return load
