"""The phases of a tree between two events: the modes of its joints, and the equations in them in any arithmetic."""

import functools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.exact.numbers import MP, Real, WideArray, exactly, real
from bodycheck.reference.mechanisms.articulation.articulated import Constants
from bodycheck.reference.mechanisms.hybrid.cells import Cell, Margin
from bodycheck.reference.mechanisms.hybrid.equations import STOP_MARGINS, Part, Shape, law_parameters
from bodycheck.reference.mechanisms.hybrid.sampled import Memory
from bodycheck.reference.mechanisms.hybrid.signals import Piece
from bodycheck.reference.mechanisms.link_states import Form, Rates, derivatives, in_arithmetic, links_of, places_of_rates
from bodycheck.reference.mechanisms.tree import Tree
from bodycheck.reference.mechanisms.tree_equations import numbers

#: The part of its terms by which a margin may be negative at the end of a step, small beside what a missed event would cause, and
#: the least size of these terms in SI units.
MISSED, SMALL = 1e-9, 1e-3

#: The cell of a joint without a continuous law or without elastic stops.
NO_CELL = Cell(())


@dataclass(frozen=True, eq=False)
class Phase:
    """The beginning of a phase without events.

    Attributes
    ----------
    time, state
        The time (s), in exact arithmetic, and the state with the integrals of continuous laws.
    rest
        The mode of each link that may be held at rest: 0 if it is held; 1 or -1 if it moves, which for a link with dry friction is
        the direction in which it slips.
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


def joint_states(tree: Tree, state: Sequence[Any], number: Number) -> list[tuple[Any, Any]]:
    """The coordinates and the velocities of all joints, None for those with more than one."""
    links = links_of(form_of(tree, number), state)
    return [(link.coordinates[0], link.rates[0]) if len(link.coordinates) == 1 else (None, None) for link in links]


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
    cells = phase.laws.get(index, NO_CELL), phase.springs.get(index, NO_CELL)
    force, stiffness, damping = (
        number(sum(getattr(cell, name) for cell in cells)) for name in ("force", "stiffness", "damping")
    )
    acting = phase.memories[index].acting if index in phase.memories else 0
    return force + number(acting) + (law if cells[0].gate else 0), stiffness, damping


def constants_in(tree: Tree, shape: Shape, phase: Phase, state: Sequence[Any], time: Real, number: Number) -> list[Constants]:
    """The constants of all links in a phase, without the force of dry friction, at a time and in a state."""
    constants, joints = list(form_of(tree, number).constants), joint_states(tree, state, number)
    for part in shape.parts:
        law = wanted(tree, shape, phase, part.link, state, *joints[part.link], time, number) if part.continuous else 0
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
    joints = joint_states(tree, state, number)
    errors = [number(phase.pieces[index][0].value(time)) - joints[index][0] for index in shape.integrals]
    return Rates([*rates.state, *errors], rates.strains)


def places(tree: Tree) -> list[int]:
    """The index of each link's velocity in a state; that of its coordinate, where it has one alone, is one less."""
    return places_of_rates(tree.links)


def parameters(tree: Tree, shape: Shape, phase: Phase) -> list[Real]:
    """The exact values of the parameters in a phase, in the order of the equations."""
    parts = {part.link: part for part in shape.parts}
    values: list[Real] = []
    for index, link in enumerate(tree.links):
        constants = link.constants if index not in parts else _constants(tree, phase, index, parts[index])
        marks = shape.marks[index]
        values += [each for mark, (_, each) in zip(marks, numbers(constants, ()), strict=True) if mark is None]
    values += [part for part in tree.gravity if part]
    for part in shape.parts:
        if part.continuous:
            controller = tree.links[part.link].controller
            assert controller is not None
            values += [*law_parameters(part, controller, phase.pieces[part.link]), phase.laws[part.link].gate]
        for margin in margins_of(tree, phase, part):
            values += [margin.slope, margin.place, margin.rate, margin.speed]
    for part in shape.parts:
        if part.may_rest:
            values += _at_rest(tree, phase, part)
    return [real(value) for value in values]


def _constants(tree: Tree, phase: Phase, index: int, part: Part) -> Constants:
    link, mode = tree.links[index], phase.rest.get(index, 1)
    force, stiffness, damping = effort_in(phase, index, 0, real)
    base = link.constants
    return replace(
        base,
        force=base.force + force - (mode * link.friction if part.dry else 0),
        stiffness=base.stiffness + stiffness,
        damping=base.damping + damping,
        moves=MP.mpf(abs(mode)),
    )


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
        free = phase.rest[index] != 0
        limits = ((1, stops.lower), (-1, stops.upper))
        margins += [Margin() if limit is None or not free else Margin(slope, MP.mpf(limit)) for slope, limit in limits]
    return margins


def require_consistent(tree: Tree, shape: Shape, phase: Phase, state: WideArray, time: Any) -> None:
    """Raise `OutOfReach` if the state at the end of a step contradicts the modes of its phase, since an event was missed."""
    if not any(part.margins or part.elastic or part.rigid or part.dry for part in shape.parts):
        return
    numbers, joints = state.astype(float).tolist(), joint_states(tree, state.astype(float).tolist(), float)
    for part in shape.parts:
        q, v = joints[part.link]
        w = wanted(tree, shape, phase, part.link, numbers, q, v, real(float(time)), float) if part.margins else 0.0
        for number, margin in enumerate(margins_of(tree, phase, part)):
            slope, place, rate, speed = (float(value) for value in (margin.slope, margin.place, margin.rate, margin.speed))
            x = w if number < part.margins else q
            size = abs(slope) * (SMALL + abs(x) + abs(place)) + abs(rate) * (SMALL + abs(v) + abs(speed))
            if slope * (x - place) + rate * (v - speed) < -MISSED * size:
                raise OutOfReach(f"rounding leaves undecided what a joint does before t = {float(time):.6g} s")
        if part.dry and phase.rest[part.link] * v < -MISSED * (
            SMALL + max(abs(each) for _, each in joints if each is not None)
        ):
            raise OutOfReach(
                f"rounding leaves undecided whether a joint with dry friction slips before t = {float(time):.6g} s"
            )


def _padded(margins: Sequence[Margin], size: int) -> list[Margin]:
    return [*margins, *[Margin()] * (size - len(margins))]


def _at_rest(tree: Tree, phase: Phase, part: Part) -> Iterator[Real]:
    """The parameters of the event in which a link ceases to slip in its direction, or to be held."""
    friction, side = tree.links[part.link].friction, phase.sides.get(part.link, 0)
    yield phase.rest[part.link] if part.dry else 0
    yield from (friction, -1) if side <= 0 else (1, 0)
    yield from (friction, 1) if side >= 0 else (1, 0)
