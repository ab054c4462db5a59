"""The equations of trees with controllers and stops in heyoka's expressions, with their parameters and margins (Linux only).

One compilation serves all trees with the same kinds of links, zeros in the same places, and controllers, stops and dry friction
of the same kinds at the same joints. What changes at events and at the instants of controllers are parameters alone.
"""

import functools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import heyoka as hy

from bodycheck.reference.exact.numbers import Real
from bodycheck.reference.integration.heyoka_solver import Equations
from bodycheck.reference.mechanisms.control import Controller, Samples, Sine
from bodycheck.reference.mechanisms.hybrid.cells import most_margins
from bodycheck.reference.mechanisms.hybrid.signals import signals
from bodycheck.reference.mechanisms.link_states import Form, LinkForm, derivatives, floating, forms_of, links_of, sizes
from bodycheck.reference.mechanisms.tree import Link, Tree
from bodycheck.reference.mechanisms.tree_equations import MOST_OPTIMISED, Mark, mark, named, numbering, numbers

#: A number that is added to margins: heyoka does not find further roots of a function that is zero at the beginning of a step.
BEGINNING = 1e-60

#: The number of margins of elastic stops, and of rigid ones.
STOP_MARGINS = 2


@dataclass(frozen=True)
class Wave:
    """Return whether a signal changes linearly in pieces, and whether it is a sine."""

    slope: bool
    sine: bool


@dataclass(frozen=True)
class Part:
    """The properties of a link with a controller, stops or dry friction that the compiled equations depend on.

    Attributes
    ----------
    link
        The index of the link.
    continuous, integral
        Whether a continuous law acts on it, and whether this law has an integral.
    waves
        The signals of the continuous law.
    margins
        The number of margins of the law's saturation.
    elastic, rigid, dry
        Whether it has elastic stops, rigid stops, and dry friction.
    """

    link: int
    continuous: bool
    integral: bool
    waves: tuple[Wave, ...]
    margins: int
    elastic: bool
    rigid: bool
    dry: bool

    @property
    def may_rest(self) -> bool:
        """True if the joint can be held at rest."""
        return self.rigid or self.dry

    @property
    def changing(self) -> tuple[str, ...]:
        """The fields of the link's constants that are parameters whatever their values are."""
        fields: tuple[str, ...] = ("force",)
        if self.elastic or self.margins == 6:
            fields += ("stiffness", "damping")
        return (*fields, "moves") if self.may_rest else fields


@dataclass(frozen=True)
class Shape:
    """The properties of a tree that its compiled equations depend on."""

    links: tuple[LinkForm, ...]
    marks: tuple[tuple[Mark, ...], ...]
    gravity: tuple[Mark, ...]
    parts: tuple[Part, ...]

    @property
    def large(self) -> bool:
        """True if there are too many equations for optimised code."""
        rates = sum(sizes(link)[1] for link in self.links) + 3 * sum(link.kind == "free" for link in self.links)
        return rates > MOST_OPTIMISED

    @property
    def components(self) -> int:
        """The number of components of a state, without the integrals."""
        return sum(sum(sizes(link)) for link in self.links) + 6 * len(floating(self.links))

    @property
    def integrals(self) -> tuple[int, ...]:
        """The indices of the links whose laws have an integral, in the order of the last components of the state."""
        return tuple(part.link for part in self.parts if part.integral)


@dataclass(frozen=True)
class Event:
    """The meaning of a root of an event function of heyoka.

    link: the index of the link. kind: "law" or "elastic" for a margin of a cell; "stop" if the link reaches a rigid stop (index
    0: the lower one, 1: the upper one); "rest" if its mode at rest or of friction ends; "turn" if its velocity changes sign.
    """

    link: int
    kind: str
    index: int = 0


@dataclass(frozen=True, eq=False)
class Written:
    """Equations in heyoka's form, and the event functions: all become negative at the event, except the velocity of "turn"."""

    system: Equations
    events: list[tuple[Event, Any]]


def shape_of(tree: Tree) -> Shape:
    """Return the properties of a tree that its compiled equations depend on."""
    parts = tuple(part for index, link in enumerate(tree.links) if (part := _part(index, link)) is not None)
    changing = {part.link: part.changing for part in parts}
    return Shape(
        tuple(forms_of(tree)),
        tuple(
            tuple(each for each, _ in numbers(link.constants, changing.get(index, ()))) for index, link in enumerate(tree.links)
        ),
        tuple(mark(part, ones=False) for part in tree.gravity),
        parts,
    )


