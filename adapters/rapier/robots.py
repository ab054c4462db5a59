"""Robot models as Rapier's loader of URDF reads them, in single precision.

The root is fixed, and links without mass and shape on fixed joints, which Rapier would leave out, are kept: both are options of
the loader. The robot is a body in reduced coordinates (`insert_using_multibody_joints`). Rapier drops damping, friction, effort
limits and mimic joints of the file. It has its own damping, 0.1 for each velocity whatever the file says, which a note reports.
The rotation of an inertia's frame (`rpy` in `inertial`) is ignored. Rapier panics if a joint in the file refers to a missing
link.

Rapier keeps an inertia along principal axes, which it computes in single precision. These axes are wrong if the two smaller
moments are equal and the third is along x, and if moments differ by less than some 1e-5 kg m^2. Rapier's response to an impulse
of torque has the same wrong axes. The moments themselves have about half of the digits of single precision, and negative
moments become zero.

Rapier computes the poses. It has no function for the mass matrix, or for the other terms of the equations of motion, apart from
a time step. Its reader of MJCF is not used.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import rapier3d
from rapier3d.loaders import urdf as loader

from bodycheck.adapters.quiet import overheard, refusal
from bodycheck.adapters.robot_numbers import along, components, finite, matrix, pose, scalar_first, vector
from bodycheck.adapters.robot_reading import (
    FormatUnknown,
    JointStates,
    ModelRefused,
    ReadBody,
    ReadJoint,
    RobotFile,
    RobotReading,
)
from bodycheck.reference.robots.state import RobotState
from bodycheck.reference.robots.terms import Terms
from bodycheck.reference.scene import Vector

#: The relative rounding of principal moments, which is the square root of the rounding of single precision.
ROUNDING = float(np.finfo(np.float32).eps) ** 0.5

#: Rapier's names of types of joints in the words of `bodycheck.reference.robots.model`.
TYPES = {"continuous": "revolute"}

#: The number of velocities of a root in Rapier, which exist even if the root is fixed.
ROOT = 6

#: The axis of a joint that moves, by its type: Rapier's joints turn about, or slide along, x.
AXES = {"revolute": rapier3d.JointAxis.ANG_X, "prismatic": rapier3d.JointAxis.LIN_X}

#: The name of the Python exception for a panic in Rust.
PANIC = "PanicException"

NOTES = ("Rapier drops the damping of joints, and has a damping of 0.1 for each velocity of its own",)


@dataclass(frozen=True, eq=False)
class Joint:
    """A moving joint of a robot: name, type, child, properties, index of the first velocity, and number of velocities."""

    name: str
    type: str
    child: str
    data: Any
    first: int
    count: int


@dataclass(frozen=True, eq=False)
class Loaded:
    """A robot that Rapier's loader has read: the set of bodies, and the handles, parents and joints of the links."""

    bodies: Any
    handles: dict[str, Any]
    parents: dict[str, str]
    joints: tuple[Joint, ...]
    tree: Any


def read_robot(file: RobotFile, states: Sequence[RobotState], gravity: Vector) -> RobotReading:
    """Return how Rapier reads a file, as `RobotModels.read_robot` does."""
    if file.format != "urdf":
        raise FormatUnknown(f"the adapter of Rapier reads no {file.format} files")
    robots = [loaded(file) for _ in states]  # the positions of a robot can be set only once
    robot = loaded(file)
    bodies = tuple(read_body(robot, name) for name in robot.handles)
    return RobotReading(
        bodies=bodies,
        joints=tuple(read_joint(robot, joint) for joint in robot.joints),
        links=tuple(robot.handles),
        velocities=sum(joint.count for joint in robot.joints),
        gravity=vector(rapier3d.PhysicsWorld().gravity.to_tuple()),
        terms=tuple(terms(placed, state) for placed, state in zip(robots, states, strict=True)),
        rounding=ROUNDING,
        notes=NOTES,
    )


def step_robot(file: RobotFile, starts: Sequence[JointStates], timestep: float, steps: int) -> list[JointStates]:
    """Return the states after steps of Rapier, as `RobotSteps.step_robot` does. Bodies of a robot have no shapes."""
    world = rapier3d.PhysicsWorld(gravity=(0.0, 0.0, 0.0))
    world.integration_parameters.dt = timestep
    robot = loaded(file, (world.rigid_bodies, world.colliders, world.multibody_joints), with_shapes=False)
    robot.tree.set_damping([0.0] * robot.tree.ndofs)
    before = robot.tree.ndofs
    world.step()  # the first step removes the velocities of a fixed root
    gone = before - robot.tree.ndofs
    single = {joint.name: joint.first + ROOT - gone for joint in robot.joints if joint.count == 1}
    return [moved(world, robot, single, start, steps) for start in starts]


