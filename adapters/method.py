"""A method (an integrator of an engine, its options and a time step) as one value with one spelling, and the allowed options.

The spelling is `INTEGRATOR` or `INTEGRATOR:KEY=VALUE,KEY=VALUE`, for example `Euler:cone=elliptic,pads=4`. It occurs in case
files, on the command line and in the column `integrator` of every table. Only this module parses and writes it.
"""

import math
from dataclasses import dataclass, replace
from typing import Literal

from bodycheck.errors import BadInput

#: The time step (s) if none is given: MuJoCo's default.
DEFAULT_TIMESTEP = 0.002

#: Most characters in the name of an engine or of an integrator.
MAX_NAME_LENGTH = 100

#: Spellings that earlier versions of bodycheck wrote into results folders and baselines, mapped to their present spellings.
FORMER_SPELLINGS = {
    **{f"{name}-fluid": f"{name}:drag=fluid" for name in ("Euler", "RK4", "implicit", "implicitfast", "discrete")},
    "Euler-planar": "Euler:model=planar",
    "law-force-planar": "law-force:model=planar-joint",
    "law-force:model=contact": "admm",
    "law-force:model=everything": "admm:model=everything",
}


#: The values of options that are never spelled.
DEFAULTS = {"control": "effort", "limits": "engine", "sensors": "step"}

#: The value of the option `accuracy` that stands for all accuracies, in tables and charts over them.
ANY = "any"


@dataclass(frozen=True)
class Method:
    """An integrator by the engine's own name, its options, and the time step (s).

    Parameters
    ----------
    integrator
        The name without options.
    timestep
        The time step (s); of a method with error control the largest step. 0 stands for any time step.
    options
        Pairs of key and value, sorted by key, with numbers in their shortest form. The engine defines the keys and values; the
        option `model` selects one of its models of a scene.
    """

    integrator: str
    timestep: float
    options: tuple[tuple[str, str], ...] = ()

    @classmethod
    def parse(cls, spelling: str, timestep: float) -> "Method":
        """Return the method with this spelling and time step (s); the options may be in any order, and have no `DEFAULTS`.

        Raises `BadInput` for text that is not a spelling of a method, and for a spelling of an earlier version.
        """
        if not spelling.isprintable():
            raise BadInput(f"{spelling!r} is not the spelling of a method: it has characters that cannot be printed")
        if (present := current(spelling)) != spelling:
            raise BadInput(f"{spelling!r} is now spelled {present!r}")
        integrator, colon, rest = spelling.partition(":")
        options: dict[str, str] = {}
        for item in rest.split(",") if colon else ():
            key, equals, value = item.partition("=")
            if not (key and equals and value.strip()):
                raise BadInput(f"{spelling!r}: {item!r} is not an option; allowed: INTEGRATOR:KEY=VALUE,KEY=VALUE")
            if key in options:
                raise BadInput(f"{spelling!r}: the option {key} is given twice")
            options[key] = " ".join(map(_shortest, value.split()))
            if key == "accuracy" and not (ACCURACY.accepts(value) or value == ANY):
                raise BadInput(f"{spelling!r}: read {value!r}; allowed: {ACCURACY.allowed}")
        options = {key: value for key, value in options.items() if DEFAULTS.get(key) != value}
        if not integrator:
            raise BadInput(f"{spelling!r} names no integrator; allowed: INTEGRATOR or INTEGRATOR:KEY=VALUE,KEY=VALUE")
        return cls(checked_name(integrator, "integrator"), timestep, tuple(sorted(options.items())))

    @property
    def name(self) -> str:
        """The spelling: integrator and options, without the time step."""
        options = ",".join(f"{key}={value}" for key, value in self.options)
        return f"{self.integrator}:{options}" if options else self.integrator

    def option(self, key: str) -> str | None:
        """Return the value of an option; None if the method does not set it."""
        return dict(self.options).get(key)

    @property
    def accuracy(self) -> float | None:
        """The relative tolerance of a method with error control, 0 for any; None if its steps are fixed."""
        value = self.option("accuracy")
        return None if value is None else 0.0 if value == ANY else float(value)

    @property
    def sampling(self) -> float:
        """The time step (s) at whose multiples a run is sampled; 0 with error control: at the instants of the case exactly."""
        return self.timestep if self.accuracy is None else 0.0

    def at(self, timestep: float) -> "Method":
        """Return the method with the same integrator and options, and another time step (s)."""
        return replace(self, timestep=timestep)

    def with_accuracy(self, accuracy: float) -> "Method":
        """Return the method with the same integrator, other options and time step, and another relative tolerance."""
        return self.with_option("accuracy", _shortest(repr(accuracy)))

    @property
    def over_accuracies(self) -> "Method":
        """The spelling that stands for all accuracies of a method with error control; the method itself if steps are fixed."""
        return self if self.accuracy is None else self.with_option("accuracy", ANY)

    def with_option(self, key: str, value: str) -> "Method":
        """Return the method with a value of an option, in the place of another value that it may have."""
        return replace(self, options=tuple(sorted((dict(self.options) | {key: value}).items())))

    def without(self, key: str) -> "Method":
        """Return the method without an option."""
        return replace(self, options=tuple(option for option in self.options if option[0] != key))

    def is_at(self, timestep: float) -> bool:
        """Return whether the method's time step equals `timestep` (s) to within the rounding of a product or quotient."""
        return math.isclose(self.timestep, timestep, rel_tol=1e-12)

    def __str__(self) -> str:
        return f"{self.name} {self.timestep:g} s"


