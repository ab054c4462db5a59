"""Spheres on a plane with rolling and torsional friction: phases with constant rates, and integrated ones, until rest.

Slip is v - p, where p = r w x n is the velocity that a body which rolls would have; s = r w_n. With separate limits, each
force brakes its own velocity. In one cone, the forces are the gradients of the size of all velocities with their coefficients.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal
from functools import cache
from typing import Any

from tests.judge.numerals import HALF, ONE, ZERO, Matrix, Vector, exact, matrix_of, product
from tests.judge.planes import OnPlane, on_plane
from tests.judge.series import Tape
from tests.judge.states import Motion, State
from tests.judge.turning import integrated, quaternion_rates, with_steady_change

#: The size of a velocity, relative to its first, at which it has vanished; what is left takes its square in what follows.
GONE = Decimal("1e-18")

#: The longest step as a part of the time until a velocity vanishes.
MOST_OF_IT = Decimal("0.7")

#: Velocities (m/s) that are rounding.
NOTHING = Decimal("1e-40")

#: The sine of the angle between two directions that are one, for the decimals of a file.
ASIDE = Decimal("1e-12")


@dataclass(frozen=True)
class _Ball:
    radius: Decimal
    ratio: Decimal
    drive: Decimal
    friction: Decimal | None
    rolling: Decimal
    torsional: Decimal
    one: bool


@dataclass(frozen=True)
class _Now:
    """Position, rotation since the start, slip, rolling velocity and pivoting velocity."""

    position: Vector
    turn: Matrix
    slip: tuple[Decimal, Decimal]
    roll: tuple[Decimal, Decimal]
    pivot: Decimal

    def state(self, body: OnPlane, ball: _Ball) -> State:
        """Return the state in the world."""
        velocity = (self.slip[0] + self.roll[0], self.slip[1] + self.roll[1], ZERO)
        return body.in_world(self.position, velocity, product(self.turn, body.turn), spin_of(self, ball))


def spin_of(now: _Now, ball: _Ball) -> Vector:
    """Return the angular velocity along the axes of the plane."""
    return (-now.roll[1] / ball.radius, now.roll[0] / ball.radius, now.pivot / ball.radius)


def motion(text: str, instants: Sequence[Decimal]) -> Motion:
    """Return the motion of a sphere with rolling or torsional friction that begins on the plane."""
    body = on_plane(text)
    ball = _ball(body)
    r, spin = ball.radius, body.spin
    roll = (r * spin[1], -r * spin[0])
    slip = (body.velocity[0] - roll[0], body.velocity[1] - roll[1])
    scale = _size(body.velocity[:2]) + _size(roll)
    if _size(slip) <= ASIDE * scale:
        slip = (ZERO, ZERO)
    identity = ((ONE, ZERO, ZERO), (ZERO, ONE, ZERO), (ZERO, ZERO, ONE))
    now = _Now((*body.position[:2], r), identity, slip, roll, r * spin[2])
    time, states, events, slipped = ZERO, dict[int, State](), list[tuple[str, Decimal]](), slip != (ZERO, ZERO)
    for number in range(50):
        rates = _line(ball, now)
        still = not any((*now.slip, *now.roll, now.pivot)) and rates is not None and not any(rates)
        slips = now.slip != (ZERO, ZERO) or (rates is not None and any(rates[:2]))
        if number and still:
            events.append(("rest", time))
        elif number and slips != slipped and not ball.one:
            events.append(("slip" if slips else "roll", time))
        slipped = slips
        waiting = [i for i in range(len(instants)) if i not in states]
        if not waiting:
            break
        later = [instants[i] - time for i in waiting]
        rows, length, after = _steady(ball, now, rates, later) if rates is not None else _curved(ball, now, later)
        for i, row in zip(waiting, rows, strict=False):
            states[i] = row.state(body, ball)
        if length is None or after is None:
            break
        time, now = time + length, after
    return Motion(states, [event for event in events if event[1] <= instants[-1]])


def _ball(body: OnPlane) -> _Ball:
    radius, load = exact(body.table["radius"]), -body.gravity[2]
    plane = body.plane
    rolling, torsional = (load * exact(plane.get(key, 0)) / radius for key in ("rolling_friction", "torsional_friction"))
    ratio = body.inertia.tensor[0][0] / (body.inertia.mass * radius * radius)
    friction = None if body.friction is None else load * body.friction
    return _Ball(radius, ratio, body.gravity[0], friction, rolling, torsional, plane.get("cone") == "one")


def _size(pair: Sequence[Decimal]) -> Decimal:
    return sum((part * part for part in pair), ZERO).sqrt()


def _line(ball: _Ball, now: _Now) -> tuple[Decimal, ...] | None:
    """Return the rates of slip, rolling and pivoting velocity along a line with separate limits, or of rest; else None."""
    if ball.one:
        assert ball.friction is not None
        held = ball.drive**2 * (1 / ball.friction**2 + 1 / ball.rolling**2) <= 1
        moving = any((*now.slip, *now.roll)) or (now.pivot and ball.torsional)
        return None if moving else (ZERO,) * 5 if held else _from_rest(ball)
    pairs = [pair for pair in (now.slip, now.roll) if any(pair)]
    if ball.drive or not pairs:
        x, y = ONE, ZERO
    else:
        x, y = (part / _size(pairs[0]) for part in pairs[0])
    if any(abs(a * y - b * x) > ASIDE * _size((a, b)) for a, b in pairs):
        return None
    slip, roll = (a * x + b * y for a, b in (now.slip, now.roll))
    faster, rolled = _accelerations(ball, slip, roll, ball.drive * x)
    pivot = -ball.torsional / ball.ratio * (ONE.copy_sign(now.pivot) if now.pivot else ZERO)
    return faster * x, faster * y, rolled * x, rolled * y, pivot


def _accelerations(ball: _Ball, slip: Decimal, roll: Decimal, drive: Decimal) -> tuple[Decimal, Decimal]:
    """Return the rates of slip and rolling velocity, from what would happen if nothing moved that stands."""
    k, most, moment = ball.ratio, ball.friction, ball.rolling
    if not slip and not roll:
        if (most is None or abs(drive) <= most) and abs(drive) <= moment:
            return ZERO, ZERO
        roll_only = _rolled(ball, ONE.copy_sign(drive), drive)
        if roll_only is not None:
            return ZERO, roll_only
        assert most is not None
        pushed = drive - most.copy_sign(drive)
        turned = max(most - moment, ZERO).copy_sign(drive) / k
        return pushed - turned, turned
    if not slip:
        rolled = _rolled(ball, ONE.copy_sign(roll), drive)
        if rolled is not None:
            return ZERO, rolled
        assert most is not None
        resisting = -moment.copy_sign(roll)
        way = ONE.copy_sign((drive * k - resisting) / (1 + k))  # of the slip that friction does not hold
        turned = (resisting + most * way) / k
        return drive - most * way - turned, turned
    assert most is not None
    force = -most.copy_sign(slip)
    if not roll and most <= moment:
        return drive + force, ZERO
    resisting = -moment.copy_sign(roll if roll else -force)
    turned = (resisting - force) / k
    return drive + force - turned, turned


def _rolled(ball: _Ball, way: Decimal, drive: Decimal) -> Decimal | None:
    """Return the rate at which a ball rolls in a direction without slip; None if friction does not hold it."""
    rate = (drive - ball.rolling * way) / (1 + ball.ratio)
    return rate if ball.friction is None or abs(rate - drive) <= ball.friction else None


def _from_rest(ball: _Ball) -> tuple[Decimal, ...]:
    """Return the constant rates in one cone of a ball that is released and not held, by Newton's method for their ratio."""
    a, b, k, drive = ball.friction, ball.rolling, ball.ratio, ball.drive
    assert a is not None

    def rates(angle: Decimal) -> tuple[Decimal, Decimal, Decimal]:
        cosine, sine = 1 / (1 + angle * angle).sqrt(), angle / (1 + angle * angle).sqrt()
        force, moment = -a * cosine, -b * sine
        rolled = (moment - force) / k
        slipped = drive + force - rolled
        return slipped, rolled, slipped * sine / b - rolled * cosine / a

    low, high = ZERO, Decimal("1e12")
    for _ in range(400):
        middle = (low + high) / 2
        low, high = (low, middle) if rates(middle)[2] > 0 else (middle, high)
    slipped, rolled, _ = rates(low)
    return slipped, ZERO, rolled, ZERO, ZERO


