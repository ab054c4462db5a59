"""The witness of a body between two fingers: power series of all forces and motions in short steps.

Friction and forces are along a line. The acceleration r of the body relative to its fingers makes Gauss's function r^2/2 - b r,
with the power of friction B |r|, smallest, where b is the acceleration without friction and B the largest that friction gives.
With the body at rest on its fingers, B - |b| decides by the first term of its series that is not zero.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.bounds import EPS, STATES
from bodycheck.reference.contact.witness import pieces
from bodycheck.reference.contact.witness.clasping import Clasp, clasp_of
from bodycheck.reference.contact.witness.pieces import Piece
from bodycheck.reference.errors import NotModelled, OutOfReach
from bodycheck.reference.independent.arithmetic import Real, Wide
from bodycheck.reference.independent.border import MP
from bodycheck.reference.mechanisms.control import Samples, Signal, Sine
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.trajectory import Array
from bodycheck.reference.witness import Instant, Witness

#: The name of the way in results.
NAME = "power series of a gripped body (mpmath)"

#: The number of terms of a series, and the largest angle (rad) by which a sine advances in a step.
TERMS, ANGLE = 30, MP.mpf(1) / 2

#: The number of equal parts of a step in which a change of sign is looked for, and the halvings that begin to locate it.
PARTS, HALVINGS = 16, 50

#: The steps of Newton's method that follow: each doubles the digits.
NEWTON_STEPS = 5

#: The size of a value of a series, relative to its terms, from which on double precision tells its sign.
CERTAIN = 1e-8

#: The size of a term of a series, relative to the largest, that is rounding.
ROUNDED = MP.mpf(10) ** -70

#: The largest number of steps of a motion.
MOST_STEPS = 40_000

#: A power series of the time since the start of a step.
Series = list[Real]

#: A part of a motion: the time (s) at which it begins, and the place along the line (m).
_Part = tuple[Real, Series]


@dataclass(frozen=True)
class _Line:
    """Places (m) and speeds (m/s) along the line of body and carriage at a time (s)."""

    time: Real
    body: tuple[Real, Real]
    carriage: tuple[Real, Real]

    @property
    def slip(self) -> Real:
        """The speed (m/s) of the body relative to its fingers."""
        return self.body[1] - self.carriage[1]


@dataclass(frozen=True)
class _Forces:
    """The press of a finger and the effort on the carriage (N), and the accelerations b and B (m/s^2), as series."""

    press: Series
    effort: Series
    free: Series
    most: Series


def second(scene: AnyScene, times: Array) -> Witness | None:
    """The motion of a gripped body and its fingers at ascending times (n,) >= 0 (s).

    Raises `NotModelled` for one that turns, and `OutOfReach` for too many steps.
    """
    if not isinstance(scene, Mechanism) or not scene.joints:
        return None
    clasp = clasp_of(scene)
    *parts, events = _followed(clasp, MP.mpf(float(times.max(initial=0.0))))
    of_body, of_carriage = (pieces.states(_placed(clasp, part), times) for part in parts)
    states = [of_body if index == clasp.body else of_carriage for index in range(len(scene.bodies))]
    centres = np.stack([pieces.wide(centre) for centre in clasp.centres])
    errors = {name: np.maximum(of_body.errors[name], of_carriage.errors[name]) for name in STATES}
    errors["position_error"] = errors["position_error"] + pieces.ROUNDINGS * float(np.abs(centres).max())
    return Witness(
        NAME,
        np.stack([np.tile(attitude, (len(times), 1)) for attitude in clasp.attitudes]),
        np.zeros((len(scene.bodies), len(times), 3)),
        np.stack([centre + each.position for centre, each in zip(centres, states, strict=True)]),
        np.stack([each.velocity for each in states]),
        **errors | {"error": errors["error"] + pieces.ROUNDINGS},
        events=tuple(events),
    )


def _followed(clasp: Clasp, last: Real) -> tuple[list[_Part], list[_Part], list[Instant]]:
    """The places of body and carriage as series, each from a time (s) on, and the events, until a time (s)."""
    now, events = _Line(MP.mpf(0), (MP.mpf(0), clasp.speed), (MP.mpf(0), clasp.carried)), list[Instant]()
    parts: tuple[list[_Part], list[_Part]] = [], []
    signals = clasp.press, *clasp.effort
    edges = sorted({MP.mpf(time) for signal in signals if isinstance(signal, Samples) for time in signal.times})
    fastest = max((abs(MP.mpf(signal.angular_frequency)) for signal in signals if isinstance(signal, Sine)), default=MP.mpf(0))
    slipped = None
    for _ in range(MOST_STEPS):
        left = [last - now.time, *(edge - now.time for edge in edges if edge > now.time)]
        step = min([*left, ANGLE / fastest]) if fastest else min(left)
        forces = _forces(clasp, now.time)
        sign = int(MP.sign(now.slip)) if abs(now.slip) > ROUNDED else _starts(forces)
        if sign and clasp.turning:
            raise NotModelled("a body that turns between fingers")
        if slipped is not None and bool(slipped) != bool(sign):
            events.append(Instant("slip" if sign else "rest", float(now.time), EPS * float(now.time), clasp.body))
        slipped = sign
        rates = _rates(clasp, forces, sign)
        ways = [integral(integral(rate, at[1]), at[0]) for rate, at in zip(rates, (now.body, now.carriage), strict=True)]
        for part, way in zip(parts, ways, strict=True):
            part.append((now.time, way))
        tests = [times(rate_of(plus(ways[0], times(ways[1], -1))), sign)] if sign else _margins(forces)
        ends = [end for end in (_falls(test, step) for test in tests) if end is not None]
        lasting = min(ends, default=step)
        body, carriage = ((value(way, lasting), value(rate_of(way), lasting)) for way in ways)
        now = _Line(now.time + lasting, body if sign and not ends else (body[0], carriage[1]), carriage)
        if now.time >= last:
            return *parts, events
    raise OutOfReach(f"a gripped body with more than {MOST_STEPS} steps")


def _forces(clasp: Clasp, time: Real) -> _Forces:
    """The forces about a time (s)."""
    press = times(series_of(clasp.press, time), clasp.sign)
    effort = constant(0)
    for signal in clasp.effort:
        effort = plus(effort, series_of(signal, time))
    free = times(effort, -clasp.light) if clasp.light else constant(clasp.gravity)
    return _Forces(press, effort, free, times(press, clasp.bearing * (1 / clasp.mass + clasp.light)))


def _rates(clasp: Clasp, forces: _Forces, sign: int) -> tuple[Series, Series]:
    """The accelerations of body and carriage. sign: of the slip; 0 if the body is held."""
    falling = constant(clasp.gravity)
    if not sign:
        held = times(forces.effort, clasp.light / (1 + clasp.light * clasp.mass))
        common = plus(held, falling) if clasp.light else held
        return common, common
    friction = times(forces.press, -2 * sign * clasp.friction)
    pulled = times(plus(forces.effort, times(friction, -1)), clasp.light)
    return plus(falling, times(friction, 1 / clasp.mass)), plus(pulled, falling) if clasp.light else pulled


def _margins(forces: _Forces) -> list[Series]:
    return [plus(forces.most, times(forces.free, side)) for side in (-1, 1)]


def _starts(forces: _Forces) -> int:
    """The sign of the slip that begins from rest; 0 if friction holds."""
    size = max(map(abs, (*forces.free, *forces.most)))
    for side, margin in zip((1, -1), _margins(forces), strict=True):
        first = next((term for term in margin if abs(term) > ROUNDED * size), MP.mpf(0))
        if first < 0:
            return side
    return 0


def _falls(series: Series, step: Real) -> Real | None:
    """The time within a step (s) at which a series becomes negative, after it has been positive; None if it does not."""
    if _stays(series, step):
        return None
    zero = ROUNDED * max(abs(term) * step**order for order, term in enumerate(series))
    rate = rate_of(series)
    edges = [step * number / PARTS for number in range(PARTS + 1)]
    for low, high in itertools.pairwise(edges):
        lowest = _crossed(rate, low, high, rising=True) if value(rate, low) < 0 < value(rate, high) else high
        if value(series, lowest) < -zero:
            highest = low if value(series, low) > zero else _crossed(rate, low, lowest, rising=False)
            return _crossed(series, highest, lowest, rising=False)
        if value(series, high) < -zero:
            return _crossed(series, lowest, high, rising=False)
    return None


def _stays(series: Series, step: Real) -> bool:
    """Return whether a series is certainly positive within a step (s), by its first terms in double precision."""
    terms = [abs(float(term * step**order)) for order, term in enumerate(series)]
    return float(series[0]) > (1 + CERTAIN) * sum(terms[1:]) + CERTAIN * terms[0]


def _crossed(series: Series, low: Real, high: Real, *, rising: bool) -> Real:
    """The place between two others at which a series changes its sign, from negative on if it rises."""
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        low, high = (middle, high) if (value(series, middle) < 0) == rising else (low, middle)
    rate, place = rate_of(series), high
    for _ in range(NEWTON_STEPS):
        steep = value(rate, place)
        place -= value(series, place) / steep if steep else MP.mpf(0)
    return place if low <= place <= high else high


def series_of(signal: Signal, time: Real) -> Series:
    """The power series of a signal about a time (s), for later times."""
    match signal:
        case Sine():
            a, w, p = MP.mpf(signal.amplitude), MP.mpf(signal.angular_frequency), MP.mpf(signal.phase)
            sine, cosine = a * MP.sin(w * time + p), a * MP.cos(w * time + p)
            terms, factor = [], MP.mpf(1)
            for order in range(TERMS + 1):
                terms.append(factor * (sine, cosine, -sine, -cosine)[order % 4])
                factor = factor * w / (order + 1)
            terms[0] += MP.mpf(signal.offset)
            return terms
        case Samples():
            moments = [MP.mpf(each) for each in signal.times]
            past = [index for index, moment in enumerate(moments) if moment <= time]
            if not past:
                return constant(signal.values[0])
            index = past[-1]
            here = MP.mpf(signal.values[index])
            if signal.between == "hold" or index + 1 == len(moments):
                return constant(here)
            slope = (MP.mpf(signal.values[index + 1]) - here) / (moments[index + 1] - moments[index])
            return [here + slope * (time - moments[index]), slope, *[MP.mpf(0)] * (TERMS - 1)]
        case _:
            return constant(signal)


def constant(number: Real) -> Series:
    """The series of a constant."""
    return [MP.mpf(number), *[MP.mpf(0)] * TERMS]


def times(series: Series, factor: Real) -> Series:
    """A series times a number."""
    return [factor * term for term in series]


def plus(one: Series, other: Series) -> Series:
    """The sum of two series."""
    return [a + b for a, b in zip(one, other, strict=True)]


def integral(series: Series, start: Real) -> Series:
    """The integral of a series, which begins at a number."""
    return [start, *(term / (order + 1) for order, term in enumerate(series[:-1]))]


def rate_of(series: Series) -> Series:
    """The derivative of a series."""
    return [*(order * term for order, term in enumerate(series) if order), MP.mpf(0)]


def value(series: Series, time: Real) -> Real:
    """The value of a series at a time (s)."""
    total = MP.mpf(0)
    for term in reversed(series):
        total = total * time + term
    return total


def _placed(clasp: Clasp, parts: Sequence[_Part]) -> list[Piece]:
    """The pieces of a displacement from its places along the line."""
    none, still = np.zeros((3, 2), Wide), pieces.wide([MP.mpf(each) for each in (1, 0, 0, 0)])
    direction, clock = pieces.wide(clasp.along)[:, None], np.array([0, 1], Wide)
    ways = [(start, pieces.wide(way), pieces.wide(rate_of(way))) for start, way in parts]
    return [Piece(start, none[:, 0], still, direction * way, direction * rate, none, None, clock) for start, way, rate in ways]
