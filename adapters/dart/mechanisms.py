"""Mechanisms in DART: bodies on DART's joints, and the forces in these joints.

Each joint is DART's joint of the same type, with DART's damping, spring and dry friction; an effort is the command of the
joint. DART has no armature. Loops are ball joint constraints. Stops are DART's limits of positions, enforced without rebound.
"""

from collections.abc import Sequence
from typing import Any

import dartpy as dart
import numpy as np

from bodycheck.adapters.attitudes import rotation_vector
from bodycheck.adapters.contract import EngineDiverged, Method, Simulation
from bodycheck.adapters.dart.bodies import LARGEST_ENERGY_J, inertia, pose
from bodycheck.adapters.mechanisms import bounds, check_rebounds, frames, in_body_axes, link_of, starts, stops_of
from bodycheck.adapters.quiet import no_stderr
from bodycheck.adapters.stepping import Loop as Stepped
from bodycheck.adapters.stepping import Taking
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.mechanisms import exact, kinematics
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Loop, Mechanism
from bodycheck.reference.trajectory import Array

#: The features of mechanisms that DART models; see `Engine.models`.
MODELS = frozenset(
    {
        "mechanisms",
        "revolute joints",
        "prismatic joints",
        "ball joints",
        "free joints",
        "fixed joints",
        "planar joints",
        "universal joints",
        "joint damping",
        "joint springs",
        "joint friction",
        "joint efforts",
        "loops",
        "point masses",
        "massless bodies",
        "controllers",
        "rigid stops",
    }
)


def prepare(mechanism: Mechanism, method: Method) -> tuple[Simulation, "dart.simulation.World", list[Any]]:
    """Return the simulation of a mechanism, its world, and its bodies in their order.

    Raises `SceneUnsupported` for stops with a rebound.
    """
    check_rebounds(mechanism, "DART")
    world = dart.simulation.World()
    world.setGravity([0.0, 0.0, -mechanism.gravity])
    world.setTimeStep(method.timestep)
    sleeping = world.getDeactivationOptions()
    sleeping.mEnabled = method.option("settings") == "engine"
    world.setDeactivationOptions(sleeping)
    skeleton = dart.dynamics.Skeleton("mechanism")
    bodies = built(skeleton, mechanism, method)
    world.addSkeleton(skeleton)
    for loop in mechanism.loops:
        world.getConstraintSolver().addConstraint(closing(bodies, loop))

    def step(state: None) -> None:
        world.step(False)  # keep the efforts
        if not skeleton.computeKineticEnergy() < LARGEST_ENERGY_J:
            raise EngineDiverged(f"DART's accelerations overflow at t = {world.getTime():.6g} s")

    simulation = Stepped(None, step, lambda _: seen(bodies), in_body_axes)
    return driven(simulation, mechanism, bodies) if mechanism.driven else simulation, world, bodies


def driven(simulation: Simulation, mechanism: Mechanism, bodies: Sequence[Any]) -> Taking:
    """Return a simulation of a mechanism whose joints take efforts, from the bodies in their order."""
    driven_joints = [mechanism.joints[index] for index in mechanism.driven]
    dart_joints = [bodies[joint.child].getParentJoint() for joint in driven_joints]

    def state() -> tuple[Array, Array]:
        motion = [(joint.getPosition(0), joint.getVelocity(0)) for joint in dart_joints]
        position, velocity = np.array(motion).T
        return position, velocity

    def apply(efforts: Array) -> None:
        for joint, dart_joint, effort in zip(driven_joints, dart_joints, efforts.tolist(), strict=True):
            dart_joint.setCommand(0, joint.effort + effort)

    return Taking(simulation, state, apply)


def built(skeleton: "dart.dynamics.Skeleton", mechanism: Mechanism, method: Method) -> list[Any]:
    """Add the bodies and joints of a mechanism to a skeleton, in their initial state, and return the bodies in their order."""
    bodies: dict[int, Any] = {WORLD: None}
    for index, (body, frame) in enumerate(zip(mechanism.bodies, frames(mechanism), strict=True)):
        if body.start is not None:
            joint, bodies[index] = skeleton.createFreeJointAndBodyNodePair()
            joint.setPositions(free_positions(frame.position, frame.quaternion))
            turn = np.array(frame.quaternion)
            joint.setVelocities([*rotate(turn, np.array(frame.angular_velocity)), *frame.velocity])
    of_joint = dict(zip([joint.name for joint in mechanism.joints], starts(mechanism), strict=True))
    for joint in kinematics.from_the_root(mechanism):
        dart_joint, bodies[joint.child] = add_joint(skeleton, bodies[joint.parent], joint, method)
        dart_joint.setTransformFromParentBodyNode(pose(joint.position, exact.nearest_turn(joint.attitude)))
        position, velocity = in_dart(joint, *of_joint[joint.name])
        dart_joint.setPositions(position)
        dart_joint.setVelocities(velocity)
    with no_stderr():  # DART warns of bodies without mass, but takes them
        for index, body in enumerate(mechanism.bodies):
            bodies[index].setInertia(inertia(link_of(body)))
    return [bodies[index] for index in range(len(mechanism.bodies))]


