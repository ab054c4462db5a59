"""Step free bodies that touch a plane and each other in DART, by DART's own contacts.

Each body is a skeleton with a free joint and one shape. If there is a brick among the bodies, the plane is the upper face of a
large box, and the detector is Bullet's: between DART's plane and a brick, most detectors find one contact, which jumps from
corner to corner. Round bodies alone lie on DART's plane. Their detector is FCL, DART's default, or ODE's if there are
cylinders, since ODE's alone finds several contacts under the face of a cylinder. The options of the module `contact` apply.

DART uses the smaller coefficient of friction of two shapes, and the product of their coefficients of restitution. The
coefficients of the bodies are chosen such that every pair has those of the scene.

A push is an external force, which DART applies at the start of a step.
"""

import itertools
import math
from collections.abc import Mapping, Sequence
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
from bodycheck.adapters.stepping import Loop, several
from bodycheck.adapters.touching import laws, plane_of, switches, touching_bodies
from bodycheck.reference.mechanisms.mechanism import WORLD, AnyScene, Mechanism
from bodycheck.reference.scene import Brick, Cylinder, Ellipsoid, Push, Shape
from bodycheck.reference.trajectory import Array

#: The requirements of touching bodies that DART models.
MODELS = frozenset({"incline", "restitution", "rolling", "pushes", "contacts"})

#: Two bodies, by their indices, the lower one first; the plane is `WORLD`.
Pair = tuple[int, int]


@dataclass(frozen=True, eq=False)
class Touching:
    """Bodies that touch in a world of DART at t = 0, and their pushes as `switches` returns them."""

    world: "dart.simulation.World"
    bodies: Sequence[Any]
    pushes: Mapping[int, tuple[Push, ...]]


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
    frictions, restitutions = coefficients(scene, len(parts))
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
    solve(world, method, detector(shapes))
    return Touching(world, bodies, switches(scene.pushes, method.timestep))


def detector(shapes: Sequence[Shape]) -> str:
    """Return the name of the detector for bodies of these shapes."""
    kinds = set(map(type, shapes))
    return "bullet" if Brick in kinds else "ode" if Cylinder in kinds and Ellipsoid not in kinds else "fcl"


def loop(touched: Touching) -> Loop[None]:
    """Return the simulation of bodies that touch."""
    world, bodies, pushes = touched.world, touched.bodies, touched.pushes
    skeletons = [body.getSkeleton() for body in bodies]
    taken, acting = itertools.count(), pushes[0]

    def step() -> None:
        nonlocal acting
        acting = pushes.get(next(taken), acting)
        for push in acting:
            bodies[push.body].addExtForce(push.force, push.point, False, True)  # a force in the world, a point in the body
        world.step()
        if not all(skeleton.computeKineticEnergy() < LARGEST_ENERGY_J for skeleton in skeletons):
            raise EngineDiverged(f"DART's accelerations overflow at t = {world.getTime():.6g} s")

    return several(step, skeletons, coordinates, rows)


def terms(scene: AnyScene, method: Method) -> str:
    """Return the contact law that DART has in the place of a scene's, as `ContactTerms.contact_terms` does."""
    if scene.plane is None:
        return ""
    bodies = scene.bodies if isinstance(scene, Mechanism) else (scene.body,)
    friction, restitution = wanted(scene, len(bodies))
    phrases = []
    if friction.any() and method.option("solver") not in CONES:
        along = "along y and down the plane" if scene.plane.incline else "along x and y"
        phrases.append(f"friction limited in each of two directions, {along}, instead of by a cone")
    if np.any((friction > 0) & (friction <= NO_FRICTION)):
        phrases.append(f"no friction where the coefficient is at most {NO_FRICTION:g}")
    if np.any((restitution > 0) & (restitution <= NO_RESTITUTION)):
        phrases.append(f"no restitution where the coefficient is at most {NO_RESTITUTION:g}")
    if np.any(restitution > NO_RESTITUTION):
        phrases.append(f"restitution in rebounds from {SLOWEST_REBOUND:g} m/s to {FASTEST_REBOUND:g} m/s alone")
    frictions, restitutions = coefficients(scene, len(bodies))
    names = [body.name for body in scene.bodies] if isinstance(scene, Mechanism) else ["body"]
    names.append("the plane")
    phrases += differing("friction", np.minimum.outer(frictions, frictions), friction, names)
    phrases += differing("restitution", np.multiply.outer(restitutions, restitutions), restitution, names)
    return "; ".join(phrases)


def differing(what: str, given: Array, scene: Array, names: Sequence[str]) -> list[str]:
    """Return a phrase about the pairs that are given another coefficient than that of the scene, if there are any.

    The coefficients (n, n) are those of pairs of bodies with n names.
    """
    pairs = [pair for pair in itertools.combinations(range(len(names)), 2) if not math.isclose(given[pair], scene[pair])]
    if not pairs:
        return []
    (one, other), *others = pairs
    more = f" and {len(others)} other pairs" if others else ""
    return [f"{what} {given[one, other]:g} instead of {scene[one, other]:g} between {names[one]} and {names[other]}{more}"]


def wanted(scene: AnyScene, bodies: int) -> tuple[Array, Array]:
    """Return the coefficients of friction and of restitution (bodies + 1, bodies + 1) of all pairs; the plane is the last."""
    usual, *others = laws(scene)
    size = bodies + 1
    friction, restitution = np.full((size, size), usual.friction), np.full((size, size), usual.restitution)
    for law in others:
        one, other = law.bodies  # the index of the plane is -1
        friction[one, other] = friction[other, one] = law.friction
        restitution[one, other] = restitution[other, one] = law.restitution
    return friction, restitution


def coefficients(scene: AnyScene, bodies: int) -> tuple[Array, Array]:
    """Return the coefficients of friction and of restitution (bodies + 1,) that DART is given; the plane is the last.

    Where no coefficients give every pair its own, a pair has more friction than in the scene, or a restitution near its own.
    """
    friction, restitution = wanted(scene, bodies)
    apart = ~np.eye(bodies + 1, dtype=bool)
    return friction.max(axis=1, where=apart, initial=0.0), factors(restitution, apart)


def factors(products: Array, apart: Array) -> Array:
    """Return the factors (n,), 0 to 1, whose products are nearest to those of pairs (n, n) that are not zero.

    The array `apart` (n, n) says which elements are of pairs.
    """
    if np.ptp(products[apart]) == 0:
        return np.full(len(products), math.sqrt(products[0, 1]))
    pairs = list(zip(*np.nonzero(np.triu(products) * apart), strict=True))
    places = np.zeros((len(pairs), len(products)))
    for row, pair in enumerate(pairs):
        places[row, list(pair)] = 1.0
    logarithms, *_ = np.linalg.lstsq(places, np.log([products[pair] for pair in pairs]))
    return np.where(places.any(axis=0), np.minimum(np.exp(logarithms), 1.0), 0.0)
