"""The growth of an error along the smooth motion of trees, from nudged motions that heyoka follows together."""

import numpy as np

from bodycheck.reference.bounds import STATES
from bodycheck.reference.exact.numbers import FloatType
from bodycheck.reference.mechanisms.growth import LARGEST, NUDGE, STARTS, Growth, capped, scales
from bodycheck.reference.mechanisms.link_states import floating, sizes, split
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.mechanisms.recursion import joined
from bodycheck.reference.mechanisms.tree import Tree, forest
from bodycheck.reference.mechanisms.ways import Motion, apart, reach
from bodycheck.reference.trajectory import Array

#: The type in which growth is measured.
DOUBLES = FloatType(np.float64)


def growth_of_trees(mechanism: Mechanism, t: Array) -> tuple[Motion, Growth]:
    """The motion in double precision of a mechanism without loops and events, and the growth of an error along it.

    The largest speeds and rates, which are the sizes of nudges of velocities, are known only at the end. So coordinates are
    nudged apart from velocities, whose nudges have sizes that are known before; their deviations are proportional to these.

    t: (m,) ascending instants (s), the first of which is 0. Raises `Stopped` if the integration fails or takes too many steps.
    """
    from bodycheck.reference.mechanisms import tree_equations

    random, trees = np.random.default_rng(0), forest(mechanism).trees
    length, rate = reach(mechanism), _rate(mechanism, float(t[-1]))
    units = {"position_error": length, "velocity_error": length * rate, "angular_velocity_error": rate}
    firsts = [int(np.searchsorted(t, begin * t[-1])) for begin in STARTS]
    followed = [tree_equations.beside(tree, t, *_nudges(tree, firsts, units, random)) for tree in trees]
    base = _motion(mechanism, t, [rows for rows, _, _ in followed])
    known = scales(mechanism, base, float(t[-1]))
    faster = max(known[name] / units[name] for name in ("velocity_error", "angular_velocity_error"))
    figures = {name: np.full(len(t), known[name]) for name in STATES}
    of_start = np.ones(len(t))
    for number in range(len(STARTS)):
        grown = dict.fromkeys(STATES, np.zeros(len(t)))
        for lane, weight in ((number, 1.0), *(((len(STARTS) + number - 1, faster),) if number else ())):
            factors = np.max([each[lane] for _, _, each in followed], axis=0, initial=0.0)
            states = [deviating(rows, off[lane], each[lane], factors) for rows, off, each in followed]
            differences = apart(mechanism, _motion(mechanism, t, states), base)
            grown = {name: grown[name] + weight * differences[name] * factors / NUDGE for name in STATES}
        figures = {name: np.maximum(figures[name], grown[name]) for name in STATES}
        if not number:
            of_start = np.maximum(of_start, grown["error"])
    return base, capped(t, figures, known, of_start)


def _rate(mechanism: Mechanism, duration: float) -> float:
    """A rate (rad/s) of the order of those that gravity causes in a mechanism."""
    return max(float(np.sqrt(mechanism.gravity / reach(mechanism))), 1 / (duration or 1.0))


def _nudges(
    tree: Tree, firsts: list[int], units: dict[str, float], random: np.random.Generator
) -> tuple[list[tuple[int, Array]], Array]:
    """The nudges of a tree, and the sizes of the components of its states.

    The first nudge is one of angles alone; then come those of coordinates at the other instants, and those of velocities.
    """
    every, turned = (components(tree, units, turned_only=turned_only) for turned_only in (False, True))
    coordinates = components(tree, units | {"velocity_error": 0.0, "angular_velocity_error": 0.0}, turned_only=False)
    chosen = [turned, *[coordinates] * (len(firsts) - 1), *[every - coordinates] * (len(firsts) - 1)]
    signs = [random.choice([-1.0, 1.0], len(every)) for _ in chosen]
    return [
        (first, NUDGE * sign * nudge) for first, sign, nudge in zip([*firsts, *firsts[1:]], signs, chosen, strict=True)
    ], every


def _motion(mechanism: Mechanism, t: Array, rows: list[Array]) -> Motion:
    """The motion of a mechanism from the states (m, k) of its trees."""
    links = [split(tree, states, t, DOUBLES) for tree, states in zip(forest(mechanism).trees, rows, strict=True)]
    states = joined(mechanism, links, t, DOUBLES)
    return Motion(states.position, states.velocity, states.bodies)


def components(tree: Tree, units: dict[str, float], *, turned_only: bool) -> Array:
    """The sizes of the components of a state of links; zero for those that are not angles if these alone are nudged."""
    length, speed, rate = (
        0.0 if turned_only else units[name] for name in ("position_error", "velocity_error", "angular_velocity_error")
    )
    values: list[float] = []
    for link in tree.links:
        held, moving = sizes(link)
        slides = link.kind == "prismatic"
        values += [length if slides else 1.0] * held + [speed if slides else rate] * moving
    for _ in floating(tree.links):
        values += [length] * 3 + [speed] * 3
    return np.array(values)


def deviating(rows: Array, deviations: Array, factors: Array, common: Array) -> Array:
    """The states (m, k) of a motion that deviates from states (m, k), `rows`, with deviations in units of common factors (m,).

    deviations: (m, k) in units of `factors` (m,).
    """
    share = np.divide(factors, common, out=np.zeros_like(common), where=common > 0)
    return np.asarray(rows + deviations * np.minimum(share, LARGEST)[:, None])
