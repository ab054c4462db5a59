"""Motions of the links of a tree, in any floating-point type, and the motions of joints and bodies that follow from them."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from bodycheck.reference.exact.numbers import MP, FloatType, Quaternion4, Vector3, WideArray, vector
from bodycheck.reference.kinematics import conjugate, cross, multiply, normalise, rotate
from bodycheck.reference.mechanisms import exact
from bodycheck.reference.mechanisms.coordinates import COORDINATES, VELOCITIES, places
from bodycheck.reference.mechanisms.frames import Place
from bodycheck.reference.mechanisms.link_states import LinkStates
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, JointedBody, Mechanism
from bodycheck.reference.mechanisms.tree import STILL, Anchor, Forest, Link, Tree, forest
from bodycheck.reference.trajectory import Array, Trajectory


@dataclass(frozen=True, eq=False)
class Frames:
    """The motion of a frame at n instants.

    turn: (n, 4) unit quaternions from its axes to the axes of the world. origin, velocity: (n, 3) position (m) and velocity
    (m/s) of its origin, world. spin: (n, 3) its angular velocity along its own axes (rad/s).
    """

    turn: WideArray
    origin: WideArray
    velocity: WideArray
    spin: WideArray

    def moved(self, turn: WideArray, shift: WideArray, velocity: WideArray | None, spin: WideArray | None) -> "Frames":
        """The motion in the world of a frame that moves relative to this frame.

        turn: (n, 4) quaternions from its axes to the axes of this frame. shift, velocity: (n, 3) position and velocity of its
        origin relative to this frame, along the axes of this frame. spin: (n, 3) its relative angular velocity, along its own
        axes. None means zero.
        """
        arm = rotate(self.turn, shift)
        swung = self.velocity + cross(rotate(self.turn, self.spin), arm)
        carried = rotate(conjugate(turn), self.spin)
        return Frames(
            multiply(self.turn, turn),
            self.origin + arm,
            swung if velocity is None else swung + rotate(self.turn, velocity),
            carried if spin is None else carried + spin,
        )

    def carried(self, pose: Place, kind: FloatType) -> "Frames":
        """The motion in the world of a frame that is fixed in this frame, at `pose`."""
        turn, shift = _spread(pose.turn, len(self.turn), kind), _spread(pose.origin, len(self.turn), kind)
        return self.moved(turn, shift, None, None)


def resting(pose: Place, count: int, kind: FloatType) -> Frames:
    """A frame at rest in the world, at `pose`, for `count` instants."""
    zeros = _spread((MP.mpf(0),) * 3, count, kind)
    return Frames(_spread(pose.turn, count, kind), _spread(pose.origin, count, kind), zeros, zeros)


def link_frames(tree: Tree, states: list[LinkStates], count: int, kind: FloatType) -> list[Frames]:
    """The motions of the frames of all links of a tree."""
    base, frames = resting(tree.base, count, kind), list[Frames]()
    for link, state in zip(tree.links, states, strict=True):
        parent = base if link.parent == STILL else frames[link.parent]
        frames.append(_link_frame(link, state, parent.carried(link.before, kind)))
    return frames


def _link_frame(link: Link, state: LinkStates, before: Frames) -> Frames:
    zero = np.zeros_like(before.spin)
    if link.kind == "prismatic":
        shift, velocity = zero.copy(), zero.copy()
        shift[:, 2], velocity[:, 2] = state.coordinates[:, 0], state.rates[:, 0]
        still = np.zeros_like(before.turn)
        still[:, 0] = still[:, 0] + 1
        return before.moved(still, shift, velocity, None)
    if link.kind == "revolute":
        turn, spin = np.zeros_like(before.turn), zero.copy()
        half = state.coordinates[:, 0] / 2
        turn[:, 0], turn[:, 3], spin[:, 2] = np.cos(half), np.sin(half), state.rates[:, 0]
        return before.moved(turn, zero, None, spin)
    turn = normalise(state.coordinates)
    if state.origin is None or state.velocity is None:
        return before.moved(turn, zero, None, state.rates)
    return Frames(turn, state.origin, state.velocity, state.rates)


def body_frames(forest: Forest, frames: list[list[Frames]], count: int, kind: FloatType) -> list[Frames]:
    """The motions of the frames of all bodies."""
    return [_anchored(anchor, frames, count, kind) for anchor in forest.anchors]


def _anchored(anchor: Anchor, frames: list[list[Frames]], count: int, kind: FloatType) -> Frames:
    if anchor.tree < 0:
        return resting(anchor.pose, count, kind)
    return frames[anchor.tree][anchor.link].carried(anchor.pose, kind)


def bodies(mechanism: Mechanism, frames: list[Frames], times: WideArray, kind: FloatType) -> Trajectory:
    """The states of all bodies, arrays (b, n, ...), in the floating-point type."""
    centres = [centred(body, frame, kind) for body, frame in zip(mechanism.bodies, frames, strict=True)]
    return Trajectory(
        times,
        np.stack([frame.origin for frame in centres]),
        np.stack([normalise(frame.turn) for frame in centres]),
        np.stack([frame.velocity for frame in centres]),
        np.stack([frame.spin for frame in centres]),
    )


def centred(body: JointedBody, frame: Frames, kind: FloatType) -> Frames:
    """The motion of the frame at the centre of mass of a body from that of the body's frame."""
    return frame.carried(Place(origin=exact.inertia(body).centre), kind)


