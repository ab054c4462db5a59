"""The equalities of an MJCF file: rules by which joints follow others, loops, and welds of bodies that float.

MuJoCo's equalities are soft; those of a case hold exactly.
"""

from collections.abc import Iterator
from typing import Any

from bodycheck.casefile.robots import tables
from bodycheck.casefile.robots.mjcf.carriers import Tree
from bodycheck.casefile.robots.mjcf.features import Kind
from bodycheck.casefile.robots.mjcf.joints import JointOfFile
from bodycheck.casefile.robots.mjcf.settings import Defaults, word
from bodycheck.casefile.robots.numbers import number, numbers
from bodycheck.casefile.robots.reading import Ignored
from bodycheck.casefile.robots.tables import HERE, Pose
from bodycheck.reference.exact.numbers import MP, Real, vector
from bodycheck.reference.exact.rotations import IDENTITY, unit
from bodycheck.robots.elements import Element, quoted, refuse
from bodycheck.suggestion import did_you_mean

#: The name of the world in MJCF.
WORLD = "world"


def loops_of(root: Element, tree: Tree) -> list[dict[str, Any]]:
    """Apply the equalities of a file to its joints, and return the table `loops`.

    Those that a case does not have, or that it ignores, are added to the features. Raises `BadInput` for what MuJoCo refuses.
    """
    loops = []
    for element in _active(root):
        word_of: Ignored = (
            "mimic" if element.tag in ("joint", "tendon") and "equalities" not in tree.features.ignore else "equalities"
        )
        kind: Kind = (word_of, True, "hold their bodies", (f"equality <{element.tag}>", f"equalities <{element.tag}>"))
        if "equality" in tree.features.off:
            continue
        if word_of in tree.features.ignore:
            tree.features.add(kind, element)
            continue
        match element.tag:
            case "joint" | "tendon":
                done = _follow(element, tree)
            case "connect":
                loops.append(_loop(element, tree))
                done = True
            case "weld":
                done = _weld(element, tree)
            case _:
                done = False
        if not done:
            tree.features.add(("equalities", *kind[1:]), element)
    return loops


def _active(root: Element) -> Iterator[Element]:
    """Yield the equalities that are active at the start, with their default attributes."""
    defaults = Defaults(root, "equality")
    for section in root.all("equality"):
        for element in section.children:
            resolved = defaults.resolved(element, None)
            if word(resolved, "active", "true", ("true", "false")) == "true":
                yield resolved


#: A linear form of coordinates: hinges and slides with the coefficients of their displacements from the pose of the file.
Form = list[tuple[JointOfFile, Real]]


def _follow(element: Element, tree: Tree) -> bool:
    """Let joints follow others by an equality of joints or of fixed tendons; return whether a case can state that.

    In MuJoCo, y - y0 = a0 + a1 (x - x0) + ... for the coordinates or lengths y of the first and x of the second one, where y0
    and x0 are those in the pose of the file.
    """
    coefficients = numbers(element, "polycoef", (1, 2, 3, 4, 5), (0.0, 1.0))
    # Coefficients that are not stated keep their defaults, of which the second is 1.
    coefficients = (*coefficients, *(0.0, 1.0, 0.0, 0.0, 0.0)[len(coefficients) :])
    ends = [f"{element.tag}{index}" for index in (1, 2) if index == 1 or f"{element.tag}2" in element.attributes]
    if len(ends) == 2 and any(coefficients[2:]):
        return False
    factors = (MP.mpf(1), -MP.mpf(coefficients[1]))
    form: Form = []
    for end, factor in zip(ends, factors, strict=False):
        coordinates = _coordinates(element, end, tree)
        if coordinates is None:
            return False
        form += [(joint, factor * coefficient) for joint, coefficient in coordinates]
    names = dict.fromkeys(joint.name for joint, _ in form)
    by_name = {joint.name: joint for joint, _ in form}
    sums = [(by_name[name], sum(part for joint, part in form if joint.name == name)) for name in names]
    return _bind([(joint, coefficient) for joint, coefficient in sums if coefficient], MP.mpf(coefficients[0]), tree)


def _coordinates(element: Element, attribute: str, tree: Tree) -> Form | None:
    """Return the joint, or the linear form of a fixed tendon, that an equality names; None for a spatial tendon."""
    if element.tag == "joint":
        return [(joint_named(element, attribute, tree), MP.mpf(1))]
    name = element.attributes.get(attribute, "")
    if name not in tree.tendons:
        refuse(element, attribute, f"there is no tendon {quoted(name)}{did_you_mean(name, tree.tendons)}")
    tendon = tree.tendons[name]
    if tendon.tag != "fixed":
        return None
    return [(joint_named(each, "joint", tree), MP.mpf(number(each, "coef"))) for each in tendon.all("joint")]


