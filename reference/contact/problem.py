"""The bodies of a scene that touch a plane or each other, along the axes of the plane, in the widest type of NumPy."""

import math
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.errors import NotModelled
from bodycheck.reference.exact.numbers import MP, Real, Vector3, Wide, wide
from bodycheck.reference.exact.rotations import IDENTITY as NO_TURN
from bodycheck.reference.exact.rotations import conjugate, matrix, multiply, turned
from bodycheck.reference.exact.start import start
from bodycheck.reference.inertia import IDENTITY
from bodycheck.reference.mechanisms import exact
from bodycheck.reference.mechanisms.mechanism import WORLD, AnyScene, Mechanism, PairContact, shape_of
from bodycheck.reference.planar import describe_shape
from bodycheck.reference.scene import Plane, Push, Scene, Shape
from bodycheck.reference.witness import WideArray

#: The ratio of a velocity along the normal to the whole velocity, or of a distance from the plane to the size of the body, up
#: to which the velocity or distance counts as zero, because of the decimals in the file.
NONE = 1e-12


@dataclass(frozen=True, eq=False)
class ContactBody:
    """A body at t = 0. Its frame is along its principal axes, and its shape is about its centre of mass.

    Attributes
    ----------
    name
        Its name.
    mass, moments
        Mass (kg) and principal moments (3,) along the axes of its frame (kg m^2).
    shape
        Its shape.
    position, velocity
        (3,) position (m) and velocity (m/s) of the centre of mass, along the axes of the plane.
    quaternion
        (4,) unit quaternion w, x, y, z, body to plane.
    spin
        (3,) angular velocity along the axes of the body (rad/s).
    """

    name: str
    mass: Wide
    moments: WideArray
    shape: Shape
    position: WideArray
    velocity: WideArray
    quaternion: WideArray
    spin: WideArray


@dataclass(frozen=True, eq=False)
class Problem:
    """Bodies on a plane. All vectors are along the axes of the plane: x downhill, z along the normal.

    Attributes
    ----------
    bodies
        The bodies.
    plane
        The plane, with the friction and restitution of all pairs that `contacts` does not name.
    contacts
        The pairs with a friction and restitution of their own.
    gravity
        (3,) gravitational acceleration (m/s^2).
    pushes
        The constant forces, with components along the axes of the plane.
    """

    bodies: tuple[ContactBody, ...]
    plane: Plane
    contacts: tuple[PairContact, ...]
    gravity: WideArray
    pushes: tuple[Push, ...]

    def contact(self, one: int, other: int = WORLD) -> Plane | PairContact:
        """The law of the contact of two bodies, given by their indices; by default that of a body and the plane."""
        both = min(one, other), max(one, other)
        return next((pair for pair in self.contacts if pair.bodies == both), self.plane)

    def pair(self, one: int, other: int = WORLD) -> tuple[float, float]:
        """Friction and restitution of two bodies, given by their indices; by default those of a body and the plane."""
        law = self.contact(one, other)
        return law.friction, law.restitution


def problem(scene: AnyScene) -> Problem:
    """The bodies of a scene with a plane.

    Raises `NotModelled` for bodies without a shape, or with a frame that is not along their principal axes, and for drag.
    """
    plane = scene.plane
    assert plane is not None  # the caller has checked this
    back = _to_plane(plane)
    bodies = _bodies(scene, back) if isinstance(scene, Mechanism) else (_body(scene, back),)
    sine, cosine = MP.sin(MP.mpf(plane.incline)), MP.cos(MP.mpf(plane.incline))
    gravity = MP.mpf(scene.gravity)
    return Problem(
        bodies,
        plane,
        scene.contacts if isinstance(scene, Mechanism) else (),
        _wide((gravity * sine, MP.mpf(0), -gravity * cosine)),
        tuple(_along(push, back) for push in scene.pushes),
    )


def turn_of(scene: AnyScene) -> WideArray:
    """The unit quaternion (4,) from the axes of the plane of a scene to those of the world; no rotation without a plane."""
    return _wide(NO_TURN if scene.plane is None else conjugate(_to_plane(scene.plane)))


def _to_plane(plane: Plane) -> tuple[Real, Real, Real, Real]:
    """The unit quaternion from the axes of the world to those of a plane."""
    half = MP.mpf(plane.incline) / 2
    return MP.cos(half), MP.mpf(0), -MP.sin(half), MP.mpf(0)


def _body(scene: Scene, back: tuple[Real, Real, Real, Real]) -> ContactBody:
    """The only body of a scene. back: the quaternion from the axes of the world to the axes of the plane."""
    if scene.drag:
        raise NotModelled("drag on a body that touches a plane")
    begin = start(scene)
    if scene.body.axes != IDENTITY:
        raise NotModelled("a body on a plane whose frame is not that of its principal axes")
    initial = scene.initial
    return ContactBody(
        "body",
        wide(MP.mpf(scene.body.mass)),
        _wide(begin.moments),
        _shaped(scene.body.shape),
        _turned(back, initial.position),
        _turned(back, initial.velocity),
        _wide(multiply(back, begin.attitude)),
        _wide(begin.rates),
    )


def _bodies(mechanism: Mechanism, back: tuple[Real, Real, Real, Real]) -> tuple[ContactBody, ...]:
    bodies = []
    for body in mechanism.bodies:
        inertia, begin = exact.inertia(body), body.start
        assert begin is not None  # a scene with a plane has no joints
        xx, yy, zz, *products = inertia.tensor
        if any(products):
            raise NotModelled("a body on a plane whose frame is not that of its principal axes")
        bodies.append(
            ContactBody(
                body.name,
                wide(inertia.mass),
                _wide((xx, yy, zz)),
                _shaped(shape_of(body)),
                _turned(back, begin.position),
                _turned(back, begin.velocity),
                _wide(multiply(back, exact.turn(begin.attitude))),
                _wide(exact.rates(begin.attitude, begin.rotation)),
            )
        )
    return tuple(bodies)


def _shaped(shape: Shape | None) -> Shape:
    if shape is None:
        raise NotModelled(f"{describe_shape(shape)} on a plane")
    return shape


def _along(push: Push, back: tuple[Real, Real, Real, Real]) -> Push:
    x, y, z = map(float, _turned(back, push.force))
    return Push((x, y, z), push.point, push.start, push.end, push.body)


def _turned(back: tuple[Real, Real, Real, Real], components: tuple[float, float, float]) -> WideArray:
    x, y, z = components
    return _wide(turned(matrix(back), (MP.mpf(x), MP.mpf(y), MP.mpf(z))))


def _wide(values: Vector3 | tuple[Real, Real, Real, Real]) -> WideArray:
    return np.array([wide(MP.mpf(value)) for value in values], dtype=Wide)


def holds(friction: float, tangential: Real, normal: Real) -> bool:
    """Return whether friction holds a force along the plane (N) under a normal force (N), both exact."""
    return math.isinf(friction) or bool(abs(tangential) <= MP.mpf(friction) * normal)
