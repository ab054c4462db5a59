"""Mechanisms in Drake: bodies on Drake's joints, and the forces in these joints.

Each joint is Drake's joint of the same type. The coordinates of a spherical joint are roll, pitch and yaw, whose rates are
infinite at a pitch of a right angle. A body without a joint and a body on a free joint have Drake's quaternion joint. Springs
are Drake's force elements. Armature is the inertia of the rotor of an actuator with a gear ratio of 1, and efforts are inputs
of such an actuator. Loops are Drake's ball constraints, a joint that follows another one has Drake's coupler constraint, and
stops are Drake's limits of coordinates. Only the discrete plant has all of these; `cenic` has couplers and limits, and other
integrators have none of them. Drake has no dry friction.
"""

from collections.abc import Callable, Collection
from dataclasses import replace
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
from bodycheck.adapters.drake.driving import Actuated, Inputs, follows
from bodycheck.adapters.drake.models import CENIC, PLANT, Model, add_link, configured, controlled, integrated, stepper
from bodycheck.adapters.links import Link
from bodycheck.adapters.mechanisms import (
    bounds,
    centred,
    check_rebounds,
    frames,
    in_body_axes,
    link_of,
    massless_parts,
    starts,
    stops_of,
)
from bodycheck.adapters.stepping import Loop, Taking, TakingControl, TakingLaws
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
        "controllers",
        "rigid stops",
    }
)

#: The approximations of contact of the discrete plant whose solver is SAP, the only one with constraints for loops.
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
    if method.accuracy is not None and not mechanism.driven:
        return controlled(lambda: built(mechanism, method, approximations)[:2], method, lambda seen: rows(mechanism, seen))
    return stepped(mechanism, method, *built(mechanism, method, approximations))


def stepped(mechanism: Mechanism, method: Method, model: Model, seen: Callable[[], Array], joints: Actuated) -> Simulation:
    """Return the simulation of a mechanism that steps one model, from all that `built` returns."""

    def in_bodies(numbers: Array) -> Array:
        return rows(mechanism, numbers)

    if method.accuracy is not None:
        # Efforts change, and sensors are read, at the ends of steps of the one model, so that its steps end at samples too.
        simulation = replace(controlled(lambda: (model, seen), method, in_bodies), between=None)
        return TakingControl(simulation, joints.state, joints.apply) if mechanism.driven else simulation
    loop = Loop(0, stepper(model, method.timestep), lambda _: seen(), in_bodies)
    if not mechanism.driven:
        return loop
    if not follows(mechanism, method):
        return Taking(loop, joints.state, joints.apply)
    return TakingLaws(loop, joints.state, joints.apply, joints.obey)


def check(mechanism: Mechanism, method: Method, approximations: tuple[str, ...]) -> None:
    """Raise `SceneUnsupported` for what Drake lacks with a method: constraints, limits, and bodies without mass."""
    if mechanism.loops and method.integrator not in CONSTRAINED:
        raise SceneUnsupported("Drake has constraints for loops in its discrete plant with the solver SAP only")
    if any(joint.mimic for joint in mechanism.joints) and method.integrator not in (*CONSTRAINED, CENIC):
        raise SceneUnsupported(
            "Drake has couplers for mimic joints in cenic and in its discrete plant with the solver SAP only"
        )
    if method.integrator == CENIC and (part := next(massless_parts(mechanism), None)) is not None:
        raise SceneUnsupported(f"cenic refuses the body {mechanism.bodies[part[0]].name}: composite for body has zero mass")
    if any(stops_of(joint, method) for joint in mechanism.joints) and method.integrator not in (*approximations, CENIC):
        raise SceneUnsupported("Drake has limits of joints in cenic and in its discrete plant only")
    check_rebounds(mechanism, "Drake")


