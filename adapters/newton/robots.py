"""Robot models as Newton's importers read them, and the terms that Newton computes with them, in single precision.

The importers weld the root of a URDF to the world, and keep the free joints of an MJCF. All links are bodies, including links
on fixed joints. A link without inertia has the inertia of its shapes of collision with the density of water. When a model is
finalised, Newton checks masses and tensors: it replaces values that it does not accept, and raises moments of less than about
1e-6 kg m^2. It warns of the number of changed bodies; its warnings are notes of the reading.

Newton has armature, damping, dry friction, stiffness, effort limits and mimic joints. It computes mass matrix, gravity and
Coriolis forces, inverse dynamics and Jacobians; outside the steps of its solvers it offers no passive forces and no forward
dynamics. A row of its Jacobian is for the centre of mass of a body, and is converted to the origin of the body's frame here.

The velocities of a floating joint are the velocity of the child's centre of mass and then the angular velocity, both along the
axes of the joint's frame in the parent; the velocities of a ball joint are along these axes too. Newton's forces of a floating
joint are along the axes of the world, and are rotated to the axes of its velocities here. A planar joint of a URDF does not
turn in Newton.
"""

import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import newton
import numpy as np
import warp as wp

from bodycheck.adapters.quiet import overheard, refusal
from bodycheck.adapters.robot_numbers import components, finite, matrix, pose, scalar_first, vector
from bodycheck.adapters.robot_reading import JointStates, ModelRefused, ReadBody, ReadJoint, RobotFile, RobotReading
from bodycheck.reference.kinematics import normalise, rotate
from bodycheck.reference.robots.model import Mimic
from bodycheck.reference.robots.state import RobotState, Values
from bodycheck.reference.robots.terms import Terms
from bodycheck.reference.scene import Vector
from bodycheck.reference.trajectory import Array

#: Newton's type of joint with any axes, which a planar joint of a URDF becomes, without its rotation. Its state is left out.
OTHER = "d6"

#: Newton's types of joints in the words of `bodycheck.reference.robots.model`.
TYPES = {
    newton.JointType.REVOLUTE: "revolute",
    newton.JointType.PRISMATIC: "prismatic",
    newton.JointType.FIXED: "fixed",
    newton.JointType.FREE: "floating",
    newton.JointType.BALL: "spherical",
    newton.JointType.D6: OTHER,
}

#: The numbers by which Newton says that a position or an effort has no limit.
NO_POSITION, NO_EFFORT = float(newton.MAXVAL), 1e6


@dataclass(frozen=True, eq=False)
class Joint:
    """A joint of Newton's model: its index, name, type, body and parent, and the slices of its coordinates and velocities.

    `at` and `on` are the frames of the joint in the parent and in the child, as position and quaternion x, y, z, w.
    """

    index: int
    name: str
    type: str
    body: int
    parent: int
    held: slice
    moved: slice
    at: Array
    on: Array


@dataclass(frozen=True, eq=False)
class Imported:
    """A model of Newton with a state, the names of its bodies, and its joints."""

    model: Any
    state: Any
    names: tuple[str, ...]
    joints: tuple[Joint, ...]

    @property
    def moving(self) -> tuple[Joint, ...]:
        """The joints that move."""
        return tuple(joint for joint in self.joints if joint.moved.stop > joint.moved.start)


def read_robot(file: RobotFile, states: Sequence[RobotState], gravity: Vector) -> RobotReading:
    """Return how Newton reads a file, as `RobotModels.read_robot` does."""
    with overheard(), warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        robot = imported(file)
        standard = vector(robot.model.gravity.numpy()[0])
        robot.model.set_gravity(gravity)
        bodies = read_bodies(robot)
        return RobotReading(
            bodies=bodies,
            joints=tuple(read_joint(robot, joint) for joint in robot.moving),
            links=robot.names,
            velocities=robot.model.joint_dof_count,
            gravity=standard,
            terms=tuple(terms(robot, state) for state in states),
            notes=tuple(dict.fromkeys(f"Newton warns: {warning.message}" for warning in caught)),
        )