def _part(index: int, link: Link) -> Part | None:
    controller, stops = link.controller, link.stops
    if controller is None and stops is None and not link.friction:
        return None
    continuous = controller is not None and controller.rate is None
    waves: tuple[Wave, ...] = ()
    if controller is not None and continuous:
        waves = tuple(
            Wave(isinstance(signal, Samples) and signal.between == "linear", isinstance(signal, Sine))
            for signal in signals(controller)
        )
    return Part(
        link=index,
        continuous=continuous,
        integral=_integrates(controller),
        waves=waves,
        margins=0 if controller is None or not continuous else most_margins(controller),
        elastic=stops is not None and not stops.rigid,
        rigid=stops is not None and stops.rigid,
        dry=bool(link.friction),
    )


def _integrates(controller: Controller | None) -> bool:
    return controller is not None and controller.rate is None and bool(controller.ki)


@functools.cache
def written(shape: Shape) -> Written:
    """The equations and events of trees with a shape; the parameters are numbered in the order of `phases.parameters`."""
    symbols = numbering()
    constants = [named(symbols(marks)) for marks in shape.marks]
    gravity = symbols(shape.gravity)
    state = [hy.make_vars(f"x{index}") for index in range(shape.components)]
    totals = {index: hy.make_vars(f"i{index}") for index in shape.integrals}
    links = links_of(Form(shape.links, constants, gravity), state)
    events, integrals = list[tuple[Event, Any]](), list[Any]()
    for part in shape.parts:
        q, v = links[part.link].coordinates[0], links[part.link].rates[0]
        wanted: Any = 0
        if part.continuous:
            wanted, error = _law(part, q, v, totals.get(part.link), lambda size: symbols([None] * size))
            (gate,) = symbols([None])
            constants[part.link] = replace(constants[part.link], force=constants[part.link].force + gate * wanted)
            if part.integral:
                integrals.append((totals[part.link], error))
        arguments = [("law", wanted)] * part.margins + [("elastic", q)] * (STOP_MARGINS * part.elastic)
        arguments += [("stop", q)] * (STOP_MARGINS * part.rigid)
        for index, (kind, x) in enumerate(arguments):
            slope, origin, rate, speed = symbols([None] * 4)
            number = index - part.margins if kind != "law" else index
            margin = slope * (x - origin) + rate * (v - speed) + BEGINNING
            events.append((Event(part.link, kind, number), margin))
        if part.rigid or part.elastic:
            events.append((Event(part.link, "turn"), v))
    rates = derivatives(Form(shape.links, constants, gravity), state, hy)
    for part in shape.parts:
        if part.may_rest:
            mode, low, at_low, high, at_high = symbols([None] * 5)
            strain, moves = rates.strains[part.link], constants[part.link].moves
            room = (low + at_low * strain) * (high + at_high * strain)
            v = links[part.link].rates[0]
            events.append((Event(part.link, "rest"), moves * (mode * v + BEGINNING) + (1 - moves) * (room + BEGINNING)))
    system = [(x, hy.expression(0.0) + rate) for x, rate in zip(state, rates.state, strict=True)]
    return Written([*system, *integrals], events)


def _law(part: Part, q: Any, v: Any, total: Any, symbols: Callable[[int], list[Any]]) -> tuple[Any, Any]:
    """The effort that a continuous law wants, and the error e; the parameters are those of `law_parameters`."""
    constant, kp, kd = symbols(3)
    wanted, error = constant - kp * q - kd * v, None
    for index, wave in enumerate(part.waves):
        shares: list[Any] = [0]
        if wave.slope:
            (slope,) = symbols(1)
            shares.append(slope * hy.time)
        if wave.sine:
            amplitude, frequency, phase = symbols(3)
            shares.append(amplitude * hy.sin(frequency * hy.time + phase))
        (gain,) = symbols(1)
        moving = sum(shares)
        wanted = wanted + gain * moving
        if index == 0 and part.integral:
            ki, target = symbols(2)
            wanted, error = wanted + ki * total, target + moving - q
    return wanted, error


def law_parameters(part: Part, controller: Controller, pieces: Sequence[Any]) -> list[Real]:
    """The parameters of a continuous law, in the order of the equations. pieces: of its three signals."""
    gains = (controller.kp, controller.kd, 1.0)
    values = [sum(gain * piece.constant for gain, piece in zip(gains, pieces, strict=True)), controller.kp, controller.kd]
    for index, (wave, piece, gain) in enumerate(zip(part.waves, pieces, gains, strict=True)):
        values += [piece.slope] if wave.slope else []
        values += [piece.amplitude, piece.angular_frequency, piece.phase] if wave.sine else []
        values += [gain]
        values += [controller.ki, piece.constant] if index == 0 and part.integral else []
    return values
