"""Step free bodies that touch a plane and each other in PyBullet, by Bullet's own contacts.

The plane is a box, as the ground of PyBullet's own `plane.urdf` is: a box on a box has four contacts at once, but a box on
PyBullet's `GEOM_PLANE` gets them one by one, which throws it about at the start. Bodies are PyBullet's spheres, boxes and
cylinders. Bullet multiplies the coefficients of two bodies; a friction of a pair above `MAX_FRICTION` becomes this number. Its
rolling and spinning friction are lengths, as those of a scene; the plane has neither. A
push is a force that is applied in each step.

Bullet bounces bodies before they touch: a contact exists from a distance of 2 cm on, and the step that would close the gap
gives the body the velocity of the bounce less that which would close the gap in the step. With steps so short that a body
crosses the 2 cm in several of them, this takes the bounce away: with a coefficient of 0.8, balls that fall by some half a metre
keep 0.6 to 0.9 of their velocity at PyBullet's 1/240 s, 0 to 0.7 at 1 ms, and nothing at 0.5 ms. Four of PyBullet's parameters
are options. With `contactProcessingThreshold=0` contacts act only when bodies touch, as an author of Bullet advises
(https://github.com/bulletphysics/bullet3/issues/3094). With `contactERP=0` the correction of penetration adds no velocity: with
both, a ball keeps 0.80. `restitutionVelocityThreshold` is the speed below which bodies do not bounce, 0.2 m/s in PyBullet.
`globalCFM` makes contacts give way in proportion to their loads, so that contacts of one face share its load evenly.
"""

import weakref
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations

import numpy as np
import pybullet

from bodycheck.adapters.attitudes import in_body_frame
from bodycheck.adapters.contract import Kind, Method, Option, SceneUnsupported
from bodycheck.adapters.method import Range
from bodycheck.adapters.pair_coefficients import coefficients, differences, differing
from bodycheck.adapters.pybullet.links import BASE
from bodycheck.adapters.pybullet.worlds import (
    World,
    add_ground,
    collision_shape,
    connected,
    named,
    rows,
    seen,
    set_properties,
    set_state,
)
from bodycheck.adapters.stepping import Loop, several
from bodycheck.adapters.touching import Law, TouchingBody, acting, laws, laws_of_pairs, touching_bodies
from bodycheck.reference.inertia import along_principal_axes
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.mechanisms.mechanism import WORLD, AnyScene, Mechanism
from bodycheck.reference.requirements import grips, touches
from bodycheck.reference.scene import Push, Scene
from bodycheck.reference.trajectory import Array

#: The requirements of touching bodies that Bullet models.
MODELS = frozenset(
    {
        *("incline", "restitution", "rolling", "rolling friction", "torsional friction", "pushes", "contacts"),
        "contacts without a plane",
    }
)

#: The kinds of scene with these contacts.
CONTACT: frozenset[Kind] = frozenset({"contact"})

#: The largest coefficient of friction of a pair (source: `btManifoldResult::calculateCombinedFriction`).
MAX_FRICTION = 10.0

#: The speed (m/s) below which bodies do not bounce, as PyBullet sets it.
BOUNCE_THRESHOLD = 0.2

NOT_NEGATIVE = ((Range(0.0),),)

#: PyBullet's parameters of contacts that a method may set.
OPTIONS = {
    "contactProcessingThreshold": Option("a distance in m of at least 0", numbers=NOT_NEGATIVE, kinds=CONTACT),
    "contactERP": Option("a number from 0 to 1", numbers=((Range(0.0, 1.0),),), kinds=CONTACT),
    "globalCFM": Option("a number of at least 0", numbers=NOT_NEGATIVE, kinds=CONTACT),
    "restitutionVelocityThreshold": Option("a speed in m/s of at least 0", numbers=NOT_NEGATIVE, kinds=CONTACT),
}

