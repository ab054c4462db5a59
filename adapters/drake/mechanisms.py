"""Mechanisms in Drake: bodies on Drake's joints, and the forces in these joints.

Each joint is Drake's joint of the same type. The coordinates of a spherical joint are roll, pitch and yaw, whose rates are
infinite at a pitch of a right angle. A body without a joint and a body on a free joint have Drake's quaternion joint. Springs
are Drake's force elements. Armature is the inertia of the rotor of an actuator with a gear ratio of 1, and a constant effort
is the input of such an actuator. Loops are Drake's ball constraints, and a joint that follows another one has Drake's coupler
constraint; only the discrete plant has constraints. Drake has no dry friction."""

from collections.abc import Callable
from typing import Any

import numpy as np
from pydrake.common.eigen_geometry import Quaternion
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.math import SpatialVelocity
from pydrake.multibody.plant import AddMultibodyPlant, ApplyMultibodyPlantConfig, MultibodyPlant
from pydrake.multibody.tree import (
    BallRpyJoint,
    FixedOffsetFrame,
    PlanarJoint,
    PrismaticJoint,
    PrismaticSpring,
    QuaternionFloatingJoint,
    RevoluteJoint,
    RevoluteSpring,
    UniversalJoint,
    WeldJoint,
)
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from bodycheck.adapters.contract import Method, SceneUnsupported, Simulation
from bodycheck.adapters.drake.models import CENIC, PLANT, Model, add_link, configured, controlled, integrated, stepper
from bodycheck.adapters.links import Link
from bodycheck.adapters.mechanisms import centred, frames, in_body_axes, link_of, massless_parts, starts
from bodycheck.adapters.stepping import Loop
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.mechanisms.exact import nearest_axis, nearest_turn
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Mechanism
from bodycheck.reference.trajectory import Array

#: The features of mechanisms that Drake models; see `Engine.models`.
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
        "armature",
        "joint damping",
        "joint springs",
        "joint efforts",
        "loops",
        "point masses",
        "massless bodies",
        "mimic joints",
    }
)

#: The approximations of contact of the discrete plant whose solver is SAP, the only one with constraints.
CONSTRAINED = ("lagged", "similar", "sap")


def prepare(mechanism: Mechanism, method: Method, approximations: tuple[str, ...]) -> Simulation:
    """Return the simulation of a mechanism.

    Parameters
    ----------
    mechanism, method
        The mechanism and the method.
    approximations
        The names of the integrators that are approximations of contact of the discrete plant.

    Raises
    ------
    SceneUnsupported
        If Drake refuses a body, has no constraints with this method, or refuses bodies without mass with it.
    """

    def in_bodies(numbers: Array) -> Array:
        return rows(mechanism, numbers)

    if method.accuracy is not None:
        return controlled(lambda: built(mechanism, method, approximations), method, in_bodies)
    model, seen = built(mechanism, method, approximations)
    return Loop(0, stepper(model, method.timestep), lambda _: seen(), in_bodies)


def built(mechanism: Mechanism, method: Method, approximations: tuple[str, ...]) -> tuple[Model, Callable[[], Array]]:
    """Return the model of a mechanism, and the function that `seer` returns. Raises `SceneUnsupported` as `prepare` does."""
    constrained = bool(mechanism.loops) or any(joint.mimic for joint in mechanism.joints)
    if constrained and method.integrator not in CONSTRAINED:
        raise SceneUnsupported(
            "Drake has constraints for loops and mimic joints in its discrete plant with the solver SAP only"
        )
    if method.integrator == CENIC and (part := next(massless_parts(mechanism), None)) is not None:
        raise SceneUnsupported(f"cenic refuses the body {mechanism.bodies[part[0]].name}: composite for body has zero mass")
    config = configured(method, approximations)
    builder = DiagramBuilder()
    in_diagram = method.integrator == CENIC or constrained
    if in_diagram:
        plant, _ = AddMultibodyPlant(config, builder)
    else:
        plant = MultibodyPlant(config.time_step)
        ApplyMultibodyPlantConfig(config, plant)
    plant.set_name(PLANT)
    bodies = [add_link(plant, f"body {index}", link_of(body)) for index, body in enumerate(mechanism.bodies)]
    joints = [add_joint(plant, bodies, joint, f"joint {index}") for index, joint in enumerate(mechanism.joints)]
    actuators = [add_actuator(plant, drake_joint, joint) for drake_joint, joint in zip(joints, mechanism.joints, strict=True)]
    if mechanism.loops:
        add_loops(plant, bodies, mechanism)
    for joint, drake_joint in zip(mechanism.joints, joints, strict=True):
        if joint.mimic is not None:
            plant.AddCouplerConstraint(drake_joint, joints[joint.mimic.joint], joint.mimic.multiplier, joint.mimic.offset)
    plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -mechanism.gravity])
    try:
        plant.Finalize()
    except RuntimeError as error:
        raise SceneUnsupported(f"Drake refuses the mechanism: {' '.join(str(error).split())}") from error
    simulator = Simulator(builder.Build() if in_diagram else plant)
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    if plant.num_actuators():
        efforts = [joint.effort for joint, actuator in zip(mechanism.joints, actuators, strict=True) if actuator is not None]
        plant.get_actuation_input_port().FixValue(context, efforts)
    start(mechanism, plant, context, bodies, joints)
    integrated(simulator, method, continuous=method.integrator not in approximations)
    model = Model(simulator, plant, context)
    return model, seer(model, bodies)


