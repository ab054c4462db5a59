"""Mechanisms in Exudyn as rigid bodies that joints hold together. The joints are constraints, which need implicit solvers.

Springs, damping and efforts are connectors parallel to the joints. There are no universal joints, no armature and no dry
friction.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import exudyn
import numpy as np
from exudyn import itemInterface, utilities

from bodycheck.adapters.contract import SceneUnsupported
from bodycheck.adapters.exudyn import formulations
from bodycheck.adapters.exudyn.formulations import Formulation
from bodycheck.adapters.mechanisms import centred, frames, from_x, from_z, link_of, starts
from bodycheck.reference.kinematics import multiply
from bodycheck.reference.mechanisms import exact
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Mechanism
from bodycheck.reference.trajectory import Array

#: The identity quaternion (w, x, y, z).
NO_TURN = np.array([1.0, 0.0, 0.0, 0.0])

#: The axes, three of translation and three of rotation, that Exudyn's generic joint locks for each type of joint.
LOCKED = {"fixed": [1, 1, 1, 1, 1, 1], "planar": [0, 0, 1, 1, 1, 0]}


@dataclass(frozen=True)
class Assembly:
    """Bodies and joints in a system.

    Attributes
    ----------
    seen
        Returns the numbers (k,) that describe the current state of the system, which must be assembled.
    rows
        Converts the numbers (n, k) of n states to the states (n, bodies, 13) of the contract.
    bodies, joints
        Exudyn's numbers of the bodies, and of the joints by the indices of their children.
    """

    seen: Callable[[], Array]
    rows: Callable[[Array], Array]
    bodies: Sequence[Any]
    joints: Mapping[int, Any]


def add(system: "exudyn.MainSystem", mechanism: Mechanism, formulation: Formulation) -> Assembly:
    """Add a mechanism to a system.

    Raises
    ------
    SceneUnsupported
        If a joint is universal, or has armature or dry friction.
    """
    each = zip(mechanism.bodies, frames(mechanism), strict=True)
    numbers_of_bodies = [
        formulations.add_body(system, formulation, link_of(body), frame, mechanism.gravity) for body, frame in each
    ]
    ground = system.AddObject(itemInterface.ObjectGround())
    joints: dict[int, Any] = {}
    for joint, (position, _) in zip(mechanism.joints, starts(mechanism), strict=True):
        joints[joint.child] = add_joint(
            system,
            joint,
            ground if joint.parent == WORLD else numbers_of_bodies[joint.parent],
            numbers_of_bodies[joint.child],
            position,
        )
    for loop in mechanism.loops:
        ends = zip(loop.bodies, loop.points, strict=True)
        markers = [marker(system, ground if body == WORLD else numbers_of_bodies[body], point, NO_TURN) for body, point in ends]
        system.AddObject(itemInterface.ObjectJointSpherical(markerNumbers=markers))
    count, number = formulations.coordinates(formulation), len(mechanism.bodies)

    def seen() -> Array:
        data = system.systemData
        both = [data.GetODE2Coordinates(), data.GetODE2Coordinates_t()]
        return np.concatenate([np.reshape(part[: number * count], (number, count)) for part in both], axis=1).ravel()

    def rows(numbers: Array) -> Array:
        states = formulations.rows(formulation, numbers.reshape(-1, 2 * count))
        return centred(mechanism, states.reshape(len(numbers), number, 13))

    return Assembly(seen, rows, numbers_of_bodies, joints)


def add_joint(system: "exudyn.MainSystem", joint: Joint, parent: Any, child: Any, position: Array) -> Any:
    """Add a joint to a system, with the forces in it, and return its number; None if it is free. Raises `SceneUnsupported`."""
    only = "in its kinematic trees only, which begin at the world and have no balls"
    if joint.armature or joint.friction:
        raise SceneUnsupported(f"Exudyn has {'armature' if joint.armature else 'dry friction'} of joints {only}")
    if joint.type == "universal":
        raise SceneUnsupported(f"Exudyn has universal joints {only}")
    turn, number = turn_of(joint), None
    frame = np.array(exact.nearest_turn(joint.attitude))
    ends = [marker(system, parent, joint.position, multiply(frame, turn)), marker(system, child, (0.0, 0.0, 0.0), turn)]
    if joint.type == "revolute":
        number = system.AddObject(itemInterface.ObjectJointRevoluteZ(markerNumbers=ends))
        if joint.stiffness or joint.damping or joint.effort:
            turns = itemInterface.NodeGenericData(initialCoordinates=[position[0]], numberOfDataCoordinates=1)
            system.AddObject(
                itemInterface.TorsionalSpringDamper(
                    markerNumbers=ends,
                    nodeNumber=system.AddNode(turns),
                    stiffness=joint.stiffness,
                    damping=joint.damping,
                    offset=joint.rest,
                    torque=-joint.effort,
                )
            )
    elif joint.type == "prismatic":
        number = system.AddObject(itemInterface.ObjectJointPrismaticX(markerNumbers=ends))
        if joint.stiffness or joint.damping or joint.effort:
            system.AddObject(
                itemInterface.LinearSpringDamper(
                    markerNumbers=ends,
                    stiffness=joint.stiffness,
                    damping=joint.damping,
                    offset=joint.rest,
                    force=-joint.effort,
                )
            )
    elif joint.type == "spherical":
        number = system.AddObject(itemInterface.ObjectJointSpherical(markerNumbers=ends))
        if joint.damping:
            damping = np.diag([0.0, 0.0, 0.0, *[joint.damping] * 3])
            system.AddObject(itemInterface.RigidBodySpringDamper(markerNumbers=ends, damping=damping))
    elif joint.type in LOCKED:
        number = system.AddObject(itemInterface.GenericJoint(markerNumbers=ends, constrainedAxes=LOCKED[joint.type]))
    return number


def turn_of(joint: Joint) -> Array:
    """Return the quaternion (4,) from the axes of a joint in Exudyn, whose axis is z or x, to those of the joint's frame."""
    if joint.type not in ("revolute", "prismatic"):
        return NO_TURN
    return (from_z if joint.type == "revolute" else from_x)(np.array(exact.nearest_axis(joint)))


def marker(system: "exudyn.MainSystem", body: Any, point: Sequence[float], turn: Array) -> Any:
    """Add a marker to a system, at a point and with an attitude in the frame of a body, and return its number."""
    pose = exudyn.HT(rotation=utilities.EulerParameters2RotationMatrix(turn), translation=[*point])
    return system.AddMarker(itemInterface.MarkerBodyRigid(bodyNumber=body, localHT=pose))
