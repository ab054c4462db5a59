"""Mechanisms in Exudyn as kinematic trees, in the coordinates of their joints.

`ObjectKinematicTree` has turning and sliding joints along the axes of its links. The frames of the links are rotated so that
the axis of every joint is z. A universal joint consists of two of these joints and a planar joint of three, with links without
mass between them, as bodies without mass are. A body on a fixed joint is a part of the link that carries it, by Exudyn's own
sum of inertias. Springs, damping and efforts are properties of the tree; see `driving` for efforts that change, and for stops.
Armature is the mass matrix of a second object on the coordinates of the tree. Dry friction is a connector of a coordinate, and
is proportional to the velocity at low speeds; see `friction_zone`. A loop is a spherical joint between two markers, which needs
an implicit solver.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import exudyn
import numpy as np
from exudyn import itemInterface, utilities
from scipy.spatial.transform import Rotation

from bodycheck.adapters.contract import Method
from bodycheck.adapters.exudyn.driving import Actuated, add_stops, follows
from bodycheck.adapters.links import tensor
from bodycheck.adapters.mechanisms import from_z, has_mass, link_of, starts
from bodycheck.reference.kinematics import conjugate, multiply, rotate
from bodycheck.reference.mechanisms import exact, kinematics
from bodycheck.reference.mechanisms.joint_types import JointType
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, JointedBody, Mechanism
from bodycheck.reference.trajectory import Array

#: The types of joints of a tree.
JOINTS: frozenset[JointType] = frozenset({"revolute", "prismatic", "universal", "planar", "fixed"})

#: The quantities that a sensor measures at a point of a link of a tree.
SEEN = ("Position", "RotationMatrix", "Velocity", "AngularVelocityLocal")


@dataclass(frozen=True)
class Place:
    """The place of a frame: the number of its link, and its origin (3,) and attitude (4,), w x y z, in the link's frame."""

    link: int
    origin: Array
    turn: Array

    def after(self, origin: Array, turn: Array) -> "Place":
        """Return the place of a frame whose origin and attitude in the frame of this place are given."""
        return Place(self.link, self.origin + rotate(self.turn, origin), multiply(self.turn, turn))


@dataclass(frozen=True)
class Link:
    """A link of a tree.

    Attributes
    ----------
    kind
        The type of its joint in Exudyn.
    parent
        The number of the parent link; -1 for the world.
    origin, turn
        The origin (3,) of the joint's frame (m) and its attitude (4,), w x y z, in the frame of the parent link.
    position, velocity
        The initial coordinate of the joint (rad or m) and its rate.
    acting
        The joint of the mechanism, for the forces and the armature.
    """

    kind: str
    parent: int
    origin: Array
    turn: Array
    position: float
    velocity: float
    acting: Joint


def fits(mechanism: Mechanism) -> bool:
    """Return whether all bodies of a mechanism are on joints that Exudyn's trees have; free bodies are not."""
    return all(joint is not None and joint.type in JOINTS for joint in mechanism.joint_of)


def elements(joint: Joint) -> list[tuple[str, Array]]:
    """Return the kinds and axes (3,) of the turning and sliding joints that make up a joint."""
    x, y, z = np.eye(3)
    kinds = {
        "revolute": [("RevoluteZ", np.array(exact.nearest_axis(joint)))],
        "prismatic": [("PrismaticZ", np.array(exact.nearest_axis(joint)))],
        "universal": [("RevoluteZ", x), ("RevoluteZ", y)],
        "planar": [("PrismaticZ", x), ("PrismaticZ", y), ("RevoluteZ", z)],
        "fixed": [],
    }
    return kinds[joint.type]


def linked(mechanism: Mechanism) -> tuple[list[Link], list[Place]]:
    """Return the links of a tree, and the places of the bodies' frames in them."""
    values = dict(zip((joint.name for joint in mechanism.joints), starts(mechanism), strict=True))
    none = np.array([1.0, 0.0, 0.0, 0.0])
    places = {WORLD: Place(-1, np.zeros(3), none)}
    links: list[Link] = []
    for joint in kinematics.from_the_root(mechanism):
        frame = places[joint.parent].after(np.array(joint.position), np.array(exact.nearest_turn(joint.attitude)))
        for (kind, axis), position, velocity in zip(elements(joint), *values[joint.name], strict=True):
            turn = from_z(axis)
            joint_frame = frame.after(np.zeros(3), turn)
            links.append(Link(kind, joint_frame.link, joint_frame.origin, joint_frame.turn, position, velocity, joint))
            frame = Place(len(links) - 1, np.zeros(3), conjugate(turn))
        places[joint.child] = frame
    return links, [places[index] for index in range(len(mechanism.bodies))]


