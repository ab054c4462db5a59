"""Bodies on joints that touch free bodies, such as fingers that hold a body, in PyBullet.

The bodies and joints are those of `mechanisms`. The bodies that touch others have a sphere or a box in the URDF file of their
tree, and Bullet's filter lets only the pairs of the scene collide. Bullet multiplies the coefficients of friction and of
restitution of two bodies. It adds the products of each body's torsional friction, a length, and the other one's friction: the
body on a joint has that of its pair, and the free body none.
"""

from collections.abc import Mapping, Sequence
from itertools import combinations

import pybullet

from bodycheck.adapters.contract import Method, SceneUnsupported
from bodycheck.adapters.links import spaced
from bodycheck.adapters.pair_coefficients import shared
from bodycheck.adapters.pybullet.mechanisms import Part
from bodycheck.adapters.pybullet.touching import OPTIONS
from bodycheck.reference.mechanisms.exact import nearest_inertia
from bodycheck.reference.mechanisms.mechanism import Mechanism, shape_of
from bodycheck.reference.planar import describe_shape
from bodycheck.reference.scene import Brick, Sphere

#: The requirements of bodies on joints that touch others.
MODELS = frozenset({"contacts of bodies on joints"})


def collisions(mechanism: Mechanism) -> dict[int, str]:
    """Return the collision elements of the bodies that touch others, by their indices. Raises `SceneUnsupported`."""
    touching = sorted({index for pair in mechanism.contacts for index in pair.bodies})
    return {index: collision(mechanism, index) for index in touching}


def collision(mechanism: Mechanism, index: int) -> str:
    """Return the collision element of a body: its shape about its centre of mass. Raises `SceneUnsupported`."""
    body = mechanism.bodies[index]
    match shape := shape_of(body):
        case Sphere():
            geometry = f'<sphere radius="{spaced([shape.radius])}"/>'
        case Brick((a, b, c)):
            geometry = f'<box size="{spaced([2 * a, 2 * b, 2 * c])}"/>'
        case _:
            raise SceneUnsupported(f"{describe_shape(shape)} on a joint, or between bodies on joints")
    centre = spaced(nearest_inertia(body).centre)
    return f'<collision><origin xyz="{centre}" rpy="0 0 0"/><geometry>{geometry}</geometry></collision>'


def touch(client: int, mechanism: Mechanism, parts: Sequence[Part], method: Method) -> None:
    """Let the pairs of a mechanism collide, and no others, with their coefficients. Raises `SceneUnsupported`."""
    chosen = {key: float(value) for key, value in method.options if key in OPTIONS}
    of_body = {key: chosen.pop(key) for key in ("contactProcessingThreshold",) if key in chosen}
    pybullet.setPhysicsEngineParameter(physicsClientId=client, **chosen)
    friction, restitution, torsional = coefficients(mechanism)
    for index in friction:
        pybullet.changeDynamics(
            parts[index].tree,
            parts[index].link,
            lateralFriction=friction[index],
            restitution=restitution[index],
            spinningFriction=torsional[index],
            physicsClientId=client,
            **of_body,
        )
    touching = {pair.bodies for pair in mechanism.contacts}
    for one, other in combinations(range(len(parts)), 2):
        first, second, collide = parts[one], parts[other], (one, other) in touching
        ends = first.tree, second.tree, first.link, second.link
        pybullet.setCollisionFilterPair(*ends, enableCollision=collide, physicsClientId=client)


def coefficients(mechanism: Mechanism) -> tuple[Mapping[int, float], Mapping[int, float], Mapping[int, float]]:
    """Return friction, restitution and torsional friction (m) of the bodies that touch others, by their indices.

    Raises `SceneUnsupported` for coefficients of pairs that no coefficients of bodies give.
    """
    pairs = {pair.bodies: pair for pair in mechanism.contacts}
    friction = shared({bodies: pair.friction for bodies, pair in pairs.items()}, "product")
    restitution = shared({bodies: pair.restitution for bodies, pair in pairs.items()}, "product")
    torsional = dict.fromkeys(friction, 0.0)
    for (one, other), pair in pairs.items():
        if pair.rolling_friction:
            raise SceneUnsupported("rolling friction of two bodies")
        free, jointed = (other, one) if mechanism.joint_of[other] is None else (one, other)
        torsional[jointed] = pair.torsional_friction / friction[free] if friction[free] else 0.0
    for (one, other), pair in pairs.items():
        given = friction[one] * friction[other], restitution[one] * restitution[other]
        spinning = torsional[one] * friction[other] + torsional[other] * friction[one]
        wanted = pair.friction, pair.restitution, pair.torsional_friction
        if any(abs(a - b) > 1e-9 * b for a, b in zip((*given, spinning), wanted, strict=True)):
            names = mechanism.bodies[one].name, mechanism.bodies[other].name
            raise SceneUnsupported(f"the coefficients of {names[0]} and {names[1]} beside those of the other pairs")
    return friction, restitution, torsional
