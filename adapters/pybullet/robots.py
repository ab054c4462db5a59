"""Robot models as PyBullet's readers read them, and the terms that Bullet's inverse dynamics computes with them.

A URDF is loaded with a fixed base and with the flag `URDF_USE_INERTIA_FROM_FILE`, without which PyBullet computes the inertia
from the shapes of collision. Everything else is PyBullet's default. Bullet keeps each link along its principal axes. It stops
their computation when less than a millionth of the trace is off the diagonal, and drops the remaining entries: 2e-7 of the
trace for one in thousands of random tensors, and some 1e-9 for most. The frames of links that `getLinkState` returns are
rounded to single precision; therefore the frames are computed here from the poses of the centres of mass. A link without
inertia has 1 kg and moments of 1 kg m^2.

From an MJCF of one tree on the world PyBullet keeps masses, and centres of mass in single precision, but not the inertia of an
`inertial`. A joint moves a link without mass, which PyBullet names, and the body is fixed to this link.

PyBullet has damping of a joint, but no armature and no mimic joints. It tells the friction of a joint, and the limits that a
file states for a continuous joint, and enforces neither, as trials by motion show (`step_robot`). A joint of the type
"floating" becomes a fixed joint. Mass matrix, Jacobians and inverse dynamics are computed from positions that the caller gives,
so that they do not contain the damping of links and the motors, which PyBullet applies in every step. PyBullet offers no
forward dynamics, and no Jacobians of a robot with a spherical or planar joint. A robot with a spherical joint has no terms
except poses, and a robot with a planar joint has no terms.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
import pybullet

from bodycheck.adapters.pybullet.links import BASE
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
from bodycheck.reference.kinematics import conjugate, multiply, rotate
from bodycheck.reference.robots.state import RobotState, Values
from bodycheck.reference.robots.terms import Terms
from bodycheck.reference.scene import Vector
from bodycheck.reference.trajectory import Array

#: PyBullet's types of joints in the words of `bodycheck.reference.robots.model`, and their numbers of velocities.
TYPES = {
    pybullet.JOINT_REVOLUTE: ("revolute", 1),
    pybullet.JOINT_PRISMATIC: ("prismatic", 1),
    pybullet.JOINT_SPHERICAL: ("spherical", 3),
    pybullet.JOINT_PLANAR: ("planar", 3),
    pybullet.JOINT_FIXED: ("fixed", 0),
}

#: A millionth of the trace of a tensor may be off Bullet's principal axes. The trace is at most three times the largest
#: component.
ROUNDING = 3e-6

#: The text that PyBullet writes before a message.
PLACES = re.compile(r"b3(?:Warning|Error|Printf)\[[^]]*\]:")

NOTES = (
    "URDF_USE_INERTIA_FROM_FILE is set; without it PyBullet computes the inertia from the shapes of collision",
    "PyBullet's links have linear and angular damping of 0.04 unless it is switched off, and motors that brake each joint",
)


@dataclass(frozen=True)
class Joint:
    """A joint of PyBullet.

    Attributes
    ----------
    index
        The index of the joint, which is also the index of its link.
    name, type
        The name and the type.
    first, count
        The index of its first velocity, and the number of its velocities.
    link, parent
        The name of its link, and the index of the parent link.
    info
        The entries of PyBullet's `getJointInfo`.
    """

    index: int
    name: str
    type: str
    first: int
    count: int
    link: str
    parent: int
    info: tuple[Any, ...]


@dataclass(frozen=True)
class Loaded:
    """A robot in a physics server: the connection, the body, the name of its base, and its joints, including fixed joints."""

    client: int
    body: int
    base: str
    joints: tuple[Joint, ...]

    @property
    def moving(self) -> tuple[Joint, ...]:
        """The joints that move."""
        return tuple(joint for joint in self.joints if joint.count)

    @property
    def velocities(self) -> int:
        """The number of velocities."""
        return sum(joint.count for joint in self.joints)

    def dynamics(self, index: int) -> tuple[Any, ...]:
        """Return the entries of PyBullet's `getDynamicsInfo` for a link, by the index of its joint."""
        dynamics: tuple[Any, ...] = pybullet.getDynamicsInfo(self.body, index, physicsClientId=self.client)
        return dynamics


