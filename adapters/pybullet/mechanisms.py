"""Mechanisms in PyBullet: trees in reduced coordinates, and the forces in their joints.

Each tree is a body of PyBullet, read from a URDF file: the tree on the world has a fixed base, and every free body is the base
of another tree. Joints are Bullet's revolute, prismatic, spherical and fixed joints. Damping is given in the URDF file.
PyBullet has no armature and no springs: the force of a spring is computed from the coordinate at the start of a step and
applied together with the efforts in each step, as users do. Dry friction is PyBullet's velocity motor with the target zero and
a limited force. Loops are constraints between points. A joint that follows another one has Bullet's gear constraint, which
holds its velocity: the offset of the rule is in the initial coordinates. Stops are the limits of the URDF file, where an
impulse takes the velocity away; in the next step Bullet pushes out a fifth of the penetration, and with it gives back up to a
fifth of the velocity.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pybullet

from bodycheck.adapters.contract import Method, SceneUnsupported
from bodycheck.adapters.links import angles, file_of, link_element, spaced
from bodycheck.adapters.mechanisms import bounds, check_rebounds, has_mass, link_of, starts, stops_of, trees
from bodycheck.adapters.pybullet.links import BASE
from bodycheck.reference.kinematics import conjugate, multiply, rotate
from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.mechanisms.exact import nearest_axis, nearest_inertia, nearest_turn
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Loop, Mechanism
from bodycheck.reference.trajectory import Array

#: The features of mechanisms that PyBullet models; see `Engine.models`.
MODELS = frozenset(
    {
        "mechanisms",
        "revolute joints",
        "prismatic joints",
        "ball joints",
        "fixed joints",
        "joint damping",
        "joint springs",
        "joint friction",
        "joint efforts",
        "loops",
        "point masses",
        "massless bodies",
        "mimic joints",
        "controllers",
        "rigid stops",
    }
)


#: A force (N or N m) that no gear constraint and no limit of a joint needs.
UNLIMITED = 1e20

#: A coordinate (rad or m) that no joint reaches, for the side on which a joint has no stop.
FAR = 1e9


#: The collision elements of bodies that touch nothing.
NO_COLLISIONS: Mapping[int, str] = {}


@dataclass(frozen=True)
class Part:
    """A body of a mechanism in PyBullet.

    Parameters
    ----------
    tree, link
        The number of PyBullet's body for the tree, and the number of the link in it.
    axes
        The quaternion w x y z (4,) from Bullet's frame of the link, which is along its principal axes, to the body's frame.
    """

    tree: int
    link: int
    axes: Array


def built(client: int, mechanism: Mechanism, method: Method, collisions: Mapping[int, str] = NO_COLLISIONS) -> list[Part]:
    """Add a mechanism in its initial state to a physics server, and return its bodies in their order.

    collisions: the collision elements of the URDF file, by the index of the body.

    Raises `SceneUnsupported` for a free body without mass, and for stops with a rebound.
    """
    check_rebounds(mechanism, "PyBullet")
    for root in mechanism.bodies:
        if root.start is not None and not has_mass(root):
            raise SceneUnsupported(f"the free body {root.name} without mass, which PyBullet would hold in place")
    by_index: dict[int, Part] = {}
    for tree in trees(mechanism):
        body = loaded(client, document(mechanism, tree, method, collisions), tree[0] == WORLD)
        pybullet.changeDynamics(body, BASE, physicsClientId=client, **switched_off(method))
        numbers = {f"body_{tree[0]}": BASE}
        for link in range(pybullet.getNumJoints(body, physicsClientId=client)):
            numbers[pybullet.getJointInfo(body, link, physicsClientId=client)[12].decode()] = link
        for index in tree:
            if index != WORLD:
                link = numbers[f"body_{index}"]
                x, y, z, w = pybullet.getDynamicsInfo(body, link, physicsClientId=client)[4]
                by_index[index] = Part(body, link, np.array([w, x, y, z]))
    parts = [by_index[index] for index in range(len(mechanism.bodies))]
    start(client, mechanism, parts)
    for joint in mechanism.joints:
        if stops_of(joint, method) is not None:
            part = parts[joint.child]
            pybullet.changeDynamics(part.tree, part.link, jointLimitForce=UNLIMITED, physicsClientId=client)
    for loop in mechanism.loops:
        close(client, mechanism, parts, loop)
    for joint in mechanism.joints:
        if joint.mimic is not None:
            couple(client, parts[joint.child], parts[mechanism.joints[joint.mimic.joint].child], joint.mimic.multiplier)
    return parts


def couple(client: int, follower: Part, leader: Part, multiplier: float) -> None:
    """Add a constraint by which a joint follows another one: the sum of its velocity and gear ratio * the other's is zero."""
    ends = follower.tree, follower.link, leader.tree, leader.link
    unused = (0, 1, 0), (0, 0, 0), (0, 0, 0)  # the axis and the points that only other constraints have
    gear = pybullet.createConstraint(*ends, pybullet.JOINT_GEAR, *unused, physicsClientId=client)
    pybullet.changeConstraint(gear, gearRatio=-multiplier, maxForce=UNLIMITED, physicsClientId=client)


