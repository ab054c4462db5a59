"""Mechanisms in SAPIEN: articulations of PhysX, in the coordinates of their joints.

Each tree is an articulation: the tree on the world has a fixed root, and every free body is the root of another articulation.
Joints turn about, or slide along, the x axis of the joint's frame, so that frames are rotated to have the joint's axis along x.
Damping and springs are PhysX's drive with the target `rest`, armature is a property of the joint, and an effort is set as the
force of the coordinate. Stops are the limits of the joint, which have no rebound. PhysX's joint friction is a coefficient of
the force in the joint, not a constant force, so that dry friction is not modelled.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from sapien import Pose

from bodycheck.adapters.contract import Method
from bodycheck.adapters.links import Link, tensor
from bodycheck.adapters.mechanisms import bounds, check_rebounds, frames, from_x, link_of, starts, stops_of, trees
from bodycheck.adapters.sapien.links import NO_LIMIT, place, switch_off
from bodycheck.reference.kinematics import multiply, rotate
from bodycheck.reference.mechanisms import exact, kinematics
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Mechanism
from bodycheck.reference.trajectory import Array

#: The features of mechanisms that SAPIEN models; see `Engine.models`.
MODELS = frozenset(
    {
        "mechanisms",
        "revolute joints",
        "prismatic joints",
        "fixed joints",
        "armature",
        "joint damping",
        "joint springs",
        "joint efforts",
        "controllers",
        "rigid stops",
    }
)

#: SAPIEN's types of joints. A wrapped joint would keep its angle within a full turn.
TYPES = {"revolute": "revolute_unwrapped", "prismatic": "prismatic", "fixed": "fixed"}


#: What adds shapes to the builders of links, by the indices of their bodies.
Shaped = Callable[[Mapping[int, Any]], None]


def built(whole: Any, mechanism: Mechanism, method: Method, shaped: Shaped) -> list[Any]:
    """Add a mechanism in its initial state to a scene of SAPIEN, and return the links of its bodies in their order.

    Raises `SceneUnsupported` for stops with a rebound.
    """
    check_rebounds(mechanism, "PhysX")
    links_by_body: dict[int, Any] = {}
    first = kinematics.initial(mechanism)
    for tree in trees(mechanism):
        articulation, links = articulated(whole, mechanism, tree, method, shaped)
        if method.option("settings") != "engine":
            switch_off(articulation)
        if tree[0] != WORLD:
            frame = frames(mechanism)[tree[0]]
            spin = rotate(first.quaternion[tree[0], 0], first.angular_velocity[tree[0], 0])
            velocity = first.velocity[tree[0], 0]
            place(articulation, Pose(frame.position, frame.quaternion), velocity, spin)
        set_joints(articulation, links, mechanism, method)
        links_by_body |= links
    return [links_by_body[number] for number in range(len(mechanism.bodies))]


def articulated(
    whole: Any, mechanism: Mechanism, tree: Sequence[int], method: Method, shaped: Shaped
) -> tuple[Any, dict[int, Any]]:
    """Return the articulation of a tree, and its links keyed by the indices of their bodies."""
    builder = whole.create_articulation_builder()
    root, *others = tree
    builders = {root: builder.create_link_builder()}
    if root == WORLD:
        builders[root].set_joint_properties("fixed", [], Pose(), Pose())
        set_inertia(builders[root], Link(1.0, (1.0, 1.0, 1.0, 0.0, 0.0, 0.0)))
    else:
        set_inertia(builders[root], link_of(mechanism.bodies[root]))
    for number in others:
        joint = mechanism.joint_of[number]
        assert joint is not None  # only roots have none
        builders[number] = builder.create_link_builder(builders[joint.parent])
        set_inertia(builders[number], link_of(mechanism.bodies[number]))
        add_joint(builders[number], joint, method)
    shaped({number: builder for number, builder in builders.items() if number != WORLD})
    for number, link_builder in builders.items():
        link_builder.set_name(f"body_{number}")
    articulation = builder.build(fix_root_link=root == WORLD)
    return articulation, {number: articulation.find_link_by_name(f"body_{number}") for number in tree if number != WORLD}


def set_inertia(builder: Any, link: Link) -> None:
    """Set the mass, the centre of mass and the inertia of a link, along its principal axes."""
    moments, axes = np.linalg.eigh(tensor(link))
    if np.linalg.det(axes) < 0:
        axes[:, 2] *= -1
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = axes, link.center_of_mass
    builder.set_mass_and_inertia(link.mass, Pose(pose), moments)


def add_joint(builder: Any, joint: Joint, method: Method) -> None:
    """Set the joint of a link to its parent, with its limits."""
    frame, turn = np.array(exact.nearest_turn(joint.attitude)), turn_of(joint)
    limits = [] if joint.type == "fixed" else [[*bounds(stops_of(joint, method))]]
    builder.set_joint_properties(
        TYPES[joint.type], limits, Pose(joint.position, multiply(frame, turn)), Pose((0.0, 0.0, 0.0), turn)
    )


def turn_of(joint: Joint) -> Array:
    """Return the quaternion (4,) from the axes of a joint in SAPIEN, of which x is the joint's axis, to those of the child."""
    return np.array([1.0, 0.0, 0.0, 0.0]) if joint.type == "fixed" else from_x(np.array(exact.nearest_axis(joint)))