def read_robot(file: RobotFile, states: Sequence[RobotState], gravity: Vector) -> RobotReading:
    """Return how PyBullet reads a file, as `RobotModels.read_robot` does."""
    with server() as client:
        standard = default_gravity(client)
        robot, warnings = loaded(client, file)
        with overheard():  # Bullet repeats its warnings in each call
            computed_terms = tuple(terms(robot, state, gravity) for state in states)
        return RobotReading(
            bodies=read_bodies(robot),
            joints=tuple(read_joint(robot, joint) for joint in robot.moving),
            links=(robot.base, *(joint.link for joint in robot.joints)),
            velocities=robot.velocities,
            gravity=standard,
            terms=computed_terms,
            rounding=ROUNDING,
            notes=(*NOTES, *(f"PyBullet warns: {warning}" for warning in warnings)),
        )


def step_robot(file: RobotFile, starts: Sequence[JointStates], timestep: float, steps: int) -> list[JointStates]:
    """Return the states after steps of Bullet, as `RobotSteps.step_robot` does. Raises `ModelRefused`.

    A server has no gravity unless it is set.
    """
    with server() as client, overheard():
        robot, _ = loaded(client, file)
        pybullet.setTimeStep(timestep, physicsClientId=client)
        release(robot)
        try:
            return [moved(robot, start, steps) for start in starts]
        except pybullet.error as error:  # PyBullet stores the states of at most 128 joints, including fixed joints
            raise ModelRefused(refusal(file.path, str(error))) from error


def release(robot: Loaded) -> None:
    """Switch off the damping of links and the motors that brake joints, which PyBullet adds to every robot."""
    for index in (BASE, *(joint.index for joint in robot.joints)):
        pybullet.changeDynamics(robot.body, index, linearDamping=0, angularDamping=0, physicsClientId=robot.client)
    for joint in robot.moving:
        if joint.type == "spherical":
            still = {"targetPosition": [0, 0, 0, 1], "positionGain": 0, "velocityGain": 0, "force": [0, 0, 0]}
            pybullet.setJointMotorControlMultiDof(
                robot.body, joint.index, pybullet.POSITION_CONTROL, **still, physicsClientId=robot.client
            )
        else:
            motor = {"controlMode": pybullet.VELOCITY_CONTROL, "force": 0}
            pybullet.setJointMotorControl2(robot.body, joint.index, **motor, physicsClientId=robot.client)


def moved(robot: Loaded, start: JointStates, steps: int) -> JointStates:
    """Return the state of the joints with one velocity after steps from a state."""
    single = [joint for joint in robot.moving if joint.count == 1]
    for joint in single:
        position, velocity = start.positions.get(joint.name, 0.0), start.velocities.get(joint.name, 0.0)
        pybullet.resetJointState(robot.body, joint.index, position, velocity, physicsClientId=robot.client)
    for _ in range(steps):
        pybullet.stepSimulation(physicsClientId=robot.client)
    states = [pybullet.getJointState(robot.body, joint.index, physicsClientId=robot.client) for joint in single]
    return JointStates(*({joint.name: state[part] for joint, state in zip(single, states, strict=True)} for part in (0, 1)))


@contextmanager
def server() -> Iterator[int]:
    """Yield the connection to a new physics server, which ends with this context."""
    with overheard():
        client = pybullet.connect(pybullet.DIRECT)
    if client < 0:
        raise ModelRefused("PyBullet starts no further physics server in this process")
    try:
        yield client
    finally:
        pybullet.disconnect(client)


def default_gravity(client: int) -> Vector:
    """Return the gravity of a new physics server (m/s^2)."""
    parameters = pybullet.getPhysicsEngineParameters(physicsClientId=client)
    return vector([parameters[f"gravityAcceleration{axis}"] for axis in "XYZ"])


