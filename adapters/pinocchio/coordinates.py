"""The joints of bodies in flight in Pinocchio, and the states of many bodies in their coordinates q and v.

Pinocchio's quaternions are x, y, z, w. The linear velocity of a translation joint is in the world frame. The linear velocity of
a free-flyer joint, whose v is the spatial twist, is in the body frame.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from bodycheck.reference.kinematics import conjugate, rotate
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array


@dataclass(frozen=True)
class Coordinates:
    """The joints of a body in flight, and its states in their coordinates.

    Parameters
    ----------
    kinds
        The classes of the joints, from the world to the body.
    start
        Converts the initial states (m, 13) of m bodies to q (m, nq) and v (m, nv).
    rows
        Converts the initial states (m, 13), q (m, n, nq) and v (m, n, nv) of m bodies at n instants to states (m, n, 13).
    turned
        Whether the frame of the last joint has the axes of the world, so that the body has its attitude in this frame.
    """

    kinds: tuple[Callable[[], pin.JointModel], ...]
    start: Callable[[Array], tuple[Array, Array]]
    rows: Callable[[Array, Array, Array], Array]
    turned: bool = False


def initial_states(scenes: Sequence[Scene]) -> Array:
    """Return the initial states of scenes as rows (m, 13) in the columns of `Simulation.advance`."""
    starts = [scene.initial for scene in scenes]
    return np.array([(*start.position, *start.quaternion, *start.velocity, *start.angular_velocity) for start in starts])


def _rows(shape: tuple[int, ...], position: ArrayLike, quaternion: ArrayLike, velocity: ArrayLike, rates: ArrayLike) -> Array:
    """Return states (m, n, 13) from their parts; a part may have a single value for all instants."""
    rows = np.empty((*shape[:2], 13))
    rows[..., :3], rows[..., 3:7], rows[..., 7:10], rows[..., 10:] = position, quaternion, velocity, rates
    return rows


def _free_start(first: Array) -> tuple[Array, Array]:
    twist = np.hstack([rotate(conjugate(first[:, 3:7]), first[:, 7:10]), first[:, 10:]])
    return first[:, [0, 1, 2, 4, 5, 6, 3]], twist


def _free_rows(first: Array, q: Array, v: Array) -> Array:
    attitude = q[..., [6, 3, 4, 5]]
    return _rows(q.shape, q[..., :3], attitude, rotate(attitude, v[..., :3]), v[..., 3:])


#: A translation joint, for a body that does not rotate.
TRANSLATION = Coordinates(
    (pin.JointModelTranslation,),
    lambda first: (first[:, :3], first[:, 7:10]),
    lambda first, q, v: _rows(q.shape, q, first[:, None, 3:7], v, 0.0),
    turned=True,
)

#: A spherical joint, for a body whose centre of mass does not move.
ROTATION = Coordinates(
    (pin.JointModelSpherical,),
    lambda first: (first[:, [4, 5, 6, 3]], first[:, 10:]),
    lambda first, q, v: _rows(q.shape, first[:, None, :3], q[..., [3, 0, 1, 2]], 0.0, v),
)

#: A translation joint and a spherical one.
TRANSLATION_AND_ROTATION = Coordinates(
    (pin.JointModelTranslation, pin.JointModelSpherical),
    lambda first: (first[:, [0, 1, 2, 4, 5, 6, 3]], first[:, 7:]),
    lambda first, q, v: _rows(q.shape, q[..., :3], q[..., [6, 3, 4, 5]], v[..., :3], v[..., 3:]),
)

#: One free-flyer joint.
FREE_FLYER = Coordinates((pin.JointModelFreeFlyer,), _free_start, _free_rows)
