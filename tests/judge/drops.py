"""Bodies that fly and turn freely up to the first touch of a plane: Euler's equations as power series.

The gap between a body and its plane is a power series too, for each corner of a brick, and its first root is the touch.
"""

import itertools
from collections.abc import Sequence
from decimal import Decimal
from typing import Any

from tests.judge.numerals import ONE, ZERO, Matrix, applied, exact, matrix_of, product, transposed
from tests.judge.planes import OnPlane, on_plane
from tests.judge.series import ORDER, Tape, at, first_root
from tests.judge.states import Motion, State
from tests.judge.turning import quaternion_rates


class _Free:
    """The equations of a body that turns freely: quaternion since the start, angular momentum constant along the plane's axes.

    States: the quaternion; height and speed along the normal. The spin follows from the momentum and the attitude.
    """

    def __init__(self, body: OnPlane) -> None:
        self.tape = tape = Tape()
        self.quaternion = [tape.state() for _ in range(4)]
        self.height, self.speed = tape.state(), tape.state()
        w, x, y, z = self.quaternion
        turn: Matrix = (
            (ONE - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
            (2 * (x * y + w * z), ONE - 2 * (x * x + z * z), 2 * (y * z - w * x)),
            (2 * (x * z - w * y), 2 * (y * z + w * x), ONE - 2 * (x * x + y * y)),
        )
        turn = product(turn, body.turn)
        tensor = body.inertia.tensor
        moments = (tensor[0][0], tensor[1][1], tensor[2][2])
        spin = applied(transposed(body.turn), body.spin)
        self.momentum = applied(body.turn, tuple(m * s for m, s in zip(moments, spin, strict=True)))
        along = [part / moment for part, moment in zip(applied(transposed(turn), self.momentum), moments, strict=True)]
        self.spin = applied(turn, (along[0], along[1], along[2]))
        for state, rate in zip(self.quaternion, quaternion_rates(self.spin, self.quaternion), strict=True):
            tape.rate(state, rate)
        tape.rate(self.height, self.speed)
        tape.rate(self.speed, body.gravity[2])
        self.gaps = _gaps(body.table, self.height, turn[2])
        for gap in self.gaps:
            tape.watch(gap)


def _gaps(table: dict[str, Any], height: Any, up: Any) -> list[Any]:
    """Return the distances of the lowest points, or of all that may be lowest, from the plane."""
    match table["shape"]:
        case "sphere":
            return [height - exact(table["radius"])]
        case "brick":
            edges = exact(table["semi_axes"])
            return [
                height + sum((sign * edge * part for sign, edge, part in zip(signs, edges, up, strict=True)), ZERO)
                for signs in itertools.product((ONE, -ONE), repeat=3)
            ]
        case "cylinder":
            across = (up[0] * up[0] + up[1] * up[1]).sqrt() * exact(table["radius"])
            return [height - across - sign * exact(table["half_length"]) * up[2] for sign in (ONE, -ONE)]
        case _:
            edges = exact(table["semi_axes"])
            return [height - sum((part * part * (edge * edge) for edge, part in zip(edges, up, strict=True)), ZERO).sqrt()]


def motion(text: str, instants: Sequence[Decimal]) -> Motion:
    """Return the motion of a body up to the first touch; an event is the touch."""
    body = on_plane(text)
    free = _Free(body)
    numbers = [ONE, ZERO, ZERO, ZERO, body.position[2], body.velocity[2]]
    now, states = ZERO, dict[int, State]()
    tensor = body.inertia.tensor
    while True:
        free.tape.expand(numbers, ORDER)
        step, left = free.tape.step(), instants[-1] - now
        step = left if step is None else min(step, left)
        roots = [first_root(gap.coefficients, step) for gap in free.gaps]
        touch = min((root for root in roots if root is not None), default=None)
        end = step if touch is None else touch
        for i, instant in enumerate(instants):
            if i not in states and now <= instant <= now + end:
                row = [at(term.coefficients, instant - now) for term in free.tape.states]
                turn = product(matrix_of((row[0], row[1], row[2], row[3])), body.turn)
                along = applied(transposed(turn), free.momentum)
                spin = applied(turn, (along[0] / tensor[0][0], along[1] / tensor[1][1], along[2] / tensor[2][2]))
                moved = [
                    p + v * instant + g * instant * instant / 2
                    for p, v, g in zip(body.position, body.velocity, body.gravity, strict=True)
                ]
                speed = [v + g * instant for v, g in zip(body.velocity, body.gravity, strict=True)]
                states[i] = body.in_world((moved[0], moved[1], moved[2]), (speed[0], speed[1], speed[2]), turn, spin)
        if touch is not None:
            return Motion(states, [("impact", now + touch)])
        if len(states) == len(instants):
            return Motion(states, [])
        numbers = [at(term.coefficients, step) for term in free.tape.states]
        now += step