#: The method whose contacts act only when bodies touch, and add no velocity to a bounce.
BOUNCING = "multibody:contactERP=0,contactProcessingThreshold=0"


@dataclass(frozen=True, eq=False)
class Touching:
    """A physics server with bodies that touch; the server ends with this object.

    Parameters
    ----------
    client
        The number of the connection to the server.
    worlds
        The bodies, in their order.
    indices
        The indices of the bodies, and `WORLD` for the ground, by the server's numbers.
    pushes
        The pushes that act in each step from the next one on.
    """

    client: int
    worlds: tuple[World, ...]
    indices: Mapping[int, int]
    pushes: Iterator[tuple[Push, ...]] = field(repr=False)

    def step(self) -> None:
        """Take a time step."""
        for push in next(self.pushes):
            body = self.worlds[push.body].body
            position, (x, y, z, w) = pybullet.getBasePositionAndOrientation(body, physicsClientId=self.client)
            point = np.add(position, rotate(np.array([w, x, y, z]), np.array(push.point))).tolist()
            pybullet.applyExternalForce(body, BASE, push.force, point, pybullet.WORLD_FRAME, physicsClientId=self.client)
        pybullet.stepSimulation(physicsClientId=self.client)


def prepare(scene: AnyScene, method: Method) -> Loop[None]:
    """Return the simulation of bodies that touch, as `Adapter.prepare` does. Raises `SceneUnsupported`."""
    return simulated(scene, built(scene, method))


def simulated(scene: AnyScene, touching: Touching) -> Loop[None]:
    """Return the simulation of bodies that touch from their server."""
    if isinstance(scene, Mechanism):
        return several(touching.step, touching.worlds, seen, rows)
    return several(touching.step, touching.worlds, seen, lambda seen: in_body_frame(scene, rows(seen)))


def built(scene: AnyScene, method: Method) -> Touching:
    """Return a server with the bodies of a scene in their initial states. Raises `SceneUnsupported`."""
    bodies, maximal = touching_bodies(scene), method.integrator == "maximal"
    shapes = [collision_shape(body.shape, body.body.axes) for body in bodies]
    given, between = coefficients(scene, len(bodies), "product"), laws_of_pairs(scene, len(bodies))
    client = connected(scene.gravity, method)
    chosen = {key: float(value) for key, value in method.options if key in OPTIONS}
    of_body = {key: chosen.pop(key) for key in ("contactProcessingThreshold",) if key in chosen}
    pybullet.setPhysicsEngineParameter(physicsClientId=client, **chosen)
    indices: dict[int, int] = {}
    if scene.plane is not None:
        ground = add_ground(client, maximal, scene.plane, given[WORLD])
        pybullet.changeDynamics(ground, BASE, physicsClientId=client, **of_body)
        indices[ground] = WORLD
    worlds = []
    for index, (body, arguments) in enumerate(zip(bodies, shapes, strict=True)):
        shape = pybullet.createCollisionShape(**arguments, physicsClientId=client)
        number = pybullet.createMultiBody(body.body.mass, shape, useMaximalCoordinates=maximal, physicsClientId=client)
        worlds.append(world := World(client, number))
        on_plane = between.get((WORLD, index))
        resisting = {} if on_plane is None else moments(on_plane, given[WORLD].friction, maximal=maximal)
        set_properties(world, body.body, named(given[index]) | resisting | of_body, method)
        set_state(world, along_principal_axes(Scene(body.body, body.start)).initial)
    indices |= {world.body: index for index, world in enumerate(worlds)}
    for (one, first), (other, second) in combinations(enumerate(worlds), 2):
        if (one, other) not in between:
            pybullet.setCollisionFilterPair(first.body, second.body, BASE, BASE, enableCollision=0, physicsClientId=client)
    touching = Touching(client, tuple(worlds), indices, acting(scene.pushes, method.timestep))
    weakref.finalize(touching, pybullet.disconnect, client)
    return touching


