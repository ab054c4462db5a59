"""The equations of motion of a tree as a system of first order, and the layout of its state, in any arithmetic.

The state has the coordinates and the rates of one link after another (see `articulated.Link`), but not those of links that
follow others. For each free link that carries other links, the last components of the state are the displacement (3,) and its
derivative (3,), world, from the position that the link would have if it moved with the velocity of the centre of mass of these
links, so that a long flight does not cost digits. For a free body that carries nothing the displacement is zero, and the state
does not have it.

The equations of quaternions conserve their norm, which changes by rounding only. So the matrices are formed without dividing
by the norm.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, Literal

from bodycheck.reference.exact.numbers import MP, FloatType, Real, Vector3, WideArray
from bodycheck.reference.exact.rotations import ORIGIN, plus, scaled
from bodycheck.reference.mechanisms.articulation import articulated
from bodycheck.reference.mechanisms.articulation.articulated import Constants, Kind
from bodycheck.reference.mechanisms.articulation.spatial import Number, quaternion_rows
from bodycheck.reference.mechanisms.frames import Place
from bodycheck.reference.mechanisms.tree import Link, Tree

#: The numbers of coordinates and of rates of each kind of link.
SIZES: dict[Kind, tuple[int, int]] = {"revolute": (1, 1), "prismatic": (1, 1), "ball": (4, 3), "free": (4, 3)}


@dataclass(frozen=True)
class LinkForm:
    """The kind of a link, the index of its parent (-1: the fixed base), and that of the link that it follows, or None."""

    kind: Kind
    parent: int
    follows: int | None = None


def sizes(link: Link | LinkForm) -> tuple[int, int]:
    """Return the numbers of coordinates and of rates of a link in a state."""
    return SIZES[link.kind] if link.follows is None else (0, 0)


def floating(links: Sequence[Link | LinkForm]) -> list[int]:
    """The indices of the free links that carry other links."""
    return [index for index, link in enumerate(links) if link.kind == "free" and any(each.parent == index for each in links)]


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
class Critical:
    """A change that errors of a state may cause altogether in the motion of a tree with controllers and stops.

    Attributes
    ----------
    time, joint
        The time (s), and the index of the joint in the mechanism.
    kind
        "impact" at a rigid stop; "touch" where the joint turns back near a stop; "rest" where joints remain at rest or do not.
    turns
        Whether the joint is revolute.
    room
        Of an impact, the time (s) to another impact or to an instant of a controller; where a joint turns back, the distance
        from its stop (rad or m); of joints at rest, the distance from another decision as a part of the forces.
    speed, jumps
        Of an impact, the speed of the joint before it, and the largest jumps of rates (rad/s) and of velocities (m/s).
    """

    time: float
    joint: int
    kind: Literal["impact", "touch", "rest"]
    turns: bool
    room: float
    speed: float = 0.0
    jumps: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True, eq=False)
class Course:
    """The motion of a tree: the states of its links, and in order of time the changes of its joints with dry friction.

    decisions: which joints stick. criticals: what errors may change altogether.
    """

    links: list[LinkStates]
    changes: tuple[Change, ...] = ()
    decisions: tuple[Decision, ...] = ()
    criticals: tuple[Critical, ...] = ()


@dataclass(frozen=True, eq=False)
class Form:
    """A tree in any arithmetic: the form of each link, its constants, and gravity (3,) (see `Tree`)."""

    links: Sequence[LinkForm]
    constants: Sequence[Constants]
    gravity: Sequence[Number]


@dataclass(frozen=True, eq=False)
class Rates:
    """The derivative of a state, and the strain of each link's joint (see `articulated.Accelerations`)."""

    state: list[Number]
    strains: list[Number]


def derivatives(form: Form, state: Sequence[Number], functions: Any) -> Rates:
    """The derivative of a state. functions: a module or object with the functions `sin` and `cos` of the arithmetic."""
    links = links_of(form, state)
    rates: list[Number] = []
    solution = articulated.accelerations(links, form.gravity, functions)
    for kin, link, accelerations in zip(form.links, links, solution.rates, strict=True):
        if kin.follows is None:
            rates += [*_coordinate_rates(link), *accelerations[: len(link.rates)]]
    first = len(rates)
    for index in floating(form.links):
        linear, rows = solution.rates[index][3:], quaternion_rows(links[index].coordinates)
        rates += [*state[first + 3 : first + 6], *(sum(a * b for a, b in zip(row, linear, strict=True)) for row in rows)]
        first += 6
    return Rates(rates, solution.strains)


