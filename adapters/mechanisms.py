"""Bodies on joints in the forms in which engines take them."""

import numpy as np
from numpy.typing import ArrayLike

from bodycheck.adapters.links import Link, carried
from bodycheck.reference.inertia import IDENTITY
from bodycheck.reference.kinematics import multiply
from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.mechanisms.coordinates import places
from bodycheck.reference.mechanisms.exact import nearest_inertia
from bodycheck.reference.mechanisms.mechanism import WORLD, JointedBody, Mechanism
from bodycheck.reference.scene import State
from bodycheck.reference.trajectory import Array


def link_of(body: JointedBody) -> Link:
    """Return the mass, the centre of mass and the inertia of a body of a mechanism."""
    found = nearest_inertia(body)
    return Link(found.mass, found.tensor, found.centre)


def starts(mechanism: Mechanism) -> tuple[tuple[Array, Array], ...]:
    """Return the initial coordinates and velocities of each joint, laid out as in `coordinates`; quaternions have norm 1."""
    motion = kinematics.start_of(mechanism)
    return tuple((motion.position[0, held], motion.velocity[0, moving]) for held, moving in places(mechanism))


def frames(mechanism: Mechanism) -> tuple[State, ...]:
    """Return the initial states of the frames of all bodies: of their origins, and the angular velocity along their axes."""
    start = kinematics.initial(mechanism)
    made = []
    for place, body in enumerate(mechanism.bodies):
        row = np.concatenate(
            [part[place, 0] for part in (start.position, start.quaternion, start.velocity, start.angular_velocity)]
        )
        origin = carried(row[None], -np.array(nearest_inertia(body).centre), IDENTITY)[0]
        made.append(State(*(tuple(part.tolist()) for part in np.split(origin, (3, 7, 10)))))
    return tuple(made)


def centred(mechanism: Mechanism, rows: ArrayLike) -> Array:
    """Return the states (n, bodies, 13) of the centres of mass from those of the origins of the bodies' frames.

    Quaternions may have any norm, which they keep.
    """
    seen = np.asarray(rows, dtype=float)
    of_bodies = [carried(seen[:, place], nearest_inertia(body).centre, IDENTITY) for place, body in enumerate(mechanism.bodies)]
    return np.stack(of_bodies, axis=1)


def from_z(axis: Array) -> Array:
    """Return a quaternion (4,) of a turn from z to a unit vector (3,)."""
    if axis[2] < 0:
        # By half a turn about x first, so that the rest is not near half a turn.
        return multiply(np.array([0.0, 1.0, 0.0, 0.0]), from_z(axis * np.array([1.0, -1.0, -1.0])))
    made = np.array([1.0 + axis[2], -axis[1], axis[0], 0.0])
    return np.asarray(made / np.linalg.norm(made))


def from_x(axis: Array) -> Array:
    """Return a quaternion (4,) of a turn from x to a unit vector (3,)."""
    return multiply(from_z(axis), np.array([np.sqrt(0.5), 0.0, -np.sqrt(0.5), 0.0]))


def trees(mechanism: Mechanism) -> list[tuple[int, ...]]:
    """Return the places of the bodies of each tree: the root, which is the world or a free body, then what hangs on it."""
    free = [place for place, joint in enumerate(mechanism.joint_of) if joint is None]
    found = []
    for root in (WORLD, *free):
        places = [root]
        for parent in places:
            places += [joint.child for joint in mechanism.joints if joint.parent == parent]
        found.append(tuple(places))
    return [tree for tree in found if tree != (WORLD,)]
