"""The surroundings of the bodies of a case file: the plane, pairs with their own friction or restitution, and pushes.

Both formats have them. The body of a file of format 1 is called `BODY` here.
"""

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from fnmatch import fnmatchcase
from typing import Any

from bodycheck.casefile import grammar
from bodycheck.casefile.raw_values import mapping, number, tables_of
from bodycheck.casefile.toml_positions import Path
from bodycheck.casefile.values import MAX_CONTACTS, MAX_NAME_LENGTH, MAX_PUSHES
from bodycheck.reference.exact.touching import touching_above_origin
from bodycheck.reference.mechanisms.mechanism import WORLD, PairContact
from bodycheck.reference.scene import AlongPlane, Attitude, Plane, Push, Shape, Vector, vector_of
from bodycheck.suggestion import did_you_mean, first_names

#: The name of the body of a file of format 1, and the name of the plane among the bodies.
BODY = "body"
PLANE = "plane"

#: The keys of a contact that a pair may have of its own.
OF_PAIRS = ("friction", "restitution", "rolling_friction", "torsional_friction", "cone")


def surroundings_faults(document: Mapping[str, Any], names: Sequence[str]) -> Iterator[tuple[Path, str]]:
    """Yield the faults between keys of the surroundings, as pairs of path and message. names: the names of the bodies.

    The raw document may also have other faults.
    """
    scene = mapping(document.get("scene"))
    for index, contact in enumerate(tables_of(scene, "contacts", MAX_CONTACTS)):
        for path, message in _of_contact(contact, names, on_plane="plane" in scene):
            yield ("scene", "contacts", index, *path), message
    for index, push in enumerate(tables_of(scene, "push", MAX_PUSHES)):
        if "until" in push and number(push["until"]) <= number(push.get("from")):
            yield ("scene", "push", index, "until"), "must be later than from"
    plane = mapping(scene.get("plane"))
    for path, law in _laws(scene, plane):
        for message in _of_cone(law):
            yield (*path, "cone"), message
    if plane.get("law") == "decoupled" and plane.get("pressure") == "balanced":
        yield ("scene", "plane", "pressure"), "the decoupled law does not depend on where the load is; allowed: uniform"


def _laws(scene: Mapping[str, Any], plane: Mapping[str, Any]) -> Iterator[tuple[Path, Mapping[str, Any]]]:
    """Yield the tables that name a cone, with what they take over from the plane."""
    if "cone" in plane:
        yield ("scene", "plane"), plane
    for index, contact in enumerate(tables_of(scene, "contacts", MAX_CONTACTS)):
        if "cone" in contact:
            yield ("scene", "contacts", index), {**plane, **contact}


def _of_cone(law: Mapping[str, Any]) -> Iterator[str]:
    if "rolling_friction" not in law and "torsional_friction" not in law:
        yield "says nothing without a coefficient; give rolling_friction or torsional_friction"
    if law.get("cone") == "one" and law.get("friction") == "no-slip":
        yield "one limit for friction and moments needs a coefficient of friction; allowed with no-slip: product"


def _of_contact(contact: Mapping[str, Any], names: Sequence[str], *, on_plane: bool) -> Iterator[tuple[Path, str]]:
    if not on_plane and len(names) < 2:
        yield (), "nothing touches without a plane; give [scene.plane]"
        return
    if not on_plane:
        missing = [key for key in ("friction", "restitution") if key not in contact]
        yield from (((key,), "is missing; without a plane it has no default") for key in missing)
    elif not any(key in contact for key in OF_PAIRS):
        yield (), f"says nothing; give any of {', '.join(OF_PAIRS)}"
    pair = contact.get("bodies")
    if not isinstance(pair, list) or len(pair) != 2 or not all(isinstance(name, str) for name in pair):
        return
    for index, pattern in enumerate(pair):
        if not 0 < len(pattern) <= MAX_NAME_LENGTH or not pattern.isprintable():
            continue  # reported as another fault
        allowed = [PLANE, *names] if on_plane else list(names)
        if (pattern == PLANE and not on_plane) or (pattern != PLANE and not _places(pattern, names)):
            shown = ", ".join([PLANE, *first_names(names)] if on_plane else first_names(names))
            yield ("bodies", index), f"there is no such body; allowed: {shown}{did_you_mean(pattern, allowed)}"
    if pair[0] == pair[1] and (pair[0] == PLANE or "*" not in pair[0]):
        yield ("bodies",), "a contact is of two different bodies"


