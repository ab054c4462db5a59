"""Build the joints of a body in Pinocchio, and convert their coordinates q and v to states.

With separate joints for translation and rotation, q is a vector and a rotation, and v is (linear velocity in the world frame,
angular velocity in the body frame). With a free-flyer joint, q is one element of SE(3), and v is the spatial twist in the body
frame. A body on a plane has joints of both kinds too: two prismatic joints and a revolute joint, with the linear velocity in
the world frame, or Pinocchio's planar joint, with the twist in the body frame. Pinocchio's quaternions are x, y, z, w.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pinocchio as pin

from bodycheck.adapters.contract import states
from bodycheck.adapters.links import Link, links_of, tensor
from bodycheck.adapters.pinocchio.coordinates import (
    FREE_FLYER,
    ROTATION,
    TRANSLATION,
    TRANSLATION_AND_ROTATION,
    Coordinates,
    initial_states,
)
from bodycheck.reference.planar import planar_state
from bodycheck.reference.scene import Quaternion, Scene
from bodycheck.reference.trajectory import Array

#: A function that returns q and v one time step after given q and v.
Step = Callable[[Array, Array], tuple[Array, Array]]

#: The index of the joint that does not move; its frame is the world frame.
UNIVERSE = 0


@dataclass(frozen=True, eq=False)
class Joints:
    """A body on its joints.

    Parameters
    ----------
    model
        The Pinocchio model.
    joint
        The index of the joint to which the body is fixed.
    q, v
        The initial configuration (nq,) and velocity (nv,).
    rows
        Converts n states (n, nq) and (n, nv) to rows (n, 13) of the contract.
    heading
        For a flat body, returns the cosine and sine of its yaw, measured in the frame in which v is expressed, from q.
    attitude
        The rotation matrix (3, 3) from the body frame to the frame of the joint; None for the identity.
    """

    model: pin.Model
    joint: int
    q: Array
    v: Array
    rows: Callable[[Array, Array], Array]
    heading: Callable[[Array], tuple[float, float]] = lambda q: (1.0, 0.0)
    attitude: Array | None = None


def in_flight(coordinates: Coordinates, scene: Scene, gravity: float, links: Sequence[Link] = ()) -> Joints:
    """Return a body on the joints of `coordinates`, which consists of `links` if given. `gravity` is in m/s^2, as below."""
    first = initial_states([scene])
    attitude = to_pinocchio(scene.initial.quaternion).matrix() if coordinates.turned else None
    model, joint = body_on_joints(links_of(scene, links), gravity, [kind() for kind in coordinates.kinds], attitude)
    (q,), (v,) = coordinates.start(first)
    rows = coordinates.rows
    return Joints(model, joint, q, v, lambda q, v: np.asarray(rows(first, q[None], v[None])[0]), attitude=attitude)


def translation(scene: Scene, gravity: float) -> Joints:
    """Return a translation joint, for a body that does not rotate."""
    return in_flight(TRANSLATION, scene, gravity)


def rotation(scene: Scene, gravity: float) -> Joints:
    """Return a spherical joint, for a body whose centre of mass does not move."""
    return in_flight(ROTATION, scene, gravity)


def translation_and_rotation(scene: Scene, gravity: float, links: Sequence[Link] = ()) -> Joints:
    """Return a translation joint and a spherical joint. The body consists of `links` if they are given."""
    joints = in_flight(TRANSLATION_AND_ROTATION, scene, gravity, links)
    return replace(joints, heading=lambda q: (float(q[6] ** 2 - q[5] ** 2), float(2 * q[6] * q[5])))


def free_flyer(scene: Scene, gravity: float, links: Sequence[Link] = ()) -> Joints:
    """Return one free-flyer joint. The body consists of `links` if they are given."""
    return in_flight(FREE_FLYER, scene, gravity, links)


def prismatic_and_revolute(scene: Scene, gravity: float) -> Joints:
    """Return two prismatic joints along x and y and a revolute joint about z. Raises `NotFlat` for a body that is not flat."""
    start, height = planar_state(scene), scene.initial.position[2]
    joints = pin.JointModelComposite()
    for part in (pin.JointModelPX(), pin.JointModelPY(), pin.JointModelRZ()):
        joints.addJoint(part)
    model, joint = body_on_joints(links_of(scene), gravity, [joints])

    def rows(q: Array, v: Array) -> Array:
        return flat_states(height, q[:, :2], q[:, 2], v[:, :2], v[:, 2])

    return Joints(model, joint, start[:3], start[3:], rows, lambda q: (math.cos(q[2]), math.sin(q[2])))


def planar_joint(scene: Scene, gravity: float) -> Joints:
    """Return Pinocchio's planar joint, whose q is (x, y, cosine of the yaw, sine of the yaw).

    Raises `NotFlat` for a body that does not lie flat.
    """
    start, height = planar_state(scene), scene.initial.position[2]
    model, joint = body_on_joints(links_of(scene), gravity, [pin.JointModelPlanar()])
    x, y, yaw, vx, vy, w = start.tolist()
    cosine, sine = math.cos(yaw), math.sin(yaw)

    def rows(q: Array, v: Array) -> Array:
        c, s = q[:, 2], q[:, 3]
        velocity = np.column_stack([c * v[:, 0] - s * v[:, 1], s * v[:, 0] + c * v[:, 1]])
        return flat_states(height, q[:, :2], np.arctan2(s, c), velocity, v[:, 2])

    v = np.array([cosine * vx + sine * vy, cosine * vy - sine * vx, w])
    return Joints(model, joint, np.array([x, y, cosine, sine]), v, rows)


def body_on_joints(
    links: Sequence[Link], gravity: float, joints: Sequence[pin.JointModel], attitude: Array | None = None
) -> tuple[pin.Model, int]:
    """Return the model of a body on a chain of joints, and the index of the last joint; see `add_body`."""
    model = world(gravity)
    return model, add_body(model, links, joints, attitude)


def world(gravity: float) -> pin.Model:
    """Return a model without bodies, with a gravitational acceleration (m/s^2) along -z."""
    model = pin.Model()
    model.gravity.linear[:] = 0.0, 0.0, -gravity
    return model


def add_body(model: pin.Model, links: Sequence[Link], joints: Sequence[pin.JointModel], attitude: Array | None = None) -> int:
    """Add a body on its own chain of joints to a model, and return the index of the last joint.

    Parameters
    ----------
    model
        The model.
    links
        The links of the body, which are fixed to the last joint. Pinocchio adds up their inertia.
    joints
        The joints of the chain, from the world to the body.
    attitude
        The rotation matrix (3, 3) from the body frame to the frame of the last joint; the identity if it is None.
    """
    joint = UNIVERSE
    for kind in joints:
        joint = model.addJoint(joint, kind, pin.SE3.Identity(), f"joint {model.njoints - 1}")
    turn = np.eye(3) if attitude is None else attitude
    for link in links:
        inertia = pin.Inertia(link.mass, np.array(link.center_of_mass), tensor(link))
        placement = pin.SE3(to_pinocchio(link.quaternion).matrix(), np.array(link.position))
        model.appendBodyToJoint(joint, inertia, pin.SE3(turn, np.zeros(3)) * placement)
    return joint


def to_pinocchio(quaternion: Quaternion) -> pin.Quaternion:
    """Return Pinocchio's quaternion of a quaternion (w, x, y, z)."""
    w, x, y, z = quaternion
    return pin.Quaternion(w, x, y, z)


def flat_states(height: float, position: Array, yaw: Array, velocity: Array, spin: Array) -> Array:
    """Return the rows (n, 13) of a flat body.

    Parameters
    ----------
    height
        The height (m) of the centre of mass.
    position
        The horizontal positions (n, 2), in m.
    yaw
        The yaw angles (n,), in rad.
    velocity
        The horizontal velocities (n, 2) in the world frame, in m/s.
    spin
        The angular velocities (n,) about the vertical, in rad/s.
    """
    nothing = np.zeros(len(yaw))
    return states(
        np.column_stack([position, nothing + height]),
        np.column_stack([np.cos(yaw / 2), nothing, nothing, np.sin(yaw / 2)]),
        np.column_stack([velocity, nothing]),
        np.column_stack([nothing, nothing, spin]),
    )
