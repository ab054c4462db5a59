"""The growth of an error along the motion of a mechanism with controllers or stops, from the nudged motions of its trees."""

import numpy as np

from bodycheck.reference.bounds import STATES
from bodycheck.reference.exact.numbers import FloatType
from bodycheck.reference.mechanisms.articulation.nudges import components, deviating
from bodycheck.reference.mechanisms.growth import NUDGE, STARTS, Growth, capped, scales
from bodycheck.reference.mechanisms.hybrid.following import beside
from bodycheck.reference.mechanisms.hybrid.shadows import Shadow
from bodycheck.reference.mechanisms.link_states import LinkStates, floating, sizes, split
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.mechanisms.recursion import follow, joined
from bodycheck.reference.mechanisms.tree import Tree, forest
from bodycheck.reference.mechanisms.ways import Motion, apart
from bodycheck.reference.trajectory import Array

#: The type in which growth is measured.
DOUBLES = FloatType(np.float64)


def measured_growth(mechanism: Mechanism, t: Array) -> tuple[Motion, Growth]:
    """The motion of a mechanism in double precision, and the growth of an error, at ascending instants (m,), s, from 0 on."""
    states = follow(mechanism, t, np.float64)
    base = Motion(states.position, states.velocity, states.bodies)
    units, random = scales(mechanism, base, float(t[-1])), np.random.default_rng(0)
    trees = [_beside(tree, t, units, random) for tree in forest(mechanism).trees]
    figures, of_start = {name: np.full(len(t), units[name]) for name in STATES}, np.ones(len(t))
    for number in range(len(STARTS)):
        factors = np.max([shadows[number].factors for _, shadows in trees], axis=0)
        links = [
            _nudged(tree, t, rows, shadows[number], factors)
            for tree, (rows, shadows) in zip(forest(mechanism).trees, trees, strict=True)
        ]
        states = joined(mechanism, links, t, DOUBLES)
        differences = apart(mechanism, Motion(states.position, states.velocity, states.bodies), base)
        for name in STATES:
            figures[name] = np.maximum(figures[name], differences[name] * factors / NUDGE)
        if number == 0:
            of_start = np.maximum(of_start, differences["error"] * factors / NUDGE)
    return base, capped(t, figures, units, of_start)


def _beside(tree: Tree, t: Array, units: dict[str, float], random: np.random.Generator) -> tuple[Array, list[Shadow]]:
    """The states of a tree, and the nudged motions beside it: the first is nudged in its angles alone."""
    every, turned = (components(tree, units, turned_only=turned_only) for turned_only in (False, True))
    totals = sum(link.controller is not None and not link.controller.rate and bool(link.controller.ki) for link in tree.links)
    every, turned = np.append(every, np.full(totals, t[-1] or 1.0)), np.append(turned, np.zeros(totals))
    nudges = [
        (int(np.searchsorted(t, begin * t[-1])), random.choice([-1.0, 1.0], len(every)) * (every if number else turned))
        for number, begin in enumerate(STARTS)
    ]
    return beside(tree, t, nudges, every)


def _nudged(tree: Tree, t: Array, rows: Array, each: Shadow, factors: Array) -> list[LinkStates]:
    """The states of the links in a nudged motion whose deviations are in units of the factors (n,)."""
    count = sum(sum(sizes(link)) for link in tree.links) + 6 * len(floating(tree.links))
    return split(tree, deviating(rows, each.deviations, each.factors, factors)[:, :count], t, DOUBLES)
