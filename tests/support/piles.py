"""Several free bodies on a plane, and what balances them."""

from collections.abc import Sequence

import numpy as np

from bodycheck.reference.contact.motion import ContactMotion, Interface
from bodycheck.reference.contact.problem import Problem, problem
from bodycheck.reference.contact.ways import Way
from bodycheck.reference.mechanisms.mechanism import BodyStart, JointedBody, Mechanism, PairContact
from bodycheck.reference.scene import Brick, Cylinder, EulerAngles, Plane, Push, Shape, Solid, Sphere, Vector

GRAVITY = 9.81


def body(name: str, shape: Shape, mass: float, position: Vector, *, yaw: float = 0.0, tilt: float = 0.0) -> JointedBody:
    """A free body at rest, turned about the vertical; or about the y of the world, as an inclined plane is."""
    attitude = (np.cos(tilt / 2), 0.0, np.sin(tilt / 2), 0.0) if tilt else EulerAngles(yaw, 0.0, 0.0)
    return JointedBody(name, Solid(shape, mass), start=BodyStart(position, attitude), shape=shape)


def pile(
    *bodies: JointedBody, friction: float = 0.5, contacts: Sequence[PairContact] = (), push: Push | None = None
) -> Problem:
    """The problem of bodies on a level plane."""
    pushes = () if push is None else (push,)
    plane = Plane(friction=friction)
    return problem(Mechanism(bodies, gravity=GRAVITY, plane=plane, contacts=tuple(contacts), pushes=pushes))


def on_incline(angle: float, *standing: tuple[str, Shape, float, Vector], friction: float = 1.0) -> Problem:
    """The problem of bodies on an inclined plane, whose positions are along its axes."""
    sine, cosine = np.sin(angle), np.cos(angle)
    bodies = [
        body(name, shape, mass, (cosine * x + sine * z, y, cosine * z - sine * x), tilt=angle)
        for name, shape, mass, (x, y, z) in standing
    ]
    return problem(Mechanism(tuple(bodies), gravity=GRAVITY, plane=Plane(friction=friction, incline=angle)))


def height(shape: Shape) -> float:
    """Half the height of a shape that stands upright (m)."""
    match shape:
        case Sphere(radius):
            return radius
        case Cylinder(_, half_length):
            return half_length
        case Brick(semi_axes):
            return semi_axes[2]
        case _:
            raise TypeError(shape)


def moved(way: Way, known: Problem, times: np.ndarray) -> ContactMotion:
    """The motion that a way has; it must have one."""
    found = way(known, times)
    assert found is not None
    return found


def loads_of(found: ContactMotion) -> dict[tuple[int, int], float]:
    """The loads (N) by pairs."""
    return {interface.bodies: interface.load for interface in found.interfaces}


def names(interfaces: Sequence[Interface]) -> set[tuple[int, int]]:
    return {interface.bodies for interface in interfaces}
