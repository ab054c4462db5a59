"""Bodies that lean on an edge or a rim of a level plane and are released from rest: pendulums about what they touch.

With a the angle of the centre of mass from the vertical through the contact, l its distance and I the moment about the contact:
I a'' = m g l sin a. The forces follow from the acceleration of the centre of mass.
"""

from collections.abc import Sequence
from decimal import Decimal
from functools import cache
from typing import Any

from tests.judge.numerals import ONE, ZERO, Vector, about, applied, cross, exact, plus, product, sine_cosine, times
from tests.judge.planes import OnPlane, on_plane
from tests.judge.series import ORDER, Tape, at, first_root
from tests.judge.states import Motion, State

#: What must not become negative: the load, and what friction has left to either side.
MARGINS = ("load", "fore", "back")


@cache
def _pendulum() -> tuple[Tape, dict[str, Any]]:
    """Return the equations. States: sine and cosine of a, the turn, its rate. Parameters: m g l / I, l / g, friction.

    Watched: the margins of friction to either side, and of the load.
    """
    tape = Tape()
    sine, cosine, turn, rate = (tape.state() for _ in range(4))
    stiffness, length, friction = (tape.parameter() for _ in range(3))
    acceleration = stiffness * sine
    tape.rate(sine, cosine * rate)
    tape.rate(cosine, -(sine * rate))
    tape.rate(turn, rate)
    tape.rate(rate, acceleration)
    square = rate * rate
    # forces over the weight: along the fall and upwards
    push = length * (acceleration * cosine - square * sine)
    load = ONE - length * (acceleration * sine + square * cosine)
    margins = dict(zip(MARGINS, (load, friction * load - push, friction * load + push), strict=True))
    for margin in margins.values():
        tape.watch(margin)
    return tape, margins | {"sine": sine, "cosine": cosine}


def motion(text: str, instants: Sequence[Decimal]) -> Motion:
    """Return the motion until the contact slips or another part of the body lands."""
    body = on_plane(text)
    level, arm, faces = _leaning(body)
    reach = (arm[0] * arm[0] + arm[1] * arm[1] + arm[2] * arm[2]).sqrt()
    fall = arm[0] * level[1] - arm[1] * level[0]  # positive where the turn about `level` lowers the centre
    if fall < 0:
        level, fall = times(-1, level), -fall
    mass, gravity = body.inertia.mass, -body.gravity[2]
    along = [sum((level[i] * body.turn[i][k] for i in range(3)), ZERO) for k in range(3)]
    moment = sum((along[k] * along[k] * body.inertia.tensor[k][k] for k in range(3)), ZERO) + mass * reach * reach
    friction = ZERO if body.friction is None else body.friction
    margins = MARGINS[:1] if body.friction is None else MARGINS
    parameters = [mass * gravity * reach / moment, reach / gravity, friction]
    tape, results = _pendulum()
    numbers = [fall / reach, arm[2] / reach, ZERO, ZERO]
    foot = plus(body.position, times(-1, arm))
    now, states = ZERO, dict[int, State]()
    while True:
        tape.expand([*numbers, *parameters], ORDER)
        step, left = tape.step(), instants[-1] - now
        step = left if step is None else min(step, left)
        ends = [(root, "slip") for name in margins if (root := first_root(results[name].coefficients, step)) is not None]
        for face in faces:
            sinks = level[0] * face[1] - level[1] * face[0]
            of_cosine, of_sine = face[2] * arm[2] - sinks * fall, face[2] * fall + sinks * arm[2]
            pairs = zip(results["cosine"].coefficients, results["sine"].coefficients, strict=True)
            height = [of_cosine * cosine + of_sine * sine for cosine, sine in pairs]
            if (root := first_root(height, step)) is not None:
                ends.append((root, "impact"))
        if any(results[name].coefficients[0] < 0 for name in margins):
            ends.append((ZERO, "slip"))  # at the start
        end, kind = min(ends, default=(step, ""))
        for i, instant in enumerate(instants):
            if i not in states and now <= instant <= now + end:
                row = [at(term.coefficients, instant - now) for term in tape.states]
                rotation = about(level, *sine_cosine(row[2]))
                moved = applied(rotation, arm)
                spin = times(row[3], level)
                states[i] = body.in_world(plus(foot, moved), cross(spin, moved), product(rotation, body.turn), spin)
        if kind:
            return Motion(states, [(kind, now + end)])
        if len(states) == len(instants):
            return Motion(states, [])
        numbers = [at(term.coefficients, step) for term in tape.states]
        now += step


def _leaning(body: OnPlane) -> tuple[Vector, Vector, list[Vector]]:
    """Return the level axis about which a body turns, the arm from the contact to the centre of mass, and the faces beside it.

    The faces are vectors from the contact along the two faces, or the face and the side, that meet there.
    """
    up = body.turn[2]
    if body.table["shape"] == "cylinder":
        # the axis of the cylinder, its part along the plane, and the lowest point of the rim
        axis = (body.turn[0][2], body.turn[1][2], body.turn[2][2])
        sign = ONE.copy_sign(axis[2])
        axis = times(sign, axis)
        flat = (axis[0] * axis[0] + axis[1] * axis[1]).sqrt()
        x, y = axis[0] / flat, axis[1] / flat
        radial = (axis[2] * x, axis[2] * y, -flat)  # from the axis down to the rim
        to_contact = plus(times(-exact(body.table["half_length"]), axis), times(exact(body.table["radius"]), radial))
        return (-y, x, ZERO), times(-1, to_contact), [axis, times(-1, radial)]
    edges = exact(body.table["semi_axes"])
    level = min(range(3), key=lambda k: abs(up[k]))
    corner = [ZERO if k == level else edges[k] * ONE.copy_sign(up[k]) for k in range(3)]
    columns = [tuple(body.turn[i][k] for i in range(3)) for k in range(3)]
    arm = plus(*(times(corner[k], columns[k]) for k in range(3)))
    x, y = columns[level][0], columns[level][1]
    size = (x * x + y * y).sqrt()
    axis = (x / size, y / size, ZERO)
    along = arm[0] * axis[0] + arm[1] * axis[1]
    faces = [times(ONE.copy_sign(up[k]), columns[k]) for k in range(3) if k != level]
    return axis, plus(arm, times(-along, axis)), faces
