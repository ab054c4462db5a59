"""Mechanisms in Rapier: bodies that impulse joints hold together.

Rapier has bodies in reduced coordinates too, but cannot set their velocities. Joints turn about, or slide along, the x axis of
the joint's frame, so that frames are rotated to have the joint's axis along x. Damping and springs are motors with Rapier's
force-based model, and stops are limits of joints, which have no rebound. A loop is a spherical joint. Rapier has no armature,
no effort and no dry friction in a joint: its motors pull to a position or a velocity.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import rapier3d
from scipy.spatial.transform import Rotation

from bodycheck.adapters.contract import EngineReset, SceneUnsupported
from bodycheck.adapters.links import Link, tensor
from bodycheck.adapters.mechanisms import bounds, check_rebounds, frames, from_x, link_of
from bodycheck.reference.kinematics import multiply, rotate
from bodycheck.reference.mechanisms import exact, kinematics
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Mechanism
from bodycheck.reference.trajectory import Array

#: The features of mechanisms that Rapier models; see `Engine.models`.
MODELS = frozenset(
    {
        "mechanisms",
        "revolute joints",
        "prismatic joints",
        "ball joints",
        "fixed joints",
        "joint damping",
        "joint springs",
        "loops",
        "rigid stops",
    }
)

#: A coordinate (rad or m) that no joint reaches, for the side on which a joint has no stop.
FAR = 1e6

#: The identity quaternion (w, x, y, z).
NO_TURN = np.array([1.0, 0.0, 0.0, 0.0])


def built(world: Any, mechanism: Mechanism, unlimited: Callable[[Any], Any]) -> tuple[list[Any], list[Any]]:
    """Add a mechanism in its initial state to a world, and return Rapier's views of its bodies and of its joints.

    `unlimited` removes from the builder of a body the limits that a method switches off. Raises `SceneUnsupported`.
    """
    check_rebounds(mechanism, "Rapier")
    first = kinematics.initial(mechanism)
    handles = {WORLD: world.add_body(rapier3d.RigidBody.fixed())}
    for index, (body, frame) in enumerate(zip(mechanism.bodies, frames(mechanism), strict=True)):
        spin = rotate(first.quaternion[index, 0], first.angular_velocity[index, 0]).tolist()
        builder = (
            rapier3d.RigidBody.dynamic()
            .position(rapier3d.Isometry3(frame.position, rapier3d.Rotation3(*frame.quaternion)))
            .linvel(first.velocity[index, 0].tolist())
            .angvel(spin)
            .additional_mass_properties(properties(link_of(body)))
        )
        handles[index] = world.add_body(unlimited(builder))
    inserted = [
        world.impulse_joints.insert(handles[joint.parent], handles[joint.child], joint_of(joint), True)
        for joint in mechanism.joints
    ]
    for loop in mechanism.loops:
        one, other = loop.points
        ball = rapier3d.SphericalJoint.builder().local_anchor1(one).local_anchor2(other)
        world.impulse_joints.insert(handles[loop.bodies[0]], handles[loop.bodies[1]], ball, True)
    bodies = [world.rigid_bodies[handles[index]] for index in range(len(mechanism.bodies))]
    return bodies, [world.impulse_joints[handle] for handle in inserted]


def properties(link: Link) -> Any:
    """Return Rapier's mass properties of a link: the mass, the centre of mass, and the principal moments and axes."""
    moments, axes = np.linalg.eigh(tensor(link))
    if np.linalg.det(axes) < 0:
        axes[:, 2] *= -1
    turn = Rotation.from_matrix(axes).as_quat(scalar_first=True)
    return rapier3d.MassProperties(link.center_of_mass, link.mass, moments.tolist(), rapier3d.Rotation3(*turn.tolist()))


def joint_of(joint: Joint) -> Any:
    """Return Rapier's joint. Raises `SceneUnsupported` for a ball joint with damping."""
    if joint.type == "spherical" and joint.damping:
        raise SceneUnsupported("Rapier's motors damp a ball joint about single axes, not its angular velocity")
    mask = rapier3d.JointAxesMask
    locked = {
        "revolute": mask.LOCKED_REVOLUTE_AXES,
        "prismatic": mask.LOCKED_PRISMATIC_AXES,
        "spherical": mask.LOCKED_SPHERICAL_AXES,
        "fixed": mask.LOCKED_FIXED_AXES,
    }
    turn = turn_of(joint)
    attitude = multiply(np.array(exact.nearest_turn(joint.attitude)), turn)
    builder = (
        rapier3d.GenericJoint.builder(locked[joint.type])
        .local_frame1(rapier3d.Isometry3(joint.position, rapier3d.Rotation3(*attitude.tolist())))
        .local_frame2(rapier3d.Isometry3((0.0, 0.0, 0.0), rapier3d.Rotation3(*turn.tolist())))
    )
    axis = rapier3d.JointAxis.ANG_X if joint.type == "revolute" else rapier3d.JointAxis.LIN_X
    if joint.stops is not None:
        builder = builder.limits(axis, *bounds(joint.stops, FAR))
    if joint.stiffness or joint.damping:
        builder = builder.motor_model(axis, rapier3d.MotorModel.FORCE_BASED)
        builder = builder.motor_position(axis, joint.rest, joint.stiffness, joint.damping)
    return builder


def turn_of(joint: Joint) -> Array:
    """Return the rotation (4,) from Rapier's frame of a joint, whose x axis is the axis of the joint, to the joint's frame."""
    return from_x(np.array(exact.nearest_axis(joint))) if joint.type in ("revolute", "prismatic") else NO_TURN


def check(bodies: Sequence[Any]) -> None:
    """Raise `EngineReset` if Rapier has taken a body out of the simulation."""
    if not all(body.is_enabled for body in bodies):
        raise EngineReset("Rapier quarantined a body, because its state is no longer finite, and put it back")


def seen(bodies: Sequence[Any]) -> Array:
    """Return the states (13 k,) of k bodies, all in the world frame.

    Each has the position of the frame, the quaternion w x y z, the velocity of the centre of mass, and the angular velocity.
    """
    parts = []
    for body in bodies:
        x, y, z, w = body.rotation.quaternion
        parts += [*body.translation.to_tuple(), w, x, y, z, *body.linvel.to_tuple(), *body.angvel.to_tuple()]
    return np.array(parts)
