"""The measured quantities as reports name them, and numbers as reports print them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from decimal import ROUND_CEILING, Context

from bodycheck.figures.columns import COLUMNS, FIGURES


@dataclass(frozen=True)
class Quantity:
    """A column of results. name: the column's. unit: "" for a pure number. meaning: one sentence for readers."""

    name: str
    title: str
    unit: str
    meaning: str

    @property
    def label(self) -> str:
        """The title with its unit, as an axis or a table's head wants it."""
        return f"{self.title}, {self.unit or 'relative'}"

    def with_unit(self, value: float) -> str:
        """A value with its unit, to four digits."""
        return f"{number(value)} {self.unit}".rstrip()


QUANTITIES = {
    name: Quantity(name, column.title, column.unit or column.counts, f"{column.meaning[0].upper()}{column.meaning[1:]}.")
    for name, column in COLUMNS.items()
    if name in FIGURES and not FIGURES[name].of_truth
}

#: The columns of a case's table; the results file has the rest.
TABLED = tuple(name for name in QUANTITIES if FIGURES[name].tabled)

#: What is drawn over time, where it was measured: the attitude error first, which tells most of a turning body.
PLOTTED = tuple(sorted((name for name in QUANTITIES if FIGURES[name].plotted), key=lambda name: name != "attitude_error"))


def number(value: float | None, digits: int = 4) -> str:
    """A number to so many significant digits, its exponent without padding; a dash for what is not there."""
    if value is None or math.isnan(value):
        return "–"
    mantissa, e, exponent = f"{value:.{digits}g}".partition("e")
    return f"{mantissa}e{int(exponent)}" if e else mantissa


def bound(value: float, digits: int = 4) -> str:
    """A number that others do not exceed, rounded up, so that what is printed still bounds them (to a millionth of it)."""
    return number(float(Context(prec=digits, rounding=ROUND_CEILING).create_decimal(f"{value:.7g}")), digits)


def milliseconds(seconds: float, digits: int = 12) -> str:
    """A time step in ms with its unit, all digits that were given unless fewer are asked for."""
    return f"{seconds * 1e3:.{digits}g} ms"


def listing(names: Sequence[str], most: int | None = None, noun: str = "") -> str:
    """Names as a sentence lists them: the first `most` of them, then how many others (of that noun) there are."""
    if most is not None and len(names) > most + 1:
        names = (*names[:most], f"{count(len(names) - most, f'more {noun}')}")
    return " and ".join(filter(None, (", ".join(names[:-1]), *names[-1:])))


def count(amount: int, noun: str) -> str:
    """An amount of something: 1 run, 2 runs."""
    return f"{amount} {noun}" if amount == 1 else f"{amount} {noun}s"