def _bind(form: Form, constant: Real, tree: Tree) -> bool:
    """Let a linear form of one or two coordinates have a constant value; return whether a case can state that."""
    if len(form) == 1:
        joint, coefficient = form[0]
        if not _is_loose(joint) or any(each.table.get("mimic", {}).get("joint") == joint.name for each in tree.joints):
            return False
        joint.fix(joint.reference + constant / coefficient)
        return True
    if len(form) != 2:
        return False
    for (follower, coefficient), (leader, other) in (form, form[::-1]):
        if not _is_loose(follower) or leader.table["type"] == "fixed" or _leads(follower, leader, tree):
            continue
        factor = -other / coefficient
        offset = follower.reference + constant / coefficient - factor * leader.reference
        follower.table.pop("initial", None)
        follower.table["mimic"] = {"joint": leader.name, "multiplier": float(factor), "offset": float(offset)}
        return True
    return False


def _is_loose(joint: JointOfFile) -> bool:
    """Return whether a joint moves by itself so far."""
    return "mimic" not in joint.table and joint.table["type"] != "fixed"


def _leads(follower: JointOfFile, leader: JointOfFile, tree: Tree) -> bool:
    """Return whether a joint follows another one, perhaps over further joints, so that it cannot lead it."""
    by_name = {joint.name: joint for joint in tree.joints}
    while leader is not follower and "mimic" in leader.table:
        leader = by_name[leader.table["mimic"]["joint"]]
    return leader is follower


def joint_named(element: Element, attribute: str, tree: Tree) -> JointOfFile:
    """Return the hinge or slide that an element names. Raises `BadInput` if there is none of that name."""
    name = element.attributes.get(attribute, "")
    single = {joint.name: joint for joint in tree.joints if joint.kind in ("hinge", "slide")}
    if name not in single:
        refuse(element, attribute, f"there is no hinge or slide {quoted(name)}{did_you_mean(name, single)}")
    return single[name]


def _loop(element: Element, tree: Tree) -> dict[str, Any]:
    """Return the loop that a <connect> stands for."""
    if "site1" in element.attributes and not ("body1" in element.attributes and "anchor" in element.attributes):
        ends = [_site(element, attribute, tree) for attribute in ("site1", "site2")]
    else:
        first, second = _body(element, "body1", tree), _body(element, "body2", tree, WORLD)
        anchor = Pose(vector(numbers(element, "anchor", (3,))), IDENTITY)
        # The point of the second body is where the point of the first one is in the pose of the file.
        there = tree.carriers[second].world.inverse().then(tree.carriers[first].world).then(anchor)
        ends = [(first, anchor), (second, there)]
    carriers = [tree.carriers[body] for body, _ in ends]
    points = [carrier.pose.then(pose).origin for carrier, (_, pose) in zip(carriers, ends, strict=True)]
    if carriers[0].name == carriers[1].name:
        refuse(element, None, "connects two points of one body; allowed: points of two bodies")
    return {"bodies": [carrier.name for carrier in carriers], "points": [tables.doubles(point) for point in points]}


def _body(element: Element, attribute: str, tree: Tree, default: str | None = None) -> str:
    """Return the name of a body that an equality names. Raises `BadInput` if there is no such body."""
    name = element.attributes.get(attribute, default)
    if name is None or name not in tree.carriers:
        refuse(element, attribute, f"there is no body {quoted(name or '')}{did_you_mean(name or '', tree.carriers)}")
    return name


def _site(element: Element, attribute: str, tree: Tree) -> tuple[str, Pose]:
    """Return the body and the pose of a site that an equality names. Raises `BadInput` if there is no such site."""
    name = element.attributes.get(attribute, "")
    if name not in tree.sites:
        refuse(element, attribute, f"there is no site {quoted(name)}{did_you_mean(name, tree.sites)}")
    return tree.sites[name]


def _weld(element: Element, tree: Tree) -> bool:
    """Fix a body that floats to the other body of a <weld>; return whether one of them floats and does not carry the other."""
    if "body1" in element.attributes:
        first, second = _body(element, "body1", tree), _body(element, "body2", tree, WORLD)
        frames = [(first, _relative(element, first, second, tree)), (second, HERE)]
    else:
        frames = [_site(element, attribute, tree) for attribute in ("site1", "site2")]
    carriers = [tree.carriers[body] for body, _ in frames]
    places = [carrier.pose.then(pose) for carrier, (_, pose) in zip(carriers, frames, strict=True)]
    for one, other in ((0, 1), (1, 0)):
        joint = next((each for each in tree.joints if each.table["child"] == carriers[one].name), None)
        if joint is None or joint.table["type"] != "free" or _carries(carriers[one].name, carriers[other].name, tree):
            continue
        at = places[other].then(places[one].inverse())
        joint.table = tables.joint(joint.name, "fixed", carriers[other].name, carriers[one].name, at)
        return True
    return False


def _relative(element: Element, first: str, second: str, tree: Tree) -> Pose:
    """Return the pose of the second body of a <weld> in the frame of the first one."""
    x, y, z, *turn = numbers(element, "relpose", (7,), (0.0, 1.0, *(0.0,) * 5))
    if not any(turn):
        return tree.carriers[first].world.inverse().then(tree.carriers[second].world)
    w, i, j, k = map(MP.mpf, turn)
    return Pose(vector((x, y, z)), unit((w, i, j, k)))


def _carries(one: str, other: str, tree: Tree) -> bool:
    """Return whether a body of the case carries another one, or is it."""
    parents = {joint.table["child"]: joint.table["parent"] for joint in tree.joints}
    while other != one and other in parents:
        other = parents[other]
    return other == one
