"""Load links into PyBullet, which accepts inertia tensors only from URDF files."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pybullet

from bodycheck.adapters.links import Link, file_of, urdf
from bodycheck.reference.kinematics import conjugate, multiply, normalise, rotate
from bodycheck.reference.scene import Quaternion, Vector

#: The index of the base of a body, for functions that take a link.
BASE = -1


@dataclass(frozen=True)
class Loaded:
    """A body of PyBullet, which is one link or several.

    Parameters
    ----------
    body
        The number of the body.
    position, quaternion
        The pose of Bullet's frame of the base in the frame of the base's link (m; w x y z). Bullet's frame is at the centre of
        mass and along the principal axes that Bullet has computed.
    """

    body: int
    position: Vector
    quaternion: Quaternion


def load(client: int, links: Sequence[Link], maximal: bool, flags: int) -> list[Loaded]:
    """Load links as PyBullet's bodies at the origin of the world: in maximal coordinates as one body each, else as one body."""
    alone = [[link] for link in links]
    return [_loaded(client, urdf(part), maximal, flags) for part in (alone if maximal else [links])]


def weld(client: int, bodies: Sequence[Loaded], links: Sequence[Link]) -> None:
    """Weld bodies in maximal coordinates to the first body, at the poses of their links."""
    first = bodies[0]
    for body, link in zip(bodies[1:], links[1:], strict=True):
        on_first, on_second = _seen_from(first, link.position, link.quaternion), _seen_from(body, (0, 0, 0), (1, 0, 0, 0))
        pybullet.createConstraint(
            first.body,
            BASE,
            body.body,
            BASE,
            pybullet.JOINT_FIXED,
            (0, 0, 0),
            on_first[0],
            on_second[0],
            on_first[1],
            on_second[1],
            physicsClientId=client,
        )


def _loaded(client: int, text: str, maximal: bool, flags: int) -> Loaded:
    with file_of(text) as file:
        body = pybullet.loadURDF(file, useMaximalCoordinates=maximal, flags=flags, physicsClientId=client)
    # The link's frame is the world frame here. PyBullet's function for frames does not support maximal coordinates.
    position, (x, y, z, w) = pybullet.getBasePositionAndOrientation(body, physicsClientId=client)
    return Loaded(body, position, (w, x, y, z))


def _seen_from(body: Loaded, position: Vector, quaternion: Quaternion) -> tuple[list[float], list[float]]:
    """Return a pose in the frame of a link as position and quaternion (x y z w) in Bullet's frame of its body."""
    turn = conjugate(np.array(body.quaternion))
    w, x, y, z = multiply(turn, normalise(np.array(quaternion, dtype=float))).tolist()
    return rotate(turn, np.array(position) - np.array(body.position)).tolist(), [x, y, z, w]
