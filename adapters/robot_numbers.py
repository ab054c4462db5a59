"""Functions that readers of robot models share: conversions of the numbers of engines, and facts that engines do not report.

The facts are read from the file: the names and places of floating joints, and the joints that follow others.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import cast
from xml.etree import ElementTree

import numpy as np
from numpy.typing import ArrayLike

from bodycheck.adapters.robot_reading import Components, RobotFile
from bodycheck.reference.kinematics import multiply, normalise, rotate
from bodycheck.reference.robots.model import Mimic
from bodycheck.reference.robots.state import RobotState, Values
from bodycheck.reference.scene import Vector
from bodycheck.reference.trajectory import Array

#: The type of a joint with six degrees of freedom in each format.
FREE = {"urdf": "floating", "mjcf": "free"}

#: The origin (3,) of a joint's frame in the frame of its parent (m), and its attitude there as a quaternion (4,) w, x, y, z.
Place = tuple[Array, Array]


def components(tensor: ArrayLike) -> Components:
    """Return the components xx, yy, zz, xy, xz, yz of a tensor (3, 3)."""
    entries = np.asarray(tensor, dtype=float)
    places = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
    return cast("Components", tuple(float(entries[index]) for index in places))


def vector(values: ArrayLike) -> Vector:
    """Return three numbers as a tuple."""
    x, y, z = (float(value) for value in np.asarray(values, dtype=float))
    return x, y, z


def matrix(quaternion: ArrayLike) -> Array:
    """Return the rotation matrix (3, 3) of a quaternion w, x, y, z of any norm.

    It converts components in the rotated frame to components in the frame that was rotated.
    """
    unit = normalise(np.asarray(quaternion, dtype=float))
    return rotate(np.broadcast_to(unit, (3, 4)), np.eye(3)).T


def scalar_first(quaternion: ArrayLike) -> Array:
    """Return a quaternion (4,) in the order w, x, y, z, from an engine's order x, y, z, w."""
    return np.asarray(quaternion, dtype=float)[[3, 0, 1, 2]]


def along(moments: ArrayLike, axes: Array) -> Array:
    """Return the tensor (3, 3) of principal moments (3,), whose axes are the columns of a matrix (3, 3)."""
    return np.asarray(axes * np.asarray(moments, dtype=float) @ axes.T)


def pose(position: ArrayLike, quaternion: ArrayLike) -> Array:
    """Return the row (7,) of a position and a quaternion w, x, y, z."""
    return np.concatenate([np.asarray(position, dtype=float), np.asarray(quaternion, dtype=float)])


def finite(limit: float, beyond: float = math.inf) -> float | None:
    """Return a limit; None if its size is `beyond`, by which the engine says that there is no limit, or more."""
    return float(limit) if abs(limit) < beyond else None


def values_of(values: Mapping[str, tuple[float, ...]], joint: str, count: int) -> Array | None:
    """Return the numbers of a joint in a state; None if the state has none, or not the number that the engine's joint has."""
    numbers = values.get(joint, ())
    return np.array(numbers) if numbers and len(numbers) == count else None


def floating_joints(file: RobotFile) -> Mapping[str, str]:
    """Return the names of the joints with six degrees of freedom in a file, keyed by the links or bodies that they move.

    Engines that make such joints themselves do not keep the names of the file. The name of a joint without a name is empty.
    """
    root = ElementTree.parse(file.path).getroot()
    if file.format == "urdf":
        joints = [joint for joint in root.iter("joint") if joint.get("type") == FREE["urdf"]]
        children = [(joint, joint.find("child")) for joint in joints]
        return {child.get("link", ""): joint.get("name", "") for joint, child in children if child is not None}
    names = {}
    for body in root.iter("body"):
        free = [joint for joint in body.findall("joint") if joint.get("type") == FREE["mjcf"]]
        for joint in [*body.findall("freejoint"), *free]:
            names[body.get("name", "")] = joint.get("name", "")
    return names


def places_on_root(file: RobotFile) -> Mapping[str, Place]:
    """Return the places of the floating joints of a URDF whose parent is the root, keyed by the names of the joints."""
    joints = ElementTree.parse(file.path).getroot().findall("joint")
    ends = [
        {side: end.get("link", "") for side in ("parent", "child") if (end := joint.find(side)) is not None} for joint in joints
    ]
    children = {links.get("child") for links in ends}
    places = {}
    for joint, links in zip(joints, ends, strict=True):
        if joint.get("type") == FREE["urdf"] and links.get("parent") not in children and "child" in links:
            origin = joint.find("origin")
            words = {} if origin is None else origin.attrib
            position = np.array([float(word) for word in words.get("xyz", "0 0 0").split()])
            places[joint.get("name", "")] = position, turned([float(word) for word in words.get("rpy", "0 0 0").split()])
    return places


def turned(angles: Sequence[float]) -> Array:
    """Return the quaternion (4,) w, x, y, z of rotations by angles (rad) about the fixed axes x, y and z, in this order."""
    quaternion = np.array([1.0, 0.0, 0.0, 0.0])
    for axis, angle in enumerate(angles):
        turn = np.zeros(4)
        turn[0], turn[1 + axis] = np.cos(angle / 2), np.sin(angle / 2)
        quaternion = multiply(turn, quaternion)
    return quaternion


def on_root(state: RobotState, places: Mapping[str, Place]) -> RobotState:
    """Return the state with positions and linear components of floating joints along the axes of the root.

    Angular velocities, accelerations and torques stay along the axes of the child.

    Parameters
    ----------
    state
        The state.
    places
        The places of floating joints in the frame of the root, keyed by the names of the joints.
    """
    positions = dict(state.positions)
    for name, (origin, turn) in places.items():
        if name in positions:
            position = np.array(positions[name])
            positions[name] = (*(origin + rotate(turn, position[:3])).tolist(), *multiply(turn, position[3:]).tolist())

    def along_root(values: Values) -> Values:
        turned_values = dict(values)
        for name, (_, turn) in places.items():
            if name in values:
                turned_values[name] = (*rotate(turn, np.array(values[name][:3])).tolist(), *values[name][3:])
        return turned_values

    moved = (along_root(values) for values in (state.velocities, state.accelerations, state.efforts))
    return replace(state, positions=positions, **dict(zip(("velocities", "accelerations", "efforts"), moved, strict=True)))


def mimics(file: RobotFile) -> Mapping[str, Mimic]:
    """Return the mimic elements of a URDF, keyed by the names of the joints that have them."""
    by_joint = {}
    for joint in ElementTree.parse(file.path).getroot().findall("joint"):
        element = joint.find("mimic")
        if element is not None:
            multiplier, offset = float(element.get("multiplier", "1")), float(element.get("offset", "0"))
            by_joint[joint.get("name", "")] = Mimic(element.get("joint", ""), multiplier, offset)
    return by_joint
