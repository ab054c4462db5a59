"""Power series of a body that swings about its two fingers against torsional friction.

Half the angle has a cosine and a sine whose series follow from that of the angular velocity, coefficient by coefficient. They
are the rotation as a quaternion, and their products are the sine and the cosine of the angle.
"""

from dataclasses import dataclass

import numpy as np

from bodycheck.reference.bounds import EPS
from bodycheck.reference.contact.witness import pieces
from bodycheck.reference.contact.witness.clasping import Clasp
from bodycheck.reference.contact.witness.forces import (
    ROUNDED,
    TERMS,
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
from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.independent.arithmetic import Real, Wide, cross
from bodycheck.reference.independent.border import MP
from bodycheck.reference.witness import END, Instant

#: The angle (rad) by which a body turns at most in a step, and by which one at rest would fall in it.
ANGLE = MP.mpf(1) / 5

#: The halvings that locate where contacts slip.
HALVINGS = 70

#: The largest number of steps of a motion.
MOST_STEPS = 5000


@dataclass(frozen=True, eq=False)
class _Swing:
    """The time (s), angle (rad) and angular velocity (rad/s), and the sense in which it turns, 0 at rest."""

    time: Real
    angle: Real
    rate: Real
    sense: int


def swung(clasp: Clasp, start: Real, last: Real, edges: list[Real]) -> tuple[list[Piece], list[Instant]]:
    """Return the pieces and the events of a body that begins to turn at a time (s), until another.

    edges: the times (s) at which the press changes its formula. The motion ends where the contacts slip.
    """
    now = _Swing(start, MP.mpf(0), MP.mpf(0), 0)
    parts: list[Piece] = []
    events: list[Instant] = []
    held = True
    inertia = clasp.moment + clasp.mass * (clasp.lever**2 + clasp.rise**2)
    falling = clasp.mass * clasp.gravity / inertia
    natural = MP.sqrt(abs(falling) * MP.hypot(clasp.lever, clasp.rise))
    for _ in range(MOST_STEPS):
        step = min([last - now.time, *breaks(edges, now.time), ANGLE / (natural + abs(now.rate) + 1)])
        press = times(series_of(clasp.press, now.time), clasp.sign)
        friction = times(press, 2 * clasp.torsional / inertia)
        sense = now.sense or _begins(clasp, now, press, friction, falling)
        if bool(sense) == held and now.time > 0:
            events.append(Instant("turn" if sense else "rest", float(now.time), EPS * float(now.time), clasp.body))
        held = not sense
        cosine, sine, rate = _series(clasp, now, times(friction, -sense), falling if sense else MP.mpf(0))
        parts.append(_piece(clasp, now, cosine, sine, rate))
        angle = integral(rate, now.angle)
        margins = _margins(clasp, now, press, friction, falling)
        ends = [falls(times(rate, sense), step)] if sense else [falls(margin, step) for margin in margins]
        lasting = min((end for end in ends if end is not None), default=step)
        if sense and _slips(clasp, press, rate, angle, lasting):
            low, high = MP.mpf(0), lasting
            for _ in range(HALVINGS):
                middle = (low + high) / 2
                low, high = (low, middle) if _slips(clasp, press, rate, angle, middle) else (middle, high)
            until = float(now.time + high)
            return parts, [*events, Instant(END, until, 4 * EPS * until, clasp.body)]
        stopped = lasting < step or not sense
        now = _Swing(
            now.time + lasting, value(angle, lasting), MP.mpf(0) if stopped else value(rate, lasting), 0 if stopped else sense
        )
        if now.time >= last:
            return parts, events
    raise OutOfReach(f"a body that swings between fingers with more than {MOST_STEPS} steps")


def _arm(clasp: Clasp, angle: Real) -> tuple[Real, Real]:
    """The centre of mass (m) from the contacts, along the line and across it, at an angle (rad)."""
    cosine, sine = MP.cos_sin(angle)
    return cosine * clasp.rise - sine * clasp.lever, sine * clasp.rise + cosine * clasp.lever


def _margins(clasp: Clasp, now: _Swing, press: Series, friction: Series, falling: Real) -> tuple[Series, Series]:
    """The excess of the torsional friction over what the weight needs at rest (rad/s^2), and that of the friction (N)."""
    weight = abs(falling * _arm(clasp, now.angle)[1])
    bears = plus(times(press, 2 * clasp.friction), constant(-clasp.mass * abs(clasp.gravity)))
    return plus(friction, constant(-weight)), bears


def _begins(clasp: Clasp, now: _Swing, press: Series, friction: Series, falling: Real) -> int:
    """The sense in which a body at rest begins to turn; 0 if it is held."""
    holds, _ = _margins(clasp, now, press, friction, falling)
    first = next((term for term in holds if abs(term) > ROUNDED * max(map(abs, friction))), MP.mpf(0))
    return -int(MP.sign(falling * _arm(clasp, now.angle)[1])) if first < 0 else 0


def _slips(clasp: Clasp, press: Series, rate: Series, angle: Series, time: Real) -> bool:
    """Return whether the contacts slip at a time (s) since the start of a step."""
    along, across = _arm(clasp, value(angle, time))
    w, faster = value(rate, time), value(rate_of(rate), time)
    force = MP.hypot(-faster * across - w * w * along - clasp.gravity, faster * along - w * w * across)
    return bool(clasp.mass * force > 2 * clasp.friction * value(press, time))


def _series(clasp: Clasp, now: _Swing, braking: Series, falling: Real) -> tuple[Series, Series, Series]:
    """The series of cosine and sine of half the angle, and of the angular velocity."""
    cosine, sine, rate = [MP.cos(now.angle / 2)], [MP.sin(now.angle / 2)], [now.rate]
    for k in range(TERMS):
        whole_cosine = sum((cosine[i] * cosine[k - i] - sine[i] * sine[k - i] for i in range(k + 1)), MP.mpf(0))
        whole_sine = 2 * sum((sine[i] * cosine[k - i] for i in range(k + 1)), MP.mpf(0))
        aside = whole_sine * clasp.rise + whole_cosine * clasp.lever
        turning = [sum((rate[i] * part[k - i] for i in range(k + 1)), MP.mpf(0)) for part in (sine, cosine)]
        rate.append((braking[k] - falling * aside) / (k + 1))
        cosine.append(-turning[0] / (2 * (k + 1)))
        sine.append(turning[1] / (2 * (k + 1)))
    return cosine, sine, rate


def _piece(clasp: Clasp, now: _Swing, cosine: Series, sine: Series, rate: Series) -> Piece:
    """The piece of a step, whose path begins at the place of the body at t = 0."""
    pairs = [(cosine, cosine, 1), (sine, sine, -1)]
    whole_cosine, whole_sine = [MP.mpf(0)] * (TERMS + 1), [MP.mpf(0)] * (TERMS + 1)
    for k in range(TERMS + 1):
        whole_cosine[k] = sum((sign * a[i] * b[k - i] for a, b, sign in pairs for i in range(k + 1)), MP.mpf(0))
        whole_sine[k] = 2 * sum((sine[i] * cosine[k - i] for i in range(k + 1)), MP.mpf(0))
    along = plus(times(whole_cosine, clasp.rise), times(whole_sine, -clasp.lever))
    across = plus(times(whole_sine, clasp.rise), times(whole_cosine, clasp.lever))
    along, across = plus(along, constant(-clasp.rise)), plus(across, constant(-clasp.lever))
    normal, line = pieces.wide(clasp.normal)[:, None], pieces.wide(clasp.along)[:, None]
    side = pieces.wide(cross(clasp.normal, clasp.along))[:, None]
    path = line * pieces.wide(along) + side * pieces.wide(across)
    fast = line * pieces.wide(rate_of(along)) + side * pieces.wide(rate_of(across))
    turning = np.concatenate([pieces.wide(cosine)[None], normal * pieces.wide(sine)])
    none = np.zeros(3, Wide)
    spin, clock = normal * pieces.wide(rate), np.array([0, 1], Wide)
    return Piece(now.time, none, turning[:, 0], path, fast, spin, turning, clock)
