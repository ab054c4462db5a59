"""The equations of motion of a tree as a system of first order, and the layout of its state, in any arithmetic.

The state has the coordinates and the rates of one link after another (see `articulated.Link`). For a free link that carries
other links, the last components of the state are the displacement (3,) and its derivative (3,), world, from the position that
the link would have if it moved with the velocity of the centre of mass of its tree, so that a long flight does not cost digits.
For a free body that carries nothing the displacement is zero, and the state does not have it.

The equations of quaternions conserve their norm, which changes by rounding only. So the matrices are formed without dividing
by the norm.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from bodycheck.reference.exact.numbers import MP, FloatType, Real, Vector3, WideArray
from bodycheck.reference.exact.rotations import ORIGIN, plus, scaled
from bodycheck.reference.mechanisms import articulated
from bodycheck.reference.mechanisms.articulated import Constants, Kind, Number, quaternion_rows
from bodycheck.reference.mechanisms.frames import Place
from bodycheck.reference.mechanisms.tree import Tree

#: The numbers of coordinates and of rates of each kind of link.
SIZES: dict[Kind, tuple[int, int]] = {"revolute": (1, 1), "prismatic": (1, 1), "ball": (4, 3), "free": (4, 3)}


@dataclass(frozen=True, eq=False)
class LinkStates:
    """The states of a link at n instants, in a floating-point type.

    coordinates: (n, 1) or (n, 4), and rates: (n, 1) or (n, 3), as in `articulated.Link`. origin, velocity: (n, 3) position (m)
    and velocity (m/s) of the origin of a free link, in the world; None for any other link.
    """

    coordinates: WideArray
    rates: WideArray
    origin: WideArray | None = None
    velocity: WideArray | None = None


@dataclass(frozen=True, eq=False)
class Change:
    """A change in which a joint with dry friction begins or ceases to slip.

    time: of the change (s), in the floating-point type of the motion. joint: its index in the mechanism. mode: of the joint
    from then on, 1 or -1 if it slips forwards or backwards, 0 if it sticks.
    """

    time: Any
    joint: int
    mode: int


@dataclass(frozen=True, eq=False)
class Decision:
    """A decision which of the joints at rest stick, from a state that is exact at t = 0, and later has errors.

    Attributes
    ----------
    tree
        The tree of the joints.
    time
        The time (s).
    state
        The state of the tree as it was computed, in numbers of a hundred digits.
    exact
        The indices of the components of the state that are exact, since their joints have not moved.
    modes
        The mode of each link with dry friction from then on, by its index.
    rest
        The indices of the links that were at rest.
    """

    tree: Tree
    time: float
    state: list[Real]
    exact: frozenset[int]
    modes: dict[int, int]
    rest: tuple[int, ...]


@dataclass(frozen=True, eq=False)
class Course:
    """The motion of a tree: the states of its links, and in order of time the changes of its joints with dry friction.

    decisions: which joints stick.
    """

    links: list[LinkStates]
    changes: tuple[Change, ...] = ()
    decisions: tuple[Decision, ...] = ()


@dataclass(frozen=True, eq=False)
class Form:
    """A tree in any arithmetic: the kind and the parent of each link, its constants, and gravity (3,) (see `Tree`)."""

    links: Sequence[tuple[Kind, int]]
    constants: Sequence[Constants]
    gravity: Sequence[Number]

    @property
    def floats(self) -> bool:
        """True if the first link is free and carries other links."""
        return self.links[0][0] == "free" and len(self.links) > 1


@dataclass(frozen=True, eq=False)
class Rates:
    """The derivative of a state, and the strain of each link's joint (see `articulated.Accelerations`)."""

    state: list[Number]
    strains: list[Number]


def derivatives(form: Form, state: Sequence[Number], functions: Any) -> Rates:
    """The derivative of a state. functions: a module or object with the functions `sin` and `cos` of the arithmetic."""
    links, first = [], 0
    for (kind, parent), constants in zip(form.links, form.constants, strict=True):
        middle, last = first + SIZES[kind][0], first + sum(SIZES[kind])
        links.append(articulated.Link(kind, parent, constants, state[first:middle], state[middle:last]))
        first = last
    rates: list[Number] = []
    solution = articulated.accelerations(links, form.gravity, functions)
    for link, accelerations in zip(links, solution.rates, strict=True):
        rates += [*_coordinate_rates(link), *accelerations[: len(link.rates)]]
    if form.floats:
        linear, rows = solution.rates[0][3:], quaternion_rows(links[0].coordinates)
        rates += [*state[first + 3 :], *(sum(a * b for a, b in zip(row, linear, strict=True)) for row in rows)]
    return Rates(rates, solution.strains)