def add(
    system: "exudyn.MainSystem", mechanism: Mechanism, method: Method
) -> tuple[Callable[[], Array], Callable[[Array], Array], Actuated]:
    """Add a mechanism to a system for a method.

    Returns
    -------
    Two functions, and the driven coordinates. The first function returns the numbers (k,) that describe the current state of
    the system, which must be assembled. The second converts the numbers (n, k) of n states to the states (n, bodies, 13) of the
    contract.
    """
    links, places = linked(mechanism)
    node = system.AddNode(
        itemInterface.NodeGenericODE2(
            referenceCoordinates=[0.0] * len(links),
            initialCoordinates=[link.position for link in links],
            initialCoordinates_t=[link.velocity for link in links],
            numberOfODE2Coordinates=len(links),
        )
    )
    joints = Actuated(system, [link.acting for link in links], mechanism)
    force = joints.force if follows(mechanism, method) else 0
    joints.tree = tree = system.AddObject(tree_of(mechanism, links, places, node, force))
    add_armature(system, links, node)
    add_friction(system, mechanism, links, node, method.timestep)
    add_stops(system, [link.acting for link in links], node, method)
    for loop in mechanism.loops:
        markers = [marker(system, tree, mechanism, places, *end) for end in zip(loop.bodies, loop.points, strict=True)]
        system.AddObject(itemInterface.ObjectJointSpherical(markerNumbers=markers))
    each = zip(places, mechanism.bodies, strict=True)
    sensors = [sensor for frame, body in each for sensor in told(system, tree, frame, body)]

    def seen() -> Array:
        return np.concatenate([system.GetSensorValues(sensor) for sensor in sensors])

    return seen, lambda numbers: rows(mechanism, places, numbers), joints


def tree_of(mechanism: Mechanism, links: Sequence[Link], places: Sequence[Place], node: Any, force: Any) -> Any:
    """Return Exudyn's tree, with the inertia of each link summed over the bodies on it. force: its user function, or 0."""
    matrix = utilities.EulerParameters2RotationMatrix
    sums: list[Any] = [None] * len(links)
    for frame, body in zip(places, mechanism.bodies, strict=True):
        if frame.link >= 0 and has_mass(body):  # Exudyn's sum divides by the mass
            inertia, turn = link_of(body), matrix(frame.turn)
            centre = frame.origin + turn @ np.array(inertia.center_of_mass)
            part = utilities.RigidBodyInertia(inertia.mass, turn @ tensor(inertia) @ turn.T, centre, inertiaTensorAtCOM=True)
            sums[frame.link] = part if sums[frame.link] is None else sums[frame.link] + part
    none = utilities.RigidBodyInertia(0.0, np.zeros((3, 3)))
    inertias = [none if inertia is None else inertia for inertia in sums]
    return itemInterface.ObjectKinematicTree(
        nodeNumber=node,
        gravity=[0.0, 0.0, -mechanism.gravity],
        jointTypes=[getattr(exudyn.JointType, link.kind) for link in links],
        linkParents=[link.parent for link in links],
        jointTransformations=exudyn.Matrix3DList([matrix(link.turn) for link in links]),
        jointOffsets=exudyn.Vector3DList([link.origin for link in links]),
        linkInertiasCOM=exudyn.Matrix3DList([inertia.InertiaCOM() for inertia in inertias]),
        linkCOMs=exudyn.Vector3DList([inertia.COM() for inertia in inertias]),
        linkMasses=[inertia.Mass() for inertia in inertias],
        jointForceVector=[link.acting.effort for link in links],
        jointPositionOffsetVector=[link.acting.rest for link in links],
        jointVelocityOffsetVector=[0.0] * len(links),
        jointPControlVector=[link.acting.stiffness for link in links],
        jointDControlVector=[link.acting.damping for link in links],
        forceUserFunction=force,
    )


def add_armature(system: "exudyn.MainSystem", links: Sequence[Link], node: Any) -> None:
    """Add to a system the armature of the coordinates of a tree."""
    armatures = [link.acting.armature for link in links]
    if any(armatures):
        system.AddObject(itemInterface.ObjectGenericODE2(nodeNumbers=[node], massMatrix=np.diag(armatures)))


