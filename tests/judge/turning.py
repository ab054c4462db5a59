"""Attitudes of bodies whose angular velocity is known: quaternions as power series."""

from collections.abc import Sequence
from decimal import Decimal
from functools import cache
from typing import Any

from tests.judge.numerals import (
    HALF,
    ONE,
    ZERO,
    Matrix,
    Quaternion,
    Vector,
    about,
    matrix_of,
    product,
    sine_cosine,
    size,
    times,
)
from tests.judge.series import ORDER, Tape, at

#: Speed of a slip, relative to that at its begin, below which the angular velocity counts as constant: 1e-12 s before its end.
LAST_SLIP = Decimal("1e-12")


def turned(spin: Vector, time: Decimal) -> Matrix:
    """Return the rotation of a body that turns steadily for a time; along fixed axes."""
    rate = size(spin)
    return about(times(1 / rate, spin), *sine_cosine(rate * time)) if rate else about((ONE, ZERO, ZERO), ZERO, ONE)


def quaternion_rates(spin: Vector, quaternion: Sequence[Any]) -> tuple[Any, Any, Any, Any]:
    """Return the derivative of the quaternion of a body with an angular velocity along fixed axes."""
    a, b, c = spin
    w, x, y, z = quaternion
    return (
        -(a * x + b * y + c * z) * HALF,
        (a * w + b * z - c * y) * HALF,
        (b * w + c * x - a * z) * HALF,
        (c * w + a * y - b * x) * HALF,
    )


@cache
def _steadily_changing() -> Tape:
    """Return the equations of a quaternion and an angular velocity that changes at a constant rate."""
    tape = Tape()
    quaternion, spin = [tape.state() for _ in range(4)], [tape.state() for _ in range(3)]
    changes = [tape.parameter() for _ in range(3)]
    for state, rate in zip(quaternion, quaternion_rates((spin[0], spin[1], spin[2]), quaternion), strict=True):
        tape.rate(state, rate)
    for state, rate in zip(spin, changes, strict=True):
        tape.rate(state, rate)
    return tape


@cache
def _slipping() -> Tape:
    """Return the equations of a quaternion while the point that touches slips across its drive.

    States: the quaternion, the angular velocity, the slip along x and y. Parameters: the drive along x and y, the deceleration
    by friction, and by how much friction changes the angular velocity.
    """
    tape = Tape()
    quaternion, spin = [tape.state() for _ in range(4)], [tape.state() for _ in range(3)]
    slip, drive = [tape.state() for _ in range(2)], [tape.parameter() for _ in range(2)]
    friction, turning = tape.parameter(), tape.parameter()
    speed = (slip[0] * slip[0] + slip[1] * slip[1]).sqrt()
    x, y = slip[0] / speed, slip[1] / speed
    for state, rate in zip(quaternion, quaternion_rates((spin[0], spin[1], spin[2]), quaternion), strict=True):
        tape.rate(state, rate)
    for state, rate in zip(spin, (-(y * turning), x * turning, ZERO), strict=True):
        tape.rate(state, rate)
    tape.rate(slip[0], drive[0] - x * friction)
    tape.rate(slip[1], drive[1] - y * friction)
    return tape


def integrated(
    tape: Tape,
    states: Sequence[Decimal],
    parameters: Sequence[Decimal],
    instants: Sequence[Decimal],
    until: Decimal | None = None,
) -> tuple[list[list[Decimal]], Decimal]:
    """Return the states of a tape at ascending instants (s) >= 0, and the last time that was reached.

    until: the length of the last two states at which the integration ends; instants after that have the states there.
    """
    now, numbers, sampled = ZERO, list(states), list[list[Decimal]]()
    while len(sampled) < len(instants):
        if until is not None and size(numbers[-2:]) <= until:
            return sampled + [numbers] * (len(instants) - len(sampled)), now
        tape.expand([*numbers, *parameters], ORDER)
        step, left = tape.step(), instants[-1] - now
        step = left if step is None else min(step, left)
        while len(sampled) < len(instants) and instants[len(sampled)] <= now + step:
            sampled.append([at(term.coefficients, instants[len(sampled)] - now) for term in tape.states])
        numbers = [at(term.coefficients, step) for term in tape.states]
        now += step
    return sampled, now


def with_steady_change(spin: Vector, change: Vector, instants: Sequence[Decimal]) -> list[Matrix]:
    """Return the rotations since the begin of a body whose angular velocity changes at a constant rate."""
    states = [ONE, ZERO, ZERO, ZERO, *spin]
    return [_rotation(row) for row in integrated(_steadily_changing(), states, change, instants)[0]]


def while_slipping(
    spin: Vector,
    slip: Sequence[Decimal],
    drive: Sequence[Decimal],
    friction: Decimal,
    turning: Decimal,
    instants: Sequence[Decimal],
) -> list[Matrix]:
    """Return the rotations since the begin of a body whose point that touches slips; arguments as in `_slipping`."""
    states = [ONE, ZERO, ZERO, ZERO, *spin, *slip]
    rows, reached = integrated(_slipping(), states, [*drive, friction, turning], instants, LAST_SLIP * size(slip))
    left = [max(ZERO, time - reached) for time in instants]
    return [product(turned((row[4], row[5], row[6]), time), _rotation(row)) for row, time in zip(rows, left, strict=True)]


def _rotation(row: Sequence[Decimal]) -> Matrix:
    quaternion: Quaternion = (row[0], row[1], row[2], row[3])
    return matrix_of(quaternion)
