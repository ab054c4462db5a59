"""Variations of a mechanism along the axes of extremes: each function returns a mechanism with another value.

Closed loops stay closed, also in their velocities.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from bodycheck.reference.mechanisms import exact
from bodycheck.reference.mechanisms.mechanism import WORLD, BodyStart, Joint, JointedBody, Mechanism
from bodycheck.reference.scene import (
    Brick,
    Cylinder,
    Ellipsoid,
    EulerRates,
    Given,
    Particle,
    Shape,
    Solid,
    Sphere,
    Tensor,
    Vector,
)


@dataclass(frozen=True)
class Variation:
    """The variation of a mechanism along an axis.

    Attributes
    ----------
    change
        Function from a mechanism and a value to the mechanism that has this value.
    missing
        Returns why a mechanism cannot be varied along the axis; None if it can.
    """

    change: Callable[[Mechanism, float], Mechanism]
    missing: Callable[[Mechanism], str | None] = lambda _: None


def mass(mechanism: Mechanism, value: float) -> Mechanism:
    """Change the total mass (kg): masses and moments of all bodies change in proportion, and the joints stay the same."""
    factor = value / sum(exact.nearest_inertia(body).mass for body in mechanism.bodies)
    bodies = (replace(body, inertia=_scaled(body.inertia, 1.0, factor)) for body in mechanism.bodies)
    return replace(mechanism, bodies=tuple(bodies))


def size(mechanism: Mechanism, value: float) -> Mechanism:
    """Multiply all lengths by a factor at the same density, also those in initial states and in rests of sliders."""
    return replace(
        mechanism,
        bodies=tuple(_grown_body(body, value) for body in mechanism.bodies),
        joints=tuple(_grown_joint(joint, value) for joint in mechanism.joints),
        loops=tuple(
            replace(loop, points=(_times(loop.points[0], value), _times(loop.points[1], value))) for loop in mechanism.loops
        ),
    )


def distance(mechanism: Mechanism, value: float) -> Mechanism:
    """Move the whole mechanism by a distance (m) along x."""

    def moved(position: Vector) -> Vector:
        return position[0] + value, position[1], position[2]

    bodies = [
        body if body.start is None else replace(body, start=replace(body.start, position=moved(body.start.position)))
        for body in mechanism.bodies
    ]
    joints = [replace(joint, position=moved(joint.position)) if joint.parent == WORLD else joint for joint in mechanism.joints]
    loops = []
    for loop in mechanism.loops:
        first, second = (moved(at) if body == WORLD else at for body, at in zip(loop.bodies, loop.points, strict=True))
        loops.append(replace(loop, points=(first, second)))
    return replace(mechanism, bodies=tuple(bodies), joints=tuple(joints), loops=tuple(loops))


def gravity(mechanism: Mechanism, value: float) -> Mechanism:
    """Change the gravity (m/s^2)."""
    return replace(mechanism, gravity=value)


def spin(mechanism: Mechanism, value: float) -> Mechanism:
    """Scale all initial velocities so that the largest angular velocity of a joint or free body is the value (rad/s)."""
    return _faster(mechanism, value / _largest_spin(mechanism))


def speed(mechanism: Mechanism, value: float) -> Mechanism:
    """Scale all initial velocities so that the largest linear velocity of a joint or free body is the value (m/s)."""
    return _faster(mechanism, value / _largest_speed(mechanism))


#: The axes along which mechanisms are varied, by name, without the axes of the run.
VARIATIONS = {
    "spin": Variation(spin, lambda given: None if _largest_spin(given) else "no joint or free body has an angular velocity"),
    "mass": Variation(mass),
    "size": Variation(size),
    "distance": Variation(distance),
    "gravity": Variation(gravity),
    "speed": Variation(speed, lambda given: None if _largest_speed(given) else "no joint or free body has a linear velocity"),
}


def _largest_spin(mechanism: Mechanism) -> float:
    joints = (math.hypot(*_parts(joint, joint.start_velocity)[1]) for joint in mechanism.joints)
    free = (math.hypot(*map(float, exact.rates(start.attitude, start.rotation))) for start in _starts(mechanism))
    return max((*joints, *free))


def _largest_speed(mechanism: Mechanism) -> float:
    joints = (math.hypot(*_parts(joint, joint.start_velocity)[0]) for joint in mechanism.joints)
    return max((*joints, *(math.hypot(*start.velocity) for start in _starts(mechanism))))


def _starts(mechanism: Mechanism) -> list[BodyStart]:
    return [body.start for body in mechanism.bodies if body.start is not None]


def _parts(joint: Joint, values: tuple[float, ...]) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Split the coordinates or velocities of a joint into the linear ones, which come first, and the others."""
    count = len(joint.form.slides)
    return values[:count], values[count:]