def built(
    mechanism: Mechanism, method: Method, approximations: tuple[str, ...], actuated: Collection[int] = ()
) -> tuple[Model, Callable[[], Array], Actuated]:
    """Return the model of a mechanism, the function that `seer` returns, and the driven joints.

    actuated: the indices of joints that have an actuator in any case, so that its effort can be read.

    Raises `SceneUnsupported` as `prepare` does.
    """
    check(mechanism, method, approximations)
    constrained = bool(mechanism.loops) or any(joint.mimic for joint in mechanism.joints)
    config = configured(method, approximations)
    builder = DiagramBuilder()
    with_law = follows(mechanism, method)
    in_diagram = method.integrator == CENIC or constrained or with_law
    if in_diagram:
        plant, _ = AddMultibodyPlant(config, builder)
    else:
        plant = MultibodyPlant(config.time_step)
        ApplyMultibodyPlantConfig(config, plant)
    plant.set_name(PLANT)
    bodies = [add_link(plant, body_name(index), link_of(body)) for index, body in enumerate(mechanism.bodies)]
    joints = [add_joint(plant, bodies, joint, joint_name(index), method) for index, joint in enumerate(mechanism.joints)]
    forced = {*mechanism.driven, *actuated}
    moved = [n for n, joint in enumerate(mechanism.joints) if joint.armature or joint.effort or n in forced]
    for number in moved:
        actuator = plant.AddJointActuator(joint_name(number), joints[number])
        actuator.set_default_rotor_inertia(mechanism.joints[number].armature)
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
    law = None
    if with_law:
        law = builder.AddSystem(Inputs(plant.num_multibody_states(), plant.num_actuators()))
        builder.Connect(plant.get_state_output_port(), law.state)
        builder.Connect(law.get_output_port(), plant.get_actuation_input_port())
    simulator = Simulator(builder.Build() if in_diagram else plant)
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    port = (plant.get_actuation_input_port(), context)
    if law is not None:
        port = (law.held, law.GetMyMutableContextFromRoot(simulator.get_mutable_context()))
    of_driven = [joints[number] for number in mechanism.driven]
    constant = np.array([mechanism.joints[number].effort for number in moved])
    driven = Actuated(plant, context, port, constant, of_driven, [moved.index(number) for number in mechanism.driven])
    if moved:
        driven.apply(np.zeros(len(of_driven)))
    if law is not None:
        law.joints = driven
    start(mechanism, plant, context, bodies, joints)
    integrated(simulator, method, continuous=method.integrator not in approximations)
    model = Model(simulator, plant, context)
    return model, seer(model, bodies), driven


def body_name(index: int) -> str:
    """Return the name in a plant of a body of a mechanism."""
    return f"body {index}"


def joint_name(index: int) -> str:
    """Return the name in a plant of a joint of a mechanism, and of its actuator."""
    return f"joint {index}"


def add_joint(plant: Any, bodies: list[Any], joint: Joint, name: str, method: Method) -> Any:
    """Add a joint with its damping, its spring and its limits to a plant, and return it."""
    pose = RigidTransform(Quaternion(nearest_turn(joint.attitude)), joint.position)
    parent = plant.AddFrame(FixedOffsetFrame(name, _body(plant, bodies, joint.parent).body_frame(), pose))
    child = bodies[joint.child].body_frame()
    limits = bounds(stops_of(joint, method))
    if joint.type == "revolute":
        drake_joint = plant.AddJoint(RevoluteJoint(name, parent, child, nearest_axis(joint), *limits, joint.damping))
        if joint.stiffness:
            plant.AddForceElement(RevoluteSpring(drake_joint, joint.rest, joint.stiffness))
        return drake_joint
    if joint.type == "prismatic":
        drake_joint = plant.AddJoint(PrismaticJoint(name, parent, child, nearest_axis(joint), *limits, joint.damping))
        if joint.stiffness:
            plant.AddForceElement(PrismaticSpring(drake_joint, joint.rest, joint.stiffness))
        return drake_joint
    if joint.type == "fixed":
        return plant.AddJoint(WeldJoint(name, parent, child, RigidTransform()))
    if joint.type == "spherical":
        return plant.AddJoint(BallRpyJoint(name, parent, child, joint.damping))
    kinds = {"universal": UniversalJoint, "planar": PlanarJoint, "free": QuaternionFloatingJoint}
    return plant.AddJoint(kinds[joint.type](name, parent, child))


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
