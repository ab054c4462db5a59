"""Joining links that are welded together, as readers of robot models do."""

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from bodycheck.reference.robots.model import RobotJoint, RobotLink, RobotModel, Wide, from_the_root

#: The index of the link that carries a given link, and the origin (3,) and rotation (3, 3) of the given link in its frame.
_Place = tuple[int, Wide, Wide]


def fused(model: RobotModel, kept: Collection[str]) -> RobotModel:
    """The model without the links on fixed joints, except those in `kept`; the carriers of these links take over their masses.

    The carrier of a link is its nearest ancestor that is the root, is kept, or moves against its parent. The root carries
    everything that is welded to the world.

    Parameters
    ----------
    model
        The model.
    kept
        The names of links on fixed joints that remain separate links.

    Raises
    ------
    ValueError
        If the joints do not form a tree.
    """
    places: dict[int, _Place] = {model.root: _own(model.root)}
    for joint in from_the_root(model):
        if joint.type != "fixed" or model.links[joint.child].name in kept:
            places[joint.child] = _own(joint.child)
        else:
            places[joint.child] = _carried(places[joint.parent], joint)
    staying = [index for index in range(len(model.links)) if places[index][0] == index]
    parts: dict[int, list[RobotLink]] = {index: [] for index in staying}
    for index, link in enumerate(model.links):
        carrier, origin, rotation = places[index]
        parts[carrier].append(link if carrier == index else in_frame(link, origin, rotation))
    new = {old: index for index, old in enumerate(staying)}
    links = tuple(replace(joined(parts[index]), name=model.links[index].name) for index in staying)
    joints = tuple(_hung(joint, places[joint.parent], new) for joint in model.joints if joint.child in new)
    return replace(model, links=links, joints=joints)


def in_frame(link: RobotLink, origin: Wide, rotation: Wide) -> RobotLink:
    """A link expressed in another frame, in which the link's present frame has an origin (3,) and a rotation (3, 3)."""
    centre, tensor = origin + rotation @ link.center_of_mass, rotation @ link.inertia @ rotation.T
    return replace(link, center_of_mass=centre, inertia=tensor)


def joined(parts: Sequence[RobotLink]) -> RobotLink:
    """The rigid link that combines several links, all given in the same frame, by the parallel-axis theorem.

    It has the name of the first link. If the masses sum to zero, there is no centre of mass, and the inertia is about the
    origin of the frame.
    """
    first, *others = parts
    if not others:
        return first
    mass = sum(part.mass for part in parts)
    with np.errstate(invalid="ignore"):  # a mass in the file may be infinite
        moment = sum((part.mass * part.center_of_mass for part in parts), np.zeros(3, np.longdouble))
        centre = moment / np.longdouble(mass) if mass else np.zeros(3, np.longdouble)
        tensor = sum((_about(part, centre) for part in parts), np.zeros((3, 3), np.longdouble))
    return RobotLink(first.name, mass, centre, tensor)


def _own(index: int) -> _Place:
    return index, np.zeros(3, np.longdouble), np.eye(3, dtype=np.longdouble)


def _carried(parent: _Place, joint: RobotJoint) -> _Place:
    """Return the frame of a joint relative to the carrier of its parent. parent: the place of the joint's parent."""
    carrier, origin, rotation = parent
    return carrier, origin + rotation @ joint.position, rotation @ joint.rotation


def _hung(joint: RobotJoint, parent: _Place, new: dict[int, int]) -> RobotJoint:
    """A joint, attached to the carrier of its parent. new: the new indices of the links that stay, by their old indices."""
    carrier, origin, rotation = _carried(parent, joint)
    return replace(joint, parent=new[carrier], child=new[joint.child], position=origin, rotation=rotation)


def _about(part: RobotLink, point: Wide) -> Wide:
    """The inertia of a link about a point (3,)."""
    arm = part.center_of_mass - point
    return np.asarray(part.inertia + part.mass * (arm @ arm * np.eye(3, dtype=np.longdouble) - np.outer(arm, arm)))
