"""Robot models as Drake's parser reads them, and the terms that Drake computes with them.

The root of a URDF, which the parser leaves free, is welded to the world. A link with the name `world` is the world of Drake,
and its inertia is ignored. A child of a floating joint is a free body on the world: Drake ignores its parent and the origin of
the joint. If the parent is the root, the state of the joint is still used, converted to the world. All other links are bodies
of Drake, including links on fixed joints. Drake replaces an inertia that no body can have by the inertia of a ball of the
link's mass with the density of water, and a link with inertia but without mass by such a ball of 1 kg. It warns of both.

Effort limits and armature belong to Drake's actuators, which Drake makes only from transmissions. Drake has no dry friction.
Mimic joints are couplers, which are constraints whose numbers Drake does not report. Their numbers are read from the file, if
Drake has as many couplers as the file has mimic elements. A continuous plant with couplers has no accelerations.

The terms are those of the continuous plant. The velocities of a floating joint are the angular velocity and then the velocity
of the child's origin, both along the axes of the world. Drake's warnings are notes of the reading.
"""

import logging
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
from pydrake.common.eigen_geometry import Quaternion
from pydrake.math import RollPitchYaw
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import (
    BodyIndex,
    ForceElementIndex,
    JacobianWrtVariable,
    MultibodyForces,
    PrismaticSpring,
    RevoluteSpring,
)
from pydrake.systems.analysis import Simulator

from bodycheck.adapters.quiet import refusal
from bodycheck.adapters.robot_numbers import components, finite, floating_joints, mimics, on_root, places_on_root, pose, vector
from bodycheck.adapters.robot_reading import JointStates, ModelRefused, ReadBody, ReadJoint, RobotFile, RobotReading
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.robots.model import Mimic
from bodycheck.reference.robots.state import RobotState, Values
from bodycheck.reference.robots.terms import Terms
from bodycheck.reference.scene import Vector
from bodycheck.reference.trajectory import Array

#: Drake's names of types of joints in the words of `bodycheck.reference.robots.model`.
TYPES = {"quaternion_floating": "floating", "ball_rpy": "spherical"}

#: The text before a warning of Drake, which contains the file and a line, so that it differs between copies of one warning.
PLACE = re.compile(r"^\S+:\d+: warning: ")

#: The name of Drake's world. A link with this name in a file is Drake's world.
WORLD = "world"


class Heard(logging.Handler):
    """A handler that keeps the texts that Drake logs."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self.texts: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        """Keep the text of a record."""
        self.texts.append(record.getMessage())


@contextmanager
def heard() -> Iterator[list[str]]:
    """Keep Drake's warnings from the terminal while this context lasts, and yield the list to which their texts are added."""
    logger, handler = logging.getLogger("drake"), Heard()
    level, propagates, others = logger.level, logger.propagate, logger.handlers[:]
    logger.setLevel(logging.WARNING)
    logger.propagate, logger.handlers = False, [handler]
    try:
        yield handler.texts
    finally:
        logger.setLevel(level)
        logger.propagate, logger.handlers = propagates, others


@dataclass(frozen=True, eq=False)
class Parsed:
    """A robot file as Drake's parser has read it.

    Parameters
    ----------
    plant
        The plant, with the root welded to the world.
    anchor
        The name of the link that is, or is welded to, Drake's world.
    gravity
        The default gravity of the plant (m/s^2).
    """

    plant: Any
    anchor: str
    gravity: Vector

    @property
    def bodies(self) -> list[Any]:
        """The bodies in Drake's order, without its world."""
        return [self.plant.get_body(BodyIndex(index)) for index in range(1, self.plant.num_bodies())]

    @property
    def joints(self) -> list[Any]:
        """The joints in Drake's order."""
        return joints_of(self.plant)