def _faster(mechanism: Mechanism, factor: float) -> Mechanism:
    """Multiply all initial velocities by a factor."""
    bodies = [
        body if body.start is None else replace(body, start=_faster_start(body.start, factor)) for body in mechanism.bodies
    ]
    joints = [
        replace(joint, start_velocity=tuple(part * factor for part in joint.start_velocity)) for joint in mechanism.joints
    ]
    return replace(mechanism, bodies=tuple(bodies), joints=tuple(joints))


def _faster_start(start: BodyStart, factor: float) -> BodyStart:
    match start.rotation:
        case EulerRates(dphi, dtheta, dpsi):
            return replace(
                start,
                velocity=_times(start.velocity, factor),
                rotation=EulerRates(dphi * factor, dtheta * factor, dpsi * factor),
            )
        case rotation:
            return replace(start, velocity=_times(start.velocity, factor), rotation=_times(rotation, factor))


def _grown_body(body: JointedBody, factor: float) -> JointedBody:
    start = body.start
    if start is not None:
        start = replace(start, position=_times(start.position, factor), velocity=_times(start.velocity, factor))
    centre = _times(body.center_of_mass, factor)
    return replace(body, inertia=_scaled(body.inertia, factor, factor**3), center_of_mass=centre, start=start)


def _grown_joint(joint: Joint, factor: float) -> Joint:
    (here, still), (moving, turning) = _parts(joint, joint.start), _parts(joint, joint.start_velocity)
    return replace(
        joint,
        position=_times(joint.position, factor),
        rest=joint.rest * factor if joint.form.slides else joint.rest,
        start=(*(part * factor for part in here), *still),
        start_velocity=(*(part * factor for part in moving), *turning),
    )


def _scaled(inertia: Given, length: float, mass: float) -> Given:
    """Return the inertia of a body with its lengths multiplied by `length`, and its masses by `mass`."""
    match inertia:
        case Solid():
            return _scaled_solid(inertia, length, mass)
        case Tensor(own, (first, second, third)):
            factor = mass * length**2
            return Tensor(own * mass, (_times(first, factor), _times(second, factor), _times(third, factor)))
    solids = tuple(_scaled_solid(part, length, mass) for part in inertia if isinstance(part, Solid))
    particles = (part for part in inertia if isinstance(part, Particle))
    return solids or tuple(Particle(part.mass * mass, _times(part.position, length)) for part in particles)


def _scaled_solid(part: Solid, length: float, mass: float) -> Solid:
    position = _times(part.position, length)
    return replace(part, shape=grown(part.shape, length), mass=part.mass * mass, position=position)


def grown(shape: Shape, factor: float) -> Shape:
    """Return a shape with all lengths multiplied by a factor."""
    match shape:
        case Brick(semi_axes):
            return Brick(_times(semi_axes, factor))
        case Ellipsoid(semi_axes):
            return Ellipsoid(_times(semi_axes, factor))
        case Cylinder(radius, half_length):
            return Cylinder(radius * factor, half_length * factor)
        case Sphere(radius):
            return Sphere(radius * factor)


def _times(vector: Vector, factor: float) -> Vector:
    x, y, z = vector
    return x * factor, y * factor, z * factor
