"""The laws of elements in the Lagrangian: continuous controllers, elastic and rigid stops, and what holds an element at rest.

A law is written once for a structure, with parameters in place of all numbers. What switches is a parameter too: a controller
at its limit has the force `share` control + `constant` + `slope` u, with the share 0, and an elastic stop pushes 0 or 1 times.
So an integrator that is compiled once follows all phases of a motion. A guard is a function of the state whose root ends a
phase, or changes the sign that decides between two phases.
"""

import functools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Literal

from bodycheck.reference.independent.border import MP, Number
from bodycheck.reference.mechanisms.control import Controller, Samples, Signal, Sine
from bodycheck.reference.mechanisms.lagrangian.border import Element
from bodycheck.reference.mechanisms.lagrangian.differentiation import Node, Tape

SignalKind = Literal["none", "number", "sine", "table"]

#: The names of the signals of a controller, and the guards that decide where its limit acts.
SIGNALS = "target", "target_velocity", "effort"
PLAIN_GUARDS = "over", "under"
LINE_GUARDS = "over", "under", "over_line", "under_line", "control", "forwards", "fast", "fast_back"


@dataclass(frozen=True)
class Law:
    """The parts of an element's law.

    Attributes
    ----------
    signals
        The kinds of the three `SIGNALS` of a continuous controller.
    gains
        Whether each of the gains kp, kd and ki of a continuous controller is different from zero.
    limited, lined
        Whether its effort is limited, and whether the limit depends on the speed.
    elastic, rigid
        The stops of each kind, from "lower" and "upper".
    damped
        Whether elastic stops have damping, so that they cease to push before the element leaves them.
    dry
        Whether the element has dry friction.
    """

    signals: tuple[SignalKind, SignalKind, SignalKind] = ("none", "none", "none")
    gains: tuple[bool, bool, bool] = (False, False, False)
    limited: bool = False
    lined: bool = False
    elastic: tuple[str, ...] = ()
    rigid: tuple[str, ...] = ()
    damped: bool = False
    dry: bool = False

    @property
    def holds(self) -> bool:
        """True if dry friction or a rigid stop can hold the element at rest."""
        return self.dry or bool(self.rigid)

    @property
    def integrates(self) -> bool:
        """True if the integral of the error is a variable of the state."""
        return self.gains[2]

    @property
    def timed(self) -> bool:
        """True if the law depends on time within a phase."""
        return "sine" in self.signals or "table" in self.signals

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the law's parameters, in their order."""
        return tuple(self._names())

    def _names(self) -> Iterator[str]:
        yield from (name for name, gain in zip(("kp", "kd", "ki"), self.gains, strict=True) if gain)
        parts: dict[SignalKind, tuple[str, ...]] = {
            "none": (),
            "number": ("",),
            "sine": (".offset", ".amplitude", ".frequency", ".phase"),
            "table": (".value", ".slope", ".since"),
        }
        yield from (name + part for name, kind in zip(SIGNALS, self.signals, strict=True) for part in parts[kind])
        if self.limited:
            yield from ("limit", "share", "constant", "slope")
        if self.lined:
            yield from ("steep", "top")
        if self.elastic:
            yield "stiffness"
        if self.damped:
            yield "damping"
        yield from (f"{side}.pushes" for side in self.elastic)
        yield from (*self.elastic, *self.rigid)
        if self.holds:
            yield from ("high.share", "high", "low.share", "low")


@dataclass(frozen=True)
class Guard:
    """A guard of an element: its name among those of the element's law, and its node on the tape."""

    element: int
    name: str
    node: Node


def law_of(element: Element) -> Law | None:
    """The law of an element; None if it has none."""
    controller, stops = element.controller, element.stops
    sides = () if stops is None else tuple(side for side in ("lower", "upper") if getattr(stops, side) is not None)
    rigid = stops is not None and stops.rigid
    damped = stops is not None and bool(stops.damping)
    law = Law(elastic=() if rigid else sides, rigid=sides if rigid else (), damped=damped, dry=bool(element.friction))
    if controller is not None and controller.rate is None:
        first, second, third = (_kind(getattr(controller, name)) for name in SIGNALS)
        proportional, derivative, integral = (bool(gain) for gain in (controller.kp, controller.kd, controller.ki))
        limited, lined = controller.effort_limit is not None, controller.no_load_speed is not None
        gains = proportional, derivative, integral
        law = replace(law, signals=(first, second, third), gains=gains, limited=limited, lined=lined)
    return None if law == Law() else law