def read_robot(file: RobotFile, states: Sequence[RobotState], gravity: Vector) -> RobotReading:
    """Return how Drake reads a file, as `RobotModels.read_robot` does."""
    with heard() as texts:
        robot = parsed(file, gravity)
        names = named(robot.joints, floating_joints(file))
        context = robot.plant.CreateDefaultContext()
        places = places_on_root(file)
        computed = tuple(terms(robot, context, names, on_root(state, places)) for state in states)
    notes = [f"Drake warns: {PLACE.sub('', refusal(file.path, text))}" for text in texts]
    followers = mimics(file)
    if robot.plant.num_constraints():
        notes.append("Drake has no forward dynamics of a continuous plant with the couplers of mimic joints")
    if robot.plant.num_constraints() != len(followers):
        followers = {}
    links = read_bodies(robot)
    return RobotReading(
        bodies=links,
        joints=read_joints(robot, names, followers),
        links=tuple(body.name for body in links),
        velocities=robot.plant.num_velocities(),
        gravity=robot.gravity,
        terms=computed,
        notes=tuple(dict.fromkeys(notes)),
    )


def step_robot(file: RobotFile, starts: Sequence[JointStates], timestep: float, steps: int) -> list[JointStates]:
    """Return the states after steps of Drake's discrete plant, as `RobotSteps.step_robot` does. Raises `ModelRefused`.

    A plant without a scene graph has no contacts. Only the discrete plant has limits and couplers.
    """
    with heard():
        robot = parsed(file, (0.0, 0.0, 0.0), timestep)
        plant, names = robot.plant, named(robot.joints, floating_joints(file))
        single = {name: joint for name, joint in names.items() if joint.num_velocities() == 1}
        try:
            return [moved(plant, single, start, timestep * steps) for start in starts]
        except RuntimeError as error:
            raise ModelRefused(refusal(file.path, str(error))) from error


def moved(plant: Any, joints: Mapping[str, Any], start: JointStates, duration: float) -> JointStates:
    """Return the state of joints after steps of a discrete plant from a state for a time (s)."""
    simulator = Simulator(plant)
    context = simulator.get_mutable_context()
    positions, velocities = plant.GetPositions(context), np.zeros(plant.num_velocities())
    for name, joint in joints.items():
        positions[joint.position_start()] = start.positions.get(name, positions[joint.position_start()])
        velocities[joint.velocity_start()] = start.velocities.get(name, 0.0)
    plant.SetPositions(context, positions)
    plant.SetVelocities(context, velocities)
    simulator.AdvanceTo(duration)
    positions, velocities = plant.GetPositions(context), plant.GetVelocities(context)
    return JointStates(
        {name: float(positions[joint.position_start()]) for name, joint in joints.items()},
        {name: float(velocities[joint.velocity_start()]) for name, joint in joints.items()},
    )


def parsed(file: RobotFile, gravity: Vector, timestep: float = 0.0) -> Parsed:
    """Return a file as Drake parses it into a plant with gravity (m/s^2). Raises `ModelRefused`.

    timestep: the time step (s) of a discrete plant; 0 for a continuous one.
    """
    plant = MultibodyPlant(timestep)
    try:
        anchor = filled(plant, file)
        standard = vector(plant.gravity_field().gravity_vector())
        plant.mutable_gravity_field().set_gravity_vector(gravity)
        plant.Finalize()
    except RuntimeError as error:
        raise ModelRefused(refusal(file.path, str(error))) from error
    return Parsed(plant, anchor, standard)


def filled(plant: Any, file: RobotFile) -> str:
    """Parse a file into a plant, and return the name of the link that is fixed to the world. Raises `RuntimeError`."""
    parser = Parser(plant)
    for name, path in file.packages.items():
        parser.package_map().Add(name, path)
    parser.AddModels(file.path)
    return WORLD if file.format == "mjcf" else welded(plant, set(floating_joints(file)))


