"""Build the model of a mechanism in Pinocchio, with its initial state.

A body is on one joint of Pinocchio, or on a chain of several joints, of which only the first is displaced in its parent. As for
a body in flight, the joints depend on whether a scheme integrates the body twist or velocities along the axes of the joint's
frame:

- revolute, prismatic: the joint along x, y or z, or the unaligned one.
- spherical: `JointModelSpherical`, whose velocity is the angular velocity in the child's frame.
- free, and a body that is the child of no joint: `JointModelFreeFlyer`, or a translation joint and a spherical one.
- planar: `JointModelPlanar`, or two prismatic joints and a revolute one.
- universal: `JointModelUniversal`, or two revolute joints in a release without it.
- fixed: none. The inertia is added to the inertia of the parent's joint, as Pinocchio's readers of files do.
- a joint that follows another one: `JointModelMimic`, which has no coordinate of its own, and may follow only a joint that was
  added before it. The first of the joints that move together keeps its coordinate, and the others follow it, so that their
  rules may be reversed.

Joints are added depth first, as Pinocchio's documentation requires: `aba` accepts any order, but `constraintDynamics` and
other algorithms return wrong numbers if the joints of a branch do not follow one another, and `model.check(data)` is then
False. Pinocchio's quaternions are x, y, z, w.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from bodycheck.adapters.contract import SceneUnsupported
from bodycheck.adapters.mechanism_models import hinge_motion
from bodycheck.adapters.mechanisms import frames, starts
from bodycheck.adapters.pinocchio.joints import UNIVERSE, to_pinocchio, world
from bodycheck.reference.kinematics import conjugate, rotate
from bodycheck.reference.mechanisms import exact, mimicry
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, JointedBody, Mechanism, depth_first
from bodycheck.reference.scene import Quaternion, State, Vector
from bodycheck.reference.trajectory import Array

#: A joint of Pinocchio: the name of its class after `JointModel`, and the arguments of its constructor.
Kind = tuple[str, tuple[float, ...]]

#: The three hinges that replace a ball.
THREE_HINGES: list[Kind] = [("RX", ()), ("RY", ()), ("RZ", ())]

#: Whether the installed release has a universal joint.
HAS_UNIVERSAL = hasattr(pin, "JointModelUniversal")

#: The joints along the axes of a frame, keyed by the axis.
ALIGNED = {
    "revolute": {(1.0, 0.0, 0.0): "RX", (0.0, 1.0, 0.0): "RY", (0.0, 0.0, 1.0): "RZ"},
    "prismatic": {(1.0, 0.0, 0.0): "PX", (0.0, 1.0, 0.0): "PY", (0.0, 0.0, 1.0): "PZ"},
}

#: The joints of other types, keyed by whether the scheme integrates the body twist.
KINDS = {
    ("spherical", False): ("Spherical",),
    ("spherical", True): ("Spherical",),
    ("free", False): ("Translation", "Spherical"),
    ("free", True): ("FreeFlyer",),
    ("planar", False): ("PX", "PY", "RZ"),
    ("planar", True): ("Planar",),
}


@dataclass(frozen=True)
class Follower:
    """A joint whose coordinate is ratio * (coordinate of another joint) + offset.

    Parameters
    ----------
    joint, leader
        The indices of the two joints in the model. The leader comes first, and follows no joint.
    of_mechanism
        The index of the joint in the mechanism.
    ratio, offset
        The numbers of the rule.
    """

    joint: int
    leader: int
    of_mechanism: int
    ratio: float
    offset: float


@dataclass(frozen=True, eq=False)
class Built:
    """A mechanism in Pinocchio.

    Parameters
    ----------
    model
        The model.
    q, v
        The initial configuration (nq,) and velocity (nv,).
    places
        For each body, the index of the joint that moves it, and the frame of the body in the frame of this joint.
    first
        For each joint of the mechanism, its first index in q and its first index in v; for a joint that follows another one,
        those of the other.
    kinds
        The joints of the model, without the one that does not move.
    followers
        The joints that follow others, in the order of the model.
    """

    model: pin.Model
    q: Array
    v: Array
    places: tuple[tuple[int, pin.SE3], ...]
    first: tuple[tuple[int, int], ...]
    kinds: tuple[Kind, ...]
    followers: tuple[Follower, ...]


def built(mechanism: Mechanism, body_twist: bool, hinges: bool = False) -> Built:
    """Return a mechanism on the joints of a scheme. Raises `SceneUnsupported` for what a release of Pinocchio does not have.

    `body_twist` is whether the scheme integrates the body twist, and `hinges` whether three hinges model a ball joint.
    """
    model = world(mechanism.gravity)
    places = {WORLD: (UNIVERSE, pin.SE3.Identity())}
    q, v, kinds = list[float](), list[float](), list[Kind]()
    coordinates, origins, first = starts(mechanism), frames(mechanism), dict[Joint, tuple[int, int]]()
    numbers = dict[Joint, int]()
    for index in depth_first(mechanism):
        body, joint = mechanism.bodies[index], mechanism.joint_of[index]
        parent, frame = places[WORLD if joint is None else joint.parent]
        if joint is not None:
            frame = frame * placement(joint.position, exact.nearest_turn(joint.attitude))
            first[joint], numbers[joint] = (len(q), len(v)), model.njoints
        for kind in THREE_HINGES if hinges and is_ball(joint) else joints_of(joint, body_twist):
            joint_model = getattr(pin, f"JointModel{kind[0]}")(*kind[1])
            parent, frame = model.addJoint(parent, joint_model, frame, f"{body.name} {model.njoints}"), pin.SE3.Identity()
            kinds.append(kind)
        if joint is None:
            position, velocity = free_start(origins[index], body_twist)
        else:
            parts = coordinates[mechanism.joints.index(joint)]
            if hinges and is_ball(joint):
                position, velocity = (part.tolist() for part in hinge_motion(*parts))
            else:
                position, velocity = joint_start(joint, *parts, body_twist)
        q += position
        v += velocity
        model.appendBodyToJoint(parent, inertia_of(body), frame)
        places[index] = parent, frame
    followers = followers_of(mechanism, numbers)
    for follower in followers:
        model = pin.transformJointIntoMimic(model, follower.leader, follower.joint, follower.ratio, follower.offset)
    if followers:
        held = [first[mechanism.joints[follower.of_mechanism]] for follower in followers]
        q, v = np.delete(q, [in_q for in_q, _ in held]).tolist(), np.delete(v, [in_v for _, in_v in held]).tolist()
        moving = (joint for joint in mechanism.joints if joint.type != "fixed")
        first |= {joint: (model.joints[numbers[joint]].idx_q, model.joints[numbers[joint]].idx_v) for joint in moving}
    ratios = {follower.of_mechanism: follower.ratio for follower in followers}
    armatures = [
        (first[joint][1], ratios.get(index, 1.0) ** 2 * joint.armature)
        for index, joint in enumerate(mechanism.joints)
        if joint.armature
    ]
    add_armature(model, armatures)
    of_bodies = tuple(places[index] for index in range(len(mechanism.bodies)))
    of_joints = tuple(first[joint] for joint in mechanism.joints)
    return Built(model, np.array(q), np.array(v), of_bodies, of_joints, tuple(kinds), followers)


def followers_of(mechanism: Mechanism, numbers: Mapping[Joint, int]) -> tuple[Follower, ...]:
    """Return the joints that follow others in a model, in its order. numbers: the indices of the joints in the model.

    Raises `SceneUnsupported` for a release without mimic joints, and for a joint with the multiplier zero that comes before the
    joint that it follows.
    """
    together: dict[int, list[int]] = {}
    rules = {index: mimicry.rule(mechanism.joints, index) for index in range(len(mechanism.joints))}
    for index, rule in rules.items():
        together.setdefault(rule.leader, []).append(index)
    followers = []
    for group in together.values():
        group.sort(key=lambda index: numbers[mechanism.joints[index]])
        first = next(index for index in group if rules[index].multiplier)
        leading = rules[first]
        for index in group:
            joint, ratio = mechanism.joints[index], rules[index].multiplier / leading.multiplier
            if index == first:
                continue
            if numbers[joint] < numbers[mechanism.joints[first]]:
                raise SceneUnsupported(
                    f"the mimic joint {joint.name}, whose multiplier is zero, before the joint that it follows"
                )
            offset = rules[index].offset - ratio * leading.offset
            pair = numbers[joint], numbers[mechanism.joints[first]]
            followers.append(Follower(*pair, index, float(ratio), float(offset)))
    if followers and not hasattr(pin, "transformJointIntoMimic"):
        raise SceneUnsupported(f"mimic joints: Pinocchio {pin.__version__} has none")
    return tuple(sorted(followers, key=lambda follower: follower.joint))


def add_armature(model: pin.Model, armatures: Sequence[tuple[int, float]]) -> None:
    """Set the armature of a model.

    `armatures` are pairs of an index of v and the inertia for this velocity, in kg m^2 or, for a slide, in kg. Raises
    `SceneUnsupported` if the release of Pinocchio has no armature.
    """
    if not armatures:
        return
    if not hasattr(model, "armature"):
        raise SceneUnsupported(f"armature: Pinocchio {pin.__version__} has no `model.armature`")
    armature = np.zeros(model.nv)
    for index, value in armatures:
        armature[index] += value
    model.armature = armature


def is_ball(joint: Joint | None) -> bool:
    """Return whether a joint is a ball."""
    return joint is not None and joint.type == "spherical"


def joints_of(joint: Joint | None, body_twist: bool) -> list[Kind]:
    """Return the kinds of Pinocchio's joints that make up a joint. If `joint` is None, the body is free."""
    if joint is not None and joint.type in ALIGNED:
        axis = exact.nearest_axis(joint)
        if (aligned := ALIGNED[joint.type].get(axis)) is not None:
            return [(aligned, ())]
        return [("RevoluteUnaligned" if joint.type == "revolute" else "PrismaticUnaligned", axis)]
    if joint is not None and joint.type == "universal":
        return [("Universal", (1.0, 0.0, 0.0, 0.0, 1.0, 0.0))] if HAS_UNIVERSAL else [("RX", ()), ("RY", ())]
    if joint is not None and joint.type == "fixed":
        return []
    return [(name, ()) for name in KINDS["free" if joint is None else joint.type, body_twist]]


