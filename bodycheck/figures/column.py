"""A column of results: its name, the type of its values, its unit and its meaning."""

from dataclasses import dataclass
from typing import Literal

#: Types of values, as JSON Schema calls them.
Kind = Literal["string", "boolean", "integer", "number"]


@dataclass(frozen=True)
class Column:
    """A column of results.

    Attributes
    ----------
    name, kind
        The key in tables and files, and the type of its values.
    title
        The head of a table or the title of an axis.
    meaning
        A phrase for readers who know nothing of bodycheck.
    unit
        The SI unit, empty for a pure number.
    counts
        The things that a number without a unit counts, for example steps. A number without a unit that counts nothing is
        relative.
    largest
        Whether the value is the largest one over the sampled instants.
    remark
        Further information for the grammar of case files, for example in which scenes the value exists.
    words
        The texts that the value may have; empty for any text.
    signed
        Whether a number may be negative.
    """

    name: str
    kind: Kind
    title: str
    meaning: str
    unit: str = ""
    counts: str = ""
    largest: bool = False
    remark: str = ""
    words: frozenset[str] = frozenset()
    signed: bool = False

    @property
    def told(self) -> str:
        """The meaning, with the word "largest" if the column has the largest value over the instants."""
        return f"largest {self.meaning}" if self.largest else self.meaning

    @property
    def in_unit(self) -> str:
        """The unit; for a number without a unit, the things that it counts, or the word "relative"."""
        return self.unit or self.counts or "relative"

    @property
    def description(self) -> str:
        """The meaning with the unit and the remark."""
        return "".join((self.told, self.unit and f", {self.unit}", self.remark and f"; {self.remark}"))
