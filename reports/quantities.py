"""Names of the measured quantities in reports, and numbers, amounts and lists as text."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from bodycheck.figures.bounds import rounded_up, within_truth
from bodycheck.figures.columns import COLUMNS, FIGURES
from bodycheck.results.verdicts import WITHIN


@dataclass(frozen=True)
class Quantity:
    """A measured quantity of results.

    Parameters
    ----------
    name
        Name of the column.
    title
        Name for readers.
    unit
        Unit; empty for a relative quantity.
    meaning
        Explanation for readers, one sentence.
    """

    name: str
    title: str
    unit: str
    meaning: str

    @property
    def bounded(self) -> bool:
        """Return whether the truth's own error in this quantity may be known."""
        return bool(FIGURES[self.name].bounded_by)

    @property
    def bound_name(self) -> str:
        """Return the name of the column with the truth's own error in this quantity; empty if there is none."""
        return FIGURES[self.name].bounded_by

    @property
    def label(self) -> str:
        """Return the title with the unit, for an axis or the head of a table."""
        return f"{self.title}, {self.unit or 'relative'}"

    def with_unit(self, value: float) -> str:
        """Return a value with its unit, to four significant digits."""
        return f"{number(value)} {self.unit}".rstrip()

    def within_truth(self, values: Mapping[str, float]) -> float | None:
        """Return the truth's own error in this quantity where that of a run is no larger, and so has no meaning; else None.

        `values` are those of the run by column.
        """
        return within_truth(FIGURES[self.name], values)

    def told_within(self, own: float) -> str:
        """Return what is said of an error that is no larger than the truth's own."""
        return f"within the truth's own error ({bound(own)} {self.unit}".rstrip() + ")"


QUANTITIES = {
    name: Quantity(name, column.title, column.unit or column.counts, f"{column.meaning[0].upper()}{column.meaning[1:]}.")
    for name, column in COLUMNS.items()
    if name in FIGURES and not FIGURES[name].of_truth
}

#: Quantities in the table of a case; the file of results has all.
TABLED = tuple(name for name in QUANTITIES if FIGURES[name].tabled)

#: Quantities that are drawn over time if they were measured; the attitude error, which matters most, comes first.
PLOTTED = tuple(sorted((name for name in QUANTITIES if FIGURES[name].plotted), key=lambda name: name != "attitude_error"))


def number(value: float | None, digits: int = 4) -> str:
    """Return a number with so many significant digits; a dash for None and NaN.

    Numbers below 10 000 are written without an exponent even if they have fewer digits, and exponents without padding.
    """
    if value is None or math.isnan(value):
        return "–"
    mantissa, e, exponent = f"{value:.{digits}g}".partition("e")
    if not e:
        return mantissa
    return f"{float(f'{mantissa}e{exponent}'):.0f}" if 0 < int(exponent) < 4 else f"{mantissa}e{int(exponent)}"


def vector(components: Sequence[float]) -> str:
    """Return components as numbers in parentheses."""
    return f"({', '.join(map(number, components))})"


def bound(value: float, digits: int = 4) -> str:
    """Return an upper bound as text, rounded up so that the text is a bound too (except for one part in a million)."""
    return number(rounded_up(value, digits), digits)


def within(value: float, digits: int = 4) -> str:
    """Return the truth's own error as text, after the sign that stands for an error that is no larger."""
    return f"{WITHIN} {bound(value, digits)}"


def milliseconds(seconds: float, digits: int = 12) -> str:
    """Return a time step (s) in ms with its unit, with up to so many significant digits."""
    return f"{seconds * 1e3:.{digits}g} ms"


def listing(names: Sequence[str], most: int | None = None, noun: str = "") -> str:
    """Return names as a list in a sentence: the first `most` of them, then the number of others and their noun."""
    if most is not None and len(names) > most + 1:
        names = (*names[:most], f"{count(len(names) - most, f'more {noun}')}")
    return " and ".join(filter(None, (", ".join(names[:-1]), *names[-1:])))


def verb(amount: int, singular: str, plural: str) -> str:
    """Return the form of a verb that an amount takes: 1 run differs, 2 runs differ."""
    return singular if amount == 1 else plural


def count(amount: int, noun: str, plural: str = "") -> str:
    """Return an amount with its noun in singular or plural: 1 run, 2 runs. plural: where it has another ending than s."""
    return f"{amount} {noun}" if amount == 1 else f"{amount} {plural or f'{noun}s'}"
