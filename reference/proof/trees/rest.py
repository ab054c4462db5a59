"""The rest of a tree that dry friction holds.

A tree at rest stays at rest if and only if no joint needs more effort to be held than its dry friction can give: the
accelerations are the one minimum of a strictly convex function, and it is at zero then. At the limit friction still holds.
"""

from dataclasses import replace

from bodycheck.reference.mechanisms.coordinates import places as layout
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.proof.balls import Ball, ball
from bodycheck.reference.proof.enclosure import NotEnclosed
from bodycheck.reference.proof.trees.dynamics import efforts
from bodycheck.reference.proof.trees.tree import Tree, as_number, tree_of


def held(mechanism: Mechanism) -> tuple[Tree, list[Ball], list[str]]:
    """Return a tree that dry friction holds at rest, its coordinates, and the names of the joints at the limit of friction.

    Raises `NotEnclosed` if the tree moves at first or later, or the precision of the context does not decide it.
    """
    tree = tree_of(replace(mechanism, joints=tuple(replace(joint, friction=0.0) for joint in mechanism.joints)))
    if any(link.kind == "ball" for link in tree.links):
        raise NotEnclosed("a ball joint beside dry friction")
    q = [value for link in tree.links for value in link.start]
    if not all(value.is_zero() for link in tree.links for value in link.velocity):
        raise NotEnclosed("dry friction in a tree that moves")
    needed = efforts(tree, q, [0] * tree.size, [0] * tree.size, [value.sin() for value in q], [value.cos() for value in q])
    at_limit = []
    for joint, (columns, _) in zip(mechanism.joints, layout(mechanism), strict=True):
        for column in range(columns.start, columns.stop):
            load, most = abs(as_number(needed[tree.columns.index(column)])), ball(joint.friction)
            if load > most:
                raise NotEnclosed(f"dry friction in a tree whose joint {joint.name} slips")
            if not load <= most:
                raise NotEnclosed(f"the joint {joint.name}, whose dry friction may be just enough to hold it")
            if load.is_exact() and most and load >= most:
                at_limit.append(joint.name)
    return tree, q, at_limit