def _steady(
    ball: _Ball, now: _Now, rates: Sequence[Decimal], instants: Sequence[Decimal]
) -> tuple[list[_Now], Decimal | None, _Now | None]:
    """Return the ball at instants of a phase with constant rates, the length of the phase, and the ball at its end."""
    values = (*now.slip, *now.roll, now.pivot)
    ends = [-v / a for v, a in zip(values, rates, strict=True) if v * a < 0]
    length = min(ends, default=None)
    here = [t for t in instants if length is None or t <= length]
    times = here if length is None else [*here, length]
    start = spin_of(now, ball)
    change = spin_of(_Now(now.position, now.turn, ZERO_PAIR, (rates[2], rates[3]), rates[4]), ball)
    turns = with_steady_change(start, change, times) if times else []
    rows = []
    for time, turn in zip(times, turns, strict=True):
        u_x, u_y, p_x, p_y, s = (v + a * time for v, a in zip(values, rates, strict=True))
        way = [
            x + time * (values[i] + values[i + 2] + time * HALF * (rates[i] + rates[i + 2]))
            for i, x in enumerate(now.position[:2])
        ]
        rows.append(_Now((way[0], way[1], ball.radius), product(turn, now.turn), (u_x, u_y), (p_x, p_y), s))
    if length is None:
        return rows, None, None
    last, largest = rows[-1], max(map(abs, values))
    left = [ZERO if abs(v) <= NOTHING * largest else v for v in (*last.slip, *last.roll, last.pivot)]
    return rows[:-1], length, _Now(last.position, last.turn, (left[0], left[1]), (left[2], left[3]), left[4])


