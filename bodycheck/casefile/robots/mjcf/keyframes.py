"""The keyframe of an MJCF file at which the joints of a case begin."""

from collections.abc import Sequence

from bodycheck.casefile.robots.mjcf.joints import SIZES, JointOfFile
from bodycheck.casefile.robots.numbers import many
from bodycheck.casefile.robots.reading import FIRST_IF_ANY
from bodycheck.casefile.robots.tables import doubles, turned
from bodycheck.errors import BadInput
from bodycheck.reference.exact.numbers import MP, Quaternion4, vector
from bodycheck.reference.exact.rotations import IDENTITY, multiply
from bodycheck.robots.elements import Element, quoted, refuse
from bodycheck.suggestion import did_you_mean, first_names


def keyframe_names(root: Element) -> tuple[str, ...]:
    """Return the names of the keyframes of a file; empty texts for those without a name."""
    return tuple(key.attributes.get("name", "") for key in _keys(root))


def controls(root: Element, keyframe: str | int | None, count: int) -> tuple[Sequence[float], str]:
    """Return the controls of all actuators at a keyframe, and an empty text; or zeros, and why as a clause.

    keyframe: as in `start_at`. count: the number of actuators. Raises `BadInput` for other numbers of controls.
    """
    zeros = [0.0] * count
    if not _keys(root):
        return zeros, "since the file has no keyframe"
    if keyframe is None:
        return zeros, "since the case names no keyframe"
    key = _chosen(root, keyframe)
    if "ctrl" not in key.attributes:
        return zeros, "since the keyframe has no ctrl"
    if len(values := many(key, "ctrl")) != count:
        refuse(key, "ctrl", f"read {len(values)} numbers; allowed: {count}, one for each actuator of the file")
    return values, ""


def start_at(root: Element, keyframe: str | int | None, joints: Sequence[JointOfFile], up: Quaternion4) -> None:
    """Let joints begin at a keyframe, given by its name or its number; None for the pose of the file.

    `FIRST_IF_ANY` is allowed as a number.

    joints: the joints of the file that move, in its order. up: the rotation of the world of the file into that of the case.

    Raises `BadInput` if there is no such keyframe, or it does not fit the joints.
    """
    if keyframe is None or (keyframe == FIRST_IF_ANY and not _keys(root)):
        return
    key = _chosen(root, keyframe)
    for attribute, keys, which in (("qpos", POSITIONS, 0), ("qvel", VELOCITIES, 1)):
        count = sum(SIZES[joint.kind][which] for joint in joints)
        if attribute not in key.attributes:
            continue
        values = list(many(key, attribute))
        if len(values) != count:
            refuse(key, attribute, f"read {len(values)} numbers; allowed: {count}, as many as the joints of the file have")
        for joint in joints:
            initial = joint.table.setdefault("initial", {})
            for name, size in keys[joint.kind]:
                part, values = values[:size], values[size:]
                initial[name] = part if size > 1 else part[0]
                if joint.kind == "free" and up != IDENTITY:
                    initial[name] = _in_case(name, part, up)


def _in_case(name: str, part: Sequence[float], up: Quaternion4) -> list[float]:
    """Return a part of the state of a free joint in the world of the case, given that in the world of the file."""
    match name:
        case "quaternion":
            w, x, y, z = map(MP.mpf, part)
            return doubles(multiply(up, (w, x, y, z)))
        case "velocity":  # along the axes of the body
            return list(part)
    return doubles(turned(up, vector(part)))


#: The keys of the table `initial` of a joint, and how many coordinates or velocities each has, in MuJoCo's order.
POSITIONS = {
    "hinge": (("position", 1),),
    "slide": (("position", 1),),
    "ball": (("quaternion", 4),),
    "free": (("position", 3), ("quaternion", 4)),
}
VELOCITIES = {
    "hinge": (("velocity", 1),),
    "slide": (("velocity", 1),),
    "ball": (("velocity", 3),),
    "free": (("linear", 3), ("velocity", 3)),
}


def _keys(root: Element) -> list[Element]:
    return [key for section in root.all("keyframe") for key in section.all("key")]


def _chosen(root: Element, keyframe: str | int) -> Element:
    keys, known = _keys(root), keyframe_names(root)
    if keyframe == FIRST_IF_ANY:
        return keys[0]
    if isinstance(keyframe, int) and 0 <= keyframe < len(keys):
        return keys[keyframe]
    if isinstance(keyframe, str) and keyframe and keyframe in known:
        return keys[known.index(keyframe)]
    listed = ", ".join(first_names([quoted(name) if name else str(index) for index, name in enumerate(known)]))
    allowed = f"allowed: {listed}" if known else "the file has none"
    near = did_you_mean(keyframe, [name for name in known if name]) if isinstance(keyframe, str) else ""
    shown = quoted(keyframe) if isinstance(keyframe, str) else str(keyframe)
    raise BadInput(f"{root.file}: has no keyframe {shown}; {allowed}{near}")
