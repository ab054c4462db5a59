"""Choose coefficients of bodies for engines that combine the coefficients of two bodies to that of their pair.

Scenes state the coefficients of pairs, which a product or a mean of those of bodies cannot always give. The pairs of
`[[scene.contacts]]` come first, then those of the plane and a body, then all others; a pair whose coefficient contradicts those
before it gets another one, which `differing` tells.

Engines with compliant contacts have a dissipation in the place of a coefficient of restitution. The force of Hunt and Crossley
(J. Appl. Mech. 42, 1975) is f(x) (1 + d x') while it pushes, for the penetration x and the dissipation d; the part of its speed
that an impact returns depends on the speed.
"""

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from bodycheck.adapters.touching import TouchingBody, laws, plane_of
from bodycheck.reference import scene as shapes
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.mechanisms.mechanism import WORLD, AnyScene
from bodycheck.reference.scene import Shape
from bodycheck.reference.trajectory import Array

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

#: The least dissipation (s/m) of a pair with a coefficient of restitution.
LEAST_DISSIPATION = 1e-9

#: Pairs of bodies by their indices, the lower one first, which may be `WORLD`, with their coefficients.
Pairs = Mapping[tuple[int, int], float]


def wanted(scene: AnyScene, count: int) -> tuple[Pairs, Pairs]:
    """Return the friction and the restitution of all pairs of `count` bodies and the plane.

    Those come first that have coefficients of their own in the scene; without a plane, no others touch.
    """
    usual, *others = laws(scene)
    special = {law.bodies: law for law in others}
    if scene.plane is None:
        return {pair: law.friction for pair, law in special.items()}, {pair: law.restitution for pair, law in special.items()}
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
    """Return the coefficients of the plane, with the index `WORLD`, and of each of the `count` bodies of a scene.

    Those that touch nothing have zeros.
    """
    friction, restitution = (shared(pairs, rule) for pairs in wanted(scene, count))
    return {index: Coefficients(friction.get(index, 0.0), restitution.get(index, 0.0)) for index in (WORLD, *range(count))}


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


def impact_speed(one: int, other: int, parts: Sequence[TouchingBody], scene: AnyScene) -> float:
    """Return the speed (m/s) of the first impact of two bodies, given by their indices, of which one may be `WORLD`.

    On the plane it is that of the centre of mass after its first fall. That of two bodies is their relative speed at the start,
    or else that of the faster fall.
    """
    if WORLD not in (one, other):
        velocities = np.array([parts[index].start.velocity for index in (one, other)])
        if relative := float(np.linalg.norm(velocities[0] - velocities[1])):
            return relative
    return max(fall(parts[index], scene) for index in (one, other) if index != WORLD)


def fall(part: TouchingBody, scene: AnyScene) -> float:
    """Return the speed (m/s) along the normal with which a body first reaches the plane; zero for one that lies on it."""
    normal = np.array(plane_of(scene).normal)
    state = part.start
    along = rotate(np.array([1.0, -1.0, -1.0, -1.0]) * np.array(state.quaternion), normal)
    height = float(normal @ state.position) - extent(part.shape, along)
    squared = float(normal @ state.velocity) ** 2 + 2 * scene.gravity * float(normal[2]) * height
    # A body that lies on the plane is above it by rounding.
    return math.sqrt(squared) if height > 1e-9 and squared > 0 else 0.0


def extent(shape: Shape, direction: Array) -> float:
    """Return how far a body extends (m) from its centre along a direction in its frame."""
    match shape:
        case shapes.Brick(half):
            return float(np.abs(direction) @ half)
        case shapes.Ellipsoid(half):
            return float(np.linalg.norm(direction * half))
        case shapes.Cylinder(radius, half_length):
            return float(radius * np.hypot(direction[0], direction[1]) + half_length * abs(direction[2]))
        case _:
            return shape.radius


def dissipation(restitution: float, speed: float) -> float:
    """Return the dissipation d (s/m) with which a point that hits a plane at a speed (m/s) has a coefficient of restitution.

    The force f(x) (1 + d x'), multiplied by the velocity and divided by 1 + d x', is integrated: u - ln(1 + u) is the same
    before and after the impact, for u = d x'. The result depends neither on f nor on the mass.
    """
    from scipy.optimize import brentq  # takes longer to import than the rest of an adapter

    if restitution == 1:
        return LEAST_DISSIPATION

    def gap(u: float) -> float:
        return u - math.log1p(u) + restitution * u + math.log1p(-restitution * u)

    largest = (1 - 1e-15) / restitution
    if gap(largest) > 0:  # the rebound has its bound 1/d except for rounding
        return largest / speed
    return float(brentq(gap, 1e-3 * (1 - restitution), largest, xtol=1e-15)) / speed