ZERO_PAIR = (ZERO, ZERO)


@cache
def _equations(kind: str) -> Tape:
    """Return the equations of position, quaternion, pivoting velocity, and then the velocities of which the last two vanish.

    Parameters: radius, ratio, drive, limits of friction, rolling and torsion, and the sign of the pivoting velocity.
    """
    tape = Tape()
    place, quaternion, pivot = [tape.state() for _ in range(2)], [tape.state() for _ in range(4)], tape.state()
    one, other = [tape.state() for _ in range(2)], [tape.state() for _ in range(2)]
    roll, slip = (one, other) if kind == "slip" else (other, one)
    radius, ratio, drive, friction, rolling, torsional, sign = (tape.parameter() for _ in range(7))
    u, p = (pair[0] * pair[0] + pair[1] * pair[1] for pair in (slip, roll))
    if kind == "cone":
        size = (friction * friction * u + rolling * rolling * p + torsional * torsional * pivot * pivot).sqrt()
        force = [part * friction * friction / size for part in slip]
        moment = [part * rolling * rolling / size for part in roll]
        twist = pivot * torsional * torsional / size
    else:
        moment = [part * rolling / p.sqrt() for part in roll]
        force = [part * friction / u.sqrt() for part in slip] if kind == "slip" else moment
        twist = torsional * sign
    drives = drive, drive - drive
    rolls, slips = [], []
    for axis in (0, 1):
        if kind == "roll":
            rolled, slipped = (drives[axis] - moment[axis]) / (ratio + ONE), drive - drive
        else:
            rolled = (force[axis] - moment[axis]) / ratio
            slipped = drives[axis] - force[axis] - rolled
        rolls.append(rolled)
        slips.append(slipped)
    spin: tuple[Any, Any, Any] = (-(roll[1] / radius), roll[0] / radius, pivot / radius)
    # The states of a tape are in the order in which their rates are stated.
    rates = [slip[axis] + roll[axis] for axis in (0, 1)] + list(quaternion_rates(spin, quaternion)) + [-(twist / ratio)]
    rates += rolls + slips if kind == "slip" else slips + rolls
    for state, rate in zip((*place, *quaternion, pivot, *one, *other), rates, strict=True):
        tape.rate(state, rate)
    return tape


