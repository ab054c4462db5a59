"""Robot models as DART's `DartLoader` and `MjcfParser` read them, and the terms that DART computes with them.

The root of a URDF is welded to the world by an option of the loader; without it DART gives the root a free joint. A link with
the name `world` is DART's world, and its inertia is ignored. A link without inertia has DART's default, 1 kg with moments of
1 kg m^2. A joint whose limits exclude zero starts between its limits.

DART has damping, dry friction, stiffness and effort limits of joints, but no armature. It enforces limits of positions only
after `setLimitEnforcement(True)`, which its loader of URDF does not set. Dry friction is a constraint in each
step, so that DART computes neither passive forces nor forward dynamics of a robot with dry friction. A mimic joint has an
actuator of the type MIMIC. DART's Python package does not report its numbers; they are read from the file. Three settings of
the forward dynamics are changed here. DART evaluates damping and springs at the end of a time step: the step is so short that
this makes no difference. DART cuts efforts at their limits: the limits are lifted. DART applies no efforts to mimic joints:
they get actuators that take efforts.

From an MJCF with one tree DART keeps the tree and the damping, but ignores every `inertial`: a body has the inertia of its
shapes, or 1 kg with moments of 1 kg m^2. DART welds a body with a `freejoint`, and drops armature, friction and stiffness.

The velocities of a floating joint are the angular velocity and then the velocity of the child's origin, both along the axes of
the parent.
"""

import re
from collections.abc import Mapping, Sequence
from typing import Any

import dartpy as dart
import numpy as np

from bodycheck.adapters.attitudes import rotation_vector
from bodycheck.adapters.dart.bodies import pose as isometry
from bodycheck.adapters.quiet import overheard, refusal
from bodycheck.adapters.robot_numbers import components, finite, mimics, pose, vector
from bodycheck.adapters.robot_reading import (
    FormatUnknown,
    JointStates,
    ModelRefused,
    ReadBody,
    ReadJoint,
    RobotFile,
    RobotReading,
)
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.robots.model import Mimic
from bodycheck.reference.robots.rotations import plane_axes
from bodycheck.reference.robots.state import RobotState, Values
from bodycheck.reference.robots.terms import Terms
from bodycheck.reference.scene import Vector
from bodycheck.reference.trajectory import Array

#: DART's types of joints in the words of `bodycheck.reference.robots.model`.
TYPES = {
    "RevoluteJoint": "revolute",
    "PrismaticJoint": "prismatic",
    "WeldJoint": "fixed",
    "FreeJoint": "floating",
    "PlanarJoint": "planar",
    "BallJoint": "spherical",
}

#: The name that DART gives the joint of a root, and the name of a link that is DART's world.
ROOT_JOINT, WORLD = "rootJoint", "world"

#: The parts of DART's output, and of the library that reads URDF for it, that surround a message: colours and source locations.
COLOURS_AND_PLACES = re.compile(r"\x1b\[[0-9;]*m|Warning \[\S*\]|at line \d+ in \S*")

#: The beginning of the names of skeletons that DART makes from the shapes of an MJCF's world.
SHAPES = "__geom_skel__"

LIMITS = "DART does not enforce limits of positions until joint.setLimitEnforcement(True)"

#: A time step (s) so short that its effect vanishes in rounding beside the mass matrix.
NO_TIME = 1e-30


def read_robot(file: RobotFile, states: Sequence[RobotState], gravity: Vector) -> RobotReading:
    """Return how DART reads a file, as `RobotModels.read_robot` does."""
    skeleton, warnings = loaded(file) if file.format == "urdf" else of_mjcf(file)
    with overheard():  # DART repeats its warnings
        standard = vector(skeleton.getGravity())
        skeleton.setGravity(gravity)
        skeleton.setTimeStep(NO_TIME)
        bodies = read_bodies(skeleton)
        joints = read_joints(skeleton, mimics(file))
        freed(skeleton)
        return RobotReading(
            bodies=bodies,
            joints=joints,
            links=tuple(body.name for body in bodies),
            velocities=skeleton.getNumDofs(),
            gravity=standard,
            terms=tuple(terms(skeleton, state, frictionless=not any(joint.friction for joint in joints)) for state in states),
            notes=(LIMITS, *dict.fromkeys(f"DART warns: {line}" for line in warnings)),
        )


