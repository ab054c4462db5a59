"""The bodies of a scene at t = 0 in the world frame, with a hundred digits: what the witnesses of bodies with faces start from."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.independent.arithmetic import (
    Matrix,
    Real,
    Vector,
    Wide,
    WideArray,
    applied,
    cross,
    dot,
    scaled,
    transposed,
    wide,
)
from bodycheck.reference.independent.border import MP, Border, border
from bodycheck.reference.mechanisms.mechanism import WORLD, AnyScene, JointedBody, Mechanism, shape_of
from bodycheck.reference.scene import Body, Brick, Cylinder, Definition, Nearest, Push, Scene, Shape, State
from bodycheck.reference.scene import Vector as Doubles

#: The ratio of a length to the size of a body, or of a velocity along the normal to the whole velocity, up to which it counts as
#: zero, because of the decimals in the file.
DECIMALS = 1e-12

#: The unit vectors along the axes.
AXES = ((1, 0, 0), (0, 1, 0), (0, 0, 1))

#: A body whose numbers do not count, since a definition has them all.
_NO_BODY, _NO_STATE = Body(1.0, (1.0, 1.0, 1.0)), State()
_NEAREST = Nearest(_NO_BODY.moments, _NO_BODY.axes, _NO_STATE.quaternion, _NO_STATE.angular_velocity)


@dataclass(frozen=True, eq=False)
class RigidBody:
    """A body at t = 0.

    Attributes
    ----------
    shape
        Its shape about its centre of mass, along the axes of its frame.
    begin
        Its mass, inertia tensor, attitude and angular velocity.
    place, velocity
        Position (m) and velocity (m/s) of its centre of mass, world frame.
    """

    shape: Shape
    begin: Border
    place: Vector
    velocity: Vector

    def axis(self, index: int) -> Vector:
        """One of its axes, by its index, world frame."""
        return transposed(self.begin.cosines)[index]

    def along_axes(self, vector: Vector) -> Vector:
        """The components along its axes of a vector in the world frame."""
        return applied(transposed(self.begin.cosines), vector)

    def in_world(self, vector: Vector) -> Vector:
        """The components in the world frame of a vector along its axes."""
        return applied(self.begin.cosines, vector)

    @property
    def half_lengths(self) -> Vector:
        """Its half-lengths along its axes (m); those of a cylinder are its radius, twice, and half its length."""
        match self.shape:
            case Brick(semi_axes):
                return numbers(semi_axes)
            case Cylinder(radius, half_length):
                return numbers((radius, radius, half_length))
            case _:
                raise TypeError(self.shape)  # callers have excluded bodies without faces


def numbers(values: Doubles) -> Vector:
    """Three doubles as numbers of a hundred digits."""
    x, y, z = values
    return MP.mpf(x), MP.mpf(y), MP.mpf(z)


def rigid_bodies(scene: AnyScene) -> list[RigidBody] | None:
    """The bodies of a scene; None if a body has no shape."""
    bodies = scene.bodies if isinstance(scene, Mechanism) else (scene,)
    collected = [_jointed(body) if isinstance(body, JointedBody) else _single(body, body.body.shape) for body in bodies]
    known = [body for body in collected if body is not None]
    return known if len(known) == len(collected) else None


def _jointed(body: JointedBody) -> RigidBody | None:
    assert body.start is not None  # a scene with a plane has no joints
    start = body.start
    initial = State(position=start.position, velocity=start.velocity)
    definition = Definition(body.inertia, start.attitude, start.rotation, _NEAREST)
    return _single(Scene(_NO_BODY, initial, definition=definition), shape_of(body))


def _single(scene: Scene, shape: Shape | None) -> RigidBody | None:
    if shape is None:
        return None
    return RigidBody(shape, border(scene), numbers(scene.initial.position), numbers(scene.initial.velocity))


def normal_of(scene: AnyScene) -> Vector:
    """The unit normal of the plane of a scene, world frame."""
    assert scene.plane is not None  # the caller has checked this
    cosine, sine = MP.cos_sin(MP.mpf(scene.plane.incline))
    return sine, MP.zero, cosine


def friction_of(scene: AnyScene, one: int, other: int = WORLD) -> Real:
    """The coefficient of friction of two bodies, or of a body and the plane; it may be infinite."""
    assert scene.plane is not None  # the caller has checked this
    pairs = scene.contacts if isinstance(scene, Mechanism) else ()
    stated = [pair.friction for pair in pairs if set(pair.bodies) == {one, other}]
    return MP.mpf(stated[0] if stated else scene.plane.friction)


def tangential(vector: Vector, normal: Vector) -> Vector:
    """The part of a vector that is perpendicular to a unit normal."""
    return difference(vector, scaled(normal, dot(vector, normal)))


def total(vectors: Sequence[Vector]) -> Vector:
    """The sum of vectors."""
    x, y, z = (sum((vector[axis] for vector in vectors), MP.zero) for axis in range(3))
    return x, y, z


def difference(one: Vector, other: Vector) -> Vector:
    """The difference of two vectors."""
    return one[0] - other[0], one[1] - other[1], one[2] - other[2]


def acting(pushes: Sequence[Push], time: Real) -> list[Push]:
    """The pushes that act at an instant (s), or from this instant on."""
    return [push for push in pushes if push.start <= time < push.end]


def wide_vector(vector: Sequence[Real]) -> WideArray:
    """A vector of a hundred digits, rounded to the wide type."""
    return np.array([wide(component) for component in vector], dtype=Wide)


def constant(values: WideArray, count: int) -> WideArray:
    """A state (k,) at `count` instants, of one body: (1, count, k)."""
    return np.tile(values, (1, count, 1))


def inverse(rows: Matrix) -> Matrix:
    """The inverse of a regular matrix, from the vector products of its rows."""
    columns = cross(rows[1], rows[2]), cross(rows[2], rows[0]), cross(rows[0], rows[1])
    return transposed([scaled(column, 1 / dot(rows[0], columns[0])) for column in columns])
