"""The phases of a tree between two events: the modes of its joints, and the equations in them in any arithmetic."""

import functools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from bodycheck.reference.errors import Cause, Stopped
from bodycheck.reference.exact.numbers import MP, Real, WideArray, exactly, real
from bodycheck.reference.mechanisms.articulation.articulated import Constants
from bodycheck.reference.mechanisms.hybrid.cells import Cell, Margin
from bodycheck.reference.mechanisms.hybrid.equations import STOP_MARGINS, Part, Shape, law_parameters
from bodycheck.reference.mechanisms.hybrid.sampled import Memory
from bodycheck.reference.mechanisms.hybrid.signals import Piece
from bodycheck.reference.mechanisms.link_states import Form, Rates, derivatives, in_arithmetic, places_of_rates
from bodycheck.reference.mechanisms.tree import Tree
from bodycheck.reference.mechanisms.tree_equations import field_sizes, numbers

#: The part of its terms by which a margin may be negative at the end of a step, small beside what a missed event would cause,
#: and the least size of these terms in SI units.
MISSED, SMALL = 1e-9, 1e-3


@dataclass(frozen=True, eq=False)
class Phase:
    """The beginning of a phase without events.

    Attributes
    ----------
    time, state
        The time (s), in exact arithmetic, and the state with the integrals of continuous laws.
    rest
        The mode of each link that may be held at rest: 0 if it is held; 1 or -1 if it moves, which for a link with dry friction
        is the direction in which it slips.
    sides
        For each link that a rigid stop holds, 1 at its upper and -1 at its lower stop.
    laws, springs
        The cells of the saturation of continuous laws, and of elastic stops, by the indices of links.
    pieces
        The pieces of the three signals of continuous laws.
    memories
        What controllers with a rate remember.
    begun
        The links with an event at the beginning.
    watched
        The links that are held within rounding at the beginning, where heyoka may not find the end of it.
    released
        Whether rigid stops no longer act.
    """

    time: Real
    state: WideArray
    rest: dict[int, int]
    sides: dict[int, int]
    laws: dict[int, Cell]
    springs: dict[int, Cell]
    pieces: dict[int, tuple[Piece, ...]]
    memories: dict[int, Memory]
    begun: frozenset[int] = frozenset()
    watched: frozenset[int] = frozenset()
    released: bool = False


#: A function that converts numbers to an arithmetic.
Number = Callable[[Any], Any]


@functools.lru_cache(maxsize=32)
def form_of(tree: Tree, number: Number) -> Form:
    """A tree without controllers and stops in an arithmetic."""
    return in_arithmetic(tree, number)


def functions_of(number: Number) -> Any:
    """The module or object with the functions `sin` and `cos` of an arithmetic."""
    return math if number is float else MP


def in_numbers(state: WideArray, number: Number) -> list[Any]:
    """A state in an arithmetic: floats, or numbers of a hundred digits."""
    return state.astype(float).tolist() if number is float else [exactly(value) for value in state]


def joint_state(tree: Tree, state: Sequence[Any] | WideArray, index: int, number: Number) -> tuple[Any, Any]:
    """The coordinate and the velocity of the joint of a link with one coordinate; the state may be in any type."""
    link = tree.links[index]
    at = places(tree)[index if link.follows is None else link.follows]
    convert = float if number is float else exactly
    q, v = convert(state[at - 1]), convert(state[at])
    if link.follows is None:
        return q, v
    ratio, shift = number(link.constants.ratio), number(link.constants.shift)
    return ratio * q + shift, ratio * v


def wanted(
    tree: Tree, shape: Shape, phase: Phase, index: int, state: Sequence[Any], q: Any, v: Any, time: Real, number: Number
) -> Any:
    """The effort that the continuous law of a link wants at a time (s). q, v: the coordinate and the velocity of its joint."""
    controller = tree.links[index].controller
    assert controller is not None, "a link with a continuous law has a controller"
    target, target_velocity, effort = (number(each.value(time)) for each in phase.pieces[index])
    total = state[shape.components + shape.integrals.index(index)] if index in shape.integrals else 0
    return controller.kp * (target - q) + controller.kd * (target_velocity - v) + controller.ki * total + effort


