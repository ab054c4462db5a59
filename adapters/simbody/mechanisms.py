"""Mechanisms in Simbody by OpenSim's joints and forces.

OpenSim's pin turns about the z axis of the joint's frame, and its slider slides along the x axis, so that the frames are
rotated to have the joint's axis there. Springs and damping are OpenSim's `SpringGeneralizedForce`, and a constant effort is an
`ExpressionBasedCoordinateForce`; see `driving` for efforts that change, and for stops. Loops are OpenSim's `PointConstraint`,
and a joint that follows another one has OpenSim's `CoordinateCouplerConstraint`. OpenSim has neither armature nor dry friction
of joints, and its bushings damp the rates of angles instead of the angular velocity of a ball joint. It refuses a chain of two
bodies without mass.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import opensim

from bodycheck.adapters.contract import Method, SceneUnsupported
from bodycheck.adapters.mechanisms import frames, from_x, from_z, link_of, starts
from bodycheck.adapters.simbody.attitude import angles, use_quaternions
from bodycheck.adapters.simbody.driving import add_actuator, add_stops
from bodycheck.adapters.simbody.models import added
from bodycheck.reference.kinematics import multiply, rotate
from bodycheck.reference.mechanisms import exact
from bodycheck.reference.mechanisms.joint_types import JointType
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Mechanism, Mimic
from bodycheck.reference.scene import Vector
from bodycheck.reference.trajectory import Array

#: The features of mechanisms that OpenSim models; see `Engine.models`.
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
        "joint efforts",
        "loops",
        "point masses",
        "massless bodies",
        "mimic joints",
        "controllers",
        "elastic stops",
    }
)

#: The identity quaternion (w, x, y, z).
NO_TURN = np.array([1.0, 0.0, 0.0, 0.0])

#: OpenSim's joint for each type of joint.
KINDS = {
    "revolute": opensim.PinJoint,
    "prismatic": opensim.SliderJoint,
    "spherical": opensim.BallJoint,
    "free": opensim.FreeJoint,
    "planar": opensim.PlanarJoint,
    "universal": opensim.UniversalJoint,
    "fixed": opensim.WeldJoint,
}


@dataclass(frozen=True, eq=False)
class Built:
    """OpenSim's model of a mechanism.

    Parameters
    ----------
    model
        The model.
    bodies
        The bodies, in the order of the mechanism.
    joints
        The joints of the bodies, in the same order.
    driven, actuators
        The coordinates of the driven joints, and their actuators.
    """

    model: Any
    bodies: Sequence[Any]
    joints: Sequence[Any]
    driven: Sequence[Any]
    actuators: Sequence[Any]


def built(mechanism: Mechanism, method: Method) -> Built:
    """Return OpenSim's model of a mechanism. Raises `SceneUnsupported`."""
    model = opensim.Model()
    model.setGravity(opensim.Vec3(0.0, 0.0, -mechanism.gravity))
    bodies = [added(model, f"body_{index}", link_of(body)) for index, body in enumerate(mechanism.bodies)]
    joints = []
    for index, joint in enumerate(mechanism.joint_of):
        if joint is None:
            engine_joint = opensim.FreeJoint(f"joint_{index}", model.getGround(), bodies[index])
        else:
            engine_joint = joint_of(joint, model.getGround() if joint.parent == WORLD else bodies[joint.parent], bodies[index])
        model.addJoint(engine_joint)
        joints.append(engine_joint)
        if joint is not None:
            add_forces(model, joint, engine_joint)
            add_stops(model, joint, engine_joint, method)
    for index, joint in enumerate(mechanism.joints):
        if joint.mimic is not None:
            coupled = joints[joint.child], joints[mechanism.joints[joint.mimic.joint].child]
            model.addConstraint(coupler(index, joint.mimic, *(each.get_coordinates(0).getName() for each in coupled)))
    for index, loop in enumerate(mechanism.loops):
        one, other = (model.getGround() if body == WORLD else bodies[body] for body in loop.bodies)
        here, there = (opensim.Vec3(*point) for point in loop.points)
        constraint = opensim.PointConstraint(one, here, other, there)
        constraint.setName(f"loop_{index}")
        model.addConstraint(constraint)
    coordinates = [joints[mechanism.joints[index].child].get_coordinates(0) for index in mechanism.driven]
    return Built(model, bodies, joints, coordinates, [add_actuator(model, each) for each in coordinates])


def joint_of(joint: Joint, parent: Any, child: Any) -> Any:
    """Return OpenSim's joint between two bodies. Raises `SceneUnsupported` for a ball joint with damping."""
    if joint.type == "spherical" and joint.damping:
        raise SceneUnsupported("OpenSim has no damping of a ball joint's angular velocity")
    turn = NO_TURN
    if joint.type in ("revolute", "prismatic"):
        to_axis = from_z if joint.type == "revolute" else from_x
        turn = to_axis(np.array(exact.nearest_axis(joint)))
    return KINDS[joint.type](
        f"joint_{joint.child}",
        parent,
        opensim.Vec3(*joint.position),
        oriented(multiply(np.array(exact.nearest_turn(joint.attitude)), turn)),
        child,
        opensim.Vec3(0.0),
        oriented(turn),
    )


def oriented(turn: Array) -> Any:
    """Return the orientation of a frame in OpenSim's form, from its quaternion (4,)."""
    w, x, y, z = turn.tolist()
    return opensim.Vec3(*angles((w, x, y, z)))


