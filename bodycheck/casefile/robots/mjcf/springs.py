"""Springs and dampers of MJCF that are given by a time constant and a damping ratio, as MuJoCo's compiler makes them.

The inertia of a joint is the inverse of the diagonal element of the inverse mass matrix in the pose of the file.
"""

import numpy as np

from bodycheck.casefile.robots.mjcf.carriers import Tree
from bodycheck.casefile.robots.mjcf.joints import JointOfFile
from bodycheck.casefile.robots.numbers import numbers
from bodycheck.reference.exact.inertia import MassProperties
from bodycheck.reference.exact.numbers import wide
from bodycheck.reference.exact.rotations import matrix
from bodycheck.reference.robots.dynamics import solved, terms, velocity_labels
from bodycheck.reference.robots.model import RobotJoint, RobotJointType, RobotLink, RobotModel, Wide
from bodycheck.reference.robots.state import RobotState
from bodycheck.robots.elements import quoted, refuse

#: The types of joints of a robot model, by the types of MJCF and of bodies that are fixed.
TYPES: dict[str, RobotJointType] = {
    "hinge": "revolute", "slide": "prismatic", "ball": "spherical", "free": "floating", "fixed": "fixed",
}  # fmt: skip


def set_springs(tree: Tree) -> None:
    """Set the stiffness and damping of the hinges and slides with `springdamper`. Raises `BadInput` where MuJoCo refuses it."""
    stated = {joint.name: springdamper for joint in tree.joints if (springdamper := _springdamper(joint)) is not None}
    if not stated:
        return
    model, joints = _model(tree), {joint.name: joint for joint in tree.joints}
    inertias = _inertias(model, tree, list(stated))
    for name, (time, ratio) in stated.items():
        joint, inertia = joints[name], inertias[name]
        for key in ("stiffness", "damping"):
            joint.table.pop(key, None)
        if "spring" not in tree.features.off:
            joint.table["stiffness"] = inertia / (time * time * ratio * ratio)
        if "damper" not in tree.features.off:
            joint.table |= tree.features.keys("damping", joint.element, {"damping": 2 * inertia / time})


def _springdamper(joint: JointOfFile) -> tuple[float, float] | None:
    """Return the time constant (s) and the damping ratio of a hinge or slide; None if the file states none."""
    if joint.kind not in ("hinge", "slide"):
        return None
    time, ratio = numbers(joint.element, "springdamper", (2,), (0.0, 0.0))
    if not (time or ratio):
        return None
    if min(time, ratio) <= 0:
        refuse(
            joint.element, "springdamper", f"read {quoted(joint.element.attributes['springdamper'])}; allowed: positive numbers"
        )
    return time, ratio


def _inertias(model: RobotModel, tree: Tree, names: list[str]) -> dict[str, float]:
    """Return the inertia (kg m^2 or kg) of some hinges and slides, while all others are loose, in the pose of the file."""
    labels, mass_matrix = velocity_labels(model), _mass_matrix(model, tree)
    rows = [labels.index((name, 0)) for name in names]
    units = np.eye(len(labels), dtype=np.longdouble)[rows]
    inverse, definite = solved(np.repeat(mass_matrix[None], len(rows), axis=0), units)
    for name, holds in zip(names, definite, strict=True):
        if not holds:
            joint = next(joint for joint in tree.joints if joint.name == name)
            refuse(joint.element, "springdamper", "needs an inertia, and the mass matrix is not positive definite")
    return {name: float(1 / inverse[index, row]) for index, (name, row) in enumerate(zip(names, rows, strict=True))}


def loose_inertia(tree: Tree, name: str) -> float:
    """Return the inertia (kg m^2 or kg) of a hinge or slide, while all others are loose, in the pose of the file."""
    return _inertias(_model(tree), tree, [name])[name]


def _mass_matrix(model: RobotModel, tree: Tree) -> Wide:
    """Return the mass matrix in the pose of the file."""
    positions = {joint.name: _position(joint) for joint in tree.joints if joint.kind != "fixed"}
    zeros = dict.fromkeys(positions, (0.0,) * 6)
    labels = velocity_labels(model)
    sizes = {name: sum(other == name for other, _ in labels) for name in positions}
    still = {name: values[: sizes[name]] for name, values in zeros.items()}
    return np.array(terms(model, RobotState(positions, still, still, still), (0.0, 0.0, 0.0)).mass_matrix, np.longdouble)


def _position(joint: JointOfFile) -> tuple[float, ...]:
    """Return the coordinates of a joint in the pose of the file."""
    match joint.kind:
        case "ball":
            return 1.0, 0.0, 0.0, 0.0
        case "free":
            return (*joint.table["initial"]["position"], *joint.table["initial"]["quaternion"])
        case _:
            return (float(joint.reference),)


def _model(tree: Tree) -> RobotModel:
    """Return the bodies and joints of a file as a robot model."""
    nothing, still = np.zeros(3, np.longdouble), np.zeros((3, 3), np.longdouble)
    links = [RobotLink("", 0.0, nothing, still), *(_link(name, inertia) for name, inertia in tree.inertias.items())]
    places = {name: index for index, name in enumerate(tree.inertias, start=1)}
    joints = [
        RobotJoint(
            *(joint.name, TYPES[joint.kind], places.get(joint.table["parent"], 0), places[joint.table["child"]]),
            _wide(joint.pose.origin),
            np.stack([_wide(row) for row in matrix(joint.pose.turn)]),
            _wide(joint.axis),
            armature=joint.table.get("armature", 0.0),
        )
        for joint in tree.joints
    ]
    return RobotModel("", tuple(links), tuple(joints))


def _link(name: str, inertia: MassProperties) -> RobotLink:
    xx, yy, zz, xy, xz, yz = _wide(inertia.tensor)
    return RobotLink(name, float(inertia.mass), _wide(inertia.centre), np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))


def _wide(values: tuple[object, ...]) -> Wide:
    return np.array([wide(value) for value in values], np.longdouble)
