"""Step free bodies that touch a plane and each other in Rapier, by Rapier's own contacts.

The plane is a half-space. Bodies are Rapier's balls, cuboids and cylinders. Rapier uses the mean of the coefficients of two
bodies. A push is a force that is set in each step.

Bounces have the coefficient exactly, but only a part of the friction of their impulse, and less with shorter steps. With
`settings=engine`, a body whose speed stays low falls asleep, also on a slope that it slides down.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import rapier3d

from bodycheck.adapters.attitudes import in_body_frame
from bodycheck.adapters.contract import Method
from bodycheck.adapters.rapier.worlds import World, add_plane, check, collider, moving, new_world, rows, seen, unlimited
from bodycheck.adapters.stepping import Normalised, several
from bodycheck.adapters.touching import acting, coefficients, differences, plane_of, touching_bodies
from bodycheck.reference.inertia import along_principal_axes
from bodycheck.reference.mechanisms.mechanism import WORLD, AnyScene, Mechanism
from bodycheck.reference.scene import Push, Scene, Sphere
from bodycheck.reference.trajectory import Array

#: The requirements of touching bodies that Rapier models.
MODELS = frozenset({"incline", "restitution", "rolling", "pushes", "contacts"})

#: Rapier's default law of friction of the contacts of a face.
SIMPLIFIED = "friction of a face as one force and one torque against its spin, with a bound each"


@dataclass(frozen=True, eq=False)
class Touching:
    """A world of Rapier with bodies that touch.

    Parameters
    ----------
    world
        The world.
    worlds
        The bodies, in their order.
    indices
        The indices of the bodies, and `WORLD` for the plane, by the handles of their colliders.
    pushes
        The pushes that act in each step from the next one on.
    pushed
        The bodies that are pushed in any step.
    """

    world: rapier3d.PhysicsWorld
    worlds: tuple[World, ...]
    indices: dict[object, int]
    pushes: Iterator[tuple[Push, ...]]
    pushed: tuple[rapier3d.RigidBody, ...]

    def step(self) -> None:
        """Take a time step. Raises `EngineReset` if Rapier has taken a body out of the simulation."""
        for body in self.pushed:  # Rapier keeps forces until they are reset
            body.reset_forces(wake_up=False)
            body.reset_torques(wake_up=False)
        for push in next(self.pushes):
            body = self.worlds[push.body].body
            body.add_force_at_point(push.force, body.position.transform_point(push.point))
        self.world.step()
        for world in self.worlds:
            check(world)


def prepare(scene: AnyScene, method: Method) -> Normalised:
    """Return the simulation of bodies that touch, as `Adapter.prepare` does. Raises `SceneUnsupported`."""
    return simulated(scene, built(scene, method))


def simulated(scene: AnyScene, touching: Touching) -> Normalised:
    """Return the simulation of bodies that touch from their world."""
    if isinstance(scene, Mechanism):
        return Normalised(several(touching.step, touching.worlds, seen, rows))
    return Normalised(several(touching.step, touching.worlds, seen, lambda seen: in_body_frame(scene, rows(seen))))


def built(scene: AnyScene, method: Method) -> Touching:
    """Return a world with the bodies of a scene in their initial states. Raises `SceneUnsupported`."""
    bodies = touching_bodies(scene)
    given = coefficients(scene, len(bodies), "mean")
    shapes = [collider(body.shape, body.body.axes, given[index]) for index, body in enumerate(bodies)]
    world = new_world(scene.gravity, method)
    indices: dict[object, int] = {add_plane(world, plane_of(scene).incline, given[WORLD]): WORLD}
    worlds = []
    for index, (body, shape) in enumerate(zip(bodies, shapes, strict=True)):
        builder = moving(body.body, along_principal_axes(Scene(body.body, body.start)).initial)
        view = world.rigid_bodies[world.add_body(unlimited(builder, method), [shape])]
        indices |= dict.fromkeys(view.colliders, index)
        worlds.append(World(world, view))
    pushed = tuple(worlds[index].body for index in sorted({push.body for push in scene.pushes}))
    return Touching(world, tuple(worlds), indices, acting(scene.pushes, method.timestep), pushed)


def interface_loads(scene: AnyScene, method: Method, steps: int) -> dict[tuple[int, int], Array]:
    """Return the normal forces between pairs that touch in each of n steps, as `InterfaceLoads.interface_loads` does."""
    touching = built(scene, method)
    by_pair: dict[tuple[int, int], Array] = {}
    for step in range(steps):
        touching.step()
        for pair in touching.world.narrow_phase.contact_pairs():  # also pairs that are only near each other
            one, other = sorted((touching.indices[pair.collider1], touching.indices[pair.collider2]))
            if pressed := sum(point.impulse for manifold in pair.manifolds for point in manifold.points):
                by_pair.setdefault((one, other), np.zeros(steps))[step] += pressed / method.timestep
    return by_pair


def contact_terms(scene: AnyScene, method: Method) -> str:
    """Return which friction and restitution Rapier has in the place of those of a scene, as `ContactTerms` does."""
    if scene.plane is None:
        return ""
    bodies = touching_bodies(scene)
    phrases = differences(scene, bodies, "mean")
    if method.option("friction") != "coulomb" and not all(isinstance(body.shape, Sphere) for body in bodies):
        phrases.append(SIMPLIFIED)
    return "; ".join(phrases)