def placement(position: Vector, quaternion: Quaternion) -> pin.SE3:
    """Return Pinocchio's placement from a position (m) and a unit quaternion (w, x, y, z)."""
    return pin.SE3(to_pinocchio(quaternion).matrix(), np.array(position))


def inertia_of(body: JointedBody) -> pin.Inertia:
    """Return Pinocchio's inertia of a body in the frame of the body."""
    mass_properties = exact.nearest_inertia(body)
    xx, yy, zz, xy, xz, yz = mass_properties.tensor
    return pin.Inertia(
        mass_properties.mass, np.array(mass_properties.centre), np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    )


def free_start(start: State, body_twist: bool) -> tuple[list[float], list[float]]:
    """Return q (7,) and v (6,) of a free joint from the state of the child's frame in the joint's frame."""
    w, *xyz = start.quaternion
    linear = np.array(start.velocity)
    if body_twist:
        linear = rotate(conjugate(np.array(start.quaternion)), linear)
    return [*start.position, *xyz, w], [*linear.tolist(), *start.angular_velocity]


def joint_start(joint: Joint, position: Array, velocity: Array, body_twist: bool) -> tuple[list[float], list[float]]:
    """Return the initial q and v of a joint from its coordinates and velocities."""
    match joint.type:
        case "spherical":
            w, *xyz = position.tolist()
            return [*xyz, w], velocity.tolist()
        case "free":
            parts = (position[:3], position[3:], velocity[:3], velocity[3:])
            return free_start(State(*(tuple(part.tolist()) for part in parts)), body_twist)
        case "planar" if body_twist:
            (x, y, angle), (vx, vy, rate) = position.tolist(), velocity.tolist()
            cosine, sine = math.cos(angle), math.sin(angle)
            return [x, y, cosine, sine], [cosine * vx + sine * vy, cosine * vy - sine * vx, rate]
        case _:
            return position.tolist(), velocity.tolist()
