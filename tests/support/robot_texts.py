"""Texts of robot models, with one trap each, and states of them."""

from collections.abc import Mapping
from pathlib import Path
from typing import Literal

import numpy as np

from bodycheck.adapters.robot_reading import RobotFile
from bodycheck.reference.robots.model import RobotJoint, RobotJointType, RobotLink, RobotModel, Wide
from bodycheck.reference.robots.state import RobotState

GRAVITY = (0.4, -0.3, -9.7)

#: An inertia that is turned against its link, with a centre of mass that is not the link's origin.
INERTIAL = (
    '<inertial><origin xyz="0.05 0.02 -0.1" rpy="0.3 -0.2 0.5"/><mass value="1.5"/>'
    '<inertia ixx="0.05" iyy="0.06" izz="0.02" ixy="0.004" ixz="0.003" iyz="-0.002"/></inertial>'
)


def link(name: str, inertial: str = INERTIAL) -> str:
    """A link of a URDF."""
    return f'<link name="{name}">{inertial}</link>'


def joint(name: str, type: str, parent: str, child: str, more: str = "") -> str:
    """A joint of a URDF, which is turned and shifted against its parent."""
    return (
        f'<joint name="{name}" type="{type}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="0.1 -0.2 0.3" rpy="0.4 0.1 -0.7"/>{more}</joint>'
    )


def robot(*parts: str) -> str:
    """A URDF."""
    return f'<robot name="robot">{"".join(parts)}</robot>'


#: The limits that URDF demands of revolute and prismatic joints.
LIMIT = '<limit lower="-3" upper="3" effort="10" velocity="5"/>'

#: A joint with limits, damping and friction.
BRAKED = robot(
    link("base"), link("arm"), joint("hinge", "revolute", "base", "arm", LIMIT + '<dynamics damping="0.5" friction="0.2"/>')
)

#: A joint without limits, for which the file states limits all the same.
FULL_TURN = robot(
    link("base"),
    link("arm"),
    joint("hinge", "continuous", "base", "arm", '<limit lower="-6.28" upper="6.28" effort="1" velocity="1"/>'),
)

#: Its root is welded to the world with its mass, and to it another link.
WELDED_BASE = robot(
    link("base"),
    link("plate"),
    link("arm"),
    joint("weld", "fixed", "base", "plate"),
    joint("hinge", "revolute", "plate", "arm", '<axis xyz="0 0.6 0.8"/>' + LIMIT),
)

#: A link that moves and has no mass.
MASSLESS = robot(link("base"), link("ghost", ""), joint("hinge", "revolute", "base", "ghost", '<axis xyz="0 0 1"/>' + LIMIT))

#: A link without mass that is welded to one that moves.
TIP = robot(
    link("base"),
    link("arm"),
    link("tip", ""),
    joint("hinge", "revolute", "base", "arm", LIMIT),
    joint("weld", "fixed", "arm", "tip"),
)

#: A joint that follows another one.
MIMIC = robot(
    link("base"),
    link("left"),
    link("right"),
    joint("first", "revolute", "base", "left", '<axis xyz="0 0 1"/>' + LIMIT),
    joint(
        "second", "revolute", "base", "right", f'<axis xyz="0 0 1"/>{LIMIT}<mimic joint="first" multiplier="-2" offset="0.1"/>'
    ),
)


def on(type: RobotJointType, axis: str = "") -> str:
    """A body on a joint of several degrees of freedom, and an arm on it."""
    more = f'<axis xyz="{axis}"/>' if axis else ""
    return robot(
        link("base", ""),
        link("body"),
        link("arm"),
        joint("ride", type, "base", "body", more),
        joint("spin", "continuous", "body", "arm", '<axis xyz="0 0.6 0.8"/>'),
    )


#: States of the joints of `on`, by the type of `ride`.
RIDES: Mapping[str, RobotState] = {
    "floating": RobotState(
        {"ride": (0.3, -0.4, 0.5, 0.5, 0.1, -0.7, 0.5), "spin": (0.8,)},
        {"ride": (0.9, -0.3, 0.7, 0.4, -1.1, 0.6), "spin": (-0.7,)},
        {"ride": (0.2, 0.8, -0.5, 0.9, 0.3, -0.4), "spin": (0.6,)},
        {"ride": (1.2, -0.8, 0.4, 0.5, -0.6, 0.9), "spin": (0.3,)},
    ),
    "spherical": RobotState(
        {"ride": (0.5, 0.1, -0.7, 0.5), "spin": (0.8,)},
        {"ride": (0.4, -1.1, 0.6), "spin": (-0.7,)},
        {"ride": (0.9, 0.3, -0.4), "spin": (0.6,)},
        {"ride": (0.5, -0.6, 0.9), "spin": (0.3,)},
    ),
    "planar": RobotState(
        {"ride": (0.3, -0.4, 1.1), "spin": (0.8,)},
        {"ride": (0.9, -0.3, 0.7), "spin": (-0.7,)},
        {"ride": (0.2, 0.8, -0.5), "spin": (0.6,)},
        {"ride": (1.2, -0.8, 0.4), "spin": (0.3,)},
    ),
}


def hinges(*names: str) -> RobotState:
    """A state of revolute or prismatic joints."""
    parts = ((0.3, -0.2), (0.8, -0.5), (-0.6, 0.9), (0.4, 0.7))
    return RobotState(*({name: (first + place * step,) for place, name in enumerate(names)} for first, step in parts))


def written(text: str, folder: Path, format: Literal["urdf", "mjcf"] = "urdf") -> RobotFile:
    """A text as a file."""
    path = folder / {"urdf": "robot.urdf", "mjcf": "robot.xml"}[format]
    path.write_text(text, "utf-8")
    return RobotFile(str(path), format)


def ridden(type: RobotJointType, axis: str = "") -> RobotModel:
    """The robot model that `on` is the text of."""
    zero = np.zeros(3, np.longdouble)
    turned = rotation(0.3, -0.2, 0.5)
    tensor = np.array([[0.05, 0.004, 0.003], [0.004, 0.06, -0.002], [0.003, -0.002, 0.02]], np.longdouble)
    inertia = turned @ tensor @ turned.T
    center = np.array([0.05, 0.02, -0.1], np.longdouble)
    links = (
        RobotLink("base", 0.0, zero, np.zeros((3, 3), np.longdouble)),
        RobotLink("body", 1.5, center, inertia),
        RobotLink("arm", 1.5, center, inertia),
    )
    place = np.array([0.1, -0.2, 0.3], np.longdouble), rotation(0.4, 0.1, -0.7)
    normal = np.array([float(part) for part in axis.split()] or [0, 0, 0], np.longdouble)
    joints = (
        RobotJoint("ride", type, 0, 1, *place, normal),
        RobotJoint("spin", "revolute", 1, 2, *place, np.array([0, 0.6, 0.8], np.longdouble)),
    )
    return RobotModel("robot", links, joints)


def rotation(roll: float, pitch: float, yaw: float) -> Wide:
    """The matrix of turns about the fixed axes x, y and z."""
    (a, b, c), (d, e, f) = (part(np.array([roll, pitch, yaw], np.longdouble)) for part in (np.cos, np.sin))
    about_x = np.array([[1, 0, 0], [0, a, -d], [0, d, a]])
    about_y = np.array([[b, 0, e], [0, 1, 0], [-e, 0, b]])
    about_z = np.array([[c, -f, 0], [f, c, 0], [0, 0, 1]])
    return np.asarray(about_z @ about_y @ about_x)
