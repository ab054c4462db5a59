"""The adapter of PyBullet: each simulation has its own physics server in this process, stepped in a Python loop.

The docstring of the package describes the integrators, the settings that are switched off, and the frames that PyBullet uses.
"""

import math
import weakref
from collections.abc import Callable, Sequence
from importlib.metadata import version

import numpy as np

from bodycheck.adapters.attitudes import in_body_frame
from bodycheck.adapters.contract import (
    KINDS,
    Engine,
    Integrator,
    Method,
    SceneUnsupported,
    SensingSimulation,
    Simulation,
    Usage,
    choice,
)
from bodycheck.adapters.links import Link, carried, state_in
from bodycheck.adapters.mechanisms import in_body_axes
from bodycheck.adapters.pair_coefficients import Coefficients
from bodycheck.adapters.pybullet import INSTALLATION
from bodycheck.adapters.quiet import no_stderr
from bodycheck.adapters.stepping import Loop, Taking
from bodycheck.adapters.touching import corners_of_brick, lying_shape, touching_bodies
from bodycheck.reference.inertia import along_principal_axes
from bodycheck.reference.kinematics import conjugate, rotate
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.requirements import free_bodies_touch
from bodycheck.reference.scene import Scene
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array

# When PyBullet is imported, its C code writes the time of its build to standard error.
with no_stderr():
    import pybullet

    from bodycheck.adapters.pybullet import gripping, mechanisms, sensing, touching
    from bodycheck.adapters.pybullet.file_motion import file_facts as file_facts
    from bodycheck.adapters.pybullet.file_motion import run_file as run_file
    from bodycheck.adapters.pybullet.links import BASE, load, weld
    from bodycheck.adapters.pybullet.mechanisms import switched_off
    from bodycheck.adapters.pybullet.robots import read_robot as read_robot
    from bodycheck.adapters.pybullet.robots import step_robot as step_robot
    from bodycheck.adapters.pybullet.worlds import (
        World,
        add_ground,
        collision_shape,
        connected,
        rows,
        seen,
        set_properties,
        set_state,
    )

#: The method with PyBullet's own damping and limits.
ENGINE_SETTINGS = "multibody:settings=engine"

#: The method of the first example of PyBullet's guide, which sets no time step. The guide advises against the other integrator:
#: "experimental, best to leave it 0/false" (`useMaximalCoordinates`).
QUICK_START = Usage(
    ENGINE_SETTINGS,
    1 / 240,
    "https://github.com/bulletphysics/bullet3/blob/master/docs/pybullet_quickstart_guide/PyBulletQuickstartGuide.md.html",
)


def defaults() -> dict[str, str]:
    """Return the time step of a new physics server."""
    client = pybullet.connect(pybullet.DIRECT)
    parameters = pybullet.getPhysicsEngineParameters(physicsClientId=client)
    pybullet.disconnect(client)
    return {"timestep": f"{parameters['fixedTimeStep']:.6g} s"}


engine = Engine(
    name="pybullet",
    distribution=INSTALLATION.distribution,
    version=version(INSTALLATION.distribution),
    integrators=(
        Integrator("maximal", order=1, evaluations=1, kinds=KINDS - {"mechanism"}, options=touching.OPTIONS),
        Integrator("multibody", order=1, evaluations=1, options={"settings": choice("engine"), **touching.OPTIONS}),
    ),
    models=frozenset({"gravity", "translation", "rotation", "contact", "friction", "drag"})
    | mechanisms.MODELS
    | touching.MODELS
    | gripping.MODELS,
    variants={**dict.fromkeys(sorted(KINDS), (ENGINE_SETTINGS,)), "contact": (ENGINE_SETTINGS, touching.BOUNCING)},
    defaults=defaults(),
    roles={"default": dict.fromkeys(sorted(KINDS), QUICK_START), "recommended": dict.fromkeys(sorted(KINDS), QUICK_START)},
    combines={"friction": "product", "restitution": "product"},
    reads=("step",),
)

#: The friction law of contacts.
contact_law = corners_of_brick

lacking, interface_loads, contact_terms = sensing.lacking, touching.interface_loads, touching.contact_terms

#: The functions of PyBullet that steps call from Python.
calls = tuple(
    (pybullet, name) for name in ("stepSimulation", "getBasePositionAndOrientation", "getBaseVelocity", "applyExternalForce")
)


def prepare(scenes: Sequence[AnyScene], method: Method) -> Simulation:
    """Return the simulation of one scene, as `Adapter.prepare` does."""
    (scene,) = scenes
    if free_bodies_touch(scene):
        return touching.prepare(scene, method)
    if isinstance(scene, Mechanism):
        simulation, _, _ = jointed(scene, method)
        return simulation
    return single(scene, method)


def prepare_sensing(scene: AnyScene, sensors: Sequence[Sensor], method: Method) -> SensingSimulation:
    """Return the simulation of a scene with sensors, as `Sensing.prepare_sensing` does."""
    if free_bodies_touch(scene):
        server = touching.built(scene, method)
        bodies = [
            mechanisms.Part(world.body, BASE, np.array(body.body.axes))
            for world, body in zip(server.worlds, touching_bodies(scene), strict=True)
        ]
        return SensingSimulation(touching.simulated(scene, server), sensing.reader(server.client, bodies, sensors))
    if isinstance(scene, Mechanism):
        jointed_simulation, client, parts = jointed(scene, method)
        return SensingSimulation(jointed_simulation, sensing.reader(client, parts, sensors))
    simulation = single(scene, method)
    world = simulation.state
    part = mechanisms.Part(world.body, BASE, np.array(scene.body.axes))
    return SensingSimulation(simulation, sensing.reader(world.client, [part], sensors))