def loaded(client: int, file: RobotFile) -> tuple[Loaded, list[str]]:
    """Load a file, and return the robot and PyBullet's messages about it.

    Raises `ModelRefused`, and `FormatUnknown` for an MJCF that is not a single tree on the world.
    """
    bodies, said = loaded_bodies(client, file)
    body = bodies[0]
    if len(bodies) > 1 or (file.format == "mjcf" and pybullet.getDynamicsInfo(body, BASE, physicsClientId=client)[0]):
        raise FormatUnknown(f"the adapter of PyBullet takes an MJCF of one tree on the world; this has {len(bodies)} bodies")
    return robot_of(client, body), said


def loaded_bodies(client: int, file: RobotFile) -> tuple[Sequence[int], list[str]]:
    """Load a file, and return its bodies and PyBullet's messages about it. Raises `ModelRefused`."""
    flags = pybullet.URDF_USE_INERTIA_FROM_FILE
    try:
        with overheard() as said:
            if file.format == "urdf":
                bodies = (pybullet.loadURDF(file.path, useFixedBase=True, flags=flags, physicsClientId=client),)
            else:
                bodies = pybullet.loadMJCF(file.path, flags=flags, physicsClientId=client)
    except pybullet.error as error:
        raise ModelRefused(refusal(file.path, " ".join([str(error), *warnings_in(said)]))) from error
    if not bodies:
        raise ModelRefused(refusal(file.path, " ".join(["loadMJCF returns no body", *warnings_in(said)])))
    return bodies, warnings_in(said)


def robot_of(client: int, body: int) -> Loaded:
    """Return a body of a physics server with its joints."""
    base, _ = pybullet.getBodyInfo(body, physicsClientId=client)
    joints, first = [], 0
    for index in range(pybullet.getNumJoints(body, physicsClientId=client)):
        info = pybullet.getJointInfo(body, index, physicsClientId=client)
        type_, count = TYPES.get(info[2], (f"type {info[2]}", 0))
        joints.append(Joint(index, text(info[1]), type_, first, count, text(info[12]), info[16], info))
        first += count
    return Loaded(client, body, text(base), tuple(joints))


def warnings_in(said: Sequence[str]) -> list[str]:
    """Return the messages in PyBullet's output, each once, without the places in PyBullet's source that print them."""
    messages = [message.strip() for message in PLACES.split(" ".join(said))]
    return [message for message in dict.fromkeys(messages) if message]


def text(name: bytes) -> str:
    """Return a name of PyBullet as text."""
    return name.decode("utf-8", "replace")


def read_bodies(robot: Loaded) -> tuple[ReadBody, ...]:
    """Return the base and the links, including links on fixed joints."""
    names = {joint.index: joint.link for joint in robot.joints} | {BASE: robot.base}
    parents = {joint.index: names[joint.parent] for joint in robot.joints}
    return tuple(read_body(robot, index, names[index], parents.get(index)) for index in (BASE, *parents))


def read_body(robot: Loaded, index: int, name: str, parent: str | None) -> ReadBody:
    """Return a link in its own frame."""
    mass, _, moments, centre, turn, *_ = robot.dynamics(index)
    return ReadBody(name, parent, mass, vector(centre), components(along(moments, matrix(scalar_first(turn)))))


def read_joint(robot: Loaded, joint: Joint) -> ReadJoint:
    """Return a joint that moves. Bullet ignores limits if the lower limit is above the upper limit."""
    _, _, _, _, _, _, damping, friction, lower, upper, effort, _, _, axis, *_ = joint.info
    limited, turned = lower <= upper, matrix(scalar_first(robot.dynamics(joint.index)[4]))
    return ReadJoint(
        name=joint.name,
        type=joint.type,
        child=joint.link,
        first=joint.first,
        count=joint.count,
        axis=vector(turned @ np.array(axis)) if joint.type in ("revolute", "prismatic") else None,
        armature=0.0,
        damping=damping,
        friction=friction,
        effort_limit=effort,
        lower=finite(lower) if limited else None,
        upper=finite(upper) if limited else None,
    )