def step_robot(file: RobotFile, starts: Sequence[JointStates], timestep: float, steps: int) -> list[JointStates]:
    """Return the states after steps of Newton's solver `SolverMuJoCo`, as `RobotSteps.step_robot` does. Raises `ModelRefused`.

    Of Newton's solvers it is the one that has all of limits, rules of following, damping and friction. All starts are worlds of
    one model.
    """
    with overheard(), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        robot = imported(file, len(starts))
        model, state = robot.model, robot.state
        model.set_gravity((0.0, 0.0, 0.0))
        single = [
            joint for joint in robot.joints[: len(robot.joints) // len(starts)] if joint.type in ("revolute", "prismatic")
        ]
        q, qd = (array.numpy().reshape(len(starts), -1) for array in (model.joint_q, model.joint_qd))
        for row, start in enumerate(starts):
            for joint in single:
                q[row, joint.held] = start.positions.get(joint.name, q[row, joint.held])
                qd[row, joint.moved] = start.velocities.get(joint.name, 0.0)
        state.joint_q.assign(q.ravel())
        state.joint_qd.assign(qd.ravel())
        newton.eval_fk(model, state.joint_q, state.joint_qd, state)
        try:
            solver = newton.solvers.SolverMuJoCo(model, disable_contacts=True)
        except Exception as error:  # the conversion to MuJoCo raises exceptions of many types
            raise ModelRefused(refusal(file.path, f"{type(error).__name__}: {error}")) from error
        control = model.control()
        for _ in range(steps):
            solver.step(state, state, control, None, timestep)
        q, qd = (array.numpy().reshape(len(starts), -1).astype(float) for array in (state.joint_q, state.joint_qd))
        return [
            JointStates(
                {joint.name: float(positions[joint.held.start]) for joint in single},
                {joint.name: float(velocities[joint.moved.start]) for joint in single},
            )
            for positions, velocities in zip(q, qd, strict=True)
        ]


def imported(file: RobotFile, worlds: int = 1) -> Imported:
    """Return Newton's model of a file, or of several worlds with one robot each. Raises `ModelRefused`."""
    builder = newton.ModelBuilder()
    try:
        if file.format == "urdf":
            builder.add_urdf(file.path)
        else:
            builder.add_mjcf(file.path)
        if worlds > 1:
            one, builder = builder, newton.ModelBuilder()
            builder.replicate(one, worlds)
        model = builder.finalize()
    except Exception as error:  # the importers raise exceptions of many types, also `Exception` itself
        raise ModelRefused(refusal(file.path, f"{type(error).__name__}: {error}")) from error
    names = tuple(named(file, model, label) for label in model.body_label)
    arrays = (model.joint_type, model.joint_child, model.joint_parent, model.joint_q_start, model.joint_qd_start)
    types, children, parents, held, moved = (array.numpy() for array in arrays)
    at, on = model.joint_X_p.numpy(), model.joint_X_c.numpy()
    joints = tuple(
        Joint(
            index,
            named(file, model, label),
            TYPES.get(newton.JointType(int(types[index])), newton.JointType(int(types[index])).name.lower()),
            int(children[index]),
            int(parents[index]),
            slice(int(held[index]), int(held[index + 1])),
            slice(int(moved[index]), int(moved[index + 1])),
            at[index].astype(float),
            on[index].astype(float),
        )
        for index, label in enumerate(model.joint_label)
    )
    return Imported(model, model.state(), names, joints)


def named(file: RobotFile, model: Any, label: str) -> str:
    """Return the name in the file of the element with a label of Newton.

    Labels begin with the robot's name. Labels of an MJCF also contain the names of all enclosing bodies.
    """
    if file.format == "mjcf":
        return label.rsplit("/", 1)[-1]
    for robot in model.articulation_label:
        label = label.removeprefix(f"{robot}/")
    return label


def read_bodies(robot: Imported) -> tuple[ReadBody, ...]:
    """Return the bodies."""
    masses, centres, tensors = (
        array.numpy().astype(float) for array in (robot.model.body_mass, robot.model.body_com, robot.model.body_inertia)
    )
    parents = {joint.body: robot.names[joint.parent] for joint in robot.joints if joint.parent >= 0}
    return tuple(
        ReadBody(name, parents.get(index), float(masses[index]), vector(centres[index]), components(tensors[index]))
        for index, name in enumerate(robot.names)
    )


def read_joint(robot: Imported, joint: Joint) -> ReadJoint:
    """Return a joint that moves. For a joint with several velocities, the properties are those of the first velocity."""
    model, first = robot.model, joint.moved.start
    single = joint.moved.stop - first == 1

    def of(array: Any) -> float:
        return float(array.numpy()[first])

    leader, (offset, multiplier) = (
        int(model.joint_mimic_joint.numpy()[joint.index]),
        model.joint_mimic_coeffs.numpy()[joint.index],
    )
    return ReadJoint(
        name=joint.name,
        type=joint.type,
        child=robot.names[joint.body],
        first=first,
        count=joint.moved.stop - first,
        axis=vector(matrix(scalar_first(joint.on[3:])) @ model.joint_axis.numpy()[first]) if single else None,
        armature=of(model.joint_armature),
        damping=of(model.joint_damping),
        friction=of(model.joint_friction),
        stiffness=of(model.joint_stiffness),
        effort_limit=finite(of(model.joint_effort_limit), NO_EFFORT),
        lower=finite(of(model.joint_limit_lower), NO_POSITION) if single else None,
        upper=finite(of(model.joint_limit_upper), NO_POSITION) if single else None,
        mimic=Mimic(robot.joints[leader].name, float(multiplier), float(offset)) if leader >= 0 else None,
    )


def terms(robot: Imported, state: RobotState) -> Terms:
    """Return the terms that Newton computes at a state."""
    model, engine_state, number = robot.model, robot.state, robot.model.joint_dof_count
    engine_state.joint_q.assign(positions(robot, state).astype(np.float32))
    engine_state.joint_qd.assign(rates(robot, state, state.velocities).astype(np.float32))
    newton.eval_fk(model, engine_state.joint_q, engine_state.joint_qd, engine_state)
    poses = {
        name: pose(row[:3], scalar_first(row[3:])) for name, row in zip(robot.names, engine_state.body_q.numpy(), strict=True)
    }
    if not number:
        return Terms(poses=poses)
    most = model.max_dofs_per_articulation
    mass = wp.zeros((model.articulation_count, most, most), dtype=wp.float32)
    pull, bias, wanted, efforts = (wp.zeros(number, dtype=wp.float32) for _ in range(4))
    newton.eval_inverse_dynamics_passive(model, engine_state, mass_matrix=mass, gravity_force=pull, coriolis_force=bias)
    wanted.assign(accelerations(robot, state).astype(np.float32))
    newton.eval_inverse_dynamics_force(
        model, engine_state, mass_matrix=mass, joint_qdd=wanted, coriolis_force=bias, gravity_force=pull, joint_f=efforts
    )
    return Terms(
        poses=poses,
        jacobians=jacobians(robot),
        mass_matrix=whole(robot, mass.numpy().astype(float)),
        gravity_force=along_joints(robot, pull.numpy().astype(float)),
        coriolis_force=along_joints(robot, bias.numpy().astype(float)),
        inverse_dynamics=along_joints(robot, efforts.numpy().astype(float)),
    )


def trees(robot: Imported) -> Iterator[tuple[slice, slice]]:
    """Yield the slices of the joints and of the velocities of each articulation. A file may have several articulations."""
    starts = robot.model.articulation_start.numpy()
    ends = robot.model.joint_qd_start.numpy()
    for first, after in pairwise(starts.tolist()):
        yield slice(first, after), slice(int(ends[first]), int(ends[after]))


def whole(robot: Imported, blocks: Array) -> Array:
    """Return the mass matrix (n, n) of the robot, from the matrices (articulations, k, k) of its articulations.

    An articulation with fewer than k velocities uses the first rows and columns of its matrix.
    """
    mass_matrix = np.zeros((robot.model.joint_dof_count, robot.model.joint_dof_count))
    for block, (_, moved) in zip(blocks, trees(robot), strict=True):
        count = moved.stop - moved.start
        mass_matrix[moved, moved] = block[:count, :count]
    return mass_matrix


def along_joints(robot: Imported, forces: Array) -> Array:
    """Return forces (n,) along the axes of the joints' frames, which are the axes of Newton's velocities.

    Newton's forces of floating joints, which are along the axes of the world, are rotated.
    """
    turned, poses = forces.copy(), robot.state.body_q.numpy().astype(float)
    for joint in robot.moving:
        if joint.type == "floating":
            parent = np.eye(3) if joint.parent < 0 else matrix(scalar_first(poses[joint.parent][3:]))
            turn = parent @ matrix(scalar_first(joint.at[3:]))
            force = turned[joint.moved]
            turned[joint.moved] = np.concatenate([turn.T @ force[:3], turn.T @ force[3:]])
    return turned


def positions(robot: Imported, state: RobotState) -> Array:
    """Return Newton's coordinates of all joints."""
    coordinates = np.array(robot.model.joint_q.numpy(), dtype=float)
    for joint in robot.moving:
        if joint.name in state.positions and joint.type != OTHER:
            position = state.positions[joint.name]
            if joint.type in ("floating", "spherical"):
                *origin, w, x, y, z = position
                position = (*origin, x, y, z, w)
            coordinates[joint.held] = position
    return coordinates


def rates(robot: Imported, state: RobotState, values: Values) -> Array:
    """Return Newton's velocities of all joints from the velocities of a state.

    For the accelerations of a state, return Newton's accelerations without the terms that depend on velocities.
    """
    velocities = np.zeros(robot.model.joint_dof_count)
    for joint in robot.moving:
        if joint.name not in values or joint.type == OTHER:
            continue
        values_of_joint, position = np.array(values[joint.name]), np.array(state.positions[joint.name])
        if joint.type == "spherical":
            values_of_joint = rotate(position, values_of_joint)
        elif joint.type == "floating":
            spin = rotate(position[3:], values_of_joint[3:])
            values_of_joint = np.concatenate([values_of_joint[:3] + np.cross(spin, arm(robot, joint, position)), spin])
        velocities[joint.moved] = values_of_joint
    return velocities


def accelerations(robot: Imported, state: RobotState) -> Array:
    """Return Newton's accelerations of all joints, including the centripetal acceleration of centres of mass."""
    rates_of_joints = rates(robot, state, state.accelerations)
    for joint in robot.moving:
        if joint.type == "floating" and joint.name in state.accelerations:
            position = np.array(state.positions[joint.name])
            spin = rotate(position[3:], np.array(state.velocities[joint.name][3:]))
            rates_of_joints[joint.moved][:3] += np.cross(spin, np.cross(spin, arm(robot, joint, position)))
    return rates_of_joints


def arm(robot: Imported, joint: Joint, position: Array) -> Array:
    """Return the vector (3,) from the origin of a floating joint's child to its centre of mass, along the axes of the joint."""
    return rotate(position[3:], robot.model.body_com.numpy()[joint.body].astype(float))


def jacobians(robot: Imported) -> Mapping[str, Array]:
    """Return the Jacobians (6, n) of the origins of the bodies' frames along the axes of the world, linear rows first."""
    blocks = newton.eval_jacobian(robot.model, robot.state).numpy().astype(float)
    bodies = [joint.body for joint in robot.joints]
    rows = np.zeros((len(bodies), 6, robot.model.joint_dof_count))
    for block, (joints, moved) in zip(blocks, trees(robot), strict=True):
        rows_of_tree = block.reshape(-1, 6, block.shape[-1])
        rows[joints, :, moved] = rows_of_tree[: joints.stop - joints.start, :, : moved.stop - moved.start]
    turns = robot.state.body_q.numpy().astype(float)[bodies][:, [6, 3, 4, 5]]
    arms = rotate(normalise(turns), robot.model.body_com.numpy().astype(float)[bodies])
    linear = rows[:, :3] - np.cross(rows[:, 3:], arms[:, :, None], axis=1)
    matrices = np.concatenate([linear, rows[:, 3:]], axis=1)
    return {robot.names[body]: rows_of_tree for body, rows_of_tree in zip(bodies, matrices, strict=True)}