def single(scene: Scene, method: Method) -> Loop[World]:
    """Return the simulation of a single body. Raises `SceneUnsupported`."""
    return Loop(
        built(scene, method),
        resisted_step(scene.drag) if scene.drag else step,
        seen,
        lambda seen: in_body_frame(scene, rows(seen)),
    )


def jointed(mechanism: Mechanism, method: Method) -> tuple[Loop[None] | Taking, int, list[mechanisms.Part]]:
    """Return the simulation of a mechanism, the connection to its server, and its bodies. Raises `SceneUnsupported`."""
    if method.integrator == "maximal":
        raise SceneUnsupported("bodies on joints in maximal coordinates")
    client = connected(mechanism.gravity, method)
    parts = mechanisms.built(client, mechanism, method, gripping.collisions(mechanism))
    if mechanism.contacts:
        gripping.touch(client, mechanism, parts, method)
    joints = mechanisms.Pushed(client, mechanism, parts)

    def step(_: None) -> None:
        joints.push()
        pybullet.stepSimulation(physicsClientId=client)

    simulation = Loop(None, step, lambda _: mechanisms.seen(client, parts), in_body_axes)
    weakref.finalize(simulation, pybullet.disconnect, client)
    taking = Taking(simulation, joints.state, joints.apply) if mechanism.driven else simulation
    return taking, client, parts


def prepare_links(links: Sequence[Link], scene: Scene, method: Method) -> Loop[World]:
    """Return the simulation of a free body that is made of links, as `Links.prepare_links` does."""
    maximal, client = method.integrator == "maximal", connected(scene.gravity, method)
    flags = 0 if method.option("settings") == "engine" else pybullet.URDF_USE_INERTIA_FROM_FILE
    bodies = load(client, links, maximal, flags)
    first = bodies[0]
    world = World(client, first.body)
    weakref.finalize(world, pybullet.disconnect, client)
    for body, link in zip(bodies, links if maximal else links[:1], strict=True):
        pybullet.changeDynamics(body.body, BASE, physicsClientId=client, **switched_off(method))
        initial = state_in((link.position, link.quaternion), scene.initial)
        set_state(World(client, body.body), state_in((body.position, body.quaternion), initial))
    if maximal:
        weld(client, bodies, links)
    back = conjugate(np.array(first.quaternion))
    origin = -rotate(back, np.array(first.position))
    return Loop(world, step, seen, lambda seen: carried(rows(seen), origin, back))


def step(world: World) -> World:
    """Take a time step."""
    pybullet.stepSimulation(physicsClientId=world.client)
    return world


def resisted_step(drag: float) -> Callable[[World], World]:
    """Return a function that takes a time step with the drag -c |v| v at the centre of mass.

    `drag` is c (kg/m), and v is the velocity at the start of the step: the order of a motion with drag is one, whatever
    Bullet's order is.
    """

    def resisted(world: World) -> World:
        position, _ = pybullet.getBasePositionAndOrientation(world.body, physicsClientId=world.client)
        velocity, _ = pybullet.getBaseVelocity(world.body, physicsClientId=world.client)
        braking = -drag * math.hypot(*velocity)
        force = [braking * component for component in velocity]
        pybullet.applyExternalForce(world.body, BASE, force, position, pybullet.WORLD_FRAME, physicsClientId=world.client)
        return step(world)

    return resisted


def built(scene: Scene, method: Method) -> World:
    """Return a world with the body of a scene in its initial state. Raises `SceneUnsupported`."""
    collision = collision_shape(lying_shape(scene), scene.body.axes) if scene.plane is not None else None
    client, maximal = connected(scene.gravity, method), method.integrator == "maximal"
    if scene.plane is not None:
        # Bullet multiplies the coefficients of two bodies.
        add_ground(client, maximal, scene.plane, Coefficients(1.0, 0.0))
    shape = pybullet.createCollisionShape(**collision, physicsClientId=client) if collision is not None else -1
    body = pybullet.createMultiBody(scene.body.mass, shape, useMaximalCoordinates=maximal, physicsClientId=client)
    world = World(client, body)
    weakref.finalize(world, pybullet.disconnect, client)
    friction = {} if scene.plane is None else {"lateralFriction": scene.plane.friction}
    set_properties(world, scene.body, friction, method)
    set_state(world, along_principal_axes(scene).initial)
    return world


def contact_load(scene: Scene, method: Method, steps: int) -> Array:
    """Return the normal force (n,), in N, between body and plane in each of n steps, as `ContactLoad.contact_load` does."""
    world, load = built(scene, method), np.zeros(steps)
    for number in range(steps):
        step(world)
        points = pybullet.getContactPoints(bodyA=world.body, physicsClientId=world.client)
        load[number] = sum(point[9] for point in points)
    return load
