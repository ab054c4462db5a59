"""Choose coefficients of bodies for engines that combine the coefficients of two bodies to that of their pair.

Scenes state the coefficients of pairs. A product or a mean of the coefficients of bodies cannot give every table of pairs. The
pairs of `[[scene.contacts]]` come first, then the pairs of the plane and a body, then all others; a pair whose coefficient
contradicts those before it gets another one, which `differences` tells.
"""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from bodycheck.adapters.touching import TouchingBody, laws
from bodycheck.reference.mechanisms.mechanism import WORLD, AnyScene

#: How an engine combines the coefficients of two bodies.
Combination = Literal["product", "mean"]

#: The largest relative difference of two coefficients that count as equal. It is rounding in the solution of a few equations.
ROUNDING = 1e-9

#: Pairs of bodies by their indices, the lower one first, which may be `WORLD`, with their coefficients.
Pairs = Mapping[tuple[int, int], float]


@dataclass(frozen=True)
class Coefficients:
    """The coefficients of friction and of restitution of a body, or of the plane."""

    friction: float
    restitution: float


def coefficients(scene: AnyScene, count: int, rule: Combination) -> dict[int, Coefficients]:
    """Return the coefficients of the plane, with the index `WORLD`, and of each of the `count` bodies of a scene."""
    friction, restitution = (_shared(pairs, rule) for pairs in _wanted(scene, count))
    return {index: Coefficients(friction[index], restitution[index]) for index in (WORLD, *range(count))}


def differences(scene: AnyScene, bodies: Sequence[TouchingBody], rule: Combination, largest: float = np.inf) -> list[str]:
    """Return, as noun phrases, the coefficients of pairs that differ from those of the scene. largest: friction of a pair."""
    given = coefficients(scene, len(bodies), rule)
    groups: dict[str, list[tuple[int, int]]] = {}
    for kind, wanted in zip(("friction", "restitution"), _wanted(scene, len(bodies)), strict=True):
        most = largest if kind == "friction" else np.inf
        for pair, value in wanted.items():
            one, other = (float(getattr(given[index], kind)) for index in pair)
            arrived = min(one * other if rule == "product" else (one + other) / 2, most)
            if not np.isclose(arrived, value, rtol=ROUNDING, atol=0):
                groups.setdefault(f"{kind} {arrived:.3g} instead of {value:.3g}", []).append(pair)
    return [f"{phrase} of {_named(pairs, bodies)}" for phrase, pairs in groups.items()]


def _named(pairs: Sequence[tuple[int, int]], bodies: Sequence[TouchingBody]) -> str:
    """Return the names of the first of some pairs, and the number of the others."""
    first, second = ("the plane" if index == WORLD else bodies[index].name for index in pairs[0])
    others = len(pairs) - 1
    return f"{first} and {second}" + (f" and of {others} other pair{'s' if others > 1 else ''}" if others else "")


def _wanted(scene: AnyScene, count: int) -> tuple[Pairs, Pairs]:
    """Return the friction and the restitution of all pairs, those first that have coefficients of their own."""
    usual, *others = laws(scene)
    special = {law.bodies: law for law in others}
    with_plane = [(WORLD, index) for index in range(count)]
    order = dict.fromkeys([*special, *with_plane, *itertools.combinations(range(count), 2)])
    chosen = {pair: special.get(pair, usual) for pair in order}
    return {pair: law.friction for pair, law in chosen.items()}, {pair: law.restitution for pair, law in chosen.items()}


def _shared(pairs: Pairs, rule: Combination) -> dict[int, float]:
    """Return the coefficients of the plane and of bodies whose combinations give the first pairs that do not contradict.

    The logarithms of factors are summands, so that both rules are linear equations. A body whose pairs all have the coefficient
    zero has itself the factor zero; other pairs with the coefficient zero have no logarithm and are left out.
    """
    indices = sorted({index for pair in pairs for index in pair})
    values = set(pairs.values())
    if len(values) == 1:
        (value,) = values
        return dict.fromkeys(indices, value**0.5 if rule == "product" else value)
    if rule == "mean":
        summands = _solved({pair: 2 * value for pair, value in pairs.items()})
        return {index: max(summand, 0.0) for index, summand in summands.items()}
    zero = {index for index in indices if not any(value for pair, value in pairs.items() if index in pair)}
    logarithms = _solved({pair: float(np.log(value)) for pair, value in pairs.items() if value})
    return {index: 0.0 if index in zero else float(np.exp(logarithms[index])) for index in indices}


def _solved(sums: Pairs) -> dict[int, float]:
    """Return numbers of bodies, the nearest to zero, whose sums are those of the first pairs that do not contradict."""
    indices = sorted({index for pair in sums for index in pair})
    column = {index: number for number, index in enumerate(indices)}
    rows, right = np.zeros((0, len(indices))), np.zeros(0)
    solution = np.zeros(len(indices))
    for pair, value in sums.items():
        row = np.zeros(len(indices))
        row[[column[index] for index in pair]] = 1
        tried, wanted = np.vstack([rows, row]), np.append(right, value)
        candidate = np.linalg.lstsq(tried, wanted, rcond=None)[0]
        if np.allclose(tried @ candidate, wanted, rtol=0, atol=ROUNDING):
            solution = candidate
            if np.linalg.matrix_rank(tried) > len(rows):
                rows, right = tried, wanted
    return dict(zip(indices, solution.tolist(), strict=True))
