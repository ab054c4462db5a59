"""Convert bodies on joints to the forms that engines take."""

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike

from bodycheck.adapters.contract import Method, SceneUnsupported
from bodycheck.adapters.links import Link, carried
from bodycheck.reference.inertia import IDENTITY
from bodycheck.reference.kinematics import conjugate, multiply, normalise, rotate
from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.mechanisms.control import Stops
from bodycheck.reference.mechanisms.coordinates import places
from bodycheck.reference.mechanisms.exact import nearest_inertia
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, JointedBody, Mechanism
from bodycheck.reference.scene import State
from bodycheck.reference.trajectory import Array


def link_of(body: JointedBody) -> Link:
    """Return a body of a mechanism as a link, with its mass, its centre of mass and its inertia."""
    mass_properties = nearest_inertia(body)
    return Link(mass_properties.mass, mass_properties.tensor, mass_properties.centre)


def starts(mechanism: Mechanism) -> tuple[tuple[Array, Array], ...]:
    """Return the initial coordinates and velocities of each joint; quaternions have norm 1.

    Their layout is that of `bodycheck.reference.mechanisms.coordinates`.
    """
    motion = kinematics.start_of(mechanism)
    return tuple(
        (motion.position[0, in_position], motion.velocity[0, in_velocity]) for in_position, in_velocity in places(mechanism)
    )


def frames(mechanism: Mechanism) -> tuple[State, ...]:
    """Return the initial states of the frames of all bodies: the origins, with angular velocities along the frames' axes."""
    start = kinematics.initial(mechanism)
    states = []
    for index, body in enumerate(mechanism.bodies):
        row = np.concatenate(
            [part[index, 0] for part in (start.position, start.quaternion, start.velocity, start.angular_velocity)]
        )
        origin = carried(row[None], -np.array(nearest_inertia(body).centre), IDENTITY)[0]
        states.append(State(*(tuple(part.tolist()) for part in np.split(origin, (3, 7, 10)))))
    return tuple(states)


def in_body_axes(seen: Array) -> Array:
    """Return states (n, bodies, 13) from rows (n, 13 bodies) whose angular velocities are along the axes of the world.

    The quaternions must have norm 1. The array of the rows may be changed in place.
    """
    states = seen.reshape(len(seen), -1, 13)
    states[..., 10:] = rotate(conjugate(states[..., 3:7]), states[..., 10:])
    return states


def at_centres(mechanism: Mechanism, seen: Array) -> Array:
    """Return states (n, bodies, 13) of centres of mass, from an engine's rows (n, 13 bodies).

    In the rows, positions are those of the origins of frames, velocities those of centres of mass, and angular velocities are
    along the axes of the world. Quaternions may have any norm, which they keep. The array of the rows may be changed in place.
    """
    states = seen.reshape(len(seen), -1, 13)
    for index, body in enumerate(mechanism.bodies):
        unit = normalise(states[:, index, 3:7])
        states[:, index, :3] += rotate(unit, np.broadcast_to(nearest_inertia(body).centre, (len(seen), 3)))
        states[:, index, 10:] = rotate(conjugate(unit), states[:, index, 10:])
    return states


def centred(mechanism: Mechanism, rows: ArrayLike) -> Array:
    """Return the states (n, bodies, 13) of the centres of mass, from the states of the origins of the bodies' frames.

    Quaternions may have any norm, which they keep.
    """
    seen = np.asarray(rows, dtype=float)
    of_bodies = [carried(seen[:, index], nearest_inertia(body).centre, IDENTITY) for index, body in enumerate(mechanism.bodies)]
    return np.stack(of_bodies, axis=1)


def from_z(axis: Array) -> Array:
    """Return a quaternion (4,) of a rotation that turns the z axis to a unit vector (3,)."""
    if axis[2] < 0:
        # Turn by pi about x first, so that the remaining rotation is not near pi.
        return multiply(np.array([0.0, 1.0, 0.0, 0.0]), from_z(axis * np.array([1.0, -1.0, -1.0])))
    quaternion = np.array([1.0 + axis[2], -axis[1], axis[0], 0.0])
    return np.asarray(quaternion / np.linalg.norm(quaternion))


def from_x(axis: Array) -> Array:
    """Return a quaternion (4,) of a rotation that turns the x axis to a unit vector (3,)."""
    return multiply(from_z(axis), np.array([np.sqrt(0.5), 0.0, -np.sqrt(0.5), 0.0]))


def massless_parts(mechanism: Mechanism) -> Iterator[list[int]]:
    """Yield the sets of bodies that are fixed to each other, move, and have no mass, each with its moving body first."""
    fixed: dict[int, list[int]] = {}
    for joint in mechanism.joints:
        if joint.type == "fixed":
            fixed.setdefault(joint.parent, []).append(joint.child)
    for index, moving in enumerate(mechanism.joint_of):
        if moving is None or moving.type != "fixed":
            part = [index]
            for body in part:
                part += fixed.get(body, [])
            if not any(has_mass(mechanism.bodies[body]) for body in part):
                yield part


def has_mass(body: JointedBody) -> bool:
    """Return whether a body has a mass."""
    return nearest_inertia(body).mass > 0


def trees(mechanism: Mechanism) -> list[tuple[int, ...]]:
    """Return the indices of the bodies of each tree: first the root, which is `WORLD` or a free body, then its descendants."""
    free = [index for index, joint in enumerate(mechanism.joint_of) if joint is None]
    of_roots = []
    for root in (WORLD, *free):
        places = [root]
        for parent in places:
            places += [joint.child for joint in mechanism.joints if joint.parent == parent]
        of_roots.append(tuple(places))
    return [tree for tree in of_roots if tree != (WORLD,)]


def stops_of(joint: Joint, method: Method) -> Stops | None:
    """Return the stops of a joint that the engine itself models; None if there are none, or if they are efforts."""
    return None if method.option("limits") == "effort" else joint.stops


def bounds(stops: Stops | None, far: float = math.inf) -> tuple[float, float]:
    """Return the smallest and the largest coordinate (rad or m) of a joint; `far` is beyond all where there is no stop."""
    lower, upper = (None, None) if stops is None else (stops.lower, stops.upper)
    return -far if lower is None else lower, far if upper is None else upper


def check_rebounds(mechanism: Mechanism, engine: str) -> None:
    """Raise `SceneUnsupported` for rigid stops with a rebound, for an engine whose limits of joints have none."""
    for joint in mechanism.joints:
        if joint.stops is not None and joint.stops.restitution:
            given = f"and {joint.name} has the restitution {joint.stops.restitution:g}"
            raise SceneUnsupported(f"{engine}'s limits of joints have no rebound, {given}")
