"""Links of a URDF that are fixed to one another and become one body of a case, as the inertia of one of them is impossible.

Links that are fixed to one another move as one rigid body, whose motion depends on the sum of their mass properties alone.
Where no body has the inertia of a link, but a body may have that of all of them together, the file determines the motion. The
inertia of a link that is fixed to the world acts on nothing.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bodycheck.casefile.robots import tables
from bodycheck.casefile.robots.link import without_rounding
from bodycheck.casefile.robots.tables import HERE, Pose, turned
from bodycheck.reference.exact.inertia import MassProperties, joined
from bodycheck.reference.exact.rotations import plus
from bodycheck.reference.possible_inertia import NO_BODY, OTHER_SIGNS, impossible_tensor
from bodycheck.reference.robots.physical import rounding
from bodycheck.robots.orientations import turned_inertia
from bodycheck.robots.urdf import Parts, below, rounded
from bodycheck.robots.urdf_parts import LinkPart


@dataclass(frozen=True, eq=False)
class Rigid:
    """The links that are read as parts of what carries them.

    Attributes
    ----------
    carried
        Their names.
    heads
        The names of the links that carry others as parts of their own body.
    faults
        Why no body has the inertia of a link, for each link of such an inertia; those that are fixed to the world come last.
    grounded
        The names of those that are fixed to the world.
    """

    carried: frozenset[str]
    heads: frozenset[str]
    faults: dict[str, str]
    grounded: frozenset[str]


def rigid(read: Parts, *, floats: bool) -> Rigid:
    """Return the links of a file that are read as parts of what carries them. floats: whether the root link moves."""
    carried: set[str] = set()
    heads: set[str] = set()
    of_bodies: dict[str, str] = {}
    of_world: dict[str, str] = {}
    groups = _groups(read)
    for head, members in groups.items():
        faults = {link.name: fault for link, _ in members if (fault := _fault(prepared(link, read))) is not None}
        if head == read.root and not floats and len(groups) > 1:
            of_world = {name: fault for name, fault in faults.items() if name != head}
        elif faults and _fault(joined([placed(prepared(link, read), pose) for link, pose in members])) is None:
            of_bodies |= faults
            heads.add(head)
            carried |= {link.name for link, _ in members} - {head}
    return Rigid(frozenset(carried | set(of_world)), frozenset(heads), of_bodies | of_world, frozenset(of_world))


def _groups(read: Parts) -> dict[str, list[tuple[LinkPart, Pose]]]:
    """Return the links that are fixed to one another, with their poses on the first of them, by the names of the first ones."""
    links, holders = {link.name: link for link in read.links}, {joint.child: joint for joint in read.joints}
    places = {read.root: (read.root, HERE)}
    for name in below(read.root, read.joints):
        joint = holders[name]
        head, pose = places[joint.parent]
        fixed = joint.type == "fixed"
        places[name] = (head, pose.then(Pose(joint.origin, joint.attitude))) if fixed else (name, HERE)
    groups: dict[str, list[tuple[LinkPart, Pose]]] = {}
    for name, (head, pose) in places.items():
        groups.setdefault(head, []).append((links[name], pose))
    return groups


def placed(inertia: MassProperties, pose: Pose) -> MassProperties:
    """Return mass properties in the frame in which their own frame has a pose."""
    centre = plus(pose.origin, turned(pose.turn, inertia.centre))
    return MassProperties(inertia.mass, centre, turned_inertia(inertia.tensor, pose.turn))


def prepared(link: LinkPart, read: Parts) -> MassProperties:
    """Return the mass properties of a link; moments that are no larger than what rounding leaves of zero are zero."""
    inertia = without_rounding(link.mass_properties)
    joints = [rounded(joint.origin) for joint in read.joints if joint.parent == link.name]
    least = rounding(float(inertia.mass), rounded(inertia.centre), joints)
    if inertia.mass > 0 and max(map(abs, inertia.tensor)) <= least:
        return MassProperties(inertia.mass, inertia.centre, turned_inertia((0.0,) * 6, HERE.turn))
    return inertia


def _fault(inertia: MassProperties) -> str | None:
    """Return why no body has an inertia; None if a body may have it, or has no mass, or if the mass is the fault."""
    table = tables.body("", inertia)
    return impossible_tensor(np.array(table["inertia"]), table["mass"], zero_allowed=True) if table["mass"] > 0 else None


def sentence(faults: Sequence[tuple[str, str]], most: int) -> str:
    """Return a phrase that lists links with their faults. most: the number of links that it names."""
    listed = [f"{name} ({fault.removeprefix(NO_BODY).removesuffix(OTHER_SIGNS)})" for name, fault in faults[:most]]
    more = len(faults) - most
    return ", ".join(listed) + (f" and {more} more" if more > 0 else "")
