"""The adapter of DART; the docstring of the package describes the methods and the frames of DART's velocities."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import dartpy as dart
import numpy as np

from bodycheck.adapters.contract import (
    Engine,
    EngineDiverged,
    Integrator,
    Method,
    SensingSimulation,
    Simulation,
    Usage,
)
from bodycheck.adapters.dart import INSTALLATION, contact, file_motion, mechanisms, sensing, touching
from bodycheck.adapters.dart.bodies import LARGEST_ENERGY_J, coordinates, inertia, place, pose, rows
from bodycheck.adapters.dart.robots import read_robot as read_robot
from bodycheck.adapters.dart.robots import step_robot as step_robot
from bodycheck.adapters.links import Link, links_of
from bodycheck.adapters.stepping import Loop
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.requirements import touches
from bodycheck.reference.scene import Scene
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array

INTEGRATOR = "semi-implicit-euler"

#: A world that sets nothing. In flight, DART's own settings make no difference.
WORLD, SOURCE = f"{INTEGRATOR}:settings=engine", "https://github.com/dartsim/dart/blob/v6.20.0/dart/simulation/World.hpp"
WORLDS = {kind: Usage(WORLD if kind in contact.OWN_SETTINGS else INTEGRATOR, 0.001, SOURCE) for kind in contact.MODELLED}

engine = Engine(
    name="dart",
    distribution=INSTALLATION.distribution,
    version=str(dart.__version__),
    integrators=(Integrator(INTEGRATOR, order=1, evaluations=1, options=contact.OPTIONS),),
    models=frozenset({"gravity", "translation", "rotation", "contact", "friction", "drag"})
    | mechanisms.MODELS
    | touching.MODELS,
    variants={
        "plane": tuple(f"{INTEGRATOR}:{options}" for options in ("solver=pgs", "solver=nsgs", "solver=fbf", "settings=engine")),
        "contact": tuple(f"{INTEGRATOR}:{options}" for options in ("solver=nsgs", "settings=engine")),
    },
    defaults={"timestep": f"{dart.simulation.World().getTimeStep():g} s"},
    roles={"default": WORLDS},
    combines={"friction": "smaller of the two", "restitution": "product"},
    reads=("step", "forward"),
)

contact_law, contact_terms, lacking = contact.law, touching.terms, sensing.lacking
interface_loads = touching.interface_loads
file_facts, run_file = partial(file_motion.file_facts, INTEGRATOR), partial(file_motion.run_file, INTEGRATOR)

#: The functions of DART that steps call from Python.
calls = (
    (dart.simulation.World, "step"),
    (dart.dynamics.BodyNode, "addExtForce"),
    (dart.dynamics.BodyNode, "computeKineticEnergy"),
    (dart.dynamics.BodyNode, "getLinearVelocity"),
)


@dataclass(frozen=True, eq=False)
class Model:
    """A body in a world of DART."""

    world: "dart.simulation.World"
    skeleton: "dart.dynamics.Skeleton"
    body: "dart.dynamics.BodyNode"


def prepare(scenes: Sequence[AnyScene], method: Method) -> Simulation:
    """Return the simulation of one scene, as `Adapter.prepare` does."""
    (scene,) = scenes
    if touches(scene):
        return touching.prepare(scene, method)
    if isinstance(scene, Mechanism):
        simulation, _, _ = mechanisms.prepare(scene, method)
        return simulation
    return loop(model(scene, method), scene.drag)


def prepare_sensing(scene: AnyScene, sensors: Sequence[Sensor], method: Method) -> SensingSimulation:
    """Return the simulation of a scene with sensors, as `Sensing.prepare_sensing` does."""
    if touches(scene):
        touched = touching.built(scene, method)
        return SensingSimulation(touching.loop(touched), sensing.reader(touched.world, touched.bodies, sensors, method))
    if isinstance(scene, Mechanism):
        simulation, world, bodies = mechanisms.prepare(scene, method)
        return SensingSimulation(simulation, sensing.reader(world, bodies, sensors, method))
    built = model(scene, method)
    return SensingSimulation(loop(built, scene.drag), sensing.reader(built.world, [built.body], sensors, method))


def prepare_links(links: Sequence[Link], scene: Scene, method: Method) -> Loop[None]:
    """Return the simulation of a free body that is made of links, as `Links.prepare_links` does."""
    return loop(model(scene, method, links))


def loop(built: Model, drag: float = 0.0) -> Loop[None]:
    """Return the simulation of a body with the drag force -c |v| v, computed from the velocity v at the start of each step.

    `drag` is the coefficient c (kg/m).
    """
    world, skeleton, body = built.world, built.skeleton, built.body

    def step(state: None) -> None:
        if drag:
            velocity = body.getLinearVelocity()
            body.addExtForce(-drag * np.linalg.norm(velocity) * velocity)
        world.step()
        if not body.computeKineticEnergy() < LARGEST_ENERGY_J:
            raise EngineDiverged(f"DART's accelerations overflow at t = {world.getTime():.6g} s")

    return Loop(None, step, lambda _: coordinates(skeleton), rows)


def model(scene: Scene, method: Method, links: Sequence[Link] = ()) -> Model:
    """Return the model of a scene, in its initial state: the scene's body, or the links if given, on a free joint.

    Raises `SceneUnsupported`.
    """
    initial = scene.initial
    world = dart.simulation.World()
    world.setGravity([0.0, 0.0, -scene.gravity])
    world.setTimeStep(method.timestep)
    skeleton = dart.dynamics.Skeleton("body")
    first, *others = links_of(scene, links)
    _, body = skeleton.createFreeJointAndBodyNodePair()
    body.setInertia(inertia(first))
    for link in others:
        joint, part = skeleton.createWeldJointAndBodyNodePair(body)
        part.setInertia(inertia(link))
        joint.setTransformFromParentBodyNode(pose(link.position, link.quaternion))
    if scene.plane is not None:
        contact.add(world, body, scene, scene.plane, method)
    world.addSkeleton(skeleton)
    place(skeleton, initial)
    return Model(world, skeleton, body)


def contact_load(scene: Scene, method: Method, steps: int) -> Array:
    """Return the normal force (n,), in N, in each of n steps."""
    built = model(scene, method)
    load = np.empty(steps)
    for step in range(steps):
        built.world.step()
        load[step] = contact.load(built.world)
    return load