def set_joints(articulation: Any, links: dict[int, Any], mechanism: Mechanism, method: Method) -> None:
    """Set the initial coordinates and velocities of an articulation, and the forces in its joints."""
    of_link = {active.name: number for number, active in links.items()}
    values = dict(zip((joint.child for joint in mechanism.joints), starts(mechanism), strict=True))
    positions, velocities, efforts = [], [], []
    for active in articulation.active_joints:
        number = of_link[active.child_link.name]
        joint = mechanism.joint_of[number]
        assert joint is not None
        active.set_armature([joint.armature])
        active.set_friction(0.0)
        active.set_drive_properties(joint.stiffness, joint.damping)
        active.set_drive_target(joint.rest)
        if method.option("settings") != "engine":
            active.set_max_velocity(NO_LIMIT)
        positions += values[number][0].tolist()
        velocities += values[number][1].tolist()
        efforts.append(joint.effort)
    if positions:
        articulation.set_qpos(positions)
        articulation.set_qvel(velocities)
        articulation.set_qf(efforts)


def seen(links: Sequence[Any]) -> Array:
    """Return poses of frames, velocities of centres of mass and angular velocities (13 k,) of k links, in the world frame."""
    parts = []
    for link in links:
        parts += [link.entity_pose.p, link.entity_pose.q, link.linear_velocity, link.angular_velocity]
    return np.concatenate(parts, dtype=np.float64)


class Driven:
    """The driven joints of a mechanism, whose forces are among those of all coordinates of articulations.

    Parameters
    ----------
    mechanism, links
        The mechanism, and the links of its bodies in their order.
    """

    def __init__(self, mechanism: Mechanism, links: Sequence[Any]) -> None:
        self.places: list[tuple[Any, int]] = []
        for number in mechanism.driven:
            link = links[mechanism.joints[number].child]
            articulation = link.articulation
            names = [active.child_link.name for active in articulation.active_joints]
            self.places.append((articulation, names.index(link.name)))
        self.constant = [float(articulation.qf[index]) for articulation, index in self.places]

    def state(self) -> tuple[Array, Array]:
        """Return the coordinates and velocities (j,) of the joints."""
        motion = [(articulation.qpos[index], articulation.qvel[index]) for articulation, index in self.places]
        position, velocity = np.array(motion, dtype=np.float64).T
        return position, velocity

    def apply(self, efforts: Array) -> None:
        """Exert efforts (j,) from now on, in addition to the constant ones."""
        for (articulation, index), constant, effort in zip(self.places, self.constant, efforts.tolist(), strict=True):
            forces = np.array(articulation.qf)
            forces[index] = constant + effort
            articulation.set_qf(forces)