def add_joint(skeleton: "dart.dynamics.Skeleton", parent: Any, joint: Joint, method: Method) -> tuple[Any, Any]:
    """Add a joint, with the forces in it and its limits, and its child to a skeleton, and return both.

    The parent of a root is None.
    """
    create = {
        "revolute": skeleton.createRevoluteJointAndBodyNodePair,
        "prismatic": skeleton.createPrismaticJointAndBodyNodePair,
        "spherical": skeleton.createBallJointAndBodyNodePair,
        "universal": skeleton.createUniversalJointAndBodyNodePair,
        "planar": skeleton.createPlanarJointAndBodyNodePair,
        "free": skeleton.createFreeJointAndBodyNodePair,
        "fixed": skeleton.createWeldJointAndBodyNodePair,
    }
    dart_joint, body = create[joint.type](parent)
    if joint.type == "universal":
        dart_joint.setAxis1([1.0, 0.0, 0.0])
        dart_joint.setAxis2([0.0, 1.0, 0.0])
    if joint.type == "planar":
        dart_joint.setXYPlane()
    if joint.type == "spherical":
        for axis in range(3):
            dart_joint.setDampingCoefficient(axis, joint.damping)
    if joint.type in ("revolute", "prismatic"):
        dart_joint.setAxis(exact.nearest_axis(joint))
        dart_joint.setDampingCoefficient(0, joint.damping)
        dart_joint.setSpringStiffness(0, joint.stiffness)
        dart_joint.setRestPosition(0, joint.rest)
        dart_joint.setCoulombFriction(0, joint.friction)
        dart_joint.setCommand(0, joint.effort)
        if (stops := stops_of(joint, method)) is not None:
            lower, upper = bounds(stops)
            dart_joint.setPositionLowerLimit(0, lower)
            dart_joint.setPositionUpperLimit(0, upper)
            dart_joint.setLimitEnforcement(True)
    return dart_joint, body


def in_dart(joint: Joint, position: Array, velocity: Array) -> tuple[Any, Any]:
    """Return DART's coordinates and velocities of a joint.

    The coordinates of a ball joint are a rotation vector, and its velocities the angular velocity along the child's axes. The
    velocities of a free joint are along the axes of the parent.
    """
    if joint.type == "spherical":
        return rotation_vector(position), velocity
    if joint.type == "free":
        frame = np.array(exact.nearest_turn(joint.attitude))
        turned = rotate(frame, np.stack([rotate(position[3:], velocity[3:]), velocity[:3]]))
        return free_positions(position[:3], position[3:]), turned.ravel()
    return position, velocity


def free_positions(position: Any, quaternion: Any) -> Any:
    """Return DART's coordinates of a free joint."""
    return dart.dynamics.FreeJoint.convertToPositions(pose(position, quaternion))


def closing(bodies: list[Any], loop: Loop) -> "dart.constraint.BallJointConstraint":
    """Return DART's constraint of a loop."""
    (first, second), (point, second_point) = loop.bodies, loop.points
    if first == WORLD:
        (first, point), (second, second_point) = (second, second_point), (first, point)
    anchor = bodies[first].getWorldTransform().multiply(np.array(point))
    if second == WORLD:
        return dart.constraint.BallJointConstraint(bodies[first], anchor)
    return dart.constraint.BallJointConstraint(bodies[first], bodies[second], anchor)


def seen(bodies: list[Any]) -> Array:
    """Return the states (13 k,) of the centres of mass of k bodies; angular velocities are along the axes of the world."""
    parts = []
    for body in bodies:
        turn = body.getWorldTransform().quaternion().wxyz()
        parts += [body.getCOM(), turn, body.getCOMLinearVelocity(), body.getAngularVelocity()]
    return np.concatenate(parts)
