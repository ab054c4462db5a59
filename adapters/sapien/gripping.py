"""Bodies on joints that touch free bodies, such as fingers that hold a body, in SAPIEN.

The bodies and joints are the links of the articulations of `mechanisms`. The links that touch others have a box or a sphere,
and the collision groups of PhysX let only the pairs of the scene collide. PhysX takes the mean of two coefficients, and the
larger of two patches of torsional friction: the body on a joint has that of its pair, and the free body none.
"""

from collections.abc import Mapping
from typing import Any

from sapien import Pose

from bodycheck.adapters.contract import Method, SceneUnsupported
from bodycheck.adapters.pair_coefficients import coefficients
from bodycheck.adapters.sapien.touching import groups, patch_radius
from bodycheck.adapters.sapien.worlds import material
from bodycheck.adapters.touching import Law, laws_of_pairs
from bodycheck.reference.mechanisms.exact import nearest_inertia
from bodycheck.reference.mechanisms.mechanism import Mechanism, shape_of
from bodycheck.reference.planar import describe_shape
from bodycheck.reference.scene import Brick, Sphere

#: The requirements of bodies on joints that touch others.
MODELS = frozenset({"contacts of bodies on joints"})

#: The density of shapes, whose links have masses of their own.
NO_DENSITY = 0.0


def add_shapes(builders: Mapping[int, Any], mechanism: Mechanism, method: Method) -> None:
    """Add shapes to the builders of those links, by the indices of their bodies, that touch others.

    Raises `SceneUnsupported` for other shapes, for torsional friction that PhysX would ignore, and for pairs whose coefficients
    the means of coefficients of bodies do not give.
    """
    count = len(mechanism.bodies)
    laws, given = laws_of_pairs(mechanism, count), coefficients(mechanism, count, "mean")
    for (one, other), law in laws.items():
        arrived = (given[one].friction + given[other].friction) / 2, (given[one].restitution + given[other].restitution) / 2
        if any(abs(mean - wanted) > 1e-9 for mean, wanted in zip(arrived, (law.friction, law.restitution), strict=True)):
            names = mechanism.bodies[one].name, mechanism.bodies[other].name
            raise SceneUnsupported(f"the coefficients of {names[0]} and {names[1]} beside those of the other pairs")
    colliding = groups(laws, count)
    for index, builder in builders.items():
        if any(index in pair for pair in laws):
            add_shape(builder, mechanism, index, {"material": material(given[index]), **patch(laws, mechanism, index, method)})
            builder.collision_groups = colliding[index]


def add_shape(builder: Any, mechanism: Mechanism, index: int, surface: Mapping[str, Any]) -> None:
    """Add the shape of a body about its centre of mass to the builder of its link. Raises `SceneUnsupported`."""
    body = mechanism.bodies[index]
    pose = Pose(nearest_inertia(body).centre)
    match shape := shape_of(body):
        case Sphere():
            builder.add_sphere_collision(pose, shape.radius, density=NO_DENSITY, **surface)
        case Brick():
            builder.add_box_collision(pose, shape.semi_axes, density=NO_DENSITY, **surface)
        case _:
            raise SceneUnsupported(f"{describe_shape(shape)} on a joint, or between bodies on joints")


def patch(laws: Mapping[tuple[int, int], Law], mechanism: Mechanism, index: int, method: Method) -> dict[str, float]:
    """Return the argument with the patch of the torsional friction of a body on a joint."""
    resisting = [law for pair, law in laws.items() if index in pair and law.torsional_friction]
    if not resisting or mechanism.joint_of[index] is None:
        return {}
    return {"min_patch_radius": max(patch_radius(law, method) for law in resisting)}
