"""The joints of a body of an MJCF file, as a chain of joints of a case with bodies without mass in between."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

from bodycheck.casefile.robots import tables
from bodycheck.casefile.robots.mjcf.features import Features, property_of
from bodycheck.casefile.robots.mjcf.parts import Part
from bodycheck.casefile.robots.mjcf.settings import Settings, word
from bodycheck.casefile.robots.numbers import number, numbers
from bodycheck.casefile.robots.tables import HERE, Pose, turned
from bodycheck.reference.exact.numbers import MP, Real, Vector3, vector
from bodycheck.reference.exact.rotations import IDENTITY, ORIGIN, minus, plus, scaled
from bodycheck.robots.elements import Element, quoted, refuse
from bodycheck.robots.orientations import about_axis, normed

#: The types of joints of MJCF, and the types of a case.
TYPES = {"hinge": "revolute", "slide": "prismatic", "ball": "spherical", "free": "free"}

#: The clause on a force of joints that is no linear function.
NOT_LINEAR = "are no linear function"

#: The numbers of coordinates and of velocities of each type of joint.
SIZES = {"hinge": (1, 1), "slide": (1, 1), "ball": (4, 3), "free": (7, 6)}


@dataclass(eq=False)
class JointOfFile:
    """A joint of an MJCF file in a case.

    Attributes
    ----------
    element
        The element, with its default attributes.
    kind
        Its type in MJCF.
    table
        Its table.
    pose
        The pose in the parent's frame of the frame of the joint, where its coordinate is zero.
    axis
        The axis of a hinge or slide in this frame, of length 1.
    reference
        The coordinate (rad or m) in the pose of the file.
    """

    element: Element
    kind: str
    table: dict[str, Any]
    pose: Pose
    axis: Vector3 = ORIGIN
    reference: Real = field(default_factory=lambda: MP.mpf(0))

    @property
    def name(self) -> str:
        """The name of the joint."""
        return str(self.table["name"])

    def fix(self, coordinate: Real) -> None:
        """Make this hinge or slide a fixed joint at a coordinate (rad or m)."""
        at = self.pose.then(displacement(self.kind, self.axis, coordinate))
        self.table = tables.joint(self.name, "fixed", self.table["parent"], self.table["child"], at)


def displacement(kind: str, axis: Vector3, coordinate: Real) -> Pose:
    """Return the pose to which a hinge or slide about or along an axis moves a frame from the coordinate zero."""
    if not coordinate:
        return HERE
    if kind == "slide":
        return Pose(scaled(coordinate, axis), IDENTITY)
    return Pose(ORIGIN, about_axis(axis, coordinate))


def joints_of(parts: Iterable[Part]) -> list[Part]:
    """Return the joints among the elements of a body."""
    return [part for part in parts if part.element.tag in ("joint", "freejoint")]


def kind_of(joint: Element) -> str:
    """Return the type of a joint. Raises `BadInput` for an unknown type."""
    return "free" if joint.tag == "freejoint" else word(joint, "type", "hinge", tuple(TYPES))


def anchor(part: Part) -> Vector3:
    """Return the position of a joint in the frame of its body."""
    if kind_of(part.element) == "free":
        return ORIGIN
    position = vector(numbers(part.element, "pos", (3,), (0.0, 0.0, 0.0)))
    return plus(part.frame.origin, turned(part.frame.turn, position))


def chain(
    moving: Sequence[Part], names: Sequence[str], around: str, pose: Pose, rules: Settings, features: Features
) -> list[JointOfFile]:
    """Return the joints that move a body, one after another.

    Parameters
    ----------
    moving
        The joints of the body.
    names
        The names of the bodies that they move; the last one is the body itself.
    around
        The name of the body that carries them.
    pose
        The pose of the body's frame, in the pose of the file, in the frame of this body.
    rules
        The settings of the file.
    features
        What is not read of the joints is added here.
    """
    chained, before = [], ORIGIN
    for index, (part, child) in enumerate(zip(moving, names, strict=True)):
        kind, at = kind_of(part.element), anchor(part)
        shift = Pose(minus(at, before), IDENTITY)
        frame = pose.then(shift) if index == 0 else shift
        parent = around if index == 0 else names[index - 1]
        chained.append(_joint(part, kind, (parent, child), frame, rules, features))
        before = at
    return chained


def _joint(part: Part, kind: str, ends: tuple[str, str], frame: Pose, rules: Settings, features: Features) -> JointOfFile:
    """Return a joint between two bodies. frame: the pose of its frame in that of the first body, where the file has them."""
    joint, (parent, child) = part.element, ends
    name = joint.attributes["name"]
    if kind == "free":
        start = {"position": tables.doubles(frame.origin), "quaternion": tables.doubles(frame.turn)}
        table = tables.joint(name, "free", parent, child, HERE) | {"initial": start}
        _add_what_is_not_read(joint, kind, features)
        return JointOfFile(joint, kind, table, HERE)
    if kind == "ball":
        table = tables.joint(name, "spherical", parent, child, frame) | _damping(joint, features)
        _add_what_is_not_read(joint, kind, features)
        return JointOfFile(joint, kind, table, frame)
    axis, given = _axis(part)
    reference = _coordinate(joint, "ref", kind, rules)
    pose = frame.then(displacement(kind, axis, -reference))
    table = tables.joint(name, TYPES[kind], parent, child, pose) | {"axis": given} | _properties(joint, kind, rules, features)
    if reference:
        table["initial"] = {"position": float(reference)}
    return JointOfFile(joint, kind, table, pose, axis, reference)


def _axis(part: Part) -> tuple[Vector3, list[float]]:
    """Return the unit axis of a joint in the frame of its body, and the axis as it is written into a table."""
    given = numbers(part.element, "axis", (3,), (0.0, 0.0, 1.0))
    if not any(given):
        refuse(part.element, "axis", "read zeros; allowed: a vector that is not 0")
    if part.frame.turn == IDENTITY:
        return normed(vector(given)), list(given)
    axis = turned(part.frame.turn, normed(vector(given)))
    return axis, tables.doubles(axis)


def _coordinate(joint: Element, attribute: str, kind: str, rules: Settings) -> Real:
    """Return a coordinate of a joint (rad or m); 0 if the file states none."""
    value = MP.mpf(number(joint, attribute, 0.0))
    return rules.angle(value) if kind == "hinge" else value


def _properties(joint: Element, kind: str, rules: Settings, features: Features) -> dict[str, Any]:
    """Return the forces along a hinge or slide as keys of its table."""
    properties: dict[str, Any] = {}
    if rest := _coordinate(joint, "springref", kind, rules):
        properties["rest"] = float(rest)
    if armature := number(joint, "armature", 0.0):
        properties["armature"] = armature
    properties |= _damping(joint, features)
    if "spring" not in features.off and any(stiffness := _coefficients(joint, "stiffness")):
        properties["stiffness"] = stiffness[0]
        if any(stiffness[1:]):
            features.add((None, True, NOT_LINEAR, property_of("spring", "joint")), joint)
        if number(joint, "springyield", 0.0):
            features.add((None, True, "have a spring that yields", ("joint", "joints")), joint)
    if (friction := number(joint, "frictionloss", 0.0)) and "frictionloss" not in features.off:
        properties |= features.keys("friction", joint, {"friction": friction})
    return properties


def _damping(joint: Element, features: Features) -> dict[str, Any]:
    """Return the damping of a hinge, slide or ball as a key of its table."""
    coefficients = _coefficients(joint, "damping")
    if "damper" in features.off or not any(coefficients):
        return {}
    if any(coefficients[1:]) and "damping" not in features.ignore:
        features.add(("damping", True, NOT_LINEAR, property_of("damping", "joint")), joint)
    return features.keys("damping", joint, {"damping": coefficients[0]})


def _coefficients(joint: Element, attribute: str) -> tuple[float, ...]:
    """Return the coefficients of the force of a spring or damper, a polynomial: the linear one first."""
    return numbers(joint, attribute, (1, 2, 3), (0.0,))


def _add_what_is_not_read(joint: Element, kind: str, features: Features) -> None:
    """Add what a ball or free joint has and a case does not have."""
    noun = (f"{kind} joint", f"{kind} joints")
    spring = any(_coefficients(joint, "stiffness")) or any(numbers(joint, "springdamper", (2,), (0.0, 0.0)))
    if spring and "spring" not in features.off:
        features.add((None, True, "have a spring", noun), joint)
    if number(joint, "armature", 0.0):
        features.add((None, True, "have an armature", noun), joint)
    if number(joint, "frictionloss", 0.0) and "frictionloss" not in features.off:
        features.add(("friction", True, "act", property_of("dry friction", f"{kind} joint")), joint)
    if kind == "free" and any(_coefficients(joint, "damping")) and "damper" not in features.off:
        features.add(("damping", True, "act", property_of("damping", f"{kind} joint")), joint)
    if kind == "ball" and any(numbers(joint, "range", (2,), (0.0, 0.0))) and "limit" not in features.off:
        features.add(("limits", False, "are not looked at", property_of("range", f"{kind} joint")), joint)


def limits(joint: JointOfFile, rules: Settings) -> tuple[float, float] | None:
    """Return the limits of the coordinate of a joint (rad or m), or of the angle of a ball; None if it is not limited.

    Raises `BadInput` for limits that MuJoCo refuses.
    """
    element = joint.element
    if joint.kind == "free" or element.tag == "freejoint":
        return None
    stated = acting_range(element, "limited", "range", rules, ascending=joint.kind != "ball")
    if stated is None:
        return None
    values = [MP.mpf(value) for value in stated]
    if joint.kind in ("hinge", "ball"):
        values = [rules.angle(value) for value in values]
    return float(values[0]), float(values[1])


def acting_range(
    element: Element, switch: str, attribute: str, rules: Settings, ascending: bool = True
) -> tuple[float, float] | None:
    """Return the range of an attribute, if it limits something; None if it does not.

    switch: the attribute that states whether it does. Raises `BadInput` for a range that MuJoCo refuses, which is one that does
    not ascend unless `ascending` is false.
    """
    limited = word(element, switch, "auto", ("true", "false", "auto"))
    lower, upper = numbers(element, attribute, (2,), (0.0, 0.0))
    if limited == "auto":
        if not rules.autolimits and (lower or upper):
            refuse(element, attribute, f'has no meaning without {switch} while autolimits is "false"; allowed: {switch} too')
        limited = "true" if lower or upper else "false"
    if limited == "false":
        return None
    if lower >= upper and ascending:
        refuse(element, attribute, f"read {quoted(element.attributes.get(attribute, ''))}; allowed: the smaller limit first")
    return lower, upper