def add_forces(model: Any, joint: Joint, engine_joint: Any) -> None:
    """Add the forces in a joint to a model."""
    if joint.type not in ("revolute", "prismatic"):
        return
    name = engine_joint.get_coordinates(0).getName()
    if joint.stiffness or joint.damping:
        spring = opensim.SpringGeneralizedForce(name)
        spring.setName(f"spring_{joint.child}")
        spring.setStiffness(joint.stiffness)
        spring.setRestLength(joint.rest)
        spring.setViscosity(joint.damping)
        model.addForce(spring)
    if joint.effort:
        effort = opensim.ExpressionBasedCoordinateForce(name, repr(joint.effort))
        effort.setName(f"effort_{joint.child}")
        model.addForce(effort)


def coupler(number: int, rule: Mimic, follower: str, leader: str) -> Any:
    """Return OpenSim's constraint by which a coordinate follows another one, from the names of the two."""
    constraint, leaders = opensim.CoordinateCouplerConstraint(), opensim.ArrayStr()
    leaders.append(leader)
    constraint.setName(f"mimic_{number}")
    constraint.setIndependentCoordinateNames(leaders)
    constraint.setDependentCoordinateName(follower)
    constraint.setFunction(opensim.LinearFunction(rule.multiplier, rule.offset))
    return constraint


def started(mechanism: Mechanism, built_mechanism: Built, quaternions: bool) -> Any:
    """Return the initial state of a model of a mechanism, with quaternions or with angles.

    Raises `SceneUnsupported` if OpenSim refuses the model, as it does where two bodies without mass follow each other.
    """
    try:
        state = built_mechanism.model.initSystem()
    except RuntimeError as error:
        reason = " ".join(str(error).split()).rpartition("initSystem()")[2].lstrip("': ")
        for index, body in reversed(list(enumerate(mechanism.bodies))):
            reason = reason.replace(f"/bodyset/body_{index}", body.name)
        raise SceneUnsupported(f"OpenSim refuses the mechanism: {reason}") from error
    starting = dict(zip((joint.child for joint in mechanism.joints), starts(mechanism), strict=True))
    first, values = frames(mechanism), []
    for index, joint in enumerate(mechanism.joint_of):
        if joint is None:
            frame = first[index]
            position = np.array([*frame.position, *frame.quaternion])
            velocity = np.array([*frame.velocity, *frame.angular_velocity])
            values.append(in_simbody("free", position, velocity, quaternions))
        else:
            values.append(in_simbody(joint.type, *starting[index], quaternions))
    return placed(built_mechanism.model, state, built_mechanism.joints, values, quaternions)


def placed(model: Any, state: Any, joints: Sequence[Any], values: Sequence[tuple[Array, Array]], quaternions: bool) -> Any:
    """Return a state of a model in which joints have values: Simbody's coordinates and velocities of each."""
    places = [coordinates_of(state, joint) for joint in joints]
    if quaternions:
        use_quaternions(model, state)
    q, u = state.updQ(), state.updU()
    for addresses, (positions, velocities) in zip(places, values, strict=True):
        if addresses is not None:
            at, by = addresses
            for number, value in enumerate(positions):
                q.set(at + number, value)
            for number, value in enumerate(velocities):
                u.set(by + number, value)
    return state


def coordinates_of(state: Any, joint: Any) -> tuple[int, int] | None:
    """Return the indices of a joint's first coordinate and first velocity in a state; None for a joint without coordinates.

    OpenSim does not report these indices, but setting a value shows its place. They are the same with quaternions as with
    angles.
    """
    if not joint.numCoordinates():
        return None
    first = joint.get_coordinates(0)
    before = state.getQ().to_numpy().copy(), state.getU().to_numpy().copy()
    first.setValue(state, 0.1, False)
    first.setSpeedValue(state, 0.1)
    after = state.getQ().to_numpy().copy(), state.getU().to_numpy().copy()
    first.setValue(state, 0.0, False)
    first.setSpeedValue(state, 0.0)
    at, by = (int(np.flatnonzero(one != other)[0]) for one, other in zip(before, after, strict=True))
    return at, by


def in_simbody(type: JointType, position: Array, velocity: Array, quaternions: bool) -> tuple[Array, Array]:
    """Return Simbody's coordinates and velocities of a joint; angular velocities are along the axes of the joint's frame."""
    if type == "planar":
        return np.roll(position, 1), np.roll(velocity, 1)
    if type in ("spherical", "free"):
        origin, turn = np.split(position, [len(position) - 4])
        speed, spin = np.split(velocity, [len(velocity) - 3])
        w, x, y, z = turn.tolist()
        turned = turn if quaternions else np.array(angles((w, x, y, z)))
        return np.concatenate([turned, origin]), np.concatenate([rotate(turn, spin), speed])
    return position, velocity


def seer(mechanism: Mechanism, built_mechanism: Built) -> Callable[[Any], Array]:
    """Return a function that returns the states (13 k,) of k bodies from a state, with vectors along the axes of the world."""
    centres = [exact.nearest_inertia(body).centre for body in mechanism.bodies]
    return seer_of(built_mechanism.model, built_mechanism.bodies, centres)


def seer_of(model: Any, bodies: Sequence[Any], centres: Sequence[Vector]) -> Callable[[Any], Array]:
    """Return the function of `seer`, from bodies of a model and their centres of mass."""
    stations = [opensim.Vec3(*centre) for centre in centres]

    def seen(state: Any) -> Array:
        model.realizeVelocity(state)
        parts = []
        for body, centre in zip(bodies, stations, strict=True):
            turn = body.getTransformInGround(state).R().convertRotationToQuaternion()
            parts += [
                body.findStationLocationInGround(state, centre).to_numpy(),
                [turn.get(part) for part in range(4)],
                body.findStationVelocityInGround(state, centre).to_numpy(),
                body.getAngularVelocityInGround(state).to_numpy(),
            ]
        return np.concatenate(parts)

    return seen