def moments(law: Law, ground: float, *, maximal: bool) -> dict[str, float]:
    """Return the arguments of `changeDynamics` that set the rolling and the torsional friction of a body on the plane.

    Bullet adds the products of each body's rolling friction, a length, and the other one's friction.

    Parameters
    ----------
    law
        The law of the body on the plane.
    ground
        The coefficient of friction that the plane was given.
    maximal
        Whether bodies have maximal coordinates. Bullet then ignores torsional friction where there is no rolling friction.

    Raises
    ------
    SceneUnsupported
        For a plane without friction, or for torsional friction that Bullet would ignore.
    """
    if not law.resists:
        return {}
    if not ground:
        raise SceneUnsupported("rolling or torsional friction without friction, by which Bullet multiplies both")
    if maximal and not law.rolling_friction:
        raise SceneUnsupported("torsional friction without rolling friction: maximal coordinates ignore it then")
    return {"rollingFriction": law.rolling_friction / ground, "spinningFriction": law.torsional_friction / ground}


def interface_loads(scene: AnyScene, method: Method, steps: int) -> dict[tuple[int, int], Array]:
    """Return the normal forces between pairs that touch in each of n steps, as `InterfaceLoads.interface_loads` does."""
    touching = built(scene, method)
    by_pair: dict[tuple[int, int], Array] = {}
    for step in range(steps):
        touching.step()
        for point in pybullet.getContactPoints(physicsClientId=touching.client):
            one, other = sorted((touching.indices[point[1]], touching.indices[point[2]]))
            by_pair.setdefault((one, other), np.zeros(steps))[step] += point[9]
    return by_pair


def contact_terms(scene: AnyScene, method: Method) -> str:
    """Return which friction and restitution Bullet has in the place of those of a scene, as `ContactTerms` does."""
    if not touches(scene):
        return ""
    if grips(scene):
        return gripped_terms(scene)
    bodies = touching_bodies(scene)
    phrases = [*differences(scene, bodies, "product", MAX_FRICTION), *differing_moments(scene, bodies, method)]
    if any(law.restitution for law in laws(scene)):
        threshold = float(method.option("restitutionVelocityThreshold") or BOUNCE_THRESHOLD)
        phrases += [f"no restitution below {threshold:g} m/s"] if threshold else []
    return "; ".join(phrases)


def gripped_terms(mechanism: Mechanism) -> str:
    """Return the law that Bullet has in the place of that of bodies on joints and what they touch."""
    shares = any(pair.cone == "one" for pair in mechanism.contacts)
    return "a bound of its own for friction and for torsional friction" if shares else ""


def differing_moments(scene: AnyScene, bodies: Sequence[TouchingBody], method: Method) -> list[str]:
    """Return, as noun phrases, what Bullet has in the place of the rolling and torsional friction of a scene."""
    given, between = coefficients(scene, len(bodies), "product"), laws_of_pairs(scene, len(bodies))
    if not any(law.resists for law in between.values()):
        return []
    maximal = method.integrator == "maximal"
    on_plane = {index: law for (one, index), law in between.items() if one == WORLD}
    resisting = {index: moments(law, given[WORLD].friction, maximal=maximal) for index, law in on_plane.items()}
    phrases = ["a bound of its own for friction, torsional friction, and rolling friction about each of two axes"]
    for what, key, wanted in (
        ("rolling friction", "rollingFriction", {pair: law.rolling_friction for pair, law in between.items()}),
        ("torsional friction", "spinningFriction", {pair: law.torsional_friction for pair, law in between.items()}),
    ):

        def arrived(one: int, other: int, key: str = key) -> float:
            of_one, of_other = (resisting.get(index, {}).get(key, 0.0) for index in (one, other))
            return of_one * given[other].friction + of_other * given[one].friction

        phrases += differing(what, wanted, arrived, bodies)
    return phrases