def welded(plant: Any, floating: set[str]) -> str:
    """Weld the roots of a URDF to the world, and return the name of the link that is then fixed to the world.

    A root is a body that is the child of no joint of Drake, nor of a joint of the type "floating" in the file.
    """
    moved = {joint.child_body().name() for joint in joints_of(plant)} | floating
    names = [plant.get_body(BodyIndex(index)).name() for index in range(1, plant.num_bodies())]
    roots = [name for name in names if name not in moved]
    for name in roots:
        plant.WeldFrames(plant.world_frame(), plant.GetBodyByName(name).body_frame())
    return roots[0] if roots else WORLD


def joints_of(plant: Any) -> list[Any]:
    """Return the joints of a plant in Drake's order."""
    return [plant.get_joint(index) for index in plant.GetJointIndices()]


def named(joints: Sequence[Any], floating: Mapping[str, str]) -> dict[str, Any]:
    """Return the joints that move, keyed by the names in the file; the key of a joint that Drake added is its body's name.

    joints: all joints of a plant. floating: the names of floating joints in the file, keyed by the links that they move.
    """
    moving = [joint for joint in joints if joint.num_velocities()]
    return {floating.get(joint.child_body().name()) or joint.name(): joint for joint in moving}


def read_bodies(robot: Parsed) -> tuple[ReadBody, ...]:
    """Return the bodies. Drake's world is one of them if the file has a link for it."""
    parents = {joint.child_body().name(): joint.parent_body().name() for joint in robot.joints}
    bodies = [ReadBody(WORLD, None)] if robot.anchor == WORLD else []
    for body in robot.bodies:
        inertia = body.default_spatial_inertia()
        parent = parents.get(body.name(), WORLD)
        bodies.append(
            ReadBody(
                body.name(),
                None if body.name() == robot.anchor else robot.anchor if parent == WORLD else parent,
                inertia.get_mass(),
                vector(inertia.get_com()),
                components(inertia.Shift(inertia.get_com()).CalcRotationalInertia().CopyToFullMatrix3()),
            )
        )
    return tuple(bodies)


def read_joints(robot: Parsed, names: Mapping[str, Any], followers: Mapping[str, Mimic]) -> tuple[ReadJoint, ...]:
    """Return the joints that move. A joint without an actuator has no armature."""
    plant = robot.plant
    actuators = [plant.get_joint_actuator(index) for index in plant.GetJointActuatorIndices()]
    springs = [plant.get_force_element(ForceElementIndex(number)) for number in range(plant.num_force_elements())]
    joints = []
    for name, joint in names.items():
        driven = [actuator for actuator in actuators if actuator.joint().index() == joint.index()]
        limits = joint.position_lower_limits(), joint.position_upper_limits()
        single = joint.num_velocities() == 1
        damping = set(joint.default_damping_vector().tolist())
        joints.append(
            ReadJoint(
                name=name,
                type=TYPES.get(joint.type_name(), joint.type_name()),
                child=joint.child_body().name(),
                first=joint.velocity_start(),
                count=joint.num_velocities(),
                axis=axis(joint),
                armature=sum(actuator.default_reflected_inertia() for actuator in driven),
                damping=damping.pop() if len(damping) == 1 else None,
                stiffness=sum(stiffness(spring, joint) for spring in springs),
                effort_limit=finite(min(actuator.effort_limit() for actuator in driven)) if driven else None,
                lower=finite(limits[0][0]) if single else None,
                upper=finite(limits[1][0]) if single else None,
                mimic=followers.get(name),
            )
        )
    return tuple(joints)


def axis(joint: Any) -> Vector | None:
    """Return the axis of a joint in the frame of its child; None if it has none."""
    if joint.type_name() == "revolute":
        direction = joint.revolute_axis()
    elif joint.type_name() == "prismatic":
        direction = joint.translation_axis()
    elif joint.type_name() == "planar":
        direction = np.array([0.0, 0.0, 1.0])
    else:
        return None
    return vector(joint.frame_on_child().GetFixedRotationMatrixInBodyFrame().matrix() @ direction)


def stiffness(element: Any, joint: Any) -> float:
    """Return the stiffness (N m/rad or N/m) of a force element if it is a spring of the joint, else 0."""
    if not isinstance(element, RevoluteSpring | PrismaticSpring) or element.joint().index() != joint.index():
        return 0.0
    return float(element.default_stiffness() if isinstance(element, RevoluteSpring) else element.stiffness())


