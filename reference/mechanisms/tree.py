"""A mechanism as trees of links on elementary joints, in exact arithmetic.

A tree consists of the links that are connected by joints with at least one coordinate, other than through the world, which does
not move, and other than by free joints, which transmit no force. Two trees are one if a joint of one follows a joint of the
other. So trees do not influence one another. A body on a fixed joint is part of the link that it is fixed to; a universal joint
is two elementary joints and a planar joint is three, with massless links between them.

Each link has a frame. For a revolute or prismatic joint, z of this frame is the joint's axis and its origin lies on the axis;
if the axis of the parent is parallel, the origin has the same z as the parent's origin. For a ball the origin is its centre,
for a free link it is the centre of mass, and the axes are the principal axes about the origin. The base frame, which does not
move, is the frame of the first joint. So the links do not depend on the choice of frames in the file, and many of their numbers
are zero, so that the equations omit these terms.
"""

import functools
from collections.abc import Sequence
from dataclasses import dataclass, replace

from bodycheck.reference.exact.axes import principal_axes
from bodycheck.reference.exact.inertia import MassProperties
from bodycheck.reference.exact.numbers import MP, Real, Vector3, real, vector
from bodycheck.reference.exact.rotations import IDENTITY, ORIGIN, conjugate, matrix, multiply, scaled, unit
from bodycheck.reference.mechanisms import exact, mimicry
from bodycheck.reference.mechanisms.articulation.articulated import Constants, Kind
from bodycheck.reference.mechanisms.control import Controller, Stops
from bodycheck.reference.mechanisms.frames import (
    Moving,
    Place,
    about_origin,
    cleaned,
    frame_of,
    fused,
    onto,
    placed,
    rotated,
)
from bodycheck.reference.mechanisms.joint_types import MotionKind
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, JointedBody, Mechanism, breadth_first

_AXES = {"x": vector((1, 0, 0)), "y": vector((0, 1, 0)), "z": vector((0, 0, 1))}

#: The kinds of links on the elementary motions of joints.
_KINDS: dict[MotionKind, Kind] = {"turn": "revolute", "slide": "prismatic", "ball": "ball"}

#: The index that denotes the base, which does not move, as the parent of a link.
STILL = -1


@dataclass(frozen=True, eq=False)
class Link:
    """A link of a tree.

    Attributes
    ----------
    kind, parent
        The kind of its joint, and the index of its parent in the tree or `STILL`.
    follows
        The index of the link whose coordinate determines that of this link; None for a link that moves by itself.
    controller, stops
        The controller and the stops of its joint; None if it has none.
    constants, friction
        Its exact constants, and the dry friction of its joint (N m or N).
    joint, coordinate
        The index of the joint in the mechanism, -1 for a body without a joint; and the index of the link's coordinate among the
        coordinates of this joint.
    before
        The frame of this link in the frame of its parent if its coordinates are zero; for a ball, it has the parent's axes.
    socket
        The frame of the mechanism's joint in the frame of the parent.
    coordinates, rates
        The initial state, as in `articulated.Link`.
    start
        The motion of the frame of the link at t = 0.
    """

    kind: Kind
    parent: int
    constants: Constants
    friction: Real
    joint: int
    coordinate: int
    before: Place
    socket: Place
    coordinates: tuple[Real, ...]
    rates: tuple[Real, ...]
    start: Moving
    follows: int | None = None
    controller: Controller | None = None
    stops: Stops | None = None


@dataclass(frozen=True, eq=False)
class Tree:
    """Links, each after its parent, and the base on which they stand, which does not move.

    base: the place of the base frame in the world. gravity: (3,) gravitational acceleration along the axes of the base (m/s^2);
    zero for a tree that stands on free links alone, since these are followed relative to their free fall. fall: (3,)
    gravitational acceleration along the axes of the world (m/s^2). stops_until: as in `Mechanism`.
    """

    links: tuple[Link, ...]
    base: Place
    gravity: Vector3
    fall: Vector3
    stops_until: float | None = None


@dataclass(frozen=True, eq=False)
class Anchor:
    """The place of a body: the index of its tree (-1 if the body does not move), of its link, and its frame in the link's."""

    tree: int
    link: int
    pose: Place


