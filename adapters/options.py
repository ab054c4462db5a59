"""Options of integrators, and the kinds of scene in which integrators and options count."""

import math
from dataclasses import dataclass
from typing import Literal

#: Kinds of scene for which engines offer different integrators: free flight, flight against drag, a body that lies flat on a
#: level plane, bodies that touch in any other way, and bodies on joints.
Kind = Literal["flight", "drag", "plane", "contact", "mechanism"]
KINDS: frozenset[Kind] = frozenset({"flight", "drag", "plane", "contact", "mechanism"})


@dataclass(frozen=True)
class Range:
    """The numbers that are allowed in one place of an option.

    Parameters
    ----------
    least, most
        The bounds; None for none.
    above
        Whether the number must be larger than `least`.
    whole
        Whether it must be an integer.
    """

    least: float | None = None
    most: float | None = None
    above: bool = False
    whole: bool = False

    def has(self, text: str) -> bool:
        """Return whether a text is such a number."""
        try:
            number = int(text) if self.whole else float(text)
        except ValueError:
            return False
        large_enough = self.least is None or (number > self.least if self.above else number >= self.least)
        return math.isfinite(number) and large_enough and (self.most is None or number <= self.most)


@dataclass(frozen=True)
class Option:
    """An option of an integrator. Without `words` and `numbers`, any text is allowed.

    Parameters
    ----------
    allowed
        The allowed values in words, for error messages.
    words
        The words that are allowed.
    numbers
        The sequences of numbers, separated by spaces, that are allowed: one range for each number of a sequence.
    kinds
        The kinds of scene in which the option has an effect.
    """

    allowed: str
    words: tuple[str, ...] = ()
    numbers: tuple[tuple[Range, ...], ...] = ()
    kinds: frozenset[Kind] = KINDS

    def accepts(self, value: str) -> bool:
        """Return whether a value is allowed."""
        given = value.split()
        fits = (len(given) == len(ranges) and all(map(Range.has, ranges, given)) for ranges in self.numbers)
        return value in self.words or any(fits) or not (self.words or self.numbers)


def choice(*words: str, kinds: frozenset[Kind] = KINDS) -> Option:
    """Return an option whose value must be one of the given words."""
    return Option(" or ".join(filter(None, (", ".join(words[:-1]), words[-1]))), words, kinds=kinds)