def step_robot(file: RobotFile, starts: Sequence[JointStates], timestep: float, steps: int) -> list[JointStates]:
    """Return the states after steps of DART, as `RobotSteps.step_robot` does. The bodies of a skeleton do not touch."""
    skeleton, _ = loaded(file) if file.format == "urdf" else of_mjcf(file)
    with overheard():  # DART repeats its warnings
        world = dart.simulation.World()
        world.setGravity([0.0, 0.0, 0.0])
        world.setTimeStep(timestep)
        world.addSkeleton(skeleton)
        return [moved(world, skeleton, start, steps) for start in starts]


def moved(world: Any, skeleton: Any, start: JointStates, steps: int) -> JointStates:
    """Return the state of the joints with one velocity after steps from a state."""
    single = {joint.getName(): joint.getIndexInSkeleton(0) for joint in moving(skeleton) if joint.getNumDofs() == 1}
    positions, velocities = np.array(skeleton.getPositions()), np.zeros(skeleton.getNumDofs())
    for name, index in single.items():
        positions[index], velocities[index] = start.positions.get(name, positions[index]), start.velocities.get(name, 0.0)
    skeleton.setPositions(positions)
    skeleton.setVelocities(velocities)
    skeleton.setAccelerations(0 * velocities)
    for _ in range(steps):
        world.step()
    positions, velocities = skeleton.getPositions(), skeleton.getVelocities()
    return JointStates(
        {name: float(positions[index]) for name, index in single.items()},
        {name: float(velocities[index]) for name, index in single.items()},
    )


def loaded(file: RobotFile) -> tuple[Any, list[str]]:
    """Return the skeleton of a URDF, with the root welded to the world, and the lines that DART prints about the file.

    Raises `ModelRefused`.
    """
    loader = dart.utils.DartLoader()
    loader.setOptions(dart.utils.DartLoaderOptions(defaultRootJointType=dart.utils.DartLoaderRootJointType.FIXED))
    for name, path in file.packages.items():
        loader.addPackageDirectory(name, path)
    with overheard() as said:
        skeleton = loader.parseSkeleton(file.path)
    lines = [COLOURS_AND_PLACES.sub("", line).strip() for line in said]
    if skeleton is None:
        raise ModelRefused(refusal(file.path, " ".join(lines)))
    return skeleton, lines


def of_mjcf(file: RobotFile) -> tuple[Any, list[str]]:
    """Return the skeleton of an MJCF, and the lines that DART prints about the file.

    Raises `ModelRefused`, and `FormatUnknown` if the file has several skeletons.
    """
    world, lines = world_of_mjcf(file)
    every = [world.getSkeleton(index) for index in range(world.getNumSkeletons())]
    trees = [skeleton for skeleton in every if not skeleton.getName().startswith(SHAPES)]
    if len(trees) != 1:
        raise FormatUnknown(f"the adapter of DART takes an MJCF of one tree, and this one has {len(trees)}")
    skeleton = trees[0]
    skeleton.setGravity(world.getGravity())
    return skeleton, lines


def world_of_mjcf(file: RobotFile) -> tuple[Any, list[str]]:
    """Return the world of an MJCF, and the lines that DART prints about the file. Raises `ModelRefused`."""
    with overheard() as said:
        world = dart.utils.MjcfParser.readWorld(file.path)
    lines = [COLOURS_AND_PLACES.sub("", line).strip() for line in said]
    if world is None:
        raise ModelRefused(refusal(file.path, " ".join(lines)))
    return world, lines