def loaded(client: int, text: str, fixed: bool) -> int:
    """Load the text of a URDF file, with a base that is fixed or free, and return the number of PyBullet's body."""
    with file_of(text) as file:
        flags = pybullet.URDF_USE_INERTIA_FROM_FILE  # without it, PyBullet computes inertia from the shapes
        return int(pybullet.loadURDF(file, useFixedBase=fixed, flags=flags, physicsClientId=client))


def start(client: int, mechanism: Mechanism, parts: Sequence[Part]) -> None:
    """Set the initial state of a mechanism, and replace PyBullet's motors, which brake each joint, by its dry friction."""
    first = kinematics.initial(mechanism)
    for index, joint in enumerate(mechanism.joint_of):
        if joint is None:
            part = parts[index]
            w, x, y, z = multiply(first.quaternion[index, 0], part.axes).tolist()
            position = first.position[index, 0].tolist()
            pybullet.resetBasePositionAndOrientation(part.tree, position, (x, y, z, w), physicsClientId=client)
            spin = rotate(first.quaternion[index, 0], first.angular_velocity[index, 0]).tolist()
            velocity = first.velocity[index, 0].tolist()
            pybullet.resetBaseVelocity(part.tree, velocity, spin, physicsClientId=client)
    for joint, (position, velocity) in zip(mechanism.joints, starts(mechanism), strict=True):
        part = parts[joint.child]
        if joint.type == "spherical":
            start_ball(client, part, position, velocity)
        elif joint.type != "fixed":
            pybullet.resetJointState(part.tree, part.link, position[0], velocity[0], physicsClientId=client)
            pybullet.setJointMotorControl2(
                part.tree,
                part.link,
                pybullet.VELOCITY_CONTROL,
                targetVelocity=0.0,
                force=joint.friction,
                physicsClientId=client,
            )


def start_ball(client: int, part: Part, position: Array, velocity: Array) -> None:
    """Set the state of a spherical joint, whose coordinates are along its child's principal axes, and switch off its motor."""
    back = conjugate(part.axes)
    w, x, y, z = multiply(multiply(back, position), part.axes).tolist()
    spin = rotate(back, velocity).tolist()
    pybullet.resetJointStateMultiDof(part.tree, part.link, [x, y, z, w], spin, physicsClientId=client)
    pybullet.setJointMotorControlMultiDof(
        part.tree,
        part.link,
        pybullet.POSITION_CONTROL,
        targetPosition=[0.0, 0.0, 0.0, 1.0],
        positionGain=0.0,
        velocityGain=0.0,
        force=[0.0, 0.0, 0.0],
        physicsClientId=client,
    )


def close(client: int, mechanism: Mechanism, parts: Sequence[Part], loop: Loop) -> None:
    """Add a loop as a constraint between two points, each in Bullet's frame of its body."""
    (body, other_body), (point, other_point) = loop.bodies, loop.points
    if body == WORLD:
        body, other_body, point, other_point = other_body, body, other_point, point
    first = parts[body]
    tree, link, second = -1, -1, np.array(other_point)
    if other_body != WORLD:
        tree, link, second = (
            parts[other_body].tree,
            parts[other_body].link,
            in_principal_frame(mechanism, parts, other_body, other_point),
        )
    pybullet.createConstraint(
        first.tree,
        first.link,
        tree,
        link,
        pybullet.JOINT_POINT2POINT,
        (0, 0, 0),
        in_principal_frame(mechanism, parts, body, point).tolist(),
        second.tolist(),
        physicsClientId=client,
    )


def in_principal_frame(mechanism: Mechanism, parts: Sequence[Part], index: int, point: Sequence[float]) -> Array:
    """Return a point (3,) of a body in Bullet's frame, which is at the centre of mass and along the principal axes."""
    return rotate(conjugate(parts[index].axes), np.array(point) - np.array(nearest_inertia(mechanism.bodies[index]).centre))


