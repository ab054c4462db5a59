"""The modes of one joint whose motion is linear in pieces, in balls: limits of a continuous law, dry friction, and stops.

A mode has a linear system, and linear functions of the state that are positive while it lasts (`linear`). The state has the
coordinate, its velocity, the integral of the error, 1, the time, and the sine and the cosine of each signal that is a sine.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

from flint import arb

from bodycheck.reference.mechanisms.control import Controller, Sine, Stops
from bodycheck.reference.proof.balls import Ball, ball
from bodycheck.reference.proof.bodies import as_ball
from bodycheck.reference.proof.driven import Plant
from bodycheck.reference.proof.linear import Guard, System

#: The places of the coordinate, the velocity, the integral, 1 and the time in the state.
PLACE, VELOCITY, INTEGRAL, ONE, TIME, FIRST_SINE = range(6)

#: A state, or a linear function of it.
Row = list[Ball]


@dataclass(frozen=True)
class Mode:
    """A mode of a joint.

    Attributes
    ----------
    cut
        Whether the effort is cut above or below.
    band
        For a motor with a no-load speed n, the interval of the velocity, from -2 to 1: its border below is `band` n, or none.
    stop
        The stop that acts: an elastic one pushes, or is passed and would pull, or a rigid one holds the joint.
    side
        The side of that stop: 1 for the upper one, -1 for the lower one.
    slip
        The direction of the velocity with dry friction, 0 where it holds the joint; None without friction.
    """

    cut: Literal["", "above", "below"] = ""
    band: int | None = None
    stop: Literal["", "pushes", "passed", "holds"] = ""
    side: int = 0
    slip: int | None = None


@dataclass(frozen=True, eq=False)
class Joint:
    """A joint with its controller in an interval of time without breaks of signals: the rows of what acts on it."""

    plant: Plant
    friction: Fraction
    stops: Stops | None
    controller: Controller | None
    error: Row
    law: Row
    sines: tuple[Sine, ...]

    def unit(self, column: int, value: Ball | int = 1) -> Row:
        """The row with one entry."""
        row = [arb(0)] * (FIRST_SINE + 2 * len(self.sines))
        row[column] = arb(value)
        return row

    def caps(self, mode: Mode) -> tuple[Row, Row] | None:
        """The largest and the smallest effort in a mode; None without a limit."""
        if self.controller is None or self.controller.effort_limit is None:
            return None
        most = self.unit(ONE, ball(self.controller.effort_limit))
        if mode.band is None:
            return most, times(-1, most)
        assert self.controller.no_load_speed is not None
        slope = self.unit(VELOCITY, ball(self.controller.effort_limit) / ball(self.controller.no_load_speed))
        zero = times(0, most)
        above = {-2: most, -1: most, 0: plus(most, times(-1, slope)), 1: zero}[mode.band]
        below = {-2: zero, -1: times(-1, plus(most, slope)), 0: times(-1, most), 1: times(-1, most)}[mode.band]
        return above, below

    def beyond(self, side: int) -> Row:
        """The distance of the coordinate beyond a stop."""
        assert self.stops is not None
        limit = self.stops.upper if side > 0 else self.stops.lower
        assert limit is not None
        return plus(self.unit(PLACE, side), self.unit(ONE, -side * ball(limit)))

    def pushing(self, side: int) -> Row:
        """The force of an elastic stop away from it."""
        assert self.stops is not None
        stiff, damped = ball(self.stops.stiffness), ball(self.stops.damping)
        return plus(times(stiff, self.beyond(side)), self.unit(VELOCITY, side * damped))

    def drive(self, mode: Mode) -> Row:
        """The force on the joint, without dry friction and rigid stops."""
        caps = self.caps(mode)
        law = self.law if not mode.cut else caps[0 if mode.cut == "above" else 1]  # type: ignore[index]
        plant = self.plant
        constant = as_ball(plant.force) + ball(plant.stiffness * plant.rest)
        force = plus(law, self.unit(ONE, constant))
        force = plus(force, self.unit(VELOCITY, -ball(plant.damping)))
        force = plus(force, self.unit(PLACE, -ball(plant.stiffness)))
        return force if mode.stop != "pushes" else plus(force, times(-mode.side, self.pushing(mode.side)))

    def system(self, mode: Mode) -> System:
        """The linear system of a mode."""
        still = mode.stop == "holds" or mode.slip == 0
        force = self.drive(mode)
        if mode.slip:
            force = plus(force, self.unit(ONE, -mode.slip * ball(self.friction)))
        acceleration = times(0 if still else 1 / ball(self.plant.inertia), force)
        zero = self.unit(ONE, 0)
        rows = [zero if still else self.unit(VELOCITY), acceleration, self.error, zero, self.unit(ONE)]
        for number, sine in enumerate(self.sines):
            column, rate = FIRST_SINE + 2 * number, ball(sine.angular_frequency)
            rows += [self.unit(column + 1, rate), self.unit(column, -rate)]
        fast = max([arb(1), *(ball(sine.angular_frequency) for sine in self.sines)], key=float)
        fast = max([fast, abs(acceleration[PLACE]).sqrt(), abs(acceleration[VELOCITY])], key=lambda each: float(each.mid()))
        fast = arb(fast.mid())
        units = [arb(1), fast, 1 / fast, arb(1), 1 / fast, *[arb(1)] * (2 * len(self.sines))]
        return System(rows, units)

    def guards(self, mode: Mode) -> list[Guard]:
        """The functions that are positive while a mode lasts."""
        return [*self._guards_of_law(mode), *self._guards_of_friction(mode), *self._guards_of_stops(mode)]

    def _guards_of_law(self, mode: Mode) -> Iterator[Guard]:
        caps = self.caps(mode)
        if caps is None:
            return
        for name, room in (("above", plus(caps[0], times(-1, self.law))), ("below", plus(self.law, times(-1, caps[1])))):
            if mode.cut in ("", name):
                yield Guard(name, times(-1, room) if mode.cut else room)
        if mode.band is None or self.controller is None:
            return
        speed = ball(self.controller.no_load_speed or 0)
        if mode.band > -2 and not (mode.band == 0 and mode.slip is not None):
            yield Guard("slower", plus(self.unit(VELOCITY), self.unit(ONE, -mode.band * speed)))
        if mode.band < 1 and not (mode.band == -1 and mode.slip is not None):
            yield Guard("faster", plus(self.unit(VELOCITY, -1), self.unit(ONE, (mode.band + 1) * speed)))

    def _guards_of_friction(self, mode: Mode) -> Iterator[Guard]:
        if mode.stop == "holds" or mode.slip is None:
            return
        if mode.slip:
            yield Guard("rests", self.unit(VELOCITY, mode.slip))
            return
        limit, force = self.unit(ONE, ball(self.friction)), self.drive(mode)
        yield Guard("forwards", plus(limit, times(-1, force)))
        yield Guard("backwards", plus(limit, force))

    def _guards_of_stops(self, mode: Mode) -> list[Guard]:
        if self.stops is None:
            return []
        if mode.stop == "holds":
            force = times(mode.side, self.drive(mode))
            return [Guard("leaves", plus(force, self.unit(ONE, ball(self.friction))))]
        if not mode.stop:
            sides = [(1, self.stops.upper), (-1, self.stops.lower)]
            return [Guard(f"reaches{side}", times(-1, self.beyond(side))) for side, limit in sides if limit is not None]
        inside = [Guard("returns", self.beyond(mode.side))]
        if mode.stop == "passed":
            return [*inside, Guard("pushes", times(-1, self.pushing(mode.side)))]
        return [Guard("pulls", self.pushing(mode.side)), *(inside if self.stops.damping else [])]


def plus(one: Row, other: Row) -> Row:
    """Return the sum of two rows."""
    return [a + b for a, b in zip(one, other, strict=True)]


def times(factor: Ball | int, row: Row) -> Row:
    """Return the product of a number and a row."""
    return [factor * entry for entry in row]
