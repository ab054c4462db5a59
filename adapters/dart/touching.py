"""Step free bodies that touch a plane and each other in DART, by DART's own contacts.

Each body is a skeleton with a free joint and one shape. If there is a brick among the bodies, the plane is the upper face of a
large box: between DART's plane and a brick, most detectors find one contact, which jumps from corner to corner. Round bodies
alone lie on DART's plane. The detector is FCL, DART's default, except in two cases. Cylinders on a plane have ODE's, which
alone finds several contacts under a face. Bricks on a level plane have Bullet's, as a brick that lies flat; on an inclined
plane rounding decides which corners Bullet's finds in the first step. The options of the module `contact` apply.

DART uses the smaller coefficient of friction of two shapes, and the product of their coefficients of restitution. The
coefficients of the bodies are chosen such that every pair has those of the scene.

A push is an external force, which DART applies at the start of a step.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import dartpy as dart
import numpy as np

from bodycheck.adapters.contract import EngineDiverged, Method, SceneUnsupported
from bodycheck.adapters.dart.bodies import LARGEST_ENERGY_J, coordinates, inertia, place, rows
from bodycheck.adapters.dart.contact import (
    CONES,
    FASTEST_REBOUND,
    GROUND,
    NO_FRICTION,
    NO_RESTITUTION,
    SLOWEST_REBOUND,
    add_box,
    add_ground,
    solid,
    solve,
    touching,
)
from bodycheck.adapters.links import link_of
from bodycheck.adapters.pair_coefficients import differing, shared, wanted
from bodycheck.adapters.stepping import Loop, several
from bodycheck.adapters.touching import acting, plane_of, touching_bodies
from bodycheck.reference.mechanisms.mechanism import WORLD, AnyScene
from bodycheck.reference.scene import Brick, Cylinder, Ellipsoid, Push, Shape
from bodycheck.reference.trajectory import Array

#: The requirements of touching bodies that DART models.
MODELS = frozenset({"incline", "restitution", "rolling", "pushes", "contacts"})

#: Two bodies, by their indices, the lower one first; the plane is `WORLD`.
Pair = tuple[int, int]


@dataclass(frozen=True, eq=False)
class Touching:
    """Bodies that touch in a world of DART at t = 0, and the pushes that act in each step from the first one on."""

    world: "dart.simulation.World"
    bodies: Sequence[Any]
    pushes: Iterator[tuple[Push, ...]]


def prepare(scene: AnyScene, method: Method) -> Loop[None]:
    """Return the simulation of bodies that touch, as `Adapter.prepare` does. Raises `SceneUnsupported`."""
    return loop(built(scene, method))


def interface_loads(scene: AnyScene, method: Method, steps: int) -> dict[Pair, Array]:
    """Return the normal forces between pairs that touch in each of n steps, as `InterfaceLoads.interface_loads` does."""
    touched = built(scene, method)
    simulation, by_pair = loop(touched), dict[Pair, Array]()
    index = {body.getSkeleton().getName(): number for number, body in enumerate(touched.bodies)} | {GROUND: WORLD}
    for step in range(steps):
        simulation.advance(np.array([1]))
        for contact in touched.world.getLastCollisionResult().getContacts():
            first, second = sorted(
                index[each.getShapeFrame().asShapeNode().getSkeleton().getName()]
                for each in (contact.collisionObject1, contact.collisionObject2)
            )
            by_pair.setdefault((first, second), np.zeros(steps))[step] += abs(contact.force @ contact.normal)
    return by_pair


def built(scene: AnyScene, method: Method) -> Touching:
    """Return the bodies of a scene in a world. Raises `SceneUnsupported`."""
    world, parts, plane = dart.simulation.World(), touching_bodies(scene), plane_of(scene)
    shapes = [part.shape for part in parts]
    if method.option("detector") == "ode" and any(isinstance(shape, Ellipsoid) for shape in shapes):
        raise SceneUnsupported("an ellipsoid, which ODE's detector replaces by a small sphere")
    world.setGravity([0.0, 0.0, -scene.gravity])
    world.setTimeStep(method.timestep)
    frictions, restitutions = of_bodies(scene, len(parts))
    bodies = []
    for number, part in enumerate(parts):
        skeleton = dart.dynamics.Skeleton(f"body {number}")
        _, body = skeleton.createFreeJointAndBodyNodePair()
        body.setInertia(inertia(link_of(part.body)))
        touching(body, solid(part.shape), frictions[number], restitutions[number])
        world.addSkeleton(skeleton)
        place(skeleton, part.start)
        bodies.append(body)
    if any(isinstance(shape, Brick) for shape in shapes):
        add_box(world, plane, frictions[WORLD], restitutions[WORLD])
    else:
        add_ground(world, dart.dynamics.PlaneShape(list(plane.normal), 0.0), frictions[WORLD], restitutions[WORLD])
    solve(world, method, detector(shapes, plane.incline))
    return Touching(world, bodies, acting(scene.pushes, method.timestep))


def detector(shapes: Sequence[Shape], incline: float) -> str:
    """Return the name of the detector for bodies of these shapes on a plane."""
    kinds = set(map(type, shapes))
    if Brick in kinds:
        return "fcl" if incline else "bullet"
    return "ode" if Cylinder in kinds and Ellipsoid not in kinds else "fcl"


def loop(touched: Touching) -> Loop[None]:
    """Return the simulation of bodies that touch."""
    world, bodies = touched.world, touched.bodies
    skeletons = [body.getSkeleton() for body in bodies]

    def step() -> None:
        for push in next(touched.pushes):
            bodies[push.body].addExtForce(push.force, push.point, False, True)  # a force in the world, a point in the body
        world.step()
        if not all(skeleton.computeKineticEnergy() < LARGEST_ENERGY_J for skeleton in skeletons):
            raise EngineDiverged(f"DART's accelerations overflow at t = {world.getTime():.6g} s")

    return several(step, skeletons, coordinates, rows)


def terms(scene: AnyScene, method: Method) -> str:
    """Return the contact law that DART has in the place of a scene's, as `ContactTerms.contact_terms` does."""
    if scene.plane is None:
        return ""
    parts = touching_bodies(scene)
    friction, restitution = wanted(scene, len(parts))
    phrases = []
    if any(friction.values()) and method.option("solver") not in CONES:
        along = "along y and down the plane" if scene.plane.incline else "along x and y"
        phrases.append(f"friction limited in each of two directions, {along}, instead of by a cone")
    if any(0 < value <= NO_FRICTION for value in friction.values()):
        phrases.append(f"no friction where the coefficient is at most {NO_FRICTION:g}")
    if any(0 < value <= NO_RESTITUTION for value in restitution.values()):
        phrases.append(f"no restitution where the coefficient is at most {NO_RESTITUTION:g}")
    if any(value > NO_RESTITUTION for value in restitution.values()):
        phrases.append(f"restitution in rebounds from {SLOWEST_REBOUND:g} m/s to {FASTEST_REBOUND:g} m/s alone")
    frictions, restitutions = of_bodies(scene, len(parts))
    phrases += differing("friction", friction, lambda a, b: min(frictions[a], frictions[b]), parts)
    phrases += differing("restitution", restitution, lambda a, b: restitutions[a] * restitutions[b], parts)
    return "; ".join(phrases)


def of_bodies(scene: AnyScene, count: int) -> tuple[dict[int, float], dict[int, float]]:
    """Return the coefficients of friction and of restitution of the plane, with the index `WORLD`, and of bodies.

    DART takes the smaller of two coefficients of friction, and the product of two of restitution.
    """
    friction, restitution = wanted(scene, count)
    products = {index: min(value, 1.0) for index, value in shared(restitution, "product").items()}
    return shared(friction, "smaller"), products
