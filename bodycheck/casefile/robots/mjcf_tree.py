"""Read the bodies and joints of an MJCF file as tables of a case file.

A body without a joint is fixed to its parent; if it has no mass either, it is only a frame of its parent. The frame of a body
is moved to the anchor of its hinge or ball. Geometry, sites, sensors, ranges of joints, and the gravity, integrator and
contacts of the file are ignored: a case states its own gravity. The time step is read for runs of the method that users of an
engine get by default. Anything else that moves bodies is refused.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from bodycheck.casefile.robots import tables
from bodycheck.casefile.robots.mjcf import inertia_of, refuse_includes, refuse_what_is_not_followed
from bodycheck.casefile.robots.mjcf_settings import Defaults, Settings, attitude, settings
from bodycheck.casefile.robots.numbers import number, numbers, positive
from bodycheck.casefile.robots.tables import HERE, Pose, Tables
from bodycheck.reference.exact.inertia import MassProperties
from bodycheck.reference.exact.numbers import MP, Vector3, vector
from bodycheck.reference.exact.rotations import IDENTITY
from bodycheck.reference.mechanisms.joint_types import JOINT_TYPES
from bodycheck.robots.elements import Element, quoted, refuse

#: The types of joints by their names in MJCF.
TYPES = {form.mjcf: form.name for form in JOINT_TYPES.values() if form.mjcf is not None}

#: Parts of a file that constrain or move bodies in ways that a case cannot state.
MOVING = ("equality", "tendon", "actuator", "deformable", "extension")

#: Attributes that change a motion if they are not zero, and that a case cannot state.
OF_OPTIONS = ("density", "viscosity")
OF_BODIES = ("gravcomp",)
OF_JOINTS = ("ref", "springdamper", "actuatorgravcomp")

#: The keys of a case for attributes of joints, and the types of joints that may have them.
PROPERTIES = {
    "armature": ("armature", ("hinge", "slide")),
    "damping": ("damping", ("hinge", "slide", "ball")),
    "stiffness": ("stiffness", ("hinge", "slide")),
    "frictionloss": ("friction", ("hinge", "slide")),
}


@dataclass(frozen=True, eq=False)
class _Around:
    """The context of child bodies: the name of the body that carries them, their frame on it, and their default class."""

    name: str
    pose: Pose
    inherited: str | None


@dataclass(frozen=True, eq=False)
class _Model:
    """The settings of a file."""

    rules: Settings
    geoms: Defaults
    joints: Defaults
    world: str


def tree(root: Element, world: str) -> Tables:
    """Return the bodies and joints of an MJCF file. world: the name of the world.

    Raises `BadInput` for what cannot be read exactly.
    """
    refuse_includes(root)
    for element in root.children:
        if element.tag in MOVING and element.children:
            refuse(element.children[0], None, f"is in <{element.tag}>, which a case cannot say; take it out")
    for option in root.all("option"):
        _refuse_unless_zero(option, OF_OPTIONS)
    model = _Model(settings(root), Defaults(root, "geom"), Defaults(root, "joint"), world)
    bodies_and_joints: Tables = {"bodies": [], "joints": []}
    left = [(child, _Around(world, HERE, _class(top, None))) for top in root.all("worldbody") for child in _bodies(top)][::-1]
    while left:
        body, around = left.pop()
        inner = _add(bodies_and_joints, body, around, model)
        left += [(child, inner) for child in _bodies(body)[::-1]]
    return bodies_and_joints


def timestep(root: Element) -> float | None:
    """Return the time step (s) that a file states; None if it states none. The last of several elements is valid."""
    stated = [option for option in root.all("option") if "timestep" in option.attributes]
    return positive(stated[-1], "timestep") if stated else None


def _bodies(parent: Element) -> list[Element]:
    """Return the child bodies of the world or a body. Raises `BadInput` for elements that stand for further bodies."""
    for element in parent.children:
        if element.tag in ("frame", "replicate", "composite", "flexcomp", "attach", "plugin"):
            refuse(element, None, "is not followed here; write the bodies themselves, with the poses that they have")
    return list(parent.all("body"))


def _class(element: Element, inherited: str | None) -> str | None:
    return element.attributes.get("childclass", inherited)


def _add(tables_of_file: Tables, body: Element, around: _Around, model: _Model) -> _Around:
    """Add a body and its joint to tables, and return the context of the bodies in it."""
    refuse_what_is_not_followed(body)
    _refuse_unless_zero(body, OF_BODIES)
    if body.attributes.get("mocap") == "true":
        refuse(body, "mocap", "read 'true', which moves the body from outside; allowed: false")
    inherited, (name, joints) = _class(body, around.inherited), _named(body)
    pose_in_parent = Pose(vector(numbers(body, "pos", (3,), (0.0, 0.0, 0.0))), attitude(body, model.rules))
    inertia, pose = inertia_of(body, inherited, model.rules, model.geoms), around.pose.then(pose_in_parent)
    if not joints:
        if inertia is None:
            return _Around(around.name, pose, inherited)
        tables_of_file["bodies"].append(tables.body(name, inertia))
        tables_of_file["joints"].append(tables.joint(name, "fixed", around.name, name, pose))
        return _Around(name, HERE, inherited)
    if inertia is None:
        refuse(body, None, "has no mass and moves; only a body without a joint may have none")
    joint = model.joints.resolved(joints[0], inherited) if joints[0].tag == "joint" else joints[0]
    kind = "free" if joint.tag == "freejoint" else joint.attributes.get("type", "hinge")
    if kind not in TYPES:
        refuse(joint, "type", f"read {quoted(kind)}; allowed: {', '.join(TYPES)}")
    anchor = vector(numbers(joint, "pos", (3,), (0.0, 0.0, 0.0)) if kind in ("hinge", "ball") else (0.0, 0.0, 0.0))
    tables_of_file["bodies"].append(tables.body(name, _moved(inertia, anchor)))
    tables_of_file["joints"].append(_joint(joint, kind, (around.name, name), pose.then(Pose(anchor, IDENTITY)), model))
    x, y, z = anchor
    return _Around(name, Pose((-x, -y, -z), IDENTITY), inherited)


def _named(body: Element) -> tuple[str, Sequence[Element]]:
    """Return the name of a body, and its joint, if it has one, in a sequence."""
    joints = [element for element in body.children if element.tag in ("joint", "freejoint")]
    if len(joints) > 1:
        refuse(joints[1], None, "is a second joint of one body; allowed: one, or a body in between that has a mass")
    if "name" not in body.attributes:
        refuse(body, "name", "is missing")
    return body.attributes["name"], joints


def _moved(inertia: MassProperties, anchor: Vector3) -> MassProperties:
    """Return mass properties in a frame whose origin is moved to the position `anchor`."""
    return replace(inertia, centre=vector([one - other for one, other in zip(inertia.centre, anchor, strict=True)]))


def _joint(joint: Element, kind: str, ends: tuple[str, str], pose: Pose, model: _Model) -> dict[str, Any]:
    """Return the table of a joint between two bodies, at a pose in the frame of the first body."""
    parent, child = ends
    name = joint.attributes.get("name", child)
    _refuse_unless_zero(joint, OF_JOINTS)
    properties: dict[str, Any] = {}
    for attribute, (key, kinds) in PROPERTIES.items():
        if value := number(joint, attribute, 0.0):
            if kind not in kinds:
                refuse(joint, attribute, f"a {kind} joint has none in a case; allowed: 0")
            properties[key] = value
    if kind == "free":
        if parent != model.world:
            refuse(joint, None, "a free joint is not of a body in the world")
        start = {"position": tables.doubles(pose.origin), "quaternion": tables.doubles(pose.turn)}
        return {**tables.joint(name, "free", parent, child, HERE), "initial": start}
    if kind in ("hinge", "slide"):
        properties["axis"] = list(numbers(joint, "axis", (3,), (0.0, 0.0, 1.0)))
        rest = MP.mpf(number(joint, "springref", 0.0))
        properties["rest"] = float(rest * MP.pi / 180 if kind == "hinge" and model.rules.degrees else rest)
    return tables.joint(name, TYPES[kind], parent, child, pose) | properties


def _refuse_unless_zero(element: Element, attributes: Sequence[str]) -> None:
    for attribute in attributes:
        if any(numbers(element, attribute, (1, 2), (0.0,))):
            refuse(element, attribute, f"read {quoted(element.attributes[attribute])}, which a case cannot say; allowed: 0")
