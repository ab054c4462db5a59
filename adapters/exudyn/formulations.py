"""The formulations of a rigid body's rotation in Exudyn: the coordinates of a node, their conversions, and bodies on nodes.

A node has three coordinates of the position along the axes of the world, then the coordinates of the rotation. The velocities
are the rates of the coordinates, except for the rotation vector, whose velocities are the angular velocity in the body frame.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import exudyn
import numpy as np
from exudyn import itemInterface, utilities

from bodycheck.adapters.attitudes import quaternions, rotation_vector
from bodycheck.adapters.contract import Method, SceneUnsupported, states
from bodycheck.adapters.links import Link, tensor
from bodycheck.reference.kinematics import conjugate, multiply
from bodycheck.reference.scene import State
from bodycheck.reference.trajectory import Array

#: The distance from 1/2 of half the sine of the second angle, below which the cosine of this angle has lost half of its digits.
GIMBAL_LOCK = 1e-16


@dataclass(frozen=True)
class Formulation:
    """A formulation of the rotation of a body.

    Parameters
    ----------
    node
        Exudyn's class of nodes.
    reference
        The reference rotation, to which initial and current coordinates are relative.
    start
        Returns the coordinates of the rotation and their velocities, from a quaternion and an angular velocity.
    meaning
        Returns quaternions (n, 4) and angular velocities (n, 3) in the body frame, from the coordinates and velocities of the
        rotation in n states.
    """

    node: Callable[..., Any]
    reference: tuple[float, ...]
    start: Callable[[Array, Array], tuple[Array, Array]]
    meaning: Callable[[Array, Array], tuple[Array, Array]]


def node(formulation: Formulation, initial: State) -> Any:
    """Return a node of a formulation in an initial state."""
    rotation, rates = formulation.start(np.array(initial.quaternion), np.array(initial.angular_velocity))
    return formulation.node(
        referenceCoordinates=[0.0, 0.0, 0.0, *formulation.reference],
        initialCoordinates=[*initial.position, *(rotation - np.array(formulation.reference))],
        initialVelocities=[*initial.velocity, *rates],
    )


def coordinates(formulation: Formulation) -> int:
    """Return the number of coordinates of a link."""
    return 3 + len(formulation.reference)


def rows(formulation: Formulation, seen: Array) -> Array:
    """Return the rows (n, 13) of states from Exudyn's coordinates, which are relative to the reference, and velocities."""
    positions, velocities = np.split(seen, 2, axis=1)
    quaternion, angular_velocity = formulation.meaning(positions[:, 3:] + np.array(formulation.reference), velocities[:, 3:])
    return states(positions[:, :3], quaternion, velocities[:, :3], angular_velocity)


def euler_parameters_at(quaternion: Array, angular_velocity: Array) -> tuple[Array, Array]:
    """Return a quaternion q (4,) and its rates q (0, w) / 2 (4,), for the angular velocity w (3,) in the body frame."""
    return quaternion, multiply(quaternion, np.array([0.0, *angular_velocity])) / 2


def of_euler_parameters(parameters: Array, rates: Array) -> tuple[Array, Array]:
    """Return the quaternions q (n, 4), of any norm, and the angular velocities 2 q* dq/dt (n, 3)."""
    return parameters, 2 * multiply(conjugate(parameters), rates)[:, 1:]


def rotation_vector_at(quaternion: Array, angular_velocity: Array) -> tuple[Array, Array]:
    """Return the rotation vector (3,), in rad and at most pi long, and the angular velocity."""
    return rotation_vector(quaternion), angular_velocity


def of_rotation_vector(vectors: Array, angular_velocity: Array) -> tuple[Array, Array]:
    """Return the quaternions of rotation vectors, and the angular velocities."""
    return quaternions(vectors), angular_velocity


