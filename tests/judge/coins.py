"""Cylinders that roll on a rim of a level plane without slip: Newton's and Euler's equations along the axes of the plane.

K is the axis, d the steepest way down across it, and the rim touches at -h K + r d from the centre of mass. The force there
gives the centre of mass its acceleration, and its moment turns the body; the velocity of the rim is zero.
"""

from collections.abc import Sequence
from decimal import Decimal
from functools import cache
from typing import Any

from tests.judge.numerals import ONE, ZERO, Vector, applied, cross, dot, exact, matrix_of, minus, plus, product, solved, times
from tests.judge.planes import on_plane, support
from tests.judge.series import ORDER, Tape, at, first_root
from tests.judge.states import Motion
from tests.judge.turning import quaternion_rates

NORMAL: Vector = (ZERO, ZERO, ONE)


@cache
def _rolling() -> tuple[Tape, dict[str, Any]]:
    """Return the equations. States: the quaternion since the start, the spin, the foot of the centre of mass.

    Parameters: the axis K at the start, radius, half the length, moments across and along the axis over the mass, gravity, and
    the square of the friction. Results: the axis, the velocity, the load and what is left of friction, over the mass.
    """
    tape = Tape()
    quaternion, spin = [tape.state() for _ in range(4)], (tape.state(), tape.state(), tape.state())
    foot = [tape.state() for _ in range(2)]
    start = (tape.parameter(), tape.parameter(), tape.parameter())
    radius, half, across, along, gravity, friction = (tape.parameter() for _ in range(6))
    w, x, y, z = quaternion
    axis = applied(
        (
            (ONE - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
            (2 * (x * y + w * z), ONE - 2 * (x * x + z * z), 2 * (y * z - w * x)),
            (2 * (x * z - w * y), 2 * (y * z + w * x), ONE - 2 * (x * x + y * y)),
        ),
        start,
    )
    turning = cross(spin, axis)
    sine = (ONE - axis[2] * axis[2]).sqrt()
    down = times(ONE / sine, minus(times(axis[2], axis), NORMAL))
    sine_rate = -(axis[2] * turning[2]) / sine
    down_rate = times(ONE / sine, minus(plus(times(turning[2], axis), times(axis[2], turning)), times(sine_rate, down)))
    arm = minus(times(radius, down), times(half, axis))
    arm_rate = minus(times(radius, down_rate), times(half, turning))
    velocity = cross(arm, spin)
    excess, reach = along - across, dot(arm, arm)
    matrix = {
        (i, j): excess * (axis[i] * axis[j]) - arm[i] * arm[j] + (across + reach if i == j else ZERO)
        for i in range(3)
        for j in range(3)
    }
    bias = cross(arm_rate, spin)
    moment = minus(cross(arm, (bias[0], bias[1], bias[2] + gravity)), times(excess * dot(spin, axis), turning))
    rates = solved(matrix, dict(enumerate(moment)), range(3))
    change = (rates[0], rates[1], rates[2])
    force = plus(bias, cross(arm, change), (ZERO, ZERO, gravity))
    for state, rate in zip(quaternion, quaternion_rates(spin, quaternion), strict=True):
        tape.rate(state, rate)
    for state, rate in zip(spin, change, strict=True):
        tape.rate(state, rate)
    for state, rate in zip(foot, velocity[:2], strict=True):
        tape.rate(state, rate)
    margin = friction * (force[2] * force[2]) - (force[0] * force[0] + force[1] * force[1])
    tape.watch(margin)
    tape.watch(force[2])
    return tape, {"axis": axis, "velocity": velocity, "friction": margin, "load": force[2]}


def motion(text: str, instants: Sequence[Decimal]) -> Motion:
    """Return the motion as long as friction holds the rim, and the side does not land. It begins with the state of the file."""
    body = on_plane(text)
    tape, results = _rolling()
    sign = ONE.copy_sign(body.turn[2][2])
    axis = tuple(sign * row[2] for row in body.turn)
    mass, tensor = body.inertia.mass, body.inertia.tensor
    friction = ZERO if body.friction is None else body.friction**2
    lengths = (exact(body.table["radius"]), exact(body.table["half_length"]))
    parameters = [*axis, *lengths, tensor[0][0] / mass, tensor[2][2] / mass, -body.gravity[2], friction]
    numbers = [ONE, ZERO, ZERO, ZERO, *body.spin, *body.position[:2]]
    start = body.in_world(body.position, body.velocity, body.turn, body.spin)
    now, states = ZERO, {i: start for i, instant in enumerate(instants) if not instant}
    while True:
        tape.expand([*numbers, *parameters], ORDER)
        step, left = tape.step(), instants[-1] - now
        step = left if step is None else min(step, left)
        limits = [("slip", results["load"]), ("impact", results["axis"][2])]
        if body.friction is not None:
            limits.append(("slip", results["friction"]))
        margins = [(kind, limit.coefficients) for kind, limit in limits]
        roots = [(ZERO if margin[0] < 0 else first_root(margin, step), kind) for kind, margin in margins]
        end, kind = min(((root, kind) for root, kind in roots if root is not None), default=(step, ""))
        for i, instant in enumerate(instants):
            if i not in states and now <= instant <= now + end:
                row = [at(term.coefficients, instant - now) for term in tape.states]
                turn = product(matrix_of((row[0], row[1], row[2], row[3])), body.turn)
                x, y, z = (at(part.coefficients, instant - now) for part in results["velocity"])
                height = support(body.table, turn)
                states[i] = body.in_world((row[7], row[8], height), (x, y, z), turn, (row[4], row[5], row[6]))
        if kind:
            return Motion(states, [(kind, now + end)])
        if len(states) == len(instants):
            return Motion(states, [])
        numbers = [at(term.coefficients, step) for term in tape.states]
        now += step
