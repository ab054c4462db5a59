"""Mechanisms in DART: bodies on DART's joints, and what acts in these.

Each joint is DART's own of its type, with DART's own damping, spring and dry friction, and the constant effort is the command
of the joint. DART has no armature. Loops are ball joint constraints.
"""

from typing import Any

import dartpy as dart
import numpy as np

from bodycheck.adapters.attitudes import rotation_vector
from bodycheck.adapters.contract import EngineDiverged, Method, Simulation
from bodycheck.adapters.dart.bodies import LARGEST_ENERGY_J, inertia, pose
from bodycheck.adapters.mechanisms import frames, link_of, starts
from bodycheck.adapters.stepping import Loop as Stepped
from bodycheck.reference.kinematics import conjugate, rotate
from bodycheck.reference.mechanisms import exact, kinematics
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Loop, Mechanism
from bodycheck.reference.trajectory import Array

#: What DART models of mechanisms; see `Engine.models`.
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
    }
)


def prepare(mechanism: Mechanism, method: Method) -> Simulation:
    """Return the simulation of a mechanism."""
    world = dart.simulation.World()
    world.setGravity([0.0, 0.0, -mechanism.gravity])
    world.setTimeStep(method.timestep)
    sleeping = world.getDeactivationOptions()
    sleeping.mEnabled = False
    world.setDeactivationOptions(sleeping)
    skeleton = dart.dynamics.Skeleton("mechanism")
    bodies = built(skeleton, mechanism)
    world.addSkeleton(skeleton)
    for loop in mechanism.loops:
        world.getConstraintSolver().addConstraint(closing(bodies, loop))

    def step(state: None) -> None:
        world.step(False)  # so that efforts stay
        if not skeleton.computeKineticEnergy() < LARGEST_ENERGY_J:
            raise EngineDiverged(f"DART's accelerations overflow at t = {world.getTime():.6g} s")

    return Stepped(None, step, lambda _: seen(bodies), rows)


def built(skeleton: "dart.dynamics.Skeleton", mechanism: Mechanism) -> list[Any]:
    """Add the bodies and joints of a mechanism to a skeleton, in their initial state, and return the bodies in their order."""
    bodies: dict[int, Any] = {WORLD: None}
    for place, (body, frame) in enumerate(zip(mechanism.bodies, frames(mechanism), strict=True)):
        if body.start is not None:
            joint, bodies[place] = skeleton.createFreeJointAndBodyNodePair()
            joint.setPositions(free_positions(frame.position, frame.quaternion))
            turn = np.array(frame.quaternion)
            joint.setVelocities([*rotate(turn, np.array(frame.angular_velocity)), *frame.velocity])
    of_joint = dict(zip([joint.name for joint in mechanism.joints], starts(mechanism), strict=True))
    for joint in kinematics.from_the_root(mechanism):
        made, bodies[joint.child] = add_joint(skeleton, bodies[joint.parent], joint)
        made.setTransformFromParentBodyNode(pose(joint.position, exact.nearest_turn(joint.attitude)))
        position, velocity = in_dart(joint, *of_joint[joint.name])
        made.setPositions(position)
        made.setVelocities(velocity)
    for place, body in enumerate(mechanism.bodies):
        bodies[place].setInertia(inertia(link_of(body)))
    return [bodies[place] for place in range(len(mechanism.bodies))]


def add_joint(skeleton: "dart.dynamics.Skeleton", parent: Any, joint: Joint) -> tuple[Any, Any]:
    """Add a joint, with what acts in it, and its child to a skeleton, and return both; the parent of a root is None."""
    create = {
        "revolute": skeleton.createRevoluteJointAndBodyNodePair,
        "prismatic": skeleton.createPrismaticJointAndBodyNodePair,
        "spherical": skeleton.createBallJointAndBodyNodePair,
        "universal": skeleton.createUniversalJointAndBodyNodePair,
        "planar": skeleton.createPlanarJointAndBodyNodePair,
        "free": skeleton.createFreeJointAndBodyNodePair,
        "fixed": skeleton.createWeldJointAndBodyNodePair,
    }
    made, body = create[joint.type](parent)
    if joint.type == "universal":
        made.setAxis1([1.0, 0.0, 0.0])
        made.setAxis2([0.0, 1.0, 0.0])
    if joint.type == "planar":
        made.setXYPlane()
    if joint.type == "spherical":
        for place in range(3):
            made.setDampingCoefficient(place, joint.damping)
    if joint.type in ("revolute", "prismatic"):
        made.setAxis(exact.nearest_axis(joint))
        made.setDampingCoefficient(0, joint.damping)
        made.setSpringStiffness(0, joint.stiffness)
        made.setRestPosition(0, joint.rest)
        made.setCoulombFriction(0, joint.friction)
        made.setCommand(0, joint.effort)
    return made, body


def in_dart(joint: Joint, position: Array, velocity: Array) -> tuple[Any, Any]:
    """Return DART's coordinates and velocities of a joint.

    A ball joint has a rotation vector, and the angular velocity along the child's axes. The velocities of a free joint are
    along the axes of the parent.
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
    (one, other), (here, there) = loop.bodies, loop.points
    if one == WORLD:
        (one, here), (other, there) = (other, there), (one, here)
    place = bodies[one].getWorldTransform().multiply(np.array(here))
    if other == WORLD:
        return dart.constraint.BallJointConstraint(bodies[one], place)
    return dart.constraint.BallJointConstraint(bodies[one], bodies[other], place)


def seen(bodies: list[Any]) -> Array:
    """Return the states (13 k,) of k bodies at their centres of mass; angular velocities are along the axes of the world."""
    parts = []
    for body in bodies:
        turn = body.getWorldTransform().quaternion().wxyz()
        parts += [body.getCOM(), turn, body.getCOMLinearVelocity(), body.getAngularVelocity()]
    return np.concatenate(parts)


def rows(seen: Array) -> Array:
    """Return the states (n, bodies, 13) of the contract from what is seen (n, 13 bodies)."""
    found = seen.reshape(len(seen), -1, 13)
    found[..., 10:] = rotate(conjugate(found[..., 3:7]), found[..., 10:])
    return found