def effort_in(phase: Phase, index: int, law: Any, number: Number) -> tuple[Any, Any, Any]:
    """The force, the stiffness and the damping that a controller and elastic stops add to a link. law: its wanted effort."""
    force, stiffness, damping = phase.memories[index].acting if index in phase.memories else 0, 0, 0
    if number is float:
        force = float(force)
    for cell in (phase.laws.get(index), phase.springs.get(index)):
        if cell is not None:
            force, stiffness = force + number(cell.force) + (law if cell.gate else 0), stiffness + number(cell.stiffness)
            damping = damping + number(cell.damping)
    return force, stiffness, damping


def constants_in(tree: Tree, shape: Shape, phase: Phase, state: Sequence[Any], time: Real, number: Number) -> list[Constants]:
    """The constants of all links in a phase, without the force of dry friction, at a time and in a state."""
    constants = list(form_of(tree, number).constants)
    for part in shape.parts:
        joint = joint_state(tree, state, part.link, number)
        law = wanted(tree, shape, phase, part.link, state, *joint, time, number) if part.continuous else 0
        force, stiffness, damping = effort_in(phase, part.link, law, number)
        base = constants[part.link]
        constants[part.link] = replace(
            base, force=base.force + force, stiffness=base.stiffness + stiffness, damping=base.damping + damping
        )
    return constants


def rates_in(
    tree: Tree,
    shape: Shape,
    phase: Phase,
    state: Sequence[Any],
    time: Real,
    number: Number,
    rest: Mapping[int, int] | None = None,
) -> Rates:
    """The derivative of a state with its integrals, and the strains of links. rest: instead of the modes of the phase."""
    constants = constants_in(tree, shape, phase, state, time, number)
    for index, mode in (phase.rest if rest is None else rest).items():
        force = constants[index].force - mode * number(tree.links[index].friction)
        constants[index] = replace(constants[index], force=force, moves=abs(mode))
    form = form_of(tree, number)
    rates = derivatives(Form(form.links, constants, form.gravity), state, functions_of(number))
    errors = [
        number(phase.pieces[index][0].value(time)) - joint_state(tree, state, index, number)[0] for index in shape.integrals
    ]
    return Rates([*rates.state, *errors], rates.strains)


@functools.lru_cache(maxsize=32)
def places(tree: Tree) -> list[int]:
    """The index of each link's velocity in a state; that of its coordinate, where it has one alone, is one less."""
    return places_of_rates(tree.links)


@dataclass(frozen=True, eq=False)
class _Layout:
    """The parameters of the links of a tree, and the index of each field that changes, by its link and its name."""

    values: list[Real]
    slots: dict[tuple[int, str], int]


@functools.lru_cache(maxsize=32)
def _layout(tree: Tree, shape: Shape) -> _Layout:
    changing = {part.link: part.changing for part in shape.parts}
    values, slots = list[Real](), dict[tuple[int, str], int]()
    for index, link in enumerate(tree.links):
        names = [name for name, size in field_sizes() for _ in range(size)]
        for name, mark, (_, each) in zip(names, shape.marks[index], numbers(link.constants, ()), strict=True):
            if mark is None:
                if name in changing.get(index, ()):
                    slots[index, name] = len(values)
                values.append(each)
    return _Layout([*values, *(part for part in tree.gravity if part)], slots)


