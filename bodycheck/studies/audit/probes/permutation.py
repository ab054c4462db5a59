"""The probe of permutations: whether a mechanism moves in the same way in whatever order its bodies and joints are given.

The mechanism is a tree of hinges about oblique axes: an arm on the world, two arms on this one, and an arm on one of these. The
lists of bodies and joints are given parents first, with every child before its parent, and in another order. A scheme that
solves its joints one after another may move otherwise, because the order belongs to its result.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, JointedBody, Mechanism
from bodycheck.reference.scene import Brick, Solid
from bodycheck.reference.trajectory import Array
from bodycheck.studies.audit.flights import Flight, NotFlown, Pilot
from bodycheck.studies.audit.probe import Finding, not_probed

_ARM = Solid(Brick((0.05, 0.04, 0.15)), 1.0)

#: The tree, with parents first.
TREE = Mechanism(
    tuple(JointedBody(name, replace(_ARM, position=(0.0, 0.0, -0.15))) for name in ("first", "second", "third", "fourth")),
    (
        Joint("a", "revolute", WORLD, 0, axis=(1.0, 0.5, 0.0), start=(0.4,), start_velocity=(1.0,)),
        Joint("b", "revolute", 0, 1, position=(0.0, 0.05, -0.3), axis=(0.0, 1.0, 0.3), start=(0.7,), start_velocity=(-2.0,)),
        Joint("c", "revolute", 0, 2, position=(0.0, -0.05, -0.3), axis=(1.0, 0.0, 0.2), start=(-0.5,), start_velocity=(1.5,)),
        Joint("d", "revolute", 1, 3, position=(0.0, 0.0, -0.3), axis=(0.6, 0.8, 0.0), start=(0.3,), start_velocity=(2.0,)),
    ),
    gravity=9.81,
)

#: The orders of the bodies and of the joints, by words.
ORDERS: Mapping[str, tuple[Sequence[int], Sequence[int]]] = {
    "bodies listed child before parent": ((3, 2, 1, 0), (0, 1, 2, 3)),
    "joints listed child before parent": ((0, 1, 2, 3), (3, 2, 1, 0)),
    "bodies and joints in another order": ((2, 0, 3, 1), (1, 3, 0, 2)),
}

#: The number of steps.
STEPS = 64

#: The largest difference in a step that rounding can explain, in units of roundoff, of components of the size of 1 to 10.
ROUNDINGS_A_STEP = 64


def permutation(pilot: Pilot) -> tuple[Finding, ...]:
    """Return findings about the property order-of-bodies, one for each of `ORDERS`.

    The value is the largest difference of a component of a state, in m, m/s, rad/s or without unit, within `STEPS` steps.
    """
    plain = pilot.fly(_flight(pilot, TREE))
    if isinstance(plain, NotFlown):
        return not_probed("permutation", plain.reason, "order-of-bodies")
    if not np.isfinite(plain.states).all():
        return not_probed("permutation", "its states are not numbers", "order-of-bodies")
    return tuple(_finding(pilot, words, plain.states, *orders) for words, orders in ORDERS.items())


def _finding(pilot: Pilot, words: str, plain: Array, bodies: Sequence[int], joints: Sequence[int]) -> Finding:
    flown = pilot.fly(_flight(pilot, permuted(TREE, bodies, joints)))
    if isinstance(flown, NotFlown):
        return not_probed(f"permutation: {words}", flown.reason, "order-of-bodies")[0]
    difference = float(np.abs(flown.states - plain[:, list(bodies)]).max())
    differs = not difference <= ROUNDINGS_A_STEP * pilot.roundoff * STEPS
    value = difference if np.isfinite(difference) else None
    return Finding("order-of-bodies", f"permutation: {words}", "found" if differs else "none", value, "", "0")


def _flight(pilot: Pilot, mechanism: Mechanism) -> Flight:
    return Flight(mechanism, pilot.timestep, (STEPS // 4,) * 4)


def permuted(mechanism: Mechanism, bodies: Sequence[int], joints: Sequence[int]) -> Mechanism:
    """Return a mechanism whose bodies and joints are listed in another order. The mechanism has no loops, contacts or pushes.

    bodies, joints: the indices in the given mechanism, in the new order.
    """
    new_index = {WORLD: WORLD} | {former: index for index, former in enumerate(bodies)}
    reordered = (mechanism.joints[index] for index in joints)
    return replace(
        mechanism,
        bodies=tuple(mechanism.bodies[index] for index in bodies),
        joints=tuple(replace(joint, parent=new_index[joint.parent], child=new_index[joint.child]) for joint in reordered),
    )
