"""The rules by which joints follow other joints, in exact arithmetic: a joint may follow one that follows a third one."""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Mechanism, breadth_first


@dataclass(frozen=True)
class Rule:
    """The coordinate of a joint as multiplier * (coordinate of joint `leader`) + offset; `leader` moves by itself.

    leader: its index among the joints. A joint that moves by itself is its own leader, with the multiplier 1.
    """

    leader: int
    multiplier: Fraction
    offset: Fraction


def rule(joints: Sequence[Joint], index: int) -> Rule:
    """Return the rule of a joint, given by its index. Rules must not go round in a circle, which case files exclude."""
    multiplier, offset = Fraction(1), Fraction(0)
    while (mimic := joints[index].mimic) is not None:
        offset += multiplier * Fraction(mimic.offset)
        multiplier *= Fraction(mimic.multiplier)
        index = mimic.joint
    return Rule(index, multiplier, offset)


def start(joints: Sequence[Joint], index: int) -> tuple[Fraction, Fraction]:
    """Return the exact coordinate and velocity of a joint with one coordinate at t = 0 (rad or m; rad/s or m/s)."""
    of_joint = rule(joints, index)
    leader = joints[of_joint.leader]
    position, velocity = (Fraction(values[0]) if values else Fraction(0) for values in (leader.start, leader.start_velocity))
    return of_joint.multiplier * position + of_joint.offset, of_joint.multiplier * velocity


def roots(mechanism: Mechanism) -> dict[int, int]:
    """The first body of the tree of each body, by its index; `WORLD` for a body that does not move.

    A tree begins at a free body, at a free joint, or at a joint on the world. If a joint follows a joint of another tree, both
    trees are one.
    """
    first, joint_of = {WORLD: WORLD}, mechanism.joint_of
    for body in breadth_first(mechanism):
        joint = joint_of[body]
        above = WORLD if joint is None or joint.type == "free" else first[joint.parent]
        first[body] = above if above != WORLD or (joint is not None and joint.type == "fixed") else body
    for joint in mechanism.joints:
        if joint.mimic is not None:
            one, other = first[joint.child], first[mechanism.joints[joint.mimic.joint].child]
            first = {body: one if root == other else root for body, root in first.items()}
    return first
