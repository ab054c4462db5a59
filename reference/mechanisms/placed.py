"""The states of bodies from coordinates and velocities of joints that are known, in the widest type of NumPy."""

import numpy as np

from bodycheck.reference.integration.rotation import WideArray
from bodycheck.reference.kinematics import conjugate, multiply, rotate
from bodycheck.reference.mechanisms import poses
from bodycheck.reference.mechanisms.coordinates import places
from bodycheck.reference.mechanisms.link_states import LinkStates
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.mechanisms.rounding import FloatType
from bodycheck.reference.mechanisms.tree import Forest, Link, forest
from bodycheck.reference.trajectory import Array, Trajectory


def bodies_of(mechanism: Mechanism, times: Array, position: WideArray, velocity: WideArray) -> Trajectory:
    """The states (b, n, ...) of the bodies of a mechanism without free bodies and free joints.

    times: (n,), s. position, velocity: (n, c) and (n, u), in the layout of `coordinates`.
    """
    found, kind, count = forest(mechanism), FloatType(np.longdouble), len(times)
    links = [
        poses.link_frames(tree, [_state(mechanism, found, link, position, velocity, kind) for link in tree.links], count, kind)
        for tree in found.trees
    ]
    return poses.bodies(mechanism, poses.body_frames(found, links, count, kind), times, kind)


def _state(
    mechanism: Mechanism, found: Forest, link: Link, position: WideArray, velocity: WideArray, kind: FloatType
) -> LinkStates:
    """The states of a link; of a ball along the axes of the link, which are not those of the joint and of its child."""
    held, moving = places(mechanism)[link.joint]
    if link.kind != "ball":
        own, rate = held.start + link.coordinate, moving.start + link.coordinate
        return LinkStates(position[:, own : own + 1], velocity[:, rate : rate + 1])
    child = found.anchors[mechanism.joints[link.joint].child].place
    socket, axes = (np.tile(kind.array(turn), (len(position), 1)) for turn in (link.socket.turn, child.turn))
    turned = multiply(multiply(socket, position[:, held]), conjugate(axes))
    return LinkStates(turned, rotate(axes, velocity[:, moving]))