def parameters(tree: Tree, shape: Shape, phase: Phase) -> list[Real]:
    """The exact values of the parameters in a phase, in the order of the equations."""
    layout = _layout(tree, shape)
    values = list(layout.values)
    for part in shape.parts:
        for name, value in _changed(tree, phase, part):
            if (part.link, name) in layout.slots:
                values[layout.slots[part.link, name]] = value
        if part.continuous:
            controller = tree.links[part.link].controller
            assert controller is not None
            values += [*law_parameters(part, controller, phase.pieces[part.link]), phase.laws[part.link].gate]
        for margin in margins_of(tree, phase, part):
            values += [margin.slope, margin.origin, margin.rate, margin.speed]
    for part in shape.parts:
        if part.may_rest:
            values += _at_rest(tree, phase, part)
    return values


def _changed(tree: Tree, phase: Phase, part: Part) -> Iterator[tuple[str, Real]]:
    """Yield the names and the values of the fields of a link's constants in a phase."""
    link, mode = tree.links[part.link], phase.rest.get(part.link, 1)
    force, stiffness, damping = effort_in(phase, part.link, 0, real)
    yield "force", link.constants.force + force - (mode * link.friction if part.dry else 0)
    yield "stiffness", link.constants.stiffness + stiffness
    yield "damping", link.constants.damping + damping
    yield "moves", abs(mode)


def margins_of(tree: Tree, phase: Phase, part: Part) -> list[Margin]:
    """The margins of a link in the order of the equations; those that are not needed are zero."""
    index, margins = part.link, list[Margin]()
    if part.margins:
        margins += _padded(phase.laws[index].margins, part.margins)
    if part.elastic:
        margins += _padded(phase.springs[index].margins, STOP_MARGINS)
    if part.rigid:
        stops = tree.links[index].stops
        assert stops is not None
        free = phase.rest[index] != 0 and not phase.released
        limits = ((1, stops.lower), (-1, stops.upper))
        margins += [Margin() if limit is None or not free else Margin(slope, MP.mpf(limit)) for slope, limit in limits]
    return margins


def require_consistent(tree: Tree, shape: Shape, phase: Phase, state: WideArray, time: Any) -> None:
    """Raise `Stopped` if the state at the end of a step contradicts the modes of its phase, since an event was missed."""
    if not any(part.margins or part.elastic or part.rigid or part.dry for part in shape.parts):
        return
    values = state.astype(float).tolist()
    fastest = SMALL + max(abs(value) for value in values)
    for part in shape.parts:
        q, v = joint_state(tree, values, part.link, float)
        w = wanted(tree, shape, phase, part.link, values, q, v, real(float(time)), float) if part.margins else 0.0
        for number, margin in enumerate(margins_of(tree, phase, part)):
            slope, origin, rate, speed = (float(value) for value in (margin.slope, margin.origin, margin.rate, margin.speed))
            x = w if number < part.margins else q
            size = abs(slope) * (SMALL + abs(x) + abs(origin)) + abs(rate) * (SMALL + abs(v) + abs(speed))
            if slope * (x - origin) + rate * (v - speed) < -MISSED * size:
                cause: Cause = "controllers" if number < part.margins else "stops"
                sentence = f"rounding leaves undecided what a joint does before t = {float(time):.6g} s"
                raise Stopped(sentence, float(phase.time), cause)
        if part.dry and phase.rest[part.link] * v < -MISSED * fastest:
            sentence = f"rounding leaves undecided whether a joint with dry friction slips at t = {float(time):.6g} s"
            raise Stopped(sentence, float(phase.time), "dry friction")


def _padded(margins: Sequence[Margin], size: int) -> list[Margin]:
    return [*margins, *[Margin()] * (size - len(margins))]


def _at_rest(tree: Tree, phase: Phase, part: Part) -> Iterator[Real]:
    """The parameters of the event in which a link ceases to slip in its direction, or to be held."""
    friction, side = tree.links[part.link].friction, phase.sides.get(part.link, 0)
    yield phase.rest[part.link] if part.dry else 0
    yield from (friction, -1) if side <= 0 else (1, 0)
    yield from (friction, 1) if side >= 0 else (1, 0)
