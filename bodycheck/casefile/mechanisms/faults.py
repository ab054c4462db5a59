"""Check rules that connect several keys of a case file of format 2, which the grammar of single keys cannot express."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from bodycheck.casefile.contradictions import body_faults, run_faults, start_faults
from bodycheck.casefile.mechanisms.control_faults import control_faults
from bodycheck.casefile.mechanisms.grammar import MAX_BODIES, MAX_LOOPS, WORLD, with_shape
from bodycheck.casefile.raw_values import mapping, numbers, tables_of
from bodycheck.casefile.surroundings import PLANE, matches, surroundings_faults
from bodycheck.casefile.toml_positions import Path
from bodycheck.casefile.values import MAX_CONTACTS, MAX_PUSHES
from bodycheck.suggestion import did_you_mean, first_names


def contradictions(document: dict[str, Any]) -> Iterator[tuple[Path, str]]:
    """Yield the faults between keys of a raw document, which may also have other faults, as pairs of path and message."""
    bodies, joints = tables_of(document, "bodies", MAX_BODIES), tables_of(document, "joints", MAX_BODIES)
    if "model" not in document:
        if document.get("bodies", []) == []:
            yield ("bodies",), "is missing; a mechanism has [[bodies]], or a [model] with a file"
        if "initial" in document:
            yield ("initial",), "is that of a [model]; here, joints and free bodies have an initial of their own"
    for path, message in start_faults(mapping(mapping(document.get("initial")).get("base"))):
        yield ("initial", "base", *path), message
    yield from _twice("bodies", bodies)
    yield from _twice("joints", joints)
    names = list(dict.fromkeys(name for body in bodies if isinstance(name := body.get("name"), str) and name != WORLD))
    holder = _holders(joints)
    for index, body in enumerate(bodies):
        for path, message in _of_body(body, holder):
            yield ("bodies", index, *path), message
    for index, joint in enumerate(joints):
        for path, message in (*_of_joint(joint, names), *_of_child(index, joint, joints, holder)):
            yield ("joints", index, *path), message
    yield from _circles(joints)
    yield from _of_mimicry(joints)
    for index, loop in enumerate(tables_of(document, "loops", MAX_LOOPS)):
        for path, message in _of_loop(loop, names):
            yield ("loops", index, *path), message
    yield from control_faults(document)
    yield from _of_surroundings(document, names)
    yield from run_faults(document)


def _twice(name: str, tables: Sequence[Mapping[str, Any]]) -> Iterator[tuple[Path, str]]:
    """Yield faults for names that a table of an array repeats, and for a body that has the name of the world or the plane."""
    seen: set[str] = set()
    for index, table in enumerate(tables):
        name_of_table = table.get("name")
        if not isinstance(name_of_table, str):
            continue
        if name_of_table in seen:
            yield (name, index, "name"), f"stands twice; names of {name} must be unique"
        if name_of_table in (WORLD, PLANE) and name == "bodies":
            yield (name, index, "name"), f"is the name of the {name_of_table}; give the body another one"
        seen.add(name_of_table)


def _holders(joints: Sequence[Mapping[str, Any]]) -> dict[str, int]:
    """Return the index of the first joint that has a body as child, by the names of the bodies."""
    holders: dict[str, int] = {}
    for index, joint in enumerate(joints):
        if isinstance(child := joint.get("child"), str):
            holders.setdefault(child, index)
    return holders


def _of_body(body: Mapping[str, Any], holder: Mapping[str, int]) -> Iterator[tuple[Path, str]]:
    yield from body_faults(with_shape(body), zero_allowed=True)
    keys = [key for key in ("particles", "parts") if key in body]
    if keys and "center_of_mass" in body:
        yield ("center_of_mass",), f"follows from the positions of the {keys[0]}; leave it out"
    if "initial" in body:
        for path, message in start_faults(mapping(body["initial"])):
            yield ("initial", *path), message
        name = body.get("name")
        if isinstance(name, str) and name in holder:
            yield (
                ("initial",),
                f"the body is the child of joint {holder[name] + 1}, whose own initial says where it is; give only that one",
            )


def _of_joint(joint: Mapping[str, Any], names: Sequence[str]) -> Iterator[tuple[Path, str]]:
    if "parent" in joint and (fault := _unknown(joint["parent"], [WORLD, *names])) is not None:
        yield ("parent",), fault
    if joint.get("child") == WORLD:
        yield ("child",), f"the world is the child of no joint; allowed: {_listed(names)}"
    elif "child" in joint and (fault := _unknown(joint["child"], names)) is not None:
        yield ("child",), fault
    axis = numbers(joint.get("axis"), 3)
    if axis is not None and not any(axis):
        yield ("axis",), "its length is 0; any other length is allowed"
    yield from start_faults(joint)
    for path, message in start_faults({"quaternion": mapping(joint.get("initial")).get("quaternion")}):
        yield ("initial", *path), message


def _of_child(
    index: int, joint: Mapping[str, Any], joints: Sequence[Mapping[str, Any]], holder: Mapping[str, int]
) -> Iterator[tuple[Path, str]]:
    child = joint.get("child")
    if isinstance(child, str) and child != WORLD and (first := holder[child]) != index:
        other = _quoted(joints[first].get("name"))
        yield (
            ("child",),
            f"is the child of joint {first + 1}, {other}, too; a body has one joint, and [[loops]] close chains",
        )


def _circles(joints: Sequence[Mapping[str, Any]]) -> Iterator[tuple[Path, str]]:
    """Yield a fault for each circle of joints from child to parent, once, at the first of its joints."""
    parent_of: dict[str, tuple[int, str]] = {}
    for index, joint in enumerate(joints):
        child, parent = joint.get("child"), joint.get("parent", WORLD)
        if isinstance(child, str) and isinstance(parent, str) and child != WORLD:
            parent_of.setdefault(child, (index, parent))
    done: set[str] = set()
    for start in parent_of:
        way: dict[str, int] = {}
        body = start
        while body in parent_of and body not in done and body not in way:
            way[body], body = parent_of[body]
        if body in way:
            names = list(way)
            circle = names[names.index(body) :]
            round_ = " <- ".join([*map(_quoted, first_names(circle)), _quoted(body)])
            first = min(way[name] for name in circle)
            yield (
                ("joints", first, "parent"),
                f"goes round in a circle: {round_}; a chain begins at the world or a free body, and [[loops]] close it",
            )
        done |= set(way)


def _of_mimicry(joints: Sequence[Mapping[str, Any]]) -> Iterator[tuple[Path, str]]:
    """Yield the faults of rules by which joints follow others: unknown joints, circles, and a start of their own."""
    named = {joint["name"]: joint for joint in joints if isinstance(joint.get("name"), str)}
    leaders = {name: mapping(joint.get("mimic")).get("joint") for name, joint in named.items()}
    single = [name for name, joint in named.items() if joint.get("type") in ("revolute", "prismatic")]
    for index, joint in enumerate(joints):
        leader = mapping(joint.get("mimic")).get("joint")
        if not isinstance(leader, str):
            continue
        if leader not in single:
            listed = _listed([name for name in single if name != joint.get("name")])
            yield ("joints", index, "mimic", "joint"), f"is no revolute or prismatic joint; allowed: {listed}"
        if "initial" in joint:
            yield ("joints", index, "initial"), "the joint follows another one, whose initial determines its own; leave it out"
        way = [joint.get("name")]
        while isinstance(leader, str) and leader not in way:
            way.append(leader)
            leader = leaders.get(leader)
        if leader == joint.get("name"):
            circle = " <- ".join(map(_quoted, [*way, leader]))
            yield (
                ("joints", index, "mimic"),
                f"the rules go round in a circle: {circle}; a joint follows one that moves by itself",
            )


def _of_loop(loop: Mapping[str, Any], names: Sequence[str]) -> Iterator[tuple[Path, str]]:
    pair = loop.get("bodies")
    if not isinstance(pair, list):
        return
    for index, name in enumerate(pair[:2]):
        if (fault := _unknown(name, [WORLD, *names])) is not None:
            yield ("bodies", index), fault
    if len(pair) == 2 and isinstance(pair[0], str) and pair[0] == pair[1]:
        yield ("bodies",), "a loop joins two different bodies"


def _of_surroundings(document: Mapping[str, Any], names: Sequence[str]) -> Iterator[tuple[Path, str]]:
    yield from surroundings_faults(document, names)
    scene = mapping(document.get("scene"))
    if document.get("joints") or "model" in document:
        if "plane" in scene:
            yield ("scene", "plane"), "bodies on joints touch no plane; allowed: a plane, or joints"
        elif "contacts" in scene and "model" in document:
            yield ("scene", "contacts"), "the bodies of a model touch nothing; allowed: contacts, or a model"
        else:
            yield from _of_fingers(document, names)
    for index, push in enumerate(tables_of(scene, "push", MAX_PUSHES)):
        if "body" not in push and len(names) > 1:
            yield ("scene", "push", index, "body"), f"is missing; allowed: {_listed(names)}"
        elif "body" in push and (fault := _unknown(push["body"], names)) is not None:
            yield ("scene", "push", index, "body"), fault


def _of_fingers(document: Mapping[str, Any], names: Sequence[str]) -> Iterator[tuple[Path, str]]:
    """Yield the faults of pairs that touch where bodies are on joints: one body of a pair slides on a joint, one is free."""
    joints = tables_of(document, "joints", MAX_BODIES)
    holder = _holders(joints)
    for index, contact in enumerate(tables_of(mapping(document.get("scene")), "contacts", MAX_CONTACTS)):
        pair = contact.get("bodies")
        if not isinstance(pair, list) or len(pair) != 2 or not all(isinstance(pattern, str) for pattern in pair):
            continue  # reported as another fault
        one, other = ([name for name in names if matches(pattern, name)] for pattern in pair)
        path = ("scene", "contacts", index, "bodies")
        held = sorted({name for name in (*one, *other) if name in holder}, key=names.index)
        fixed = next((name for name in held if joints[holder[name]].get("type") not in ("prismatic", None)), None)
        if fixed is not None:
            kind = _quoted(joints[holder[fixed]].get("type"))
            yield path, f"{_quoted(fixed)} is on a joint of the type {kind}; allowed: a free body and one on a prismatic joint"
        elif both := next(((a, b) for a in one for b in other if a != b and a in holder and b in holder), None):
            listed = " and ".join(map(_quoted, both))
            yield path, f"{listed} are both on joints; allowed: a free body and one on a prismatic joint"


def _unknown(name: Any, names: Sequence[str]) -> str | None:
    """Return the fault of a name that no body has; None if a body has it or the grammar reports the fault."""
    if not isinstance(name, str) or name in names:
        return None
    return f"there is no such body; allowed: {_listed(names)}{did_you_mean(name, names)}"


def _listed(names: Sequence[str]) -> str:
    return ", ".join(first_names(names)) or "no body, as there is none"


def _quoted(name: Any) -> str:
    """Return a quoted name of a body or joint for a message; the name may be any text of a stranger."""
    text = ascii(name) if not (isinstance(name, str) and name.isprintable()) else name
    return text if len(text) <= 60 else f"{text[:59]}…"