@dataclass(frozen=True, eq=False)
class Forest:
    """The trees of a mechanism, and the anchor of each body."""

    trees: tuple[Tree, ...]
    anchors: tuple[Anchor, ...]


@dataclass(frozen=True, eq=False)
class _Draft:
    """A forest under construction.

    trees, bases: the links and the base of each tree. anchors: of the bodies added so far. roots: the root of each body, and
    indices: the index of the tree of each root (see `mimicry.roots`).
    """

    mechanism: Mechanism
    trees: list[list[Link]]
    bases: list[Place]
    anchors: dict[int, Anchor]
    roots: dict[int, int]
    indices: dict[int, int]

    def tree_of(self, body: int, base: Place) -> int:
        """The index of the tree to which a body belongs whose joint is on the world. base: of the tree, if it is a new one."""
        index = self.indices.setdefault(self.roots[body], len(self.trees))
        if index == len(self.trees):
            self.trees.append([])
            self.bases.append(base)
        return index

    def moving(self, anchor: Anchor) -> Moving:
        """The motion of a body's frame at t = 0."""
        if anchor.tree < 0:
            return Moving(anchor.pose)
        return self.trees[anchor.tree][anchor.link].start.carried(anchor.pose)


@functools.lru_cache(maxsize=64)
def forest(mechanism: Mechanism) -> Forest:
    """The trees of a mechanism."""
    draft = _Draft(mechanism, [], [], {WORLD: Anchor(-1, -1, Place())}, mimicry.roots(mechanism), {})
    joints = {joint.child: (index, joint) for index, joint in enumerate(mechanism.joints)}
    for body in breadth_first(mechanism):
        index, joint = joints.get(body, (-1, None))
        if joint is not None and joint.type == "fixed":
            parent = draft.anchors[joint.parent]
            draft.anchors[body] = Anchor(parent.tree, parent.link, parent.pose.then(frame_of(joint)))
        elif joint is None or joint.type == "free":
            _add_free(draft, body, index, joint)
        else:
            _add_jointed(draft, body, index, joint)
    down = vector((0, 0, -mechanism.gravity))
    trees = tuple(
        Tree(_completed(mechanism, links), base, _gravity(links, base, down), down, mechanism.stops_until)
        for links, base in zip(draft.trees, draft.bases, strict=True)
    )
    return Forest(trees, tuple(draft.anchors[body] for body in range(len(mechanism.bodies))))


def _completed(mechanism: Mechanism, links: Sequence[Link]) -> tuple[Link, ...]:
    """The links of a tree, with controllers, stops, and the indices of the links that they follow."""
    controllers = {controller.joint: controller for controller in mechanism.controllers}
    indices = {link.joint: index for index, link in enumerate(links)}

    def follows(joint: int) -> int | None:
        return indices[mimicry.rule(mechanism.joints, joint).leader] if joint >= 0 and mechanism.joints[joint].mimic else None

    def completed(link: Link) -> Link:
        stops = mechanism.joints[link.joint].stops if link.joint >= 0 else None
        return replace(link, follows=follows(link.joint), controller=controllers.get(link.joint), stops=stops)

    return tuple(completed(link) for link in links)


def _gravity(links: Sequence[Link], base: Place, down: Vector3) -> Vector3:
    if all(link.kind == "free" for link in links if link.parent == STILL):
        return ORIGIN
    return vector(cleaned(rotated(conjugate(base.turn), down), abs(down[2])))


def _add_free(draft: _Draft, body: int, joint_index: int, joint: Joint | None) -> None:
    """Add a tree that begins with a free body, or with a body on a free joint."""
    properties = fused(draft.mechanism, body)
    moments, axes = principal_axes(properties.tensor)
    centred_frame = Place(axes, properties.centre)
    if joint is None:
        socket, start = Place(), _body_start(draft.mechanism.bodies[body])
    else:
        parent, socket = draft.moving(draft.anchors[joint.parent]), frame_of(joint)
        x, y, z, *turn = (MP.mpf(value) for value in joint.start)
        w, i, j, k = turn
        inner = Place(unit((w, i, j, k)), (x, y, z))
        velocity, spin = vector(joint.start_velocity[:3]), vector(joint.start_velocity[3:])
        start = parent.carried(socket).moved(inner, velocity, spin)
    centred = start.carried(centred_frame)
    tensor = (*moments, *ORIGIN)
    constants = _constants(Place(), MassProperties(properties.mass, ORIGIN, tensor))
    link = Link(
        kind="free",
        parent=STILL,
        constants=constants,
        friction=MP.mpf(0),
        joint=joint_index,
        coordinate=0,
        before=Place(),
        socket=socket,
        coordinates=centred.pose.turn,
        rates=centred.spin,
        start=centred,
    )
    tree = draft.tree_of(body, Place())
    draft.anchors[body] = Anchor(tree, len(draft.trees[tree]), centred_frame.inverse())
    draft.trees[tree].append(link)