def _kind(signal: Signal) -> SignalKind:
    match signal:
        case Sine():
            return "sine"
        case Samples():
            return "table"
    return "number" if signal else "none"


@dataclass(frozen=True)
class Scales:
    """The units of an element's numbers: of its coordinate, of its inertia, and of time."""

    size: Number
    inertia: Number
    time: Number

    def of_signal(self, name: str) -> Number:
        """The unit of a signal of a controller."""
        return {
            "target": self.size,
            "target_velocity": self.size / self.time,
            "effort": self.inertia * self.size / self.time**2,
        }[name]


def constants(element: Element, law: Law, scales: Scales) -> dict[str, Number]:
    """The numbers of a law that never change, by the names of its parameters, in the units of the equations."""
    values: dict[str, Number] = {}
    size, inertia, time = scales.size, scales.inertia, scales.time
    if (controller := element.controller) is not None and controller.rate is None:
        units = {"kp": inertia / time**2, "kd": inertia / time, "ki": inertia / time**3}
        values |= {name: MP.mpf(getattr(controller, name)) / unit for name, unit in units.items()}
        for name in SIGNALS:
            values |= _of_signal(name, getattr(controller, name), scales.of_signal(name), time)
        values |= _of_limits(controller, scales)
    if (stops := element.stops) is not None:
        sides = {side: getattr(stops, side) for side in ("lower", "upper")}
        values |= {side: MP.mpf(value) / size for side, value in sides.items() if value is not None}
        values["stiffness"] = MP.mpf(stops.stiffness) * time**2 / inertia
        values["damping"] = MP.mpf(stops.damping) * time / inertia
    return {name: values[name] for name in law.names if name in values}


def _of_signal(name: str, signal: Signal, unit: Number, time: Number) -> dict[str, Number]:
    match signal:
        case Sine():
            return {
                f"{name}.offset": MP.mpf(signal.offset) / unit,
                f"{name}.amplitude": MP.mpf(signal.amplitude) / unit,
                f"{name}.frequency": MP.mpf(signal.angular_frequency) * time,
                f"{name}.phase": MP.mpf(signal.phase),
            }
        case Samples():
            return {}
    return {name: MP.mpf(signal) / unit}


def _of_limits(controller: Controller, scales: Scales) -> dict[str, Number]:
    values: dict[str, Number] = {}
    if controller.effort_limit is not None:
        values["limit"] = MP.mpf(controller.effort_limit) / scales.of_signal("effort")
        if controller.no_load_speed is not None:
            values["top"] = MP.mpf(controller.no_load_speed) / scales.of_signal("target_velocity")
            values["steep"] = values["limit"] / values["top"]
    return values


def places(laws: tuple[Law | None, ...], first: int) -> list[dict[str, int]]:
    """The indices of the parameters of each law, by their names. first: the index of the first of all."""
    indices = []
    for law in laws:
        names = () if law is None else law.names
        indices.append({name: first + number for number, name in enumerate(names)})
        first += len(names)
    return indices


@dataclass(frozen=True)
class Acting:
    """The additions of a law to the equations: the force along the velocity, the error, and the guards by their names."""

    force: Node
    error: Node
    guards: dict[str, Node]


