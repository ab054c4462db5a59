"""Spheres at an instant, with a hundred digits, along the axes of the world."""

import math
from dataclasses import dataclass

from bodycheck.reference.errors import NotModelled
from bodycheck.reference.exact.numbers import MP, Real, Vector3, vector
from bodycheck.reference.exact.rotations import dot, matrix, turned
from bodycheck.reference.mechanisms import exact
from bodycheck.reference.mechanisms.mechanism import WORLD, JointedBody, Mechanism, shape_of
from bodycheck.reference.scene import Ellipsoid, Sphere


@dataclass(frozen=True, eq=False)
class Law:
    """Coulomb's coefficient of friction, which may be infinite, and the coefficient of restitution of a pair."""

    friction: Real
    restitution: Real


@dataclass(frozen=True, eq=False)
class Ball:
    """A sphere.

    Attributes
    ----------
    mass, radius, moment
        Mass (kg), radius (m), and moment of inertia about any axis through the centre (kg m^2).
    plane
        The law of its contact with the plane; None without a plane.
    """

    mass: Real
    radius: Real
    moment: Real
    plane: Law | None

    @property
    def mobility(self) -> Real:
        """The velocity of a point of the surface, across the radius to it, for an impulse of 1 N s along this velocity."""
        return 1 / self.mass + self.radius**2 / self.moment


@dataclass(frozen=True, eq=False)
class Moving:
    """A sphere at a time (s): position (m), velocity (m/s) and angular velocity (rad/s) along the axes of the world.

    `borne` says that it stays on the plane, and `rolls` that it does so without slip. `doubt` is a bound (m/s) of the errors
    of the velocity, and of the angular velocity times the radius, from hits that are left out.
    """

    time: Real
    position: Vector3
    velocity: Vector3
    spin: Vector3
    borne: bool = False
    rolls: bool = False
    doubt: Real = MP.zero


def law_of(scene: Mechanism, one: int, other: int) -> Law | None:
    """Return the law of two bodies, given by their indices, of which one may be the plane; None if they do not touch."""
    pair = min(one, other), max(one, other)
    contact = next((each for each in scene.contacts if each.bodies == pair), scene.plane)
    return None if contact is None else Law(MP.mpf(contact.friction), MP.mpf(contact.restitution))


def ball(scene: Mechanism, index: int) -> Ball | None:
    """Return the sphere of a scene with an index; None for a body of another shape.

    Raises `NotModelled` for a sphere without a moment of inertia, or with moments that differ.
    """
    body = scene.bodies[index]
    radius = _radius(body)
    if radius is None:
        return None
    inertia = exact.inertia(body)
    xx, yy, zz, *products = inertia.tensor
    if any(products) or not xx == yy == zz:
        raise NotModelled("spheres that hit each other and whose moments of inertia differ")
    if not xx > 0:
        raise NotModelled("spheres that hit each other and have no moment of inertia")
    plane = None if scene.plane is None else law_of(scene, WORLD, index)
    return Ball(inertia.mass, MP.mpf(radius), xx, plane)


def _radius(body: JointedBody) -> float | None:
    match shape_of(body):
        case Sphere(radius):
            return radius
        case Ellipsoid((radius, b, c)) if radius == b == c:
            return radius
    return None


def begin(body: JointedBody) -> Moving:
    """Return a body at t = 0, as the file states it."""
    start = body.start
    assert start is not None  # it is free
    rates = exact.rates(start.attitude, start.rotation)
    spin = turned(matrix(exact.turn(start.attitude)), rates)
    return Moving(MP.mpf(0), vector(start.position), vector(start.velocity), spin)


def size(a: Vector3) -> Real:
    """The length of a vector."""
    return MP.sqrt(dot(a, a))


def never_slips(law: Law) -> bool:
    """Return whether nothing slips under a law."""
    return math.isinf(law.friction)