def build_plane(table: grammar.PlaneTable | None) -> Plane | None:
    """Return the plane of a table; None if there is no table."""
    if table is None:
        return None
    return Plane(
        _coefficient(table.friction),
        table.law,
        table.pressure,
        table.incline,
        table.restitution,
        table.rolling_friction,
        table.torsional_friction,
        table.cone or "product",
    )


def build_contacts(
    tables: Sequence[grammar.ContactTable], names: Sequence[str], plane: Plane | None
) -> tuple[PairContact, ...]:
    """Return the contacts that tables state for pairs of bodies, or of a body and the plane; the last for a pair counts.

    names: the names of the bodies. A pair with the coefficients and the cone of the plane is left out. Without a plane, each
    table has friction and restitution.
    """
    by_pair: dict[tuple[int, int], PairContact] = {}
    for table in tables:
        first, second = (_places(pattern, names) for pattern in table.bodies)
        stated = {key: value for key in OF_PAIRS if (value := getattr(table, key)) is not None}
        friction = {"friction": _coefficient(stated["friction"])} if "friction" in stated else {}
        law = (coefficients(plane) if plane is not None else {}) | stated | friction
        for one in first:
            for other in second:
                if one != other:
                    pair = min(one, other), max(one, other)
                    by_pair[pair] = PairContact(pair, **law)
    pairs = [pair for _, pair in sorted(by_pair.items())]
    return tuple(pair for pair in pairs if plane is None or coefficients(pair) != coefficients(plane))


def coefficients(law: Plane | PairContact) -> dict[str, Any]:
    """Return the properties of a contact that a pair may have of its own, by their keys."""
    return {key: getattr(law, key) for key in OF_PAIRS}


def build_push(table: grammar.PushTable, body: int = 0) -> Push:
    """Return the push of a table. body: the index of the body that is pushed."""
    begin, until = getattr(table, "from"), getattr(table, "until")  # noqa: B009  (Python has no attribute `from`)
    return Push(table.force, table.point, begin, math.inf if until is None else until, body)


def attitude_on(plane: Plane | None) -> Attitude:
    """Return the default attitude of a body: the attitude of the plane, or no rotation without an inclined plane."""
    return (1.0, 0.0, 0.0, 0.0) if plane is None or not plane.incline else AlongPlane(plane.incline)


def position_on(plane: Plane | None, shape: Shape | None, attitude: Attitude) -> Vector:
    """Return the default position (m) of the centre of mass: above the origin, so that the body touches the plane.

    Without a plane or a shape it is the origin. The position is computed with a hundred digits and rounded once.

    attitude: the attitude of the body, as the file gives it.
    """
    if plane is None or shape is None:
        return 0.0, 0.0, 0.0
    return vector_of(touching_above_origin(shape, attitude, plane.incline))


def _coefficient(friction: float | str) -> float:
    return math.inf if isinstance(friction, str) else friction


def _places(pattern: str, names: Sequence[str]) -> list[int]:
    """Return the indices of the bodies with names that a pattern matches, in which * stands for any characters."""
    return [WORLD] if pattern == PLANE else [index for index, name in enumerate(names) if matches(pattern, name)]


def matches(pattern: str, name: str) -> bool:
    """Return whether a pattern, in which * stands for any characters, matches a name."""
    return fnmatchcase(name, re.sub(r"[\[?]", r"[\g<0>]", pattern))