def _coordinate_rates(link: articulated.Link) -> Sequence[Number]:
    """The derivatives of the coordinates of a link; for a quaternion q with angular velocity Omega, q Omega / 2."""
    if len(link.coordinates) == 1:
        return link.rates
    (w, i, j, k), (x, y, z) = link.coordinates, link.rates
    return [
        -(i * x + j * y + k * z) / 2,
        (w * x + j * z - k * y) / 2,
        (w * y + k * x - i * z) / 2,
        (w * z + i * y - j * x) / 2,
    ]


def in_arithmetic(tree: Tree, number: Callable[[Real], Number]) -> Form:
    """A tree in an arithmetic. Zeros are the integer 0, by which the recursion recognises terms that are absent.

    number: the function that converts a number of a hundred digits to the arithmetic.
    """
    links = [(link.kind, link.parent) for link in tree.links]
    constants = [_converted(link.constants, number) for link in tree.links]
    return Form(links, constants, [number(part) if part else 0 for part in tree.gravity])


def _converted(constants: Constants, number: Callable[[Real], Number]) -> Constants:
    values: dict[str, Any] = {}
    for field in fields(Constants):
        value = getattr(constants, field.name)
        several = isinstance(value, tuple)
        converted = [number(each) if each else 0 for each in (value if several else (value,))]
        values[field.name] = converted if several else converted[0]
    return Constants(**{**values, "moves": 1})


def places_of_rates(links: Sequence[tuple[Kind, int]]) -> list[int]:
    """The index of each link's first rate in a state. links: the kind and the parent of each link."""
    indices, first = [], 0
    for kind, _ in links:
        indices.append(first + SIZES[kind][0])
        first += sum(SIZES[kind])
    return indices


def start(tree: Tree) -> list[Real]:
    """The exact state of a tree at t = 0."""
    state = [value for link in tree.links for value in (*link.coordinates, *link.rates)]
    if tree.floats:
        state += [*ORIGIN, *plus(tree.links[0].start.velocity, scaled(MP.mpf(-1), common_velocity(tree)))]
    return state


def common_velocity(tree: Tree) -> Vector3:
    """The velocity of the centre of mass of a tree at t = 0."""
    mass, momentum = MP.mpf(0), ORIGIN
    for link in tree.links:
        constants = link.constants
        if constants.mass:
            x, y, z = (part / constants.mass for part in constants.moment)
            centre = link.start.carried(Place(origin=(x, y, z)))
            mass, momentum = mass + constants.mass, plus(momentum, scaled(constants.mass, centre.velocity))
    return scaled(1 / mass, momentum)


def split(tree: Tree, rows: WideArray, times: WideArray, kind: FloatType) -> list[LinkStates]:
    """The states of the links of a tree, from states (n, k), `rows`, at times (n,), s."""
    states, first = list[LinkStates](), 0
    for link in tree.links:
        middle, last = first + SIZES[link.kind][0], first + sum(SIZES[link.kind])
        states.append(LinkStates(rows[:, first:middle], rows[:, middle:last]))
        first = last
    if tree.links[0].kind == "free":
        floating = rows[:, first:] if tree.floats else np.full((len(times), 6), kind.number(MP.mpf(0)))
        states[0] = LinkStates(states[0].coordinates, states[0].rates, *_flown(tree, floating, times, kind))
    return states


def _flown(tree: Tree, floating: WideArray, times: WideArray, kind: FloatType) -> tuple[WideArray, WideArray]:
    """Position (m) and velocity (m/s), each (n, 3), world, of the first link, which is free.

    floating: (n, 6) its displacement and velocity relative to a parabola with the velocity of the centre of mass.
    """
    begin, t = tree.links[0].start, kind.array(times)[:, None]
    origin, velocity, fall = (kind.array(part) for part in (begin.pose.origin, common_velocity(tree), tree.fall))
    return origin + (velocity + fall * t / 2) * t + floating[:, :3], velocity + fall * t + floating[:, 3:]
