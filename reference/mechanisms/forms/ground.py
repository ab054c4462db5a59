"""Mechanisms in which every joint that moves is on the world: the bodies that each joint carries, as one rigid body.

Bodies that fixed joints connect count as one body. All numbers have a hundred digits.
"""

from dataclasses import dataclass

from bodycheck.reference.exact.inertia import MassProperties, joined
from bodycheck.reference.exact.numbers import MP, NEGLIGIBLE, Quaternion4, Real, Vector3, vector
from bodycheck.reference.exact.rotations import IDENTITY, ORIGIN, conjugate, dot, matrix, multiply, plus, turned
from bodycheck.reference.mechanisms.exact import inertia, turn, unit_axis
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Mechanism


@dataclass(frozen=True, eq=False)
class Carried:
    """A joint on the world, and the rigid body that it carries: its child with all bodies fixed to the child.

    Attributes
    ----------
    index, joint
        The joint, and its index in the mechanism.
    attitude, origin
        The unit quaternion from the joint's axes to the world's axes, and the joint's origin in the world (m).
    mass, centre, tensor
        Mass (kg), centre of mass (m) in the child's frame, and inertia tensor about it along the child's axes (kg m^2).
    gravity
        The gravitational acceleration along the joint's axes (m/s^2).
    """

    index: int
    joint: Joint
    attitude: Quaternion4
    origin: Vector3
    mass: Real
    centre: Vector3
    tensor: tuple[Real, Real, Real, Real, Real, Real]
    gravity: Vector3


def carried(mechanism: Mechanism) -> tuple[Carried, ...] | None:
    """Return each moving joint with the body that it carries.

    Returns None if a moving joint is not on the world, a body is free, or there are loops.
    """
    above = mechanism.joint_of
    if mechanism.loops or any(joint is None for joint in above):
        return None
    groups: dict[int, list[tuple[int, Quaternion4, Vector3]]] = {}
    for body in range(len(mechanism.bodies)):
        root, attitude, origin = _in_root(mechanism, body)
        groups.setdefault(root, []).append((body, attitude, origin))
    parts = []
    for index, joint in enumerate(mechanism.joints):
        if joint.type == "fixed":
            continue
        root, attitude, origin = _in_root(mechanism, joint.parent)
        if root != WORLD:
            return None
        joint_turn = turn(joint.attitude)
        origin = plus(origin, turned(matrix(attitude), vector(joint.position)))
        attitude = multiply(attitude, joint_turn)
        whole = joined([_placed(mechanism, *member) for member in groups[joint.child]])
        down = turned(matrix(conjugate(attitude)), (MP.mpf(0), MP.mpf(0), -MP.mpf(mechanism.gravity)))
        parts.append(Carried(index, joint, attitude, origin, whole.mass, whole.centre, whole.tensor, _clean(down)))
    return tuple(parts)


def moment_about(held: Carried, axis: Vector3) -> Real:
    """The moment of inertia (kg m^2) of the body that a joint carries, about a unit axis through the joint's origin."""
    x, y, z = axis
    xx, yy, zz, xy, xz, yz = held.tensor
    about_centre = xx * x * x + yy * y * y + zz * z * z + 2 * (xy * x * y + xz * x * z + yz * y * z)
    arm = cross(axis, held.centre)
    return about_centre + held.mass * dot(arm, arm)


def axis_of(held: Carried) -> Vector3:
    """The unit axis of a revolute or prismatic joint, in the joint's frame."""
    return unit_axis(held.joint)


def cross(one: Vector3, other: Vector3) -> Vector3:
    """The vector product of two vectors; components that differ from zero only by rounding are zero."""
    (a, b, c), (x, y, z) = one, other
    return _difference(b * z, c * y), _difference(c * x, a * z), _difference(a * y, b * x)


def _difference(one: Real, other: Real) -> Real:
    value = one - other
    return value if abs(value) > NEGLIGIBLE * abs(one) else MP.mpf(0)


def _clean(v: Vector3) -> Vector3:
    """The vector, with zeros for components that differ from zero only by rounding."""
    limit = NEGLIGIBLE * max(abs(part) for part in v)
    x, y, z = (part if abs(part) > limit else MP.mpf(0) for part in v)
    return x, y, z


def _in_root(mechanism: Mechanism, body: int) -> tuple[int, Quaternion4, Vector3]:
    """The root to which fixed joints connect a body, and the body's attitude and origin (m) in the root's frame.

    The root is the first body on the way to the world that is not on a fixed joint, or the world.
    """
    attitude, origin = IDENTITY, ORIGIN
    above = mechanism.joint_of
    while body != WORLD:
        joint = above[body]
        if joint is None or joint.type != "fixed":
            break
        joint_turn = turn(joint.attitude)
        origin = plus(vector(joint.position), turned(matrix(joint_turn), origin))
        attitude, body = multiply(joint_turn, attitude), joint.parent
    return body, attitude, origin


def _placed(mechanism: Mechanism, body: int, attitude: Quaternion4, origin: Vector3) -> MassProperties:
    """The mass properties of a body in an outer frame, in which the body has an attitude and an origin (m)."""
    body_inertia = inertia(mechanism.bodies[body])
    if attitude == IDENTITY:
        return MassProperties(body_inertia.mass, plus(origin, body_inertia.centre), body_inertia.tensor)
    rows = matrix(attitude)
    xx, yy, zz, xy, xz, yz = body_inertia.tensor
    whole = ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))

    def component(i: int, j: int) -> Real:
        return sum(rows[i][k] * whole[k][m] * rows[j][m] for k in range(3) for m in range(3))

    tensor = (component(0, 0), component(1, 1), component(2, 2), component(0, 1), component(0, 2), component(1, 2))
    return MassProperties(body_inertia.mass, plus(origin, turned(rows, body_inertia.centre)), tensor)