def terms(robot: Parsed, context: Any, names: Mapping[str, Any], state: RobotState) -> Terms:
    """Return the terms that Drake computes at a state."""
    plant = robot.plant
    positions = plant.GetPositions(robot.plant.CreateDefaultContext())
    for name, joint in names.items():
        if name in state.positions:
            in_drake = coordinates(joint, np.array(state.positions[name]))
            positions[joint.position_start() : joint.position_start() + len(in_drake)] = in_drake
    plant.SetPositions(context, positions)
    plant.SetVelocities(context, rates(plant, names, state, state.velocities))
    forces = MultibodyForces(plant)
    plant.CalcForceElementsContribution(context, forces)
    passive = forces.generalized_forces().copy()
    forces.mutable_generalized_forces()[:] = 0.0  # so that gravity alone remains
    wanted = rates(plant, names, state, state.accelerations)
    return Terms(
        poses={body.name(): placed(plant, context, body) for body in robot.bodies},
        jacobians={body.name(): jacobian(plant, context, body) for body in robot.bodies},
        mass_matrix=plant.CalcMassMatrix(context),
        gravity_force=-plant.CalcGravityGeneralizedForces(context),
        coriolis_force=plant.CalcBiasTerm(context),
        passive_force=passive,
        forward_dynamics=accelerations(plant, context, rates(plant, names, state, state.efforts)),
        inverse_dynamics=plant.CalcInverseDynamics(context, wanted, forces),
    )


def coordinates(joint: Any, position: Array) -> Array:
    """Return Drake's coordinates of a joint."""
    if joint.type_name() == "quaternion_floating":
        return np.concatenate([position[3:], position[:3]])
    return RollPitchYaw(Quaternion(position)).vector() if joint.type_name() == "ball_rpy" else position


def rates(plant: Any, names: Mapping[str, Any], state: RobotState, values: Values) -> Array:
    """Return Drake's velocities, accelerations or efforts of all joints from the same quantities of a state.

    Drake's angular velocities are along the axes of the joint's frame. Angular accelerations are converted like angular
    velocities, because the additional term of the derivative is the cross product of the angular velocity with itself, which is
    zero.
    """
    velocities = np.zeros(plant.num_velocities())
    for name, joint in names.items():
        if name in values:
            values_of_joint, position = np.array(values[name]), np.array(state.positions[name])
            if joint.type_name() == "quaternion_floating":
                values_of_joint = np.concatenate([rotate(position[3:], values_of_joint[3:]), values_of_joint[:3]])
            elif joint.type_name() == "ball_rpy":
                values_of_joint = rotate(position, values_of_joint)
            velocities[joint.velocity_start() : joint.velocity_start() + len(values_of_joint)] = values_of_joint
    return velocities


def accelerations(plant: Any, context: Any, forces: Array) -> Array | None:
    """Return Drake's accelerations under generalised forces; None if it cannot compute them, as with constraints or no mass."""
    plant.get_applied_generalized_force_input_port().FixValue(context, forces)
    try:
        return np.array(plant.get_generalized_acceleration_output_port().Eval(context))
    except RuntimeError:
        return None


def placed(plant: Any, context: Any, body: Any) -> Array:
    """Return the pose (7,) of a body."""
    transform = plant.EvalBodyPoseInWorld(context, body)
    return pose(transform.translation(), transform.rotation().ToQuaternion().wxyz())


def jacobian(plant: Any, context: Any, body: Any) -> Array:
    """Return the Jacobian (6, n) of the origin of a body's frame along the axes of the world, linear rows first."""
    world = plant.world_frame()
    matrix = plant.CalcJacobianSpatialVelocity(context, JacobianWrtVariable.kV, body.body_frame(), np.zeros(3), world, world)
    return np.concatenate([matrix[3:], matrix[:3]])