def _body_start(body: JointedBody) -> Moving:
    """The motion at t = 0 of the frame of a body without a joint."""
    begin = body.start
    assert begin is not None, "a body without a joint has an initial state"
    turn, spin = exact.turn(begin.attitude), exact.rates(begin.attitude, begin.rotation)
    at_centre = Moving(Place(turn, vector(begin.position)), vector(begin.velocity), spin)
    return at_centre.carried(Place(origin=scaled(MP.mpf(-1), exact.inertia(body).centre)))


def _add_jointed(draft: _Draft, body: int, joint_index: int, joint: Joint) -> None:
    """Add the links of a joint that transmits forces."""
    anchor = draft.anchors[joint.parent]
    tree, parent, socket = anchor.tree, anchor.link, anchor.pose.then(frame_of(joint))
    if tree < 0:
        tree, parent = draft.tree_of(body, _base(joint, socket)), STILL
        socket = draft.bases[tree].inverse().then(socket)
    links, properties = draft.trees[tree], fused(draft.mechanism, body)
    below = Moving(draft.bases[tree]) if parent == STILL else links[parent].start
    if joint.type == "spherical":
        links.append(_ball(joint, joint_index, parent, socket, properties, below))
        draft.anchors[body] = Anchor(tree, len(links) - 1, Place(conjugate(_principal(properties))))
        return
    axes, begin = _axes(joint), _start(draft.mechanism, joint_index)
    rule = None if joint.mimic is None else mimicry.rule(draft.mechanism.joints, joint_index)
    for coordinate, (kind, axis) in enumerate(axes):
        parallel = parent == STILL or (links[parent].kind != "ball" and links[parent].kind != "free")
        before = _before(kind, socket, rotated(socket.turn, axis), parallel)
        after = before.inverse().then(socket)
        last = coordinate == len(axes) - 1
        link_properties = placed(properties, after) if last else None
        constants = _constants(before, link_properties, joint, rule)
        link = _single(joint, joint_index, coordinate, kind, parent, before, socket, constants, below, begin[coordinate])
        links.append(link)
        parent, socket, below = len(links) - 1, after, link.start
    draft.anchors[body] = Anchor(tree, parent, socket)


def _start(mechanism: Mechanism, index: int) -> list[tuple[Real, Real]]:
    """The coordinates of a joint that is made up of slides and turns, and their velocities, at t = 0."""
    joint = mechanism.joints[index]
    if joint.mimic is None:
        zeros = (0.0,) * len(joint.form.motions)
        return [(MP.mpf(q), MP.mpf(v)) for q, v in zip(joint.start or zeros, joint.start_velocity or zeros, strict=True)]
    q, v = mimicry.start(mechanism.joints, index)
    return [(real(q), real(v))]


def _axes(joint: Joint) -> list[tuple[Kind, Vector3]]:
    """The kinds of the slides and turns that make up a joint, each with its axis in the frame of the joint."""
    motions = joint.form.motions
    return [(_KINDS[each.kind], exact.unit_axis(joint) if each.axis == "given" else _AXES[each.axis]) for each in motions]


def _base(joint: Joint, socket: Place) -> Place:
    """The base frame of a tree whose first joint is on the world. socket: the frame of this joint in the world."""
    if joint.type == "spherical":
        return Place(origin=socket.origin)
    return Place(onto(rotated(socket.turn, _axes(joint)[0][1])), socket.origin)