def moved(world: Any, robot: Loaded, joints: Mapping[str, int], start: JointStates, steps: int) -> JointStates:
    """Return the state of joints, given with the indices of their velocities, after steps from a state."""
    displacements, velocities = -np.array(robot.tree.generalized_position()), np.zeros(robot.tree.ndofs)
    for name, index in joints.items():
        displacements[index] += start.positions.get(name, 0.0)
        velocities[index] = start.velocities.get(name, 0.0)
    robot.tree.apply_displacements(displacements.tolist())
    robot.tree.set_generalized_velocity(velocities.tolist())
    robot.tree.forward_kinematics(world.rigid_bodies)
    robot.tree.update_rigid_bodies(world.rigid_bodies, False)
    for _ in range(steps):
        world.step()
    ends = robot.tree.generalized_position(), robot.tree.generalized_velocity()
    return JointStates(*({name: float(values[index]) for name, index in joints.items()} for values in ends))


def loaded(file: RobotFile, sets: tuple[Any, Any, Any] | None = None, with_shapes: bool = True) -> Loaded:
    """Return the robot of a URDF. Raises `ModelRefused`.

    Parameters
    ----------
    file
        The file.
    sets
        The sets of bodies, colliders and joints of a world to which the robot is added; new sets if None.
    with_shapes
        Whether the bodies have their shapes of collision.
    """
    options = loader.UrdfLoaderOptions(
        make_roots_fixed=True, squeeze_empty_fixed_links=False, create_colliders_from_collision_shapes=with_shapes
    )
    bodies, colliders, joints = sets or (rapier3d.RigidBodySet(), rapier3d.ColliderSet(), rapier3d.MultibodyJointSet())
    try:
        with overheard():
            robot, description = loader.UrdfRobot.from_file(file.path, options)
            handles = robot.insert_using_multibody_joints(bodies, colliders, joints)
    except BaseException as error:  # a panic of Rust is a BaseException but no Exception
        if not isinstance(error, Exception) and type(error).__name__ != PANIC:
            raise
        raise ModelRefused(refusal(file.path, f"{type(error).__name__}: {error}")) from error
    names = [link.name for link in description.links]
    handles_by_name = {name: handle.body for name, handle in zip(names, handles.links, strict=True)}
    for body in handles_by_name.values():
        bodies[body].recompute_mass_properties_from_colliders(colliders)
    moving, tree = [], None
    for joint, handle in zip(description.joints, handles.joints, strict=True):
        kind = joint.joint_type.lower()
        kind = TYPES.get(kind, kind)
        tree, index = joints.get(handle.joint) if handle.joint is not None else (None, 0)
        if tree is not None and kind != "fixed":
            link = tree.get_link(index)
            data, first = joints[handle.joint].data, link.assembly_id - ROOT
            moving.append(Joint(joint.name, kind, joint.child, data, first, link.ndofs))
    return Loaded(bodies, handles_by_name, {joint.child: joint.parent for joint in description.joints}, tuple(moving), tree)


def read_body(robot: Loaded, name: str) -> ReadBody:
    """Return a link."""
    mass_properties = robot.bodies[robot.handles[name]].mass_properties
    tensor = along(
        [*mass_properties.principal_inertia], matrix(scalar_first([*mass_properties.principal_inertia_local_frame.quaternion]))
    )
    return ReadBody(
        name, robot.parents.get(name), float(mass_properties.mass), vector([*mass_properties.local_com]), components(tensor)
    )


def read_joint(robot: Loaded, joint: Joint) -> ReadJoint:
    """Return a joint that moves."""
    axis = AXES.get(joint.type)
    limits = joint.data.limits(axis) if axis is not None else None
    index = joint.first + ROOT
    return ReadJoint(
        name=joint.name,
        type=joint.type,
        child=joint.child,
        first=joint.first,
        count=joint.count,
        axis=vector([*joint.data.local_axis2]) if axis is not None else None,
        armature=float(robot.tree.armature()[index]),
        lower=finite(limits.min) if limits is not None else None,
        upper=finite(limits.max) if limits is not None else None,
    )


def terms(robot: Loaded, state: RobotState) -> Terms:
    """Return the poses of the links at a state; no terms if a joint has several velocities, because its state cannot be set."""
    if any(joint.count > 1 for joint in robot.joints):
        return Terms()
    if robot.tree is not None:
        moves = np.zeros(robot.tree.ndofs)
        for joint in robot.joints:
            moves[joint.first + ROOT] = state.positions.get(joint.name, (0.0,))[0]
        robot.tree.apply_displacements(moves.tolist())
        robot.tree.forward_kinematics(robot.bodies)
        robot.tree.update_rigid_bodies(robot.bodies, False)
    poses = {}
    for name, handle in robot.handles.items():
        body = robot.bodies[handle]
        poses[name] = pose(body.translation.to_tuple(), scalar_first([*body.rotation.quaternion]))
    return Terms(poses=poses)