def joints_of(skeleton: Any) -> list[Any]:
    """Return the joints of a skeleton in DART's order."""
    return [skeleton.getJoint(index) for index in range(skeleton.getNumJoints())]


def bodies_of(skeleton: Any) -> list[Any]:
    """Return the bodies of a skeleton in DART's order."""
    return [skeleton.getBodyNode(index) for index in range(skeleton.getNumBodyNodes())]


def moving(skeleton: Any) -> list[Any]:
    """Return the joints that move."""
    return [joint for joint in joints_of(skeleton) if joint.getNumDofs()]


def place_of(joint: Any) -> slice:
    """Return the slice of a joint's velocities and coordinates in the vectors of the skeleton."""
    first = joint.getIndexInSkeleton(0)
    return slice(first, first + joint.getNumDofs())


def read_bodies(skeleton: Any) -> tuple[ReadBody, ...]:
    """Return the bodies. DART's world is one of them if it is the parent of a body by a joint of the file."""
    bodies = []
    for joint in joints_of(skeleton):
        body, parent = joint.getChildBodyNode(), joint.getParentBodyNode()
        inertia = body.getInertia()
        on_world = None if joint.getName() == ROOT_JOINT else WORLD
        bodies.append(
            ReadBody(
                body.getName(),
                on_world if parent is None else parent.getName(),
                inertia.getMass(),
                vector(inertia.getLocalCOM()),
                components(inertia.getMoment()),
            )
        )
    return (ReadBody(WORLD, None), *bodies) if any(body.parent == WORLD for body in bodies) else tuple(bodies)


def read_joints(skeleton: Any, followed: Mapping[str, Mimic]) -> tuple[ReadJoint, ...]:
    """Return the joints that move. For a joint with several velocities, the properties are those of the first velocity."""
    joints = []
    for joint in moving(skeleton):
        single = joint.getNumDofs() == 1
        follows = joint.getActuatorType() == dart.dynamics.ActuatorType.MIMIC
        joints.append(
            ReadJoint(
                name=joint.getName(),
                type=TYPES.get(joint.getType(), joint.getType()),
                child=joint.getChildBodyNode().getName(),
                first=place_of(joint).start,
                count=joint.getNumDofs(),
                axis=axis(joint),
                armature=0.0,
                damping=joint.getDampingCoefficient(0),
                friction=joint.getCoulombFriction(0),
                stiffness=joint.getSpringStiffness(0),
                effort_limit=finite(joint.getForceUpperLimit(0)),
                lower=finite(joint.getPositionLowerLimit(0)) if single else None,
                upper=finite(joint.getPositionUpperLimit(0)) if single else None,
                mimic=followed.get(joint.getName()) if follows else None,
            )
        )
    return tuple(joints)


def axis(joint: Any) -> Vector | None:
    """Return the axis of a joint in the frame of its child; None if it has none."""
    if joint.getType() in ("RevoluteJoint", "PrismaticJoint"):
        return vector(joint.getTransformFromChildBodyNode().rotation() @ joint.getAxis())
    return vector(joint.getRotationalAxis()) if joint.getType() == "PlanarJoint" else None


def freed(skeleton: Any) -> None:
    """Remove the limits at which DART cuts efforts, and give mimic joints force actuators in place of their constraints."""
    for joint in moving(skeleton):
        joint.setActuatorType(dart.dynamics.ActuatorType.FORCE)
        for index in range(joint.getNumDofs()):
            joint.setForceLowerLimit(index, -np.inf)
            joint.setForceUpperLimit(index, np.inf)