def links_of(form: Form, state: Sequence[Number]) -> list[articulated.Link]:
    """The links of a tree in a state."""
    leaders = {each.follows for each in form.links}
    links: list[articulated.Link] = []
    first = 0
    for index, (each, constants) in enumerate(zip(form.links, form.constants, strict=True)):
        held, moving = sizes(each)
        q, v = state[first : first + held], state[first + held : first + held + moving]
        leader = index if index in leaders else each.follows
        links.append(articulated.Link(each.kind, each.parent, constants, q, v, leader))
        first += held + moving
    for index, each in enumerate(form.links):
        if each.follows is not None:
            led, constants = links[each.follows], form.constants[index]
            q, v = [constants.ratio * led.coordinates[0] + constants.shift], [constants.ratio * led.rates[0]]
            links[index] = replace(links[index], coordinates=q, rates=v, share=constants.ratio)
    return links


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
    links = forms_of(tree)
    constants = [_converted(link.constants, number) for link in tree.links]
    return Form(links, constants, [number(part) if part else 0 for part in tree.gravity])


def forms_of(tree: Tree) -> list[LinkForm]:
    """The forms of the links of a tree."""
    return [LinkForm(link.kind, link.parent, link.follows) for link in tree.links]


def _converted(constants: Constants, number: Callable[[Real], Number]) -> Constants:
    values: dict[str, Any] = {}
    for field in fields(Constants):
        value = getattr(constants, field.name)
        several = isinstance(value, tuple)
        converted = [number(each) if each else 0 for each in (value if several else (value,))]
        values[field.name] = converted if several else converted[0]
    return Constants(**{**values, "moves": 1})


def places_of_rates(links: Sequence[Link | LinkForm]) -> list[int]:
    """The index of each link's first rate in a state."""
    indices, first = [], 0
    for link in links:
        held, moving = sizes(link)
        indices.append(first + held)
        first += held + moving
    return indices


def start(tree: Tree) -> list[Real]:
    """The exact state of a tree at t = 0."""
    state = [value for link in tree.links if link.follows is None for value in (*link.coordinates, *link.rates)]
    for index in floating(tree.links):
        state += [*ORIGIN, *plus(tree.links[index].start.velocity, scaled(MP.mpf(-1), _common_velocity(tree, index)))]
    return state


def _common_velocity(tree: Tree, root: int) -> Vector3:
    """The velocity at t = 0 of the centre of mass of a free link with all links that it carries."""
    mass, momentum, carried = MP.mpf(0), ORIGIN, {root}
    for index, link in enumerate(tree.links):
        constants = link.constants
        if link.parent in carried:
            carried.add(index)
        if index in carried and constants.mass:
            x, y, z = (part / constants.mass for part in constants.moment)
            centre = link.start.carried(Place(origin=(x, y, z)))
            mass, momentum = mass + constants.mass, plus(momentum, scaled(constants.mass, centre.velocity))
    return scaled(1 / mass, momentum)


def split(tree: Tree, rows: WideArray, times: WideArray, kind: FloatType) -> list[LinkStates]:
    """The states of the links of a tree, from states (n, k), `rows`, at times (n,), s."""
    states, first = list[LinkStates](), 0
    for link in tree.links:
        held, moving = sizes(link)
        states.append(LinkStates(rows[:, first : first + held], rows[:, first + held : first + held + moving]))
        first += held + moving
    for index, link in enumerate(tree.links):
        if link.follows is not None:
            leader, ratio, shift = states[link.follows], kind.number(link.constants.ratio), kind.number(link.constants.shift)
            # Zero is added since the product of a negative ratio and zero is minus zero.
            states[index] = LinkStates(ratio * leader.coordinates + shift, ratio * leader.rates + kind.number(MP.mpf(0)))
        elif link.kind == "free":
            moved = rows[:, :6] * 0
            if index in floating(tree.links):
                moved, first = rows[:, first : first + 6], first + 6
            flown = _flown(tree, index, moved, times, kind)
            states[index] = LinkStates(states[index].coordinates, states[index].rates, *flown)
    return states


def _flown(tree: Tree, root: int, moved: WideArray, times: WideArray, kind: FloatType) -> tuple[WideArray, WideArray]:
    """Position (m) and velocity (m/s), each (n, 3), world, of a free link.

    moved: (n, 6) its displacement and velocity relative to a parabola with the velocity of the centre of mass.
    """
    begin, t = tree.links[root].start, kind.array(times)[:, None]
    origin, velocity, fall = (kind.array(part) for part in (begin.pose.origin, _common_velocity(tree, root), tree.fall))
    return origin + (velocity + fall * t / 2) * t + moved[:, :3], velocity + fall * t + moved[:, 3:]