@dataclass
class Pushed:
    """The joints in which a force must be applied in each step: joints with springs or efforts, and driven joints.

    Parameters
    ----------
    client
        The number of the connection to the server.
    mechanism, parts
        The mechanism and its bodies.
    """

    client: int
    mechanism: Mechanism
    parts: Sequence[Part]

    def __post_init__(self) -> None:
        self.driven = self.mechanism.driven
        self.efforts = {index: joint.effort for index, joint in enumerate(self.mechanism.joints) if self._acts(index, joint)}

    def _acts(self, index: int, joint: Joint) -> bool:
        return bool(joint.stiffness or joint.effort or index in self.driven)

    def push(self) -> None:
        """Apply the forces of springs at the current coordinates, and the efforts, for the next step."""
        for index, force in self.efforts.items():
            joint, part = self.mechanism.joints[index], self.parts[self.mechanism.joints[index].child]
            if joint.stiffness:
                force -= joint.stiffness * (self._state(index)[0] - joint.rest)
            pybullet.setJointMotorControl2(
                part.tree, part.link, pybullet.TORQUE_CONTROL, force=force, physicsClientId=self.client
            )

    def state(self) -> tuple[Array, Array]:
        """Return the coordinates and velocities (j,) of the driven joints."""
        position, velocity = np.array([self._state(index)[:2] for index in self.driven]).T
        return position, velocity

    def apply(self, efforts: Array) -> None:
        """Exert efforts (j,) on the driven joints from now on, in addition to the constant ones."""
        for index, effort in zip(self.driven, efforts.tolist(), strict=True):
            self.efforts[index] = self.mechanism.joints[index].effort + effort

    def _state(self, index: int) -> tuple[float, ...]:
        part = self.parts[self.mechanism.joints[index].child]
        return tuple(pybullet.getJointState(part.tree, part.link, physicsClientId=self.client)[:2])


def seen(client: int, parts: Sequence[Part]) -> Array:
    """Return the states (13 k,) of k bodies in the columns of the contract, but with vectors along the axes of the world."""
    rows = []
    for part in parts:
        if part.link == BASE:
            position, (x, y, z, w) = pybullet.getBasePositionAndOrientation(part.tree, physicsClientId=client)
            velocity, spin = pybullet.getBaseVelocity(part.tree, physicsClientId=client)
        else:
            state = pybullet.getLinkState(part.tree, part.link, 1, 1, physicsClientId=client)
            position, (x, y, z, w), velocity, spin = state[0], state[1], state[6], state[7]
        turn = multiply(np.array([w, x, y, z]), conjugate(part.axes))
        rows += [*position, *turn, *velocity, *spin]
    return np.array(rows)


def switched_off(method: Method) -> dict[str, float]:
    """Return the arguments of `changeDynamics` that switch off damping and limits, unless a method keeps them."""
    if method.option("settings") == "engine":
        return {}
    return {"linearDamping": 0.0, "angularDamping": 0.0, "maxJointVelocity": math.inf}


#: PyBullet's names of the types of joints without limits, which for a slide are a lower limit above the upper limit.
TYPES = {"revolute": "continuous", "prismatic": "prismatic", "spherical": "spherical", "fixed": "fixed"}

#: The limits of a joint without limits.
NO_LIMITS = (0.0, -1.0)

#: The base of a tree that is fixed to the world.
FIXED_BASE = (
    '<link name="world"><inertial><mass value="0"/><inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0"/></inertial></link>'
)


def document(mechanism: Mechanism, tree: Sequence[int], method: Method, collisions: Mapping[int, str]) -> str:
    """Return the URDF file of a tree. Bodies and joints have the names body_k and joint_k, where k is the index of the body."""

    def link(index: int) -> str:
        bare = link_element(f"body_{index}", link_of(mechanism.bodies[index]))
        return bare.replace("</link>", collisions.get(index, "") + "</link>")

    root, *others = tree
    parts = [FIXED_BASE if root == WORLD else link(root)]
    for index in others:
        joint = mechanism.joint_of[index]
        assert joint is not None  # only roots have none
        parts += [link(index), joint_element(joint, method)]
    return "\n".join(['<?xml version="1.0"?>', '<robot name="mechanism">', *parts, "</robot>", ""])


def joint_element(joint: Joint, method: Method) -> str:
    """Return the element of a joint with its damping and its limits."""
    stops = stops_of(joint, method)
    kind = TYPES[joint.type] if stops is None else joint.type
    lower, upper = NO_LIMITS if stops is None else bounds(stops, FAR)
    parent = "world" if joint.parent == WORLD else f"body_{joint.parent}"
    return (
        f'<joint name="joint_{joint.child}" type="{kind}">'
        f'<parent link="{parent}"/><child link="body_{joint.child}"/>'
        f'<origin xyz="{spaced(joint.position)}" rpy="{spaced(angles(nearest_turn(joint.attitude)))}"/>'
        f'<axis xyz="{spaced(nearest_axis(joint))}"/>'
        f'<limit lower="{spaced([lower])}" upper="{spaced([upper])}" effort="0" velocity="0"/>'
        f'<dynamics damping="{spaced([joint.damping])}" friction="0"/></joint>'
    )