def is_name(text: str) -> bool:
    """Return whether a text can be the name of an engine or of an integrator.

    A name begins with a letter or a digit, so that no spreadsheet takes it for a formula, and has at most `MAX_NAME_LENGTH`
    characters, all of them printable: no surrogates and no control characters.
    """
    return 0 < len(text) <= MAX_NAME_LENGTH and text[0].isalnum() and text.isprintable()


def checked_name(text: str, what: str) -> str:
    """Return a text that is the name of an engine or of an integrator. Raises `BadInput` for any other text.

    `what` is the kind of name, such as "engine" or "integrator", for the message.
    """
    if not is_name(text):
        shown = f"{text[:MAX_NAME_LENGTH]!r}{'…' if len(text) > MAX_NAME_LENGTH else ''}"
        raise BadInput(
            f"{shown} is no name of an {what}; allowed: at most {MAX_NAME_LENGTH} printable characters, the first a letter or "
            "a digit"
        )
    return text


def current(spelling: str) -> str:
    """Return the present spelling of a method that may be spelled as in an earlier version of bodycheck."""
    if spelling in FORMER_SPELLINGS:
        return FORMER_SPELLINGS[spelling]
    integrator, colon, options = spelling.partition(":")
    if not colon or integrator not in FORMER_SPELLINGS:
        return spelling
    renamed = FORMER_SPELLINGS[integrator]
    return f"{renamed}{',' if ':' in renamed else ':'}{options}"


def _shortest(word: str) -> str:
    """Return a word unchanged, or in the shortest form if it is a number (4 for 4.0 and 04, 1e-6 for 1e-06)."""
    try:
        number = float(word)
    except ValueError:
        return word
    if not math.isfinite(number):
        return word
    digits, exponential, exponent = repr(number).removesuffix(".0").partition("e")
    return f"{digits}e{int(exponent)}" if exponential else digits


#: Kinds of scene for which engines offer different integrators: free flight, flight against drag, a body that lies flat on a
#: level plane, bodies that touch in any other way, and bodies on joints.
Kind = Literal["flight", "drag", "plane", "contact", "mechanism"]
KINDS: frozenset[Kind] = frozenset({"flight", "drag", "plane", "contact", "mechanism"})


@dataclass(frozen=True)
class Range:
    """The numbers that are allowed at one position in the value of an option.

    Parameters
    ----------
    least, most
        The bounds; None for no bound.
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
        """Return whether a text is a number in this range."""
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
        The words that are allowed as a value.
    numbers
        The sequences of numbers, separated by spaces, that are allowed as a value: a range for each number of a sequence.
    kinds
        The kinds of scene in which the option has an effect.
    """

    allowed: str
    words: tuple[str, ...] = ()
    numbers: tuple[tuple[Range, ...], ...] = ()
    kinds: frozenset[Kind] = KINDS

    def accepts(self, value: str) -> bool:
        """Return whether a value is allowed."""
        parts = value.split()
        fits = (len(parts) == len(ranges) and all(map(Range.has, ranges, parts)) for ranges in self.numbers)
        return value in self.words or any(fits) or not (self.words or self.numbers)


def choice(*words: str, kinds: frozenset[Kind] = KINDS) -> Option:
    """Return an option whose value must be one of the given words."""
    return Option(" or ".join(filter(None, (", ".join(words[:-1]), words[-1]))), words, kinds=kinds)


#: The options of mechanisms whose joints are driven or have stops, in every engine that takes efforts at joints: who computes
#: the laws of controllers (bodycheck, which gives the engine efforts), and the stops (the engine, or bodycheck by efforts).
DRIVEN = {
    "control": choice("effort", kinds=frozenset({"mechanism"})),
    "limits": choice("engine", "effort", kinds=frozenset({"mechanism"})),
}

#: The option of engines that read sensors: after a step, or after the engine has computed its present state again.
SENSORS = {"sensors": choice("step", "forward")}

#: The option of integrators with error control: the relative tolerance of the error of a step. Without it, steps are fixed.
ACCURACY = Option("a relative tolerance above 0 and at most 1", numbers=((Range(0, 1, above=True),),))