def add_joint(plant: Any, bodies: list[Any], joint: Joint, name: str) -> Any:
    """Add a joint with its damping and its spring to a plant, and return it."""
    pose = RigidTransform(Quaternion(nearest_turn(joint.attitude)), joint.position)
    parent = plant.AddFrame(FixedOffsetFrame(name, _body(plant, bodies, joint.parent).body_frame(), pose))
    child = bodies[joint.child].body_frame()
    if joint.type == "revolute":
        drake_joint = plant.AddJoint(RevoluteJoint(name, parent, child, nearest_axis(joint), joint.damping))
        if joint.stiffness:
            plant.AddForceElement(RevoluteSpring(drake_joint, joint.rest, joint.stiffness))
        return drake_joint
    if joint.type == "prismatic":
        drake_joint = plant.AddJoint(PrismaticJoint(name, parent, child, nearest_axis(joint), damping=joint.damping))
        if joint.stiffness:
            plant.AddForceElement(PrismaticSpring(drake_joint, joint.rest, joint.stiffness))
        return drake_joint
    if joint.type == "fixed":
        return plant.AddJoint(WeldJoint(name, parent, child, RigidTransform()))
    if joint.type == "spherical":
        return plant.AddJoint(BallRpyJoint(name, parent, child, joint.damping))
    kinds = {"universal": UniversalJoint, "planar": PlanarJoint, "free": QuaternionFloatingJoint}
    return plant.AddJoint(kinds[joint.type](name, parent, child))


def add_actuator(plant: Any, drake_joint: Any, joint: Joint) -> Any | None:
    """Add an actuator to a joint that has armature or effort, and return it; None without them."""
    if not joint.armature and not joint.effort:
        return None
    actuator = plant.AddJointActuator(drake_joint.name(), drake_joint)
    actuator.set_default_rotor_inertia(joint.armature)
    return actuator


def add_loops(plant: Any, bodies: list[Any], mechanism: Mechanism) -> None:
    """Add the loops of a mechanism to a plant as ball constraints."""
    # A constraint on the body of the world itself ends the process; a body that is welded to the world takes its place.
    anchor = add_link(plant, "anchor", Link(1.0, (1.0, 1.0, 1.0, 0.0, 0.0, 0.0)))
    plant.WeldFrames(plant.world_frame(), anchor.body_frame())
    for loop in mechanism.loops:
        one, other = (anchor if index == WORLD else bodies[index] for index in loop.bodies)
        plant.AddBallConstraint(one, loop.points[0], other, loop.points[1])


def start(mechanism: Mechanism, plant: Any, context: Any, bodies: list[Any], joints: list[Any]) -> None:
    """Set the initial state of a mechanism in a context of its plant."""
    for index, (joint, frame) in enumerate(zip(mechanism.joint_of, frames(mechanism), strict=True)):
        if joint is None:
            turn = np.array(frame.quaternion)
            velocity = SpatialVelocity(rotate(turn, np.array(frame.angular_velocity)), np.array(frame.velocity))
            plant.SetFreeBodyPose(context, bodies[index], RigidTransform(Quaternion(turn), frame.position))
            plant.SetFreeBodySpatialVelocity(context, bodies[index], velocity)
    q, v = plant.GetPositions(context), plant.GetVelocities(context)
    for joint, drake_joint, (position, velocity) in zip(mechanism.joints, joints, starts(mechanism), strict=True):
        positions, rates = in_drake(joint, position, velocity)
        q[drake_joint.position_start() : drake_joint.position_start() + len(positions)] = positions
        v[drake_joint.velocity_start() : drake_joint.velocity_start() + len(rates)] = rates
    plant.SetPositions(context, q)
    plant.SetVelocities(context, v)


def in_drake(joint: Joint, position: Array, velocity: Array) -> tuple[Array, Array]:
    """Return Drake's coordinates and velocities of a joint; its angular velocities are along the axes of the joint's frame."""
    if joint.type == "spherical":
        return RollPitchYaw(Quaternion(position)).vector(), rotate(position, velocity)
    if joint.type == "free":
        origin, turn = position[:3], position[3:]
        return np.concatenate([turn, origin]), np.concatenate([rotate(turn, velocity[3:]), velocity[:3]])
    return position, velocity


def seer(model: Model, bodies: list[Any]) -> Callable[[], Array]:
    """Return a function that returns the poses and velocities (13 k,) of k bodies, along the axes of the world."""
    plant, context = model.plant, model.context
    # In steps of fixed size, `cenic` leaves the poses before its last step in the cache of the context that is stepped, so that
    # poses need another context.
    own_context = plant.CreateDefaultContext()

    def seen() -> Array:
        plant.SetPositionsAndVelocities(own_context, plant.GetPositionsAndVelocities(context))
        parts = []
        for body in bodies:
            pose, velocity = (
                plant.EvalBodyPoseInWorld(own_context, body),
                plant.EvalBodySpatialVelocityInWorld(own_context, body),
            )
            turn = pose.rotation().ToQuaternion().wxyz()
            parts += [pose.translation(), turn, velocity.translational(), velocity.rotational()]
        return np.concatenate(parts)

    return seen


def rows(mechanism: Mechanism, seen: Array) -> Array:
    """Return the states (n, bodies, 13) of the contract from the rows (n, 13 bodies) of the function that `seer` returns."""
    return centred(mechanism, in_body_axes(seen))


def _body(plant: Any, bodies: list[Any], index: int) -> Any:
    return plant.world_body() if index == WORLD else bodies[index]