def _before(kind: Kind, socket: Place, axis: Vector3, parallel: bool) -> Place:
    """The frame of a link with a revolute or prismatic joint, in the frame of its parent, if its coordinate is zero.

    socket: the frame of the mechanism's joint in the frame of the parent. axis: along the axes of the parent. parallel: whether
    the origin may be moved along an axis that is parallel to the parent's z.
    """
    turn, (x, y, z) = onto(axis), socket.origin
    return Place(turn, (x, y, MP.mpf(0)) if parallel and kind == "revolute" and turn == IDENTITY else (x, y, z))


def _single(
    joint: Joint,
    joint_index: int,
    coordinate: int,
    kind: Kind,
    parent: int,
    before: Place,
    socket: Place,
    constants: Constants,
    below: Moving,
    begin: tuple[Real, Real],
) -> Link:
    """The link of a revolute or prismatic joint. begin: its coordinate and velocity at t = 0."""
    q, v = begin
    cosine, sine = MP.cos_sin(q / 2)
    turning = kind == "revolute"
    inner = Place((cosine, MP.mpf(0), MP.mpf(0), sine)) if turning else Place(origin=scaled(q, _AXES["z"]))
    velocity, spin = (ORIGIN, scaled(v, _AXES["z"])) if turning else (scaled(v, _AXES["z"]), ORIGIN)
    return Link(
        kind=kind,
        parent=parent,
        constants=constants,
        friction=MP.mpf(joint.friction),
        joint=joint_index,
        coordinate=coordinate,
        before=before,
        socket=socket,
        coordinates=(q,),
        rates=(v,),
        start=below.carried(before).moved(inner, velocity, spin),
    )


def _ball(joint: Joint, joint_index: int, parent: int, socket: Place, properties: MassProperties, below: Moving) -> Link:
    """The link of a spherical joint. below: the motion of the parent's frame at t = 0."""
    axes, before = _principal(properties), Place(origin=socket.origin)
    w, x, y, z = (MP.mpf(value) for value in joint.start)
    turn = multiply(multiply(socket.turn, unit((w, x, y, z))), axes)
    spin = rotated(conjugate(axes), vector(joint.start_velocity))
    return Link(
        kind="ball",
        parent=parent,
        constants=_constants(before, placed(properties, Place(conjugate(axes))), joint),
        friction=MP.mpf(0),
        joint=joint_index,
        coordinate=0,
        before=before,
        socket=socket,
        coordinates=turn,
        rates=spin,
        start=below.carried(before).moved(Place(turn), ORIGIN, spin),
    )


def _principal(properties: MassProperties) -> tuple[Real, Real, Real, Real]:
    """The unit quaternion from the principal axes about the origin of a frame to the axes of the frame."""
    return principal_axes(about_origin(properties))[1]


def _constants(
    before: Place, properties: MassProperties | None, joint: Joint | None = None, rule: mimicry.Rule | None = None
) -> Constants:
    """The constants of a link from its place in its parent, its mass properties in its frame, and its joint.

    properties: None for a link without mass. rule: by which the joint follows another one.
    """
    properties = properties or MassProperties(MP.mpf(0), ORIGIN, (*ORIGIN, *ORIGIN))
    rows = [entry for row in matrix(before.turn) for entry in row]
    tensor = cleaned(about_origin(properties), sum(abs(part) for part in about_origin(properties)))
    xx, yy, zz, *_ = tensor
    reach = sum(abs(part) for part in properties.centre)
    armature, damping, stiffness, rest, effort = (
        (MP.mpf(0),) * 5
        if joint is None
        else (MP.mpf(value) for value in (joint.armature, joint.damping, joint.stiffness, joint.rest, joint.effort))
    )
    return Constants(
        turn=cleaned(rows, MP.mpf(1)),
        offset=cleaned(before.origin, sum(abs(part) for part in before.origin)),
        mass=properties.mass,
        moment=tuple(properties.mass * part for part in cleaned(properties.centre, reach)),
        tensor=tensor,
        differences=cleaned((zz - yy, xx - zz, yy - xx), abs(xx) + abs(yy) + abs(zz)),
        armature=armature,
        damping=damping,
        stiffness=stiffness,
        force=effort + stiffness * rest,
        ratio=MP.mpf(0) if rule is None else real(rule.multiplier),
        shift=MP.mpf(0) if rule is None else real(rule.offset),
        moves=MP.mpf(1),
    )