def terms(robot: Loaded, state: RobotState, gravity: Vector) -> Terms:
    """Return the terms that Bullet computes at a state.

    A robot with a spherical joint has only poses, and a robot with a planar joint has no terms.
    """
    place(robot, state)
    if any(joint.type == "planar" for joint in robot.joints):
        return Terms()
    if any(joint.type == "spherical" for joint in robot.joints):
        return Terms(poses=poses(robot))
    positions, moving, wanted = (rates(robot, values) for values in (state.positions, state.velocities, state.accelerations))
    still = [0.0] * robot.velocities

    def inverse(pull: Vector, velocities: list[float], accelerations: list[float]) -> Array | None:
        pybullet.setGravity(*pull, physicsClientId=robot.client)
        return computed(pybullet.calculateInverseDynamics, robot, positions, velocities, accelerations)

    return Terms(
        poses=poses(robot),
        jacobians=jacobians(robot, positions, still),
        mass_matrix=computed(pybullet.calculateMassMatrix, robot, positions),
        gravity_force=inverse(gravity, still, still),
        coriolis_force=inverse((0.0, 0.0, 0.0), moving, still),
        inverse_dynamics=inverse(gravity, moving, wanted),
    )


def computed(function: Any, robot: Loaded, *arguments: list[float]) -> Array | None:
    """Return the result of a function of PyBullet for a robot; None if it fails, for example if no joint of the robot moves."""
    try:
        numbers = function(robot.body, *arguments, physicsClientId=robot.client)
    except pybullet.error:
        return None
    return np.array(numbers) if numbers else None


def rates(robot: Loaded, values: Values) -> list[float]:
    """Return the coordinates, velocities or accelerations of all joints in PyBullet's order; each joint has exactly one."""
    return [values.get(joint.name, (0.0,))[0] for joint in robot.moving]


def place(robot: Loaded, state: RobotState) -> None:
    """Set the joints of a robot, except planar ones, to the positions of a state.

    Bullet takes the position of a spherical joint along the principal axes of its child.
    """
    for joint in robot.moving:
        position = state.positions.get(joint.name)
        if position is not None and joint.count == 1:
            pybullet.resetJointState(robot.body, joint.index, position[0], physicsClientId=robot.client)
        elif position is not None and joint.type == "spherical":
            axes = scalar_first(robot.dynamics(joint.index)[4])
            w, x, y, z = multiply(multiply(conjugate(axes), np.array(position)), axes).tolist()
            pybullet.resetJointStateMultiDof(robot.body, joint.index, [x, y, z, w], physicsClientId=robot.client)


def poses(robot: Loaded) -> Mapping[str, Array]:
    """Return the poses (7,) of the frames of all links, keyed by the names of the links.

    They are computed from PyBullet's poses, which are at the centres of mass and along the principal axes. The result is empty
    for a robot with more than 128 joints, including fixed joints, because PyBullet cannot store them.
    """
    try:
        return dict(posed(robot))
    except pybullet.error:
        return {}


def posed(robot: Loaded) -> Iterator[tuple[str, Array]]:
    """Yield the name of each link and the pose (7,) of its frame: position (m) and quaternion w, x, y, z, world frame."""
    for index, name in ((BASE, robot.base), *((joint.index, joint.link) for joint in robot.joints)):
        if index == BASE:
            at, turn = pybullet.getBasePositionAndOrientation(robot.body, physicsClientId=robot.client)
        else:
            at, turn, *_ = pybullet.getLinkState(robot.body, index, computeForwardKinematics=True, physicsClientId=robot.client)
        centre, axes = robot.dynamics(index)[3:5]
        attitude = multiply(scalar_first(turn), conjugate(scalar_first(axes)))
        yield name, pose(np.array(at) - rotate(attitude, np.array(centre)), attitude)


def jacobians(robot: Loaded, positions: list[float], at_rest: list[float]) -> Mapping[str, Array]:
    """Return the Jacobians (6, n) of the origins of the links' frames, linear rows first, keyed by the names of the links."""
    origin = (0.0, 0.0, 0.0)
    by_link = {robot.base: np.zeros((6, robot.velocities))}  # the base is fixed
    for joint in robot.joints if robot.velocities else ():
        parts = pybullet.calculateJacobian(
            robot.body, joint.index, origin, positions, at_rest, at_rest, physicsClientId=robot.client
        )
        by_link[joint.link] = np.concatenate(parts)
    return by_link
