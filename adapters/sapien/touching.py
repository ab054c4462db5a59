"""Step free bodies that touch a plane and each other in SAPIEN, by PhysX's own contacts.

The plane is PhysX's plane, turned about y. Bodies are SAPIEN's boxes, spheres and cylinders; a cylinder is a polyhedron there.
PhysX uses the mean of the coefficients of two bodies. A push is a force that is applied in each step. The torsional friction of
a body on the plane is that of a patch, whose radius is `min_patch_radius` of its shape; the solver PGS has none.

PhysX does not bounce bodies that meet more slowly than 2 m/s. The option `bounce_threshold` is this speed; at the speed that
gravity gives in a step a ball would not come to rest. A bounce has the coefficient times the velocity before it, to which
gravity has added that of the step. The friction of a first impact is missing at some places within a step, with TGS at half of
them at 10 ms, and complete at 1 ms.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import sapien
from sapien import physx

from bodycheck.adapters.attitudes import in_body_frame
from bodycheck.adapters.contract import Method, Option, SceneUnsupported
from bodycheck.adapters.method import Range
from bodycheck.adapters.pair_coefficients import coefficients, differences
from bodycheck.adapters.sapien.worlds import World, add_plane, collision_shape, moving, new_system, rows, seen
from bodycheck.adapters.stepping import Normalised, several
from bodycheck.adapters.touching import Law, acting, laws, laws_of_pairs, touching_bodies
from bodycheck.reference.inertia import along_principal_axes
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.mechanisms.mechanism import WORLD, AnyScene, Mechanism
from bodycheck.reference.requirements import grips, touches
from bodycheck.reference.scene import Push, Scene
from bodycheck.reference.trajectory import Array

#: The requirements of touching bodies that PhysX models.
MODELS = frozenset(
    {"incline", "restitution", "rolling", "pushes", "contacts", "contacts without a plane", "torsional friction"}
)

#: PhysX's setting of contacts that a method may set. PhysX refuses zero.
OPTIONS = {
    "bounce_threshold": Option("a speed in m/s above 0", numbers=((Range(0.0, above=True),),), kinds=frozenset({"contact"})),
}

#: The methods that also bounce slow bodies: faster than the speed that gravity gives in SAPIEN's default step of 10 ms.
BOUNCING = tuple(f"{solver}:bounce_threshold=0.1" for solver in ("PGS", "TGS"))


@dataclass(frozen=True, eq=False)
class Touching:
    """A scene of SAPIEN with bodies that touch.

    Parameters
    ----------
    system
        The scene of PhysX.
    worlds
        The bodies, in their order.
    ground
        The component of the plane, if there is one.
    pushes
        The pushes that act in each step from the next one on.
    """

    system: physx.PhysxCpuSystem
    worlds: tuple[World, ...]
    ground: physx.PhysxRigidStaticComponent | None
    pushes: Iterator[tuple[Push, ...]]

    def step(self) -> None:
        """Take a time step."""
        for push in next(self.pushes):
            world = self.worlds[push.body]
            pose = world.entity.pose
            point = pose.p + rotate(np.asarray(pose.q, dtype=np.float64), np.array(push.point))
            world.body.add_force_at_point(push.force, point)
        self.system.step()


def prepare(scene: AnyScene, method: Method) -> Normalised:
    """Return the simulation of bodies that touch, as `Adapter.prepare` does. Raises `SceneUnsupported`."""
    return simulated(scene, built(scene, method))


def simulated(scene: AnyScene, touching: Touching) -> Normalised:
    """Return the simulation of bodies that touch from their scene of SAPIEN."""
    if isinstance(scene, Mechanism):
        return Normalised(several(touching.step, touching.worlds, seen, rows))
    return Normalised(several(touching.step, touching.worlds, seen, lambda seen: in_body_frame(scene, rows(seen))))


def built(scene: AnyScene, method: Method) -> Touching:
    """Return a scene of SAPIEN with the bodies of a scene in their initial states. Raises `SceneUnsupported`."""
    bodies = touching_bodies(scene)
    given, between = coefficients(scene, len(bodies), "mean"), laws_of_pairs(scene, len(bodies))
    shapes = [collision_shape(body.shape, body.body.axes, given[index]) for index, body in enumerate(bodies)]
    for index, law in on_plane(scene, len(bodies)).items():
        if law.torsional_friction:
            shapes[index].min_patch_radius = patch_radius(law, method)
    system = new_system(scene.gravity, method)
    whole = sapien.Scene([system])
    if scene.plane is None:
        for shape, colliding in zip(shapes, groups(between, len(bodies)), strict=True):
            shape.set_collision_groups(colliding)
    ground = None if scene.plane is None else add_plane(whole, scene.plane.incline, given[WORLD])
    worlds = []
    for body, shape in zip(bodies, shapes, strict=True):
        start = along_principal_axes(Scene(body.body, body.start)).initial
        worlds.append(World(whole, system, *moving(whole, body.body, start, shape, method)))
    return Touching(system, tuple(worlds), ground, acting(scene.pushes, method.timestep))


def groups(pairs: Iterable[tuple[int, int]], count: int) -> list[list[int]]:
    """Return the four collision groups of each of `count` bodies of which only some pairs, by their indices, collide.

    Two shapes collide if the first group of one has a bit of the second group of the other.
    """
    partners = [0] * count
    for one, other in pairs:
        partners[one] |= 1 << other
        partners[other] |= 1 << one
    return [[1 << index, partners[index], 0, 0] for index in range(count)]


def on_plane(scene: AnyScene, count: int) -> dict[int, Law]:
    """Return the laws of the plane with each of `count` bodies, by their indices; none without a plane."""
    return {other: law for (one, other), law in laws_of_pairs(scene, count).items() if one == WORLD}


def patch_radius(law: Law, method: Method) -> float:
    """Return the radius (m) of the patch of a law with torsional friction: its moment is that of friction at this radius.

    Raises `SceneUnsupported` where PhysX would ignore it.
    """
    if method.integrator == "PGS":
        raise SceneUnsupported("torsional friction, which PhysX's solver PGS ignores")
    if not law.friction:
        raise SceneUnsupported("torsional friction without friction, by which PhysX multiplies it")
    return law.torsional_friction / law.friction


def interface_loads(scene: AnyScene, method: Method, steps: int) -> dict[tuple[int, int], Array]:
    """Return the normal forces between pairs that touch in each of n steps, as `InterfaceLoads.interface_loads` does."""
    touching = built(scene, method)
    components: list[Any] = [touching.ground, *(world.body for world in touching.worlds)]
    by_pair: dict[tuple[int, int], Array] = {}
    for step in range(steps):
        touching.step()
        for contact in touching.system.get_contacts():
            one, other = sorted(components.index(component) - 1 for component in contact.bodies)
            pressed = sum(abs(float(point.impulse @ point.normal)) for point in contact.points)
            by_pair.setdefault((one, other), np.zeros(steps))[step] += pressed / method.timestep
    return by_pair


def contact_terms(scene: AnyScene, method: Method) -> str:
    """Return which friction and restitution PhysX has in the place of those of a scene, as `ContactTerms` does."""
    if not touches(scene):
        return ""
    if grips(scene):
        return gripped_terms(scene, method)
    bodies = touching_bodies(scene)
    phrases = differences(scene, bodies, "mean")
    resisting = [law for law in on_plane(scene, len(bodies)).values() if law.torsional_friction]
    if method.integrator != "PGS" and all(law.friction for law in resisting):
        for radius in sorted({patch_radius(law, method) for law in resisting}):
            phrases.append(f"torsional friction of patches of {radius:.3g} m{', also between bodies' * (len(bodies) > 1)}")
    if any(law.cone == "one" for law in resisting):
        phrases.append("a bound of its own for friction and torsional friction")
    if any(law.restitution for law in laws(scene)):
        threshold = method.option("bounce_threshold") or physx.get_scene_config().bounce_threshold
        phrases.append(f"no restitution below {float(threshold):g} m/s")
    return "; ".join(phrases)


def gripped_terms(mechanism: Mechanism, method: Method) -> str:
    """Return the law that PhysX has in the place of that of bodies on joints and what they touch."""
    resisting = [law for law in laws(mechanism) if law.torsional_friction]
    radii = sorted({patch_radius(law, method) for law in resisting if law.friction}) if method.integrator != "PGS" else []
    phrases = [f"torsional friction of patches of {radius:.3g} m" for radius in radii]
    if any(law.cone == "one" for law in resisting):
        phrases.append("a bound of its own for friction and torsional friction")
    return "; ".join(phrases)