def add_friction(system: "exudyn.MainSystem", mechanism: Mechanism, links: Sequence[Link], node: Any, timestep: float) -> None:
    """Add to a system the dry friction of the coordinates of a tree."""
    rubbing = [(number, link.acting) for number, link in enumerate(links) if link.acting.friction]
    if not rubbing:
        return
    point = system.AddNode(itemInterface.NodePointGround())
    ground = system.AddMarker(itemInterface.MarkerNodeCoordinate(nodeNumber=point, coordinate=0))
    for number, joint in rubbing:
        coordinate = system.AddMarker(itemInterface.MarkerNodeCoordinate(nodeNumber=node, coordinate=number))
        system.AddObject(
            itemInterface.CoordinateSpringDamperExt(
                markerNumbers=[ground, coordinate],
                dynamicFrictionForce=joint.friction,
                frictionProportionalZone=friction_zone(mechanism, joint, timestep),
            )
        )


def friction_zone(mechanism: Mechanism, joint: Joint, timestep: float) -> float:
    """Return the speed (rad/s or m/s) below which dry friction is proportional to the speed.

    It is twice the speed by which the friction slows the child alone in a step, so that no step reverses the motion of a joint
    whose inertia is at least half of the child's inertia. It vanishes with the time step.
    """
    link = link_of(mechanism.bodies[joint.child])
    inertia = joint.armature + link.mass
    if joint.type == "revolute":
        axis, centre = np.array(exact.nearest_axis(joint)), np.array(link.center_of_mass)
        arm = np.cross(axis, centre)
        inertia = joint.armature + float(axis @ tensor(link) @ axis + link.mass * arm @ arm)
    return 2 * timestep * (joint.friction / inertia if inertia else 1.0)


def marker(
    system: "exudyn.MainSystem", tree: Any, mechanism: Mechanism, places: Sequence[Place], body: int, point: Sequence[float]
) -> Any:
    """Add a marker at a point of a body or of the world to a system, and return its number."""
    if body == WORLD or places[body].link < 0:
        frame = places[body] if body != WORLD else Place(-1, np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))
        ground = system.AddObject(itemInterface.ObjectGround())
        position = frame.origin + rotate(frame.turn, np.array(point))
        return system.AddMarker(itemInterface.MarkerBodyRigid(bodyNumber=ground, localPosition=position))
    frame = places[body]
    position = frame.origin + rotate(frame.turn, np.array(point))
    return system.AddMarker(
        itemInterface.MarkerKinematicTreeRigid(objectNumber=tree, linkNumber=frame.link, localPosition=position)
    )


def told(system: "exudyn.MainSystem", tree: Any, frame: Place, body: JointedBody) -> list[Any]:
    """Add sensors at the centre of mass of a body to a system, and return their numbers; empty if the body cannot move."""
    if frame.link < 0:
        return []
    centre = frame.origin + rotate(frame.turn, np.array(exact.nearest_inertia(body).centre))
    return [
        system.AddSensor(
            itemInterface.SensorKinematicTree(
                objectNumber=tree,
                linkNumber=frame.link,
                localPosition=centre,
                outputVariableType=getattr(exudyn.OutputVariableType, kind),
                writeToFile=False,
            )
        )
        for kind in SEEN
    ]


def rows(mechanism: Mechanism, places: Sequence[Place], numbers: Array) -> Array:
    """Return the states (n, bodies, 13) of the contract from the outputs (n, k) of the sensors of a tree."""
    first = kinematics.initial(mechanism)
    states = []
    readings = iter(np.split(numbers, range(18, numbers.shape[1], 18), axis=1))
    for number, frame in enumerate(places):
        if frame.link < 0:
            still = (first.position, first.quaternion, first.velocity, first.angular_velocity)
            states.append(np.tile(np.concatenate([part[number, 0] for part in still]), (len(numbers), 1)))
            continue
        centre, attitude, velocity, spin = np.split(next(readings), (3, 12, 15), axis=1)
        turn = Rotation.from_matrix(attitude.reshape(-1, 3, 3)).as_quat(scalar_first=True)
        turned = np.broadcast_to(frame.turn, turn.shape)
        states.append(np.concatenate([centre, multiply(turn, turned), velocity, rotate(conjugate(turned), spin)], axis=1))
    return np.stack(states, axis=1)