def angles_at(quaternion: Array, angular_velocity: Array) -> tuple[Array, Array]:
    """Return the angles (3,), in rad, of rotations about x, then y, then z of the body, and their rates (3,).

    Raises `SceneUnsupported` in gimbal lock, where the rotations about x and z have the same axis.
    """
    w, x, y, z = quaternion
    if abs(w * y + x * z) > 0.5 - GIMBAL_LOCK:
        raise SceneUnsupported("Rxyz has no rates at this attitude, which is in gimbal lock")
    angles = np.array(
        [
            np.arctan2(2 * (w * x - y * z), 1 - 2 * (x * x + y * y)),
            np.arcsin(np.clip(2 * (w * y + x * z), -1, 1)),
            np.arctan2(2 * (w * z - x * y), 1 - 2 * (y * y + z * z)),
        ]
    )
    return angles, np.linalg.solve(rates_to_velocity(angles[None])[0], angular_velocity)


def of_angles(angles: Array, rates: Array) -> tuple[Array, Array]:
    """Return the quaternions of angles, and the angular velocities."""
    half, nothing = angles.T / 2, np.zeros(len(angles))
    cosine, sine = np.cos(half), np.sin(half)
    about_x = np.stack([cosine[0], sine[0], nothing, nothing], axis=1)
    about_y = np.stack([cosine[1], nothing, sine[1], nothing], axis=1)
    about_z = np.stack([cosine[2], nothing, nothing, sine[2]], axis=1)
    quaternion = multiply(multiply(about_x, about_y), about_z)
    return quaternion, np.einsum("nij,nj->ni", rates_to_velocity(angles), rates)


def rates_to_velocity(angles: Array) -> Array:
    """Return the matrices (n, 3, 3) that convert rates of angles (n, 3) to angular velocities in the body frame."""
    (c2, c3), (s2, s3) = np.cos(angles[:, 1:]).T, np.sin(angles[:, 1:]).T
    zeros, ones = np.zeros(len(angles)), np.ones(len(angles))
    return np.stack([c2 * c3, s3, zeros, -c2 * s3, c3, zeros, s2, zeros, ones], axis=1).reshape(-1, 3, 3)


#: All formulations, keyed by the parts of the names of Exudyn's nodes in which these names differ.
FORMULATIONS = {
    "EP": Formulation(itemInterface.NodeRigidBodyEP, (1.0, 0.0, 0.0, 0.0), euler_parameters_at, of_euler_parameters),
    "RotVecLG": Formulation(itemInterface.NodeRigidBodyRotVecLG, (0.0, 0.0, 0.0), rotation_vector_at, of_rotation_vector),
    "Rxyz": Formulation(itemInterface.NodeRigidBodyRxyz, (0.0, 0.0, 0.0), angles_at, of_angles),
}


def of_method(method: Method) -> Formulation:
    """Return the formulation that a method names; by default `EP` with Exudyn's own settings, and `RotVecLG` otherwise."""
    return FORMULATIONS[method.option("formulation") or ("EP" if method.option("settings") == "engine" else "RotVecLG")]


def add_body(system: "exudyn.MainSystem", formulation: Formulation, link: Link, initial: State, gravity: float) -> Any:
    """Add to a system a link with its weight, whose frame is in a state, and return its number."""
    # Exudyn needs the tensor about the origin of the link; this is Exudyn's own conversion.
    inertia = utilities.RigidBodyInertia(link.mass, tensor(link), link.center_of_mass, inertiaTensorAtCOM=True)
    body = system.AddObject(
        itemInterface.ObjectRigidBody(
            nodeNumber=system.AddNode(node(formulation, initial)),
            mass=inertia.Mass(),
            inertia=inertia.GetInertia6D(),
            centerOfMass=inertia.COM(),
        )
    )
    mass = system.AddMarker(itemInterface.MarkerBodyMass(bodyNumber=body))
    system.AddLoad(itemInterface.LoadMassProportional(markerNumber=mass, loadVector=[0.0, 0.0, -gravity]))
    return body
