"""What Pinocchio computes at states of a robot model."""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
import pinocchio as pin

from bodycheck.adapters.pinocchio.robot_joints import Coordinates, Joint, coordinates
from bodycheck.reference.robots.state import RobotState
from bodycheck.reference.robots.terms import Terms
from bodycheck.reference.scene import Vector
from bodycheck.reference.trajectory import Array

#: Where the components of a pose are in Pinocchio's, whose quaternion is x, y, z, w.
POSE = [0, 1, 2, 6, 3, 4, 5]


def terms_of(
    model: pin.Model, links: Mapping[int, str], joints: Sequence[Joint], states: Sequence[RobotState], gravity: Vector
) -> tuple[Terms, ...]:
    """Return what Pinocchio computes at states with a gravity (m/s^2, world), which the model keeps.

    links: the names of links by the places of their frames in the model.
    """
    data = model.createData()
    return tuple(_terms(model, data, links, coordinates(model, joints, state), gravity) for state in states)


def _terms(model: pin.Model, data: pin.Data, links: Mapping[int, str], at: Coordinates, gravity: Vector) -> Terms:
    """Return what Pinocchio computes in one state, with poses and Jacobians of frames by their places."""
    rest = np.zeros(model.nv)
    model.gravity = pin.Motion.Zero()
    coriolis = np.array(pin.rnea(model, data, at.q, at.v, rest))
    model.gravity = pin.Motion(np.array(gravity), np.zeros(3))
    poses, jacobians = frames(model, data, at.q, links.items())
    return Terms(
        poses=poses,
        jacobians=jacobians,
        mass_matrix=mass_matrix(model, data, at.q),
        gravity_force=np.array(pin.computeGeneralizedGravity(model, data, at.q)),
        coriolis_force=coriolis,
        forward_dynamics=np.array(pin.aba(model, data, at.q, at.v, at.tau)),
        inverse_dynamics=np.array(pin.rnea(model, data, at.q, at.v, at.a)),
    )


def mass_matrix(model: pin.Model, data: pin.Data, q: Array) -> Array:
    """Return the mass matrix (nv, nv), of which Pinocchio computes the upper triangle."""
    upper = np.triu(np.reshape(pin.crba(model, data, q), (model.nv, model.nv)))
    return np.asarray(upper + np.triu(upper, 1).T)


def frame_jacobian(model: pin.Model, data: pin.Data, place: int) -> Array:
    """Return the Jacobian (6, nv) of a frame along the world's axes, from data whose Jacobians and frames are computed."""
    if not model.nv:  # Pinocchio crashes
        return np.zeros((6, 0))
    jacobian = np.array(pin.getFrameJacobian(model, data, place, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED))
    return jacobian.reshape(6, model.nv)  # with a single column it is a vector


def frames(
    model: pin.Model, data: pin.Data, q: Array, links: Iterable[tuple[int, str]]
) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return pose (7,) and Jacobian (6, nv) along the world's axes of frames, by the names beside their places."""
    pin.computeJointJacobians(model, data, q)
    pin.updateFramePlacements(model, data)
    poses, jacobians = {}, {}
    for place, name in links:
        poses[name] = np.array(pin.SE3ToXYZQUAT(data.oMf[place]))[POSE]
        jacobians[name] = frame_jacobian(model, data, place)
    return poses, jacobians