def _curved(ball: _Ball, now: _Now, instants: Sequence[Decimal]) -> tuple[list[_Now], Decimal | None, _Now | None]:
    """Return the ball at instants of a phase whose rates change, its length, and the ball at its end."""
    kind = "cone" if ball.one else "slip" if any(now.slip) else "roll"
    if kind == "slip" and not any(now.roll):
        raise ValueError("a ball that begins to roll across its slip")
    assert ball.friction is not None
    ordered = (*now.roll, *now.slip) if kind == "slip" else (*now.slip, *now.roll)
    sign = ONE.copy_sign(now.pivot) if now.pivot else ZERO
    stop = abs(now.pivot) * ball.ratio / ball.torsional if now.pivot and ball.torsional and not ball.one else None
    until = instants[-1] if stop is None else min(stop, instants[-1])
    here = [t for t in instants if t <= until]
    times = [*here, until] if not here or here[-1] < until else here
    parameters = [ball.radius, ball.ratio, ball.drive, ball.friction, ball.rolling, ball.torsional, sign]
    start = [*now.position[:2], ONE, ZERO, ZERO, ZERO, now.pivot, *ordered]
    rows, reached = _integrated(ball, now, kind, [*start, *parameters], times)
    balls = [_read(ball, now, kind, row) for row in rows]
    if reached >= until:
        after = _Now(
            balls[-1].position, balls[-1].turn, balls[-1].slip, balls[-1].roll, ZERO if stop == until else balls[-1].pivot
        )
        return balls[: len(here)], (until if stop == until else None), after
    last = balls[-1]
    vanished = (
        _Now(last.position, last.turn, ZERO_PAIR, ZERO_PAIR, ZERO if ball.torsional else last.pivot)
        if kind == "cone"
        else _Now(last.position, last.turn, ZERO_PAIR, last.roll, last.pivot)
        if kind == "slip"
        else _Now(last.position, last.turn, ZERO_PAIR, ZERO_PAIR, last.pivot)
    )
    left = _left(ball, last, kind)
    return [each for t, each in zip(here, balls, strict=False) if t <= reached], reached + left, vanished


def _integrated(
    ball: _Ball, now: _Now, kind: str, start: Sequence[Decimal], times: Sequence[Decimal]
) -> tuple[list[Sequence[Decimal]], Decimal]:
    """Return the states of the equations at ascending times, and the last time, at which a velocity may have vanished.

    A velocity that keeps its direction changes uniformly, and its series do not show that it vanishes: no step is longer than
    most of the time that is left.
    """
    tape, numbers, parameters = _equations(kind), list(start[:11]), start[11:]
    rows: list[Sequence[Decimal]] = []
    reached, first = ZERO, _size(numbers[6:])
    while len(rows) < len(times):
        current = _read(ball, now, kind, numbers)
        left = _left(ball, current, kind)
        vanishing = _size((current.pivot * (ball.torsional > 0), *numbers[7:])) if kind == "cone" else _size(numbers[9:])
        if vanishing <= GONE * first:
            return rows + [numbers] * (len(times) - len(rows)), reached
        until = min(reached + left * MOST_OF_IT, times[-1]) if left > 0 else times[-1]
        here = [time - reached for time in times[len(rows) :] if time <= until]
        seen, _ = integrated(tape, numbers, parameters, [*here, until - reached])
        rows += seen[: len(here)]
        numbers, reached = seen[-1], until
    return rows, reached


def _left(ball: _Ball, last: _Now, kind: str) -> Decimal:
    """Return the time until the last velocities vanish, from their rate; their direction no longer changes."""
    assert ball.friction is not None
    u, p = _size(last.slip), _size(last.roll)
    if kind == "roll":
        cosine = last.roll[0] / p
        return p * (1 + ball.ratio) / (ball.rolling - ball.drive * cosine)
    if kind == "slip":
        pull = [ball.drive + ball.rolling / ball.ratio * last.roll[0] / p, ball.rolling / ball.ratio * last.roll[1] / p]
        along = sum((a * b for a, b in zip(pull, last.slip, strict=True)), ZERO) / u
        return u / (ball.friction * (1 + 1 / ball.ratio) - along)
    square = (ball.friction * u) ** 2 + (ball.rolling * p) ** 2 + (ball.torsional * last.pivot) ** 2
    falling = ball.torsional**4 * last.pivot**2 / ball.ratio
    for i in (0, 1):
        force, moment = ball.friction**2 * last.slip[i], ball.rolling**2 * last.roll[i]
        rolled = (force - moment) / ball.ratio  # times the size, as all rates
        slipped = ball.drive * square.sqrt() * (1 - i) - force - rolled
        falling -= force * slipped + moment * rolled
    return square * square.sqrt() / falling if falling else -ONE


def _read(ball: _Ball, now: _Now, kind: str, row: Sequence[Decimal]) -> _Now:
    """Return the ball from the states of the equations."""
    roll, slip = ((row[7], row[8]), (row[9], row[10])) if kind == "slip" else ((row[9], row[10]), (row[7], row[8]))
    turn = product(matrix_of((row[2], row[3], row[4], row[5])), now.turn)
    return _Now((row[0], row[1], ball.radius), turn, slip, roll, row[6])
