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
        """Return whether results can have an error bound of the truth for this quantity."""
        return bool(FIGURES[self.name].bounded_by)

    @property
    def bound_name(self) -> str:
        """Return the name of the column with the error bound of the truth in this quantity; empty if there is none."""
        return FIGURES[self.name].bounded_by

    @property
    def label(self) -> str:
        """Return the title with the unit, for an axis or the head of a table."""
        return f"{self.title}, {self.unit or 'relative'}"

    def with_unit(self, value: float) -> str:
        """Return a value with its unit, to four significant digits."""
        return f"{number(value)} {self.unit}".rstrip()

    def within_truth(self, values: Mapping[str, float]) -> float | None:
        """Return the error bound of the truth in this quantity if the error of a run is no larger than it; otherwise None.

        An error within the bound has no meaningful digits. values: the values of the run by column.
        """
        return within_truth(FIGURES[self.name], values)

    def told_within(self, own: float) -> str:
        """Return the text for an error of a run within the truth's own error. own: the error bound of the truth."""
        return f"within the truth's own error ({bound(own)} {self.unit}".rstrip() + ")"


QUANTITIES = {
    name: Quantity(name, column.title, column.unit or column.counts, f"{column.meaning[0].upper()}{column.meaning[1:]}.")
    for name, column in COLUMNS.items()
    if name in FIGURES and not FIGURES[name].of_truth
}

#: The quantities in the table of a case; the file of results has all quantities.
TABLED = tuple(name for name in QUANTITIES if FIGURES[name].tabled)

#: The quantities that are drawn over time if they were measured. The attitude error, which matters most, comes first.
PLOTTED = tuple(sorted((name for name in QUANTITIES if FIGURES[name].plotted), key=lambda name: name != "attitude_error"))


def number(value: float | None, digits: int = 4) -> str:
    """Return a number as text with `digits` significant digits; a dash for None and NaN.

    Numbers below 10 000 have no exponent, even if they are rounded to fewer digits. Exponents are written without padding.
    """
    if value is None or math.isnan(value):
        return "–"
    mantissa, e, exponent = f"{value:.{digits}g}".partition("e")
    if not e:
        return mantissa
    return f"{float(f'{mantissa}e{exponent}'):.0f}" if 0 < int(exponent) < 4 else f"{mantissa}e{int(exponent)}"


def exactly(value: float) -> str:
    """Return a number as text with as many digits as are needed to read the same number from it."""
    mantissa, e, exponent = repr(value).partition("e")
    return mantissa.removesuffix(".0") + (f"e{int(exponent)}" if e else "")


def vector(components: Sequence[float]) -> str:
    """Return components as numbers in parentheses."""
    return f"({', '.join(map(number, components))})"


def bound(value: float, digits: int = 4) -> str:
    """Return an upper bound as text, rounded up so that the text is also a bound (except for one part in a million)."""
    return number(rounded_up(value, digits), digits)


def within(value: float, digits: int = 4) -> str:
    """Return an error bound of the truth as text, after the sign for an error within it."""
    return f"{WITHIN} {bound(value, digits)}"


def milliseconds(seconds: float, digits: int = 12) -> str:
    """Return a time step (s) as text in ms, with its unit and at most `digits` significant digits."""
    return f"{seconds * 1e3:.{digits}g} ms"


def listing(names: Sequence[str], most: int | None = None, noun: str = "") -> str:
    """Return names as an enumeration in a sentence: the first `most` names, then the number of the others with `noun`."""
    if most is not None and len(names) > most + 1:
        names = (*names[:most], f"{count(len(names) - most, f'more {noun}')}")
    return " and ".join(filter(None, (", ".join(names[:-1]), *names[-1:])))


def verb(amount: int, singular: str, plural: str) -> str:
    """Return the form of a verb that agrees with an amount: 1 run differs, 2 runs differ."""
    return singular if amount == 1 else plural


def count(amount: int, noun: str, plural: str = "") -> str:
    """Return an amount with its noun: 1 run, 2 runs. plural: the plural of the noun if it is not formed with s."""
    return f"{amount} {noun}" if amount == 1 else f"{amount} {plural or f'{noun}s'}"