def terms(skeleton: Any, state: RobotState, frictionless: bool) -> Terms:
    """Return the terms that DART computes at a state."""
    number = skeleton.getNumDofs()
    put(skeleton, state)
    if not number:
        return Terms(poses=poses(skeleton))
    skeleton.setCommands(rates(skeleton, state, state.efforts))
    skeleton.computeForwardDynamics()
    forward = skeleton.getAccelerations()
    skeleton.setAccelerations(rates(skeleton, state, state.accelerations))
    inverse = inverted(skeleton, passive=False)
    return Terms(
        poses=poses(skeleton),
        jacobians={body.getName(): jacobian(skeleton, body) for body in bodies_of(skeleton)},
        mass_matrix=skeleton.getMassMatrix(),
        gravity_force=skeleton.getGravityForces(),
        coriolis_force=skeleton.getCoriolisForces(),
        passive_force=inverse - inverted(skeleton, passive=True) if frictionless else None,
        forward_dynamics=forward if frictionless else None,
        inverse_dynamics=inverse,
    )


def inverted(skeleton: Any, passive: bool) -> Array:
    """Return the efforts of inverse dynamics for the accelerations of a skeleton.

    If `passive` is true, they include the efforts that overcome damping and springs.
    """
    skeleton.computeInverseDynamics(False, passive, passive)
    return np.array(skeleton.getForces())


def put(skeleton: Any, state: RobotState) -> None:
    """Set a skeleton to the positions and velocities of a state."""
    positions = np.array(skeleton.getPositions())
    for joint in moving(skeleton):
        if joint.getName() in state.positions:
            positions[place_of(joint)] = coordinates(joint, state.positions[joint.getName()])
    skeleton.setPositions(positions)
    skeleton.setVelocities(rates(skeleton, state, state.velocities))


def coordinates(joint: Any, position: Sequence[float]) -> Any:
    """Return DART's coordinates of a joint from its position in a robot model; a ball joint has a rotation vector (rad)."""
    if joint.getType() == "BallJoint":
        return rotation_vector(np.array(position))
    if joint.getType() == "FreeJoint":
        return dart.dynamics.FreeJoint.convertToPositions(isometry(position[:3], position[3:]))
    return in_plane(joint) @ position if joint.getType() == "PlanarJoint" else position


def in_plane(joint: Any) -> Array:
    """Return the matrix (3, 3) that converts coordinates of a planar joint to DART's, which chooses the axes in the plane."""
    rotation = np.eye(3)
    axes = np.stack([joint.getTranslationalAxis1(), joint.getTranslationalAxis2()])
    rotation[:2, :2] = axes @ plane_axes(np.array(joint.getRotationalAxis(), np.longdouble))[:, :2].astype(float)
    return rotation


def rates(skeleton: Any, state: RobotState, values: Values) -> Array:
    """Return DART's velocities, accelerations or efforts of all joints from the same quantities of a state.

    Angular accelerations are converted like angular velocities, because the additional term of the derivative is the cross
    product of the angular velocity with itself, which is zero.
    """
    values_of_dart = np.zeros(skeleton.getNumDofs())
    for joint in moving(skeleton):
        name = joint.getName()
        if name in values:
            values_of_joint = np.array(values[name])
            if joint.getType() == "FreeJoint":
                turn = joint.getTransformFromParentBodyNode().rotation()
                spin = rotate(np.array(state.positions[name][3:]), values_of_joint[3:])
                values_of_joint = np.concatenate([turn @ spin, turn @ values_of_joint[:3]])
            elif joint.getType() == "PlanarJoint":
                values_of_joint = in_plane(joint) @ values_of_joint
            values_of_dart[place_of(joint)] = values_of_joint
    return values_of_dart


def poses(skeleton: Any) -> Mapping[str, Array]:
    """Return the poses of all bodies."""
    poses_of_links = {}
    for body in bodies_of(skeleton):
        transform = body.getWorldTransform()
        poses_of_links[body.getName()] = pose(transform.translation(), transform.quaternion().wxyz())
    return poses_of_links


def jacobian(skeleton: Any, body: Any) -> Array:
    """Return the Jacobian (6, n) of the origin of a body's frame along the axes of the world, linear rows first."""
    matrix = np.asarray(skeleton.getJacobian(body, dart.dynamics.Frame.World()))
    return np.concatenate([matrix[3:], matrix[:3]])
