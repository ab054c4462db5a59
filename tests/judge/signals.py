"""The signals of controllers, from the tables of a case file: their values, and their power series in time."""

from collections.abc import Sequence
from decimal import Decimal
from fractions import Fraction
from typing import Any

from tests.judge.numerals import ZERO, exact, sine_cosine
from tests.judge.series import Tape


class Signal:
    """A number, a sine, or values at times.

    Attributes
    ----------
    times
        The times (s) at which it is not smooth.
    """

    def __init__(self, table: Any) -> None:
        self._table = table
        listed = isinstance(table, dict) and "times" in table
        self.times = [Fraction(time) for time in table["times"]] if listed else []

    def value(self, time: Decimal) -> Decimal:
        """Return the value at a time (s); where it jumps, the value from then on."""
        return self.piece(time)[0]

    def at_instant(self, time: Decimal, period: Decimal) -> Decimal:
        """Return the value at an instant of a controller; held values may change later by a billionth of its period (s)."""
        held = bool(self.times) and self._table.get("between", "hold") == "hold"
        return self.value(time + period / 10**9 if held else time)

    def piece(self, time: Decimal) -> tuple[Decimal, Decimal]:
        """Return the value at a time, and the slope from then on of a signal that is given at times."""
        table = self._table
        if not isinstance(table, dict):
            return exact(table), ZERO
        if not self.times:
            sine, _ = sine_cosine(self.phase(time))
            return exact(table.get("offset", 0)) + exact(table["amplitude"]) * sine, ZERO
        times, values = exact(table["times"]), exact(table["values"])
        if time < times[0]:
            return values[0], ZERO
        place = max(index for index, each in enumerate(times) if each <= time)
        if place == len(times) - 1:
            return values[-1], ZERO
        if table.get("between", "hold") == "hold":
            return values[place], ZERO
        slope = (values[place + 1] - values[place]) / (times[place + 1] - times[place])
        return values[place] + slope * (time - times[place]), slope

    def phase(self, time: Decimal) -> Decimal:
        """Return the angle (rad) of a sine at a time."""
        angle: Decimal = exact(self._table["angular_frequency"]) * time + exact(self._table.get("phase", 0))
        return angle

    def series(self, tape: Tape, elapsed: Any) -> Any:
        """Return its power series. elapsed: the time (s) since the start of the series. `inputs` has the numbers it needs."""
        table = self._table
        if not isinstance(table, dict):
            return exact(table)
        if self.times:
            return tape.parameter() + tape.parameter() * elapsed
        sine, _ = (tape.parameter() + elapsed * exact(table["angular_frequency"])).sine_cosine()
        return sine * exact(table["amplitude"]) + exact(table.get("offset", 0))

    def inputs(self, time: Decimal) -> Sequence[Decimal]:
        """Return the numbers of a series that starts at a time, in the order in which `series` asks for them."""
        if not isinstance(self._table, dict):
            return ()
        return self.piece(time) if self.times else (self.phase(time),)
