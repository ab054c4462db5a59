"""How a body may move in Pinocchio: the joints that carry it, and where a state stands in q and v.

On joints for the translation and for the rotation apart the velocity is (linear in the world frame, angular in the body
frame), and q is a vector and a rotation apart. On a free-flyer it is the spatial twist in the body frame, and q is one element
of SE(3). On a plane there are the same two: prismatic joints along x and y under a revolute one, whose linear velocity is one
of the world frame, and Pinocchio's planar joint, whose velocity is the twist in the body frame. Quaternions are x, y, z, w.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from bodycheck.adapters.contract import states
from bodycheck.reference.inertia import inertia_tensor
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.planar import planar_state
from bodycheck.reference.scene import Body, Scene, State
from bodycheck.reference.trajectory import Array

#: From q and v to q and v one time step later.
Step = Callable[[Array, Array], tuple[Array, Array]]

#: The joint that does not move, whose frame is the world's.
UNIVERSE = 0


@dataclass(frozen=True, eq=False)
class Joints:
    """A body on its joints.

    joint: the index of the one that the body is fixed to. q, v: where it starts. rows: from n states (n, nq) and (n, nv) to
    (n, 13). heading: of a flat body, from q to the cosine and sine of its yaw in the frame of its velocity v.
    """

    model: pin.Model
    joint: int
    q: Array
    v: Array
    rows: Callable[[Array, Array], Array]
    heading: Callable[[Array], tuple[float, float]] = lambda q: (1.0, 0.0)


def translation(scene: Scene, gravity: float) -> Joints:
    """The body does not turn; gravity in m/s^2, here and below."""
    initial = scene.initial

    def rows(q: Array, v: Array) -> Array:
        return states(q, np.tile(initial.quaternion, (len(q), 1)), v, np.zeros((len(q), 3)))

    model, joint = carried(scene.body, gravity, [pin.JointModelTranslation()], attitude=to_pinocchio(initial).matrix())
    return Joints(model, joint, np.array(initial.position), np.array(initial.velocity), rows)


def rotation(scene: Scene, gravity: float) -> Joints:
    """The centre of mass does not move."""
    initial = scene.initial

    def rows(q: Array, v: Array) -> Array:
        return states(np.tile(initial.position, (len(q), 1)), q[:, [3, 0, 1, 2]], np.zeros((len(q), 3)), v)

    model, joint = carried(scene.body, gravity, [pin.JointModelSpherical()])
    return Joints(model, joint, to_pinocchio(initial).coeffs(), np.array(initial.angular_velocity), rows)


def apart(scene: Scene, gravity: float) -> Joints:
    initial = scene.initial
    model, joint = carried(scene.body, gravity, [pin.JointModelTranslation(), pin.JointModelSpherical()])
    q = np.concatenate([initial.position, to_pinocchio(initial).coeffs()])
    v = np.array([*initial.velocity, *initial.angular_velocity])

    def rows(q: Array, v: Array) -> Array:
        return states(q[:, :3], q[:, [6, 3, 4, 5]], v[:, :3], v[:, 3:])

    return Joints(model, joint, q, v, rows, lambda q: (float(q[6] ** 2 - q[5] ** 2), float(2 * q[6] * q[5])))


def free_flyer(scene: Scene, gravity: float) -> Joints:
    initial = scene.initial
    model, joint = carried(scene.body, gravity, [pin.JointModelFreeFlyer()])
    attitude = to_pinocchio(initial)
    q = np.concatenate([initial.position, attitude.coeffs()])
    v = np.concatenate([attitude.matrix().T @ np.array(initial.velocity), initial.angular_velocity])

    def rows(q: Array, v: Array) -> Array:
        attitude = q[:, [6, 3, 4, 5]]
        return states(q[:, :3], attitude, rotate(attitude, v[:, :3]), v[:, 3:])

    return Joints(model, joint, q, v, rows)


def on_axes(scene: Scene, gravity: float) -> Joints:
    """x, y and yaw, each on a joint of its own. Raises `NotFlat` for a body that does not lie flat."""
    start, height = planar_state(scene), scene.initial.position[2]
    joints = pin.JointModelComposite()
    for part in (pin.JointModelPX(), pin.JointModelPY(), pin.JointModelRZ()):
        joints.addJoint(part)
    model, joint = carried(scene.body, gravity, [joints])

    def rows(q: Array, v: Array) -> Array:
        return flat_states(height, q[:, :2], q[:, 2], v[:, :2], v[:, 2])

    return Joints(model, joint, start[:3], start[3:], rows, lambda q: (math.cos(q[2]), math.sin(q[2])))


def planar(scene: Scene, gravity: float) -> Joints:
    """x, y and yaw on Pinocchio's planar joint, whose q has the cosine and the sine of the yaw. Raises `NotFlat` likewise."""
    start, height = planar_state(scene), scene.initial.position[2]
    model, joint = carried(scene.body, gravity, [pin.JointModelPlanar()])
    x, y, yaw, vx, vy, w = start.tolist()
    cosine, sine = math.cos(yaw), math.sin(yaw)

    def rows(q: Array, v: Array) -> Array:
        c, s = q[:, 2], q[:, 3]
        velocity = np.column_stack([c * v[:, 0] - s * v[:, 1], s * v[:, 0] + c * v[:, 1]])
        return flat_states(height, q[:, :2], np.arctan2(s, c), velocity, v[:, 2])

    v = np.array([cosine * vx + sine * vy, cosine * vy - sine * vx, w])
    return Joints(model, joint, np.array([x, y, cosine, sine]), v, rows)


def carried(body: Body, gravity: float, joints: list[pin.JointModel], attitude: Array | None = None) -> tuple[pin.Model, int]:
    """The model of a body on a chain of joints, and the index of the last; attitude (3, 3): of the body on it."""
    model = pin.Model()
    model.gravity.linear[:] = 0.0, 0.0, -gravity
    joint = UNIVERSE
    for number, kind in enumerate(joints):
        joint = model.addJoint(joint, kind, pin.SE3.Identity(), f"joint {number}")
    inertia = pin.Inertia(body.mass, np.zeros(3), inertia_tensor(body))
    model.appendBodyToJoint(joint, inertia, pin.SE3(np.eye(3) if attitude is None else attitude, np.zeros(3)))
    return model, joint


def to_pinocchio(state: State) -> pin.Quaternion:
    w, x, y, z = state.quaternion
    return pin.Quaternion(w, x, y, z)


def flat_states(height: float, place: Array, yaw: Array, velocity: Array, spin: Array) -> Array:
    """Rows (n, 13) of a flat body at a height (m) from its places (n, 2), yaws (n,), velocities (n, 2) and spins (n,)."""
    nothing = np.zeros(len(yaw))
    return states(
        np.column_stack([place, nothing + height]),
        np.column_stack([np.cos(yaw / 2), nothing, nothing, np.sin(yaw / 2)]),
        np.column_stack([velocity, nothing]),
        np.column_stack([nothing, nothing, spin]),
    )
