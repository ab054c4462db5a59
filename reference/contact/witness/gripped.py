"""The witness of a body between two fingers: power series of all forces and motions in short steps.

Friction and forces are along a line. The acceleration r of the body relative to its fingers makes Gauss's function r^2/2 - b r,
with the power of friction B |r|, smallest, where b is the acceleration without friction and B the largest that friction gives.
With the body at rest on its fingers, B - |b| decides by the first term of its series that is not zero.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.bounds import EPS, STATES
from bodycheck.reference.contact.witness import pieces
from bodycheck.reference.contact.witness.clasping import Clasp, clasp_of
from bodycheck.reference.contact.witness.forces import (
    ROUNDED,
    Series,
    breaks,
    constant,
    falls,
    integral,
    plus,
    rate_of,
    series_of,
    times,
    value,
)
from bodycheck.reference.contact.witness.pieces import Piece
from bodycheck.reference.contact.witness.swinging import swung
from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.independent.arithmetic import Real, Wide
from bodycheck.reference.independent.border import MP
from bodycheck.reference.mechanisms.control import Samples, Sine
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.trajectory import Array
from bodycheck.reference.witness import END, Instant, Witness

#: The name of the way in results.
NAME = "power series of a gripped body (mpmath)"

#: The largest angle (rad) by which a sine advances in a step.
ANGLE = MP.mpf(1) / 2

#: The largest number of steps of a motion.
MOST_STEPS = 40_000

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


def second(scene: AnyScene, instants: Array) -> Witness | None:
    """The motion of a gripped body and its fingers at ascending instants (n,) >= 0 (s).

    Raises `NotModelled` for one that turns and slips, and `OutOfReach` for too many steps.
    """
    if not isinstance(scene, Mechanism) or not scene.joints:
        return None
    clasp = clasp_of(scene)
    last = MP.mpf(float(instants.max(initial=0.0)))
    edges = _edges(clasp)
    parts, events, turns_at = _followed(clasp, last, edges)
    swings, turned = ([], []) if turns_at is None else swung(clasp, turns_at, last, edges)
    of_body = pieces.states([*_placed(clasp, parts[0]), *swings], instants)
    of_carriage = pieces.states(_placed(clasp, parts[1]), instants)
    states = [of_body if index == clasp.body else of_carriage for index in range(len(scene.bodies))]
    centres = np.stack([pieces.wide(centre) for centre in clasp.centres])
    errors = {name: np.maximum(of_body.errors[name], of_carriage.errors[name]) for name in STATES}
    errors["position_error"] = errors["position_error"] + pieces.ROUNDINGS * float(np.abs(centres).max())
    attitudes = [
        np.stack(pieces.multiplied(each.turn.T, start), axis=1) for each, start in zip(states, clasp.attitudes, strict=True)
    ]
    return Witness(
        NAME,
        np.stack(attitudes),
        np.stack([pieces.along_body(each.spin, turn) for each, turn in zip(states, attitudes, strict=True)]),
        np.stack([centre + each.position for centre, each in zip(centres, states, strict=True)]),
        np.stack([each.velocity for each in states]),
        errors["error"] + pieces.ROUNDINGS,
        errors["angular_velocity_error"] + pieces.ROUNDINGS * float(np.abs(of_body.spin).max(initial=0)),
        errors["position_error"],
        errors["velocity_error"],
        events=(*events, *turned),
    )


def _edges(clasp: Clasp) -> list[Real]:
    """The times (s) at which a force changes its formula."""
    signals = clasp.press, *clasp.effort
    return sorted({MP.mpf(time) for signal in signals if isinstance(signal, Samples) for time in signal.times})


def _followed(
    clasp: Clasp, last: Real, edges: list[Real]
) -> tuple[tuple[list[_Part], list[_Part]], list[Instant], Real | None]:
    """The places of body and carriage as series, each from a time (s) on, the events, and the time at which the body turns.

    edges: see `_edges`. The motion ends at a time (s), or where the body turns.
    """
    now, events = _Line(MP.mpf(0), (MP.mpf(0), clasp.speed), (MP.mpf(0), clasp.carried)), list[Instant]()
    parts: tuple[list[_Part], list[_Part]] = [], []
    signals = clasp.press, *clasp.effort
    fastest = max((abs(MP.mpf(signal.angular_frequency)) for signal in signals if isinstance(signal, Sine)), default=MP.mpf(0))
    slipped = None
    for _ in range(MOST_STEPS):
        left = [last - now.time, *breaks(edges, now.time)]
        step = min([*left, ANGLE / fastest]) if fastest else min(left)
        forces = _forces(clasp, now.time)
        sign = int(MP.sign(now.slip)) if abs(now.slip) > ROUNDED else _starts(forces)
        if (opened := falls(forces.press, step)) is not None and opened <= ROUNDED:
            return parts, [*events, _ended(clasp, now.time)], None
        if sign and (not any(clasp.reach) or (clasp.turning and (clasp.one or clasp.light))):
            return parts, [*events, _ended(clasp, now.time)], None
        if sign and clasp.turning:
            for part in parts:
                part.append((now.time, constant(0)))
            return parts, events, now.time
        if slipped is not None and bool(slipped) != bool(sign):
            events.append(Instant("slip" if sign else "rest", float(now.time), EPS * float(now.time), clasp.body))
        slipped = sign
        rates = _rates(clasp, forces, sign)
        ways = [integral(integral(rate, at[1]), at[0]) for rate, at in zip(rates, (now.body, now.carriage), strict=True)]
        for part, way in zip(parts, ways, strict=True):
            part.append((now.time, way))
        slid = plus(ways[0], times(ways[1], -1))
        tests = [times(rate_of(slid), sign)] if sign else _margins(forces)
        known = [falls(each, step) for each in (*(_left(clasp, slid) if sign else ()), forces.press)]
        ends = [end for end in (falls(test, step) for test in tests) if end is not None]
        over = min((end for end in known if end is not None), default=MP.inf)
        if over < min(ends, default=MP.inf):
            return parts, [*events, _ended(clasp, now.time + over)], None
        lasting = min(ends, default=step)
        body, carriage = ((value(way, lasting), value(rate_of(way), lasting)) for way in ways)
        now = _Line(now.time + lasting, body if sign and not ends else (body[0], carriage[1]), carriage)
        if now.time >= last:
            return parts, events, None
    raise OutOfReach(f"a gripped body with more than {MOST_STEPS} steps")


def _left(clasp: Clasp, slid: Series) -> list[Series]:
    """The ways (m) that are left until the body slips out of its fingers, from the way along them."""
    both = zip((-1, 1), clasp.reach, strict=True)
    return [plus(constant(way), times(slid, -side)) for side, way in both if not MP.isinf(way)]


def _ended(clasp: Clasp, time: Real) -> Instant:
    """The instant from which on the motion is not known."""
    return Instant(END, float(time), EPS * float(time), clasp.body)


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


def _placed(clasp: Clasp, parts: Sequence[_Part]) -> list[Piece]:
    """The pieces of a displacement from its places along the line."""
    none, still = np.zeros((3, 2), Wide), pieces.wide([MP.mpf(each) for each in (1, 0, 0, 0)])
    direction, clock = pieces.wide(clasp.along)[:, None], np.array([0, 1], Wide)
    ways = [(start, pieces.wide(way), pieces.wide(rate_of(way))) for start, way in parts]
    return [Piece(start, none[:, 0], still, direction * way, direction * rate, none, None, clock) for start, way, rate in ways]
