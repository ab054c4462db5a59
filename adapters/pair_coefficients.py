"""Choose coefficients of bodies for engines that combine the coefficients of two bodies to that of their pair.

Scenes state the coefficients of pairs, which a product or a mean of those of bodies cannot always give. The pairs of
`[[scene.contacts]]` come first, then those of the plane and a body, then all others; a pair whose coefficient contradicts those
before it gets another one, which `differing` tells.
"""

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from bodycheck.adapters.touching import TouchingBody, laws
from bodycheck.reference.mechanisms.mechanism import WORLD, AnyScene

#: How an engine combines the coefficients of two bodies.
Combination = Literal["product", "mean", "harmonic mean", "smaller"]

#: The coefficients of pairs by the rules.
COMBINED: Mapping[Combination, Callable[[float, float], float]] = {
    "product": lambda a, b: a * b,
    "mean": lambda a, b: (a + b) / 2,
    "harmonic mean": lambda a, b: 2 * a * (b / (a + b)) if a and b else 0.0,
    "smaller": min,
}

#: The largest relative difference of two coefficients that count as equal. It is rounding in the solution of a few equations.
ROUNDING = 1e-9

#: Pairs of bodies by their indices, the lower one first, which may be `WORLD`, with their coefficients.
Pairs = Mapping[tuple[int, int], float]


def wanted(scene: AnyScene, count: int) -> tuple[Pairs, Pairs]:
    """Return the friction and the restitution of all pairs of `count` bodies and the plane.

    Those come first that have coefficients of their own in the scene.
    """
    usual, *others = laws(scene)
    special = {law.bodies: law for law in others}
    with_plane = [(WORLD, index) for index in range(count)]
    order = dict.fromkeys([*special, *with_plane, *itertools.combinations(range(count), 2)])
    chosen = {pair: special.get(pair, usual) for pair in order}
    return {pair: law.friction for pair, law in chosen.items()}, {pair: law.restitution for pair, law in chosen.items()}


def shared(pairs: Pairs, rule: Combination) -> dict[int, float]:
    """Return the coefficients of the plane, with the index `WORLD`, and of bodies.

    By a rule they give the first pairs that do not contradict. Rules of means are linear equations of logarithms, of
    coefficients, or of their reciprocals. A body whose pairs all have the coefficient zero has itself zero; other pairs with
    zero have neither logarithm nor reciprocal, and are left out.
    """
    indices = sorted({index for pair in pairs for index in pair})
    values = set(pairs.values())
    if len(values) == 1:
        (value,) = values
        return dict.fromkeys(indices, value**0.5 if rule == "product" else value)
    if rule == "smaller":
        return _smallest(pairs, indices)
    if rule == "mean":
        summands = _solved({pair: 2 * value for pair, value in pairs.items()})
        return {index: max(summand, 0.0) for index, summand in summands.items()}
    zero = {index for index in indices if not any(value for pair, value in pairs.items() if index in pair)}
    positive = {pair: value for pair, value in pairs.items() if value}
    if rule == "product":
        logarithms = _solved({pair: float(np.log(value)) for pair, value in positive.items()})
        return {index: 0.0 if index in zero else float(np.exp(logarithms[index])) for index in indices}
    halves = _solved({pair: 2 / value for pair, value in positive.items()})
    return {index: 0.0 if index in zero else 1 / halves[index] if halves[index] > 0 else np.inf for index in indices}


def differing(what: str, pairs: Pairs, arrived: Callable[[int, int], float], bodies: Sequence[TouchingBody]) -> list[str]:
    """Return, as noun phrases, the coefficients of pairs that differ from those of the scene.

    what: the name of the coefficient. arrived: the coefficient of a pair in the engine.
    """
    groups: dict[str, list[tuple[int, int]]] = {}
    for pair, value in pairs.items():
        if not np.isclose(given := arrived(*pair), value, rtol=ROUNDING, atol=0):
            groups.setdefault(f"{what} {given:.3g} instead of {value:.3g}", []).append(pair)
    return [f"{phrase} of {_named(group, bodies)}" for phrase, group in groups.items()]


def _named(pairs: Sequence[tuple[int, int]], bodies: Sequence[TouchingBody]) -> str:
    """Return the names of the first of some pairs, and the number of the others."""
    first, second = ("the plane" if index == WORLD else bodies[index].name for index in pairs[0])
    others = len(pairs) - 1
    return f"{first} and {second}" + (f" and of {others} other pair{'s' if others > 1 else ''}" if others else "")


@dataclass(frozen=True)
class Coefficients:
    """The coefficients of friction and of restitution of a body, or of the plane."""

    friction: float
    restitution: float


def coefficients(scene: AnyScene, count: int, rule: Combination) -> dict[int, Coefficients]:
    """Return the coefficients of the plane, with the index `WORLD`, and of each of the `count` bodies of a scene."""
    friction, restitution = (shared(pairs, rule) for pairs in wanted(scene, count))
    return {index: Coefficients(friction[index], restitution[index]) for index in (WORLD, *range(count))}


def differences(scene: AnyScene, bodies: Sequence[TouchingBody], rule: Combination, largest: float = np.inf) -> list[str]:
    """Return, as noun phrases, the coefficients of pairs that differ from those of the scene. largest: friction of a pair."""
    given, combined = coefficients(scene, len(bodies), rule), COMBINED[rule]
    friction, restitution = wanted(scene, len(bodies))
    return [
        *differing("friction", friction, lambda a, b: min(combined(given[a].friction, given[b].friction), largest), bodies),
        *differing("restitution", restitution, lambda a, b: combined(given[a].restitution, given[b].restitution), bodies),
    ]


def _smallest(pairs: Pairs, indices: Sequence[int]) -> dict[int, float]:
    """Return coefficients of bodies of which the smaller one is that of the pair: of each body the largest of its pairs.

    Only as many pairs count, from the first on, as do not contradict.
    """
    counted: dict[tuple[int, int], float] = {}
    chosen = dict.fromkeys(indices, 0.0)
    for pair, value in pairs.items():
        tried = counted | {pair: value}
        largest = {index: max((each for key, each in tried.items() if index in key), default=0.0) for index in indices}
        if all(min(largest[one], largest[other]) == each for (one, other), each in tried.items()):
            counted, chosen = tried, largest
    return chosen


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
