"""Frames relative to other frames, at rest and moving, and mass properties in them, in exact arithmetic."""

from collections.abc import Sequence
from dataclasses import dataclass

from bodycheck.reference.exact.inertia import Components, MassProperties, joined
from bodycheck.reference.exact.numbers import MP, Quaternion4, Real, Vector3, vector
from bodycheck.reference.exact.rotations import IDENTITY, ORIGIN, conjugate, cross, matrix, multiply, plus, scaled, turned, unit
from bodycheck.reference.mechanisms import exact
from bodycheck.reference.mechanisms.mechanism import Joint, JointedBody, Mechanism

#: A sum that is smaller than its terms by this factor is taken to be zero, apart from rounding.
NEGLIGIBLE = MP.mpf(10) ** -80


@dataclass(frozen=True, eq=False)
class Place:
    """A frame in an outer frame: the unit quaternion from its axes to the outer axes, and its origin in the outer frame (m)."""

    turn: Quaternion4 = IDENTITY
    origin: Vector3 = ORIGIN

    def then(self, inner: "Place") -> "Place":
        """The place in the outer frame of a frame that is given in this frame."""
        return Place(multiply(self.turn, inner.turn), self.point(inner.origin))

    def point(self, inner: Vector3) -> Vector3:
        """The coordinates in the outer frame of a point that is given in this frame (m)."""
        return plus(self.origin, rotated(self.turn, inner))

    def inverse(self) -> "Place":
        """The place of the outer frame in this frame."""
        back = conjugate(self.turn)
        return Place(back, rotated(back, scaled(MP.mpf(-1), self.origin)))


@dataclass(frozen=True, eq=False)
class Moving:
    """A frame that moves in the world.

    pose: its place in the world. velocity: of its origin, world (m/s). spin: angular velocity along its own axes (rad/s).
    """

    pose: Place = Place()
    velocity: Vector3 = ORIGIN
    spin: Vector3 = ORIGIN

    def carried(self, inner: Place) -> "Moving":
        """The motion in the world of a frame that is fixed in this frame, at `inner`."""
        arm = rotated(self.pose.turn, inner.origin)
        swung = cross(rotated(self.pose.turn, self.spin), arm)
        return Moving(self.pose.then(inner), plus(self.velocity, swung), rotated(conjugate(inner.turn), self.spin))

    def moved(self, inner: Place, velocity: Vector3, spin: Vector3) -> "Moving":
        """The motion in the world of a frame that moves in this frame.

        inner: its place in this frame. velocity: of its origin relative to this frame, along the axes of this frame (m/s).
        spin: its angular velocity relative to this frame, along its own axes (rad/s).
        """
        at = self.carried(inner)
        return Moving(at.pose, plus(at.velocity, rotated(self.pose.turn, velocity)), plus(at.spin, spin))


def rotated(turn: Quaternion4, v: Vector3) -> Vector3:
    """A vector turned by a unit quaternion."""
    return v if turn == IDENTITY else turned(matrix(turn), v)


def onto(axis: Vector3) -> Quaternion4:
    """The unit quaternion of the smallest rotation that takes z to a unit vector."""
    x, y, z = axis
    if abs(x) + abs(y) < NEGLIGIBLE:
        return IDENTITY if z > 0 else (MP.mpf(0), MP.mpf(1), MP.mpf(0), MP.mpf(0))
    return unit((1 + z, -y, x, MP.mpf(0)))


def cleaned(values: Sequence[Real], scale: Real) -> tuple[Real, ...]:
    """Replace numbers that differ from zero or one only by rounding. scale: the size of the terms of which they are sums."""
    limit = NEGLIGIBLE * scale
    return tuple(
        MP.mpf(0) if abs(value) <= limit else MP.sign(value) if abs(abs(value) - 1) <= NEGLIGIBLE else value for value in values
    )


def placed(properties: MassProperties, pose: Place) -> MassProperties:
    """Convert mass properties from a frame to an outer frame. pose: the place of the frame in the outer frame."""
    return MassProperties(properties.mass, pose.point(properties.centre), _turned_tensor(pose.turn, properties.tensor))


def about_origin(properties: MassProperties) -> Components:
    """The inertia tensor about the origin of the frame instead of the centre of mass, by the parallel-axis theorem."""
    (x, y, z), m = properties.centre, properties.mass
    xx, yy, zz, xy, xz, yz = properties.tensor
    return (
        xx + m * (y * y + z * z),
        yy + m * (x * x + z * z),
        zz + m * (x * x + y * y),
        xy - m * x * y,
        xz - m * x * z,
        yz - m * y * z,
    )


def _turned_tensor(turn: Quaternion4, tensor: Components) -> Components:
    """Convert a tensor to other axes. turn: unit quaternion from its axes to the other axes.

    The components off the diagonal, XY, XZ and YZ, are the entries of the tensor, without a change of sign.
    """
    if turn == IDENTITY:
        return tensor
    xx, yy, zz, xy, xz, yz = tensor
    rows, entries = matrix(turn), ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))

    def component(i: int, j: int) -> Real:
        return sum(rows[i][k] * entries[k][m] * rows[j][m] for k in range(3) for m in range(3))

    return component(0, 0), component(1, 1), component(2, 2), component(0, 1), component(0, 2), component(1, 2)


def frame_of(joint: Joint) -> Place:
    """The frame of a joint in the frame of its parent, if its coordinates are zero."""
    return Place(exact.turn(joint.attitude), vector(joint.position))


def _properties(body: JointedBody) -> MassProperties:
    inertia = exact.inertia(body)
    return MassProperties(inertia.mass, inertia.centre, inertia.tensor)


def fused(mechanism: Mechanism, body: int) -> MassProperties:
    """The mass properties of a body together with all bodies that are fixed to it, in its frame."""
    parts, frames = [_properties(mechanism.bodies[body])], [(body, Place())]
    for carrier, pose in frames:
        for joint in mechanism.joints:
            if joint.parent == carrier and joint.type == "fixed":
                frames.append((joint.child, pose.then(frame_of(joint))))
                parts.append(placed(_properties(mechanism.bodies[joint.child]), frames[-1][1]))
    return joined(parts) if len(parts) > 1 else parts[0]