def bodies_of(mechanism: Mechanism, times: Array, position: WideArray, velocity: WideArray) -> Trajectory:
    """The states (b, n, ...) of the bodies of a mechanism without free bodies and free joints.

    times: (n,), s. position, velocity: (n, c) and (n, u), in the layout of `coordinates`.
    """
    whole, kind, count = forest(mechanism), FloatType(np.longdouble), len(times)
    links = [
        link_frames(tree, [_state_of(mechanism, whole, link, position, velocity, kind) for link in tree.links], count, kind)
        for tree in whole.trees
    ]
    return bodies(mechanism, body_frames(whole, links, count, kind), times, kind)


def _state_of(
    mechanism: Mechanism, whole: Forest, link: Link, position: WideArray, velocity: WideArray, kind: FloatType
) -> LinkStates:
    """The states of a link; for a ball, along the axes of the link, which differ from the axes of the joint and the child."""
    held, moving = places(mechanism)[link.joint]
    if link.kind != "ball":
        column, rate = held.start + link.coordinate, moving.start + link.coordinate
        return LinkStates(position[:, column : column + 1], velocity[:, rate : rate + 1])
    child = whole.anchors[mechanism.joints[link.joint].child].pose
    socket, axes = (np.tile(kind.array(turn), (len(position), 1)) for turn in (link.socket.turn, child.turn))
    turned = multiply(multiply(socket, position[:, held]), conjugate(axes))
    return LinkStates(turned, rotate(axes, velocity[:, moving]))


def joints(
    mechanism: Mechanism, forest: Forest, states: list[list[LinkStates]], frames: list[Frames], count: int, kind: FloatType
) -> tuple[WideArray, WideArray]:
    """The coordinates (n, c) and velocities (n, u) of all joints, in the layout of `coordinates`."""
    zero = kind.number(MP.mpf(0))
    position = np.full((count, sum(COORDINATES[joint.type] for joint in mechanism.joints)), zero)
    velocity = np.full((count, sum(VELOCITIES[joint.type] for joint in mechanism.joints)), zero)
    layout = places(mechanism)
    for tree, tree_states in zip(forest.trees, states, strict=True):
        for link, state in zip(tree.links, tree_states, strict=True):
            if link.joint < 0:
                continue
            held, moving = layout[link.joint]
            joint = mechanism.joints[link.joint]
            if link.kind == "ball":
                position[:, held], velocity[:, moving] = _ball(link, state, forest.anchors[joint.child].pose, kind)
            elif link.kind == "free":
                position[:, held], velocity[:, moving] = _free(joint, frames, count, kind)
            else:
                position[:, held.start + link.coordinate] = state.coordinates[:, 0]
                velocity[:, moving.start + link.coordinate] = state.rates[:, 0]
    return position, velocity


def _ball(link: Link, state: LinkStates, child: Place, kind: FloatType) -> tuple[WideArray, WideArray]:
    """The quaternions (n, 4) of a ball from child to joint frame, and its angular velocities (n, 3) in the child's frame."""
    count = len(state.rates)
    socket, child_turn = _spread(link.socket.turn, count, kind), _spread(child.turn, count, kind)
    turn = multiply(multiply(conjugate(socket), normalise(state.coordinates)), child_turn)
    return normalise(turn), rotate(conjugate(child_turn), state.rates)


def _free(joint: Joint, frames: list[Frames], count: int, kind: FloatType) -> tuple[WideArray, WideArray]:
    """The coordinates (n, 7) and velocities (n, 6) of a free joint from the frames of all bodies."""
    child = frames[joint.child]
    parent = resting(Place(), count, kind) if joint.parent == WORLD else frames[joint.parent]
    seen = parent.carried(Place(exact.turn(joint.attitude), vector(joint.position)), kind)
    back = conjugate(seen.turn)
    origin, turn = rotate(back, child.origin - seen.origin), normalise(multiply(back, child.turn))
    linear = rotate(back, child.velocity - seen.velocity) - cross(seen.spin, origin)
    spin = child.spin - rotate(conjugate(turn), seen.spin)
    return np.concatenate([origin, turn], axis=1), np.concatenate([linear, spin], axis=1)


def _spread(values: Quaternion4 | Vector3, count: int, kind: FloatType) -> WideArray:
    """The numbers (k,), repeated for `count` instants (count, k)."""
    rounded: Any = kind.array(values)
    return np.tile(rounded, (count, 1))
