"""Read an MJCF file for a case: its bodies, joints and loops as tables, as MuJoCo's compiler reads them, and all other parts.

A body without a joint is fixed to its parent; if it has no mass either, it is only a frame of its parent. Several joints of one
body act one after another, with bodies without mass in between. The frame of a body is moved to the anchor of its last joint.
Coordinates are MuJoCo's: a joint begins at its `ref`, where the pose is that of the file.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import combinations

from bodycheck.casefile.robot_notes import JointRange
from bodycheck.casefile.robots import tables
from bodycheck.casefile.robots.link import without_rounding
from bodycheck.casefile.robots.mjcf.actuators import controllers_of
from bodycheck.casefile.robots.mjcf.carriers import Carrier, Tree
from bodycheck.casefile.robots.mjcf.equalities import WORLD, loops_of
from bodycheck.casefile.robots.mjcf.features import features_of
from bodycheck.casefile.robots.mjcf.file import assemble
from bodycheck.casefile.robots.mjcf.gravity import strength, upright
from bodycheck.casefile.robots.mjcf.inertia import inertia_of, principal_frame, scaled, within
from bodycheck.casefile.robots.mjcf.joints import JointOfFile, anchor, chain, joints_of, kind_of, limits
from bodycheck.casefile.robots.mjcf.keyframes import keyframe_names, start_at
from bodycheck.casefile.robots.mjcf.meshes import MeshesOfFile
from bodycheck.casefile.robots.mjcf.options import options
from bodycheck.casefile.robots.mjcf.parts import Part, classes_of, parts_of, pose_of
from bodycheck.casefile.robots.mjcf.settings import TRUTHS, settings, word
from bodycheck.casefile.robots.mjcf.springs import set_springs
from bodycheck.casefile.robots.mjcf.tendons import add_tendons
from bodycheck.casefile.robots.numbers import number
from bodycheck.casefile.robots.reading import Choice, Read
from bodycheck.casefile.robots.tables import BASE, HERE, RESERVED, Pose, unique
from bodycheck.errors import BadInput
from bodycheck.reference.exact.inertia import MassProperties
from bodycheck.reference.exact.numbers import MP
from bodycheck.reference.exact.rotations import IDENTITY, ORIGIN
from bodycheck.robots.elements import Element, quoted, refuse
from bodycheck.robots.mjcf_assembly import own, tops_of
from bodycheck.robots.orientations import turned_inertia

#: The mass properties of a body without mass.
NOTHING = MassProperties(MP.mpf(0), ORIGIN, (MP.mpf(0),) * 6)


def tree(root: Element, world: str, choice: Choice) -> Read:
    """Return the result of reading an MJCF file. world: the name of the world.

    Raises `BadInput` for what cannot be read exactly.
    """
    assemble(root, choice.files)
    of_file, rules = options(root), settings(root)
    base = _float(root) if choice.base == "free" else None
    features = features_of(root, of_file, choice.ignore)
    up = upright(root, of_file, features) if choice.upright else IDENTITY
    read = Tree(rules, classes_of(root), MeshesOfFile(root, rules, choice.files), features)
    _walk(root, Carrier(world, Pose(ORIGIN, up), Pose(ORIGIN, up)), read)
    _scale(read)
    set_springs(read)
    moving = [joint for joint in read.joints if joint.kind != "fixed"]
    start_at(root, choice.keyframe, [joint for joint in moving if joint.element is not base], up)
    ranges = () if "limit" in of_file.off else tuple(_ranges(moving, read))
    of_tendons = add_tendons(root, read)
    loops = loops_of(root, read)
    controllers = controllers_of(root, of_file, read, choice)
    floating = [joint.name for joint in moving if joint.table["type"] == "free"]
    return Read(
        {
            "bodies": [tables.body(*each) for each in read.inertias.items()],
            "joints": [joint.table for joint in read.joints],
            **({"loops": loops} if loops else {}),
        },
        base=floating[0] if len(floating) == 1 else None,
        features=features.all(),
        ranges=(*ranges, *of_tendons),
        touching="contact" not in of_file.off and up == IDENTITY and _touching(root, read),
        welded=any(joint.kind == "fixed" and joint.table["parent"] == world for joint in read.joints),
        keyframes=keyframe_names(root),
        gravity=of_file.gravity if up == IDENTITY else (0.0, 0.0, -strength(of_file)),
        timestep=of_file.timestep,
        controllers=controllers,
    )


def _walk(root: Element, around: Carrier, read: Tree) -> None:
    """Read all bodies of a file, each before those in it, in the order of the file. around: the world."""
    read.tendons |= {each.attributes.get("name", ""): each for part in root.all("tendon") for each in part.children}
    bodies, joints = read.taken
    bodies |= {*RESERVED, *(body.attributes["name"] for body in root.everything() if _names(body, "body"))}
    joints |= {joint.attributes["name"] for joint in root.everything() if _names(joint, "joint", "freejoint")}
    left: list[tuple[Part, Carrier]] = []
    for top in root.all("worldbody"):
        parts = parts_of(top, None, read.rules, read.classes)
        _add_sites_and_geoms(WORLD, around, parts, read)
        left += [(part, around) for part in parts if part.element.tag == "body"]
    left.reverse()
    while left:
        part, around = left.pop()
        carrier, inside = _add(part, around, read)
        left += [(inner, carrier) for inner in reversed(inside) if inner.element.tag == "body"]


def _names(element: Element, *tags: str) -> bool:
    """Return whether an element has one of some tags, and a name."""
    return element.tag in tags and "name" in element.attributes


def _add(part: Part, around: Carrier, read: Tree) -> tuple[Carrier, Sequence[Part]]:
    """Add a body and its joints, and return what carries the bodies in it, and the elements of the body."""
    body = part.element
    name, inherited = body.attributes["name"], body.attributes.get("childclass", part.inherited)
    if name in read.carriers:
        refuse(body, "name", f"{quoted(name)} is the name of another body or of the world; names must be unique")
    parts = parts_of(body, inherited, read.rules, read.classes)
    pose = part.frame.then(pose_of(body, read.rules))
    inertia = inertia_of(body, parts, read.rules, read.shapes)
    frame = Carrier(around.name, around.pose.then(pose), around.world.then(pose), around.moves)
    if moving := joints_of(parts):
        carrier = _add_moving(body, moving, parts, inertia, frame, read)
    elif inertia is None or not inertia.mass:
        carrier = frame
        if inertia is not None and around.moves:
            _carry(body, inertia, frame, read)
    else:
        carrier = _add_fixed(body, inertia, frame, read)
    _add_sites_and_geoms(name, carrier, parts, read)
    return carrier, parts


def _add_fixed(body: Element, inertia: MassProperties, frame: Carrier, read: Tree) -> Carrier:
    """Add a body that is fixed to its parent. frame: the body of the case that carries it, and its pose there."""
    name = _name_in_case(body, read)
    joint = unique(name, read.taken[1])
    read.taken[1].add(joint)
    read.inertias[name] = inertia
    read.joints.append(JointOfFile(body, "fixed", tables.joint(joint, "fixed", frame.name, name, frame.pose), frame.pose))
    return replace(frame, name=name, pose=HERE)


def _add_moving(
    body: Element,
    moving: Sequence[Part],
    parts: Sequence[Part],
    inertia: MassProperties | None,
    frame: Carrier,
    read: Tree,
) -> Carrier:
    """Add a body that joints move, with a body without mass for each joint but the last one."""
    if frame.name != read.carriers[WORLD].name or len(moving) > 1:
        for part in moving:
            if kind_of(part.element) == "free":
                refuse(part.element, None, "is not the only joint of a body in the world, as MuJoCo's free joints are")
    if inertia is not None and not inertia.mass and any(inertia.tensor):
        refuse(body, None, "has moments of inertia without mass, which no body that moves has")
    name = _name_in_case(body, read)
    names = []
    for part in moving[:-1]:
        names.append(unique(f"{name}:{part.element.attributes['name']}", read.taken[0]))
        read.taken[0].add(names[-1])
        read.inertias[names[-1]] = NOTHING
    own_frame = Pose(anchor(moving[-1]), HERE.turn)
    if inertia is not None and _aligned(moving[0].element, parts, read):
        own_frame = principal_frame(parts, inertia, read.rules)
        frame = replace(frame, pose=frame.pose.then(own_frame))
    back = own_frame.inverse()
    read.inertias[name] = NOTHING if inertia is None else without_rounding(within(inertia, back))
    read.joints += chain(moving, [*names, name], frame.name, frame.pose, read.rules, read.features)
    return replace(frame, name=name, pose=back, moves=True)


def _aligned(joint: Element, parts: Sequence[Part], read: Tree) -> bool:
    """Return whether a body that a joint moves gets a frame along its principal axes: one that floats alone."""
    alone = kind_of(joint) == "free" and not any(part.element.tag == "body" for part in parts)
    align = word(joint, "align", "auto", (*TRUTHS, "auto")) if joint.tag == "freejoint" else "auto"
    return alone and (align == "true" or (align == "auto" and read.rules.alignfree))


def _name_in_case(body: Element, read: Tree) -> str:
    """Return the name of a body in the case, which is its name in the file if a case allows that."""
    name = body.attributes["name"]
    if name in RESERVED:
        name = unique(f"{name}:body", read.taken[0])
        read.taken[0].add(name)
    return name


def _carry(body: Element, inertia: MassProperties, frame: Carrier, read: Tree) -> None:
    """Add the moments of inertia of a body without mass to the body that it is fixed to."""
    carrying = read.inertias[frame.name]
    if not carrying.mass:
        refuse(body, None, "has moments of inertia without mass, and so has the body that it is fixed to")
    added = turned_inertia(inertia.tensor, frame.pose.turn)
    xx, yy, zz, xy, xz, yz = (one + other for one, other in zip(carrying.tensor, added, strict=True))
    read.inertias[frame.name] = replace(carrying, tensor=(xx, yy, zz, xy, xz, yz))


def _add_sites_and_geoms(body: str, carrier: Carrier, parts: Sequence[Part], read: Tree) -> None:
    """Add the sites of a body of the file, and what its geoms may touch."""
    read.carriers[body] = carrier
    types, affinities, _ = read.masks.get(carrier.name, (0, 0, False))
    for part in parts:
        if part.element.tag == "geom":
            types |= int(number(part.element, "contype", 1.0))
            affinities |= int(number(part.element, "conaffinity", 1.0))
        if part.element.tag == "site" and "name" in part.element.attributes:
            read.sites[part.element.attributes["name"]] = body, part.frame.then(pose_of(part.element, read.rules))
    read.masks[carrier.name] = types, affinities, carrier.moves


def _scale(read: Tree) -> None:
    """Scale all masses and inertias to the total mass that the file states."""
    if read.rules.settotalmass <= 0:
        return
    moving = {carrier.name for carrier in read.carriers.values() if carrier.moves}
    # Bodies that are fixed to the world become parts of it, and are without mass there, if the compiler fuses them.
    counted = [inertia.mass for name, inertia in read.inertias.items() if name in moving or not read.rules.fusestatic]
    if not (total := sum(counted)):
        return
    factor = MP.mpf(read.rules.settotalmass) / total
    for name, inertia in read.inertias.items():
        read.inertias[name] = scaled(inertia, factor)


def _float(root: Element) -> Element | None:
    """Give a free joint to the one body in the world that has mass or joints in it, and return it; None if it has one already.

    Raises `BadInput` if there is no such body, or several, or it has other joints.
    """
    tops = tops_of(root)
    listed = ", ".join(quoted(body.attributes["name"]) for body in tops[:20])
    if len(tops) != 1:
        raise BadInput(f"{root.file}: has {len(tops) or 'no'} bodies in the world, {listed}; one that is alone there can float")
    joints = [element for element in own(tops[0]) if element.tag in ("joint", "freejoint")]
    if not joints:
        names = {element.attributes["name"] for element in root.everything() if _names(element, "joint", "freejoint")}
        joint = Element("freejoint", {"name": unique(BASE, names)}, tops[0].file, tops[0].line)
        tops[0].children.insert(0, joint)
        return joint
    if joints[0].tag != "freejoint" and joints[0].attributes.get("type", "hinge") != "free":
        refuse(joints[0], None, f"moves {listed}, so that it cannot float as a base; allowed: a body without joints")
    return None


def _ranges(moving: Sequence[JointOfFile], read: Tree) -> Iterator[JointRange]:
    """Yield the limits of the hinges and slides."""
    for joint in moving:
        between = limits(joint, read.rules)
        if between is not None and joint.kind in ("hinge", "slide"):
            yield JointRange(joint.name, *between)


def _touching(root: Element, read: Tree) -> bool:
    """Return whether geoms of different bodies, one of which moves, may touch."""
    if any(section.first("pair") is not None for section in root.all("contact")):
        return True
    return any(
        (one[2] or other[2]) and (one[0] & other[1] or other[0] & one[1]) for one, other in combinations(read.masks.values(), 2)
    )