def acting(tape: Tape, law: Law, numbers: Mapping[str, Node], state: tuple[Node, Node], further: tuple[Node, Node]) -> Acting:
    """The force and the guards of a law, without those that hold the element (`equations.derived`).

    numbers: the parameters of the law. state: the coordinate and the velocity. further: the integral of the error, and time.
    """
    (q, u), (integral, clock) = state, further

    def signal(name: str) -> Node:
        match law.signals[SIGNALS.index(name)]:
            case "none":
                return tape.zero
            case "number":
                return numbers[name]
            case "sine":
                phase = tape.add(tape.multiply(numbers[f"{name}.frequency"], clock), numbers[f"{name}.phase"])
                return tape.add(numbers[f"{name}.offset"], tape.multiply(numbers[f"{name}.amplitude"], tape.sine(phase)))
        since = tape.subtract(clock, numbers[f"{name}.since"])
        return tape.add(numbers[f"{name}.value"], tape.multiply(numbers[f"{name}.slope"], since))

    error = tape.subtract(signal("target"), q)
    parts = {"kp": error, "kd": tape.subtract(signal("target_velocity"), u), "ki": integral}
    terms = (tape.multiply(numbers[name], part) for name, part in parts.items() if name in numbers)
    force = control = tape.add(tape.total(terms), signal("effort"))
    guards: dict[str, Node] = {}
    if law.limited:
        held = tape.add(numbers["constant"], tape.multiply(numbers["slope"], u))
        force = tape.add(tape.multiply(numbers["share"], control), held)
        guards |= _limits(tape, law, numbers, control, u)
    for side in law.elastic:
        beyond = tape.subtract(q, numbers[side])
        push = tape.multiply(numbers["stiffness"], beyond)
        if law.damped:
            push = tape.add(push, tape.multiply(numbers["damping"], u))
        force = tape.subtract(force, tape.multiply(numbers[f"{side}.pushes"], push))
        outwards = side == "upper"
        guards[side] = beyond if outwards else tape.negate(beyond)
        if law.damped:
            guards[f"{side}.push"] = push if outwards else tape.negate(push)
    for side in law.rigid:
        beyond = tape.subtract(q, numbers[side])
        guards[side] = beyond if side == "upper" else tape.negate(beyond)
    return Acting(force, error, guards)


def _limits(tape: Tape, law: Law, numbers: Mapping[str, Node], control: Node, u: Node) -> dict[str, Node]:
    """The guards of a limit: of the control beyond it, and of the velocity where the limit depends on it."""
    limit, back = numbers["limit"], tape.negate(control)
    guards = {"over": tape.subtract(control, limit), "under": tape.subtract(back, limit)}
    if law.lined:
        less = tape.multiply(numbers["steep"], u)
        guards["over_line"] = tape.subtract(control, tape.subtract(limit, less))
        guards["under_line"] = tape.subtract(back, tape.add(limit, less))
        guards |= {"control": control, "forwards": u}
        guards |= {"fast": tape.subtract(u, numbers["top"]), "fast_back": tape.subtract(tape.negate(u), numbers["top"])}
    return guards


def switched(law: Law, signs: Mapping[str, int], values: Mapping[str, Number]) -> dict[str, Number]:
    """The parameters that switch, for given signs of the guards. values: the `constants` of the law."""
    result: dict[str, Number] = {}
    if law.limited:
        share, constant, slope = _limited(law, signs)
        result |= {"share": MP.mpf(share), "constant": constant * values["limit"]}
        result["slope"] = slope * values["steep"] if law.lined else MP.zero
    for side in law.elastic:
        result[f"{side}.pushes"] = MP.mpf(all(signs[name] > 0 for name in _of_stop(law, side)))
    return result


def _limited(law: Law, signs: Mapping[str, int]) -> tuple[int, int, int]:
    """The share of the control, and the multiples of the limit and of its slope, for given signs of the guards."""
    forwards, backwards = law.lined and signs["forwards"] > 0, law.lined and signs["forwards"] < 0
    if forwards and signs["fast"] > 0:
        over, most = signs["control"] > 0, (0, 0, 0)
    elif forwards:
        over, most = signs["over_line"] > 0, (0, 1, -1)
    else:
        over, most = signs["over"] > 0, (0, 1, 0)
    if backwards and signs["fast_back"] > 0:
        under, least = signs["control"] < 0, (0, 0, 0)
    elif backwards:
        under, least = signs["under_line"] > 0, (0, -1, -1)
    else:
        under, least = signs["under"] > 0, (0, -1, 0)
    return most if over else least if under else (1, 0, 0)


@functools.lru_cache(maxsize=64)
def switching(law: Law) -> tuple[str, ...]:
    """The names of the guards whose signs decide parameters."""
    limits = () if not law.limited else LINE_GUARDS if law.lined else PLAIN_GUARDS
    return (*limits, *(name for side in law.elastic for name in _of_stop(law, side)))


def _of_stop(law: Law, side: str) -> tuple[str, ...]:
    """The names of the guards that are positive while an elastic stop pushes."""
    return (side, f"{side}.push") if law.damped else (side,)
