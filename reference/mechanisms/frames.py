"""Frames in other frames, at rest and moving, in exact arithmetic."""

from collections.abc import Sequence
from dataclasses import dataclass

from bodycheck.reference.exact.inertia import Components, MassProperties
from bodycheck.reference.exact.numbers import MP, Quaternion4, Real, Vector3
from bodycheck.reference.exact.rotations import IDENTITY, ORIGIN, conjugate, cross, matrix, multiply, plus, scaled, turned, unit

#: What is smaller than its terms by this factor is what rounding has left of a zero.
NEGLIGIBLE = MP.mpf(10) ** -80


@dataclass(frozen=True, eq=False)
class Place:
    """A frame in another: the unit quaternion from its axes to those of the other, and its origin in the other (m)."""

    turn: Quaternion4 = IDENTITY
    origin: Vector3 = ORIGIN

    def then(self, inner: "Place") -> "Place":
        """A frame that is given in this one, in the other."""
        return Place(multiply(self.turn, inner.turn), self.point(inner.origin))

    def point(self, inner: Vector3) -> Vector3:
        """A point that is given in this frame, in the other."""
        return plus(self.origin, rotated(self.turn, inner))

    def inverse(self) -> "Place":
        """The other frame in this one."""
        back = conjugate(self.turn)
        return Place(back, rotated(back, scaled(MP.mpf(-1), self.origin)))


@dataclass(frozen=True, eq=False)
class Moving:
    """A frame that moves in the world.

    pose: where it is. velocity: that of its origin, world (m/s). spin: angular velocity along its own axes (rad/s).
    """

    pose: Place = Place()
    velocity: Vector3 = ORIGIN
    spin: Vector3 = ORIGIN

    def carried(self, inner: Place) -> "Moving":
        """A frame that is fixed in this one."""
        arm = rotated(self.pose.turn, inner.origin)
        swung = cross(rotated(self.pose.turn, self.spin), arm)
        return Moving(self.pose.then(inner), plus(self.velocity, swung), rotated(conjugate(inner.turn), self.spin))

    def moved(self, inner: Place, velocity: Vector3, spin: Vector3) -> "Moving":
        """A frame that moves in this one: its velocity along the axes of this frame, its angular velocity along its own."""
        at = self.carried(inner)
        return Moving(at.pose, plus(at.velocity, rotated(self.pose.turn, velocity)), plus(at.spin, spin))


def rotated(turn: Quaternion4, v: Vector3) -> Vector3:
    """A vector turned by a unit quaternion."""
    return v if turn == IDENTITY else turned(matrix(turn), v)


def onto(axis: Vector3) -> Quaternion4:
    """The smallest rotation that takes z to a direction of length one."""
    x, y, z = axis
    if abs(x) + abs(y) < NEGLIGIBLE:
        return IDENTITY if z > 0 else (MP.mpf(0), MP.mpf(1), MP.mpf(0), MP.mpf(0))
    return unit((1 + z, -y, x, MP.mpf(0)))


def cleaned(values: Sequence[Real], scale: Real) -> tuple[Real, ...]:
    """Numbers without what rounding has left of zeros and ones. scale: the size of the terms of which they are sums."""
    limit = NEGLIGIBLE * scale
    return tuple(
        MP.mpf(0) if abs(value) <= limit else MP.sign(value) if abs(abs(value) - 1) <= NEGLIGIBLE else value for value in values
    )


def placed(properties: MassProperties, pose: Place) -> MassProperties:
    """Mass properties that are given in one frame, in another, in which that frame is `pose`."""
    return MassProperties(properties.mass, pose.point(properties.centre), _turned_tensor(pose.turn, properties.tensor))


def about_origin(properties: MassProperties) -> Components:
    """The inertia tensor about the origin of the frame, by the parallel-axis theorem."""
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
    """A tensor along other axes, to which a unit quaternion leads. Off the diagonal are the components themselves."""
    if turn == IDENTITY:
        return tensor
    xx, yy, zz, xy, xz, yz = tensor
    rows, entries = matrix(turn), ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))

    def component(i: int, j: int) -> Real:
        return sum(rows[i][k] * entries[k][m] * rows[j][m] for k in range(3) for m in range(3))

    return component(0, 0), component(1, 1), component(2, 2), component(0, 1), component(0, 2), component(1, 2)
