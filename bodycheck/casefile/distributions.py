"""The distributions that the members of an ensemble are drawn with, and the keys that they vary.

The parameters of a distribution are tuples with a number for each component: one for a key that is a single number.
"""

import json
import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:  # the module that finds positions in a file takes long to import
    from bodycheck.casefile.toml_positions import Path

#: Pairs of keys of a table that state the same quantity. If one of them is drawn as a whole vector, it replaces the other.
SAME = (("euler_zxz", "quaternion"), ("euler_rates", "angular_velocity"))

#: The signs of the numbers that a key allows.
Sign = Literal["any", "not negative", "positive"]


@dataclass(frozen=True)
class Key:
    """A number or a vector of a case file.

    Attributes
    ----------
    whole
        The path of the number or array in the file.
    shape
        The shape of the whole: () for a number, (k,) for a vector, (3, 3) for a tensor.
    place
        The indices of one component in the array; () for the whole array.
    sign
        The sign of the numbers that it allows.
    named
        The path of the whole with the names of bodies and joints instead of their indices; () if it has none.
    """

    whole: "Path"
    shape: tuple[int, ...]
    place: tuple[int, ...] = ()
    sign: Sign = "any"
    named: "Path" = ()

    @property
    def text(self) -> str:
        """The path as a case file has it, with a dot between the parts; names of special characters are quoted."""
        if not self.named:
            return ".".join(map(str, (*self.whole, *self.place)))
        return ".".join(map(str, (self.named[0], name_in_path(str(self.named[1])), *self.named[2:], *self.place)))

    @property
    def text_of_whole(self) -> str:
        """The path of the number or array itself, or of the array that it is a component of."""
        return replace(self, place=()).text

    @property
    def components(self) -> int | None:
        """The number of components of the vector that is drawn; None for a single number."""
        return self.shape[0] if self.shape and not self.place else None

    @property
    def names(self) -> tuple[str, ...]:
        """The paths of all numbers that are drawn, which are the names of columns in tables."""
        return (self.text,) if self.components is None else tuple(f"{self.text}.{index}" for index in range(self.components))

    def is_about(self, other: "Key") -> bool:
        """Return whether two keys state the same quantity, at least in part."""
        if self.whole != other.whole:
            return other.whole in rivals(self.whole)
        shared = min(len(self.place), len(other.place))
        return self.place[:shared] == other.place[:shared]


#: A name of a body or joint that key paths contain as it is, unless it is a number, which would count bodies or joints.
PLAIN_NAME = re.compile(r"(?![0-9]+$)[A-Za-z0-9_.:/-]+")


def name_in_path(name: str) -> str:
    """Return the name of a body or joint as key paths have it: quoted as in TOML, unless it is a `PLAIN_NAME`."""
    return name if PLAIN_NAME.fullmatch(name) else json.dumps(name, ensure_ascii=False)


def rivals(whole: "Path") -> "tuple[Path, ...]":
    """Return the paths of the other keys that state the same quantity as the key at a path."""
    name = whole[-1]
    return tuple((*whole[:-1], other) for pair in SAME for other in pair if name in pair and other != name)


#: One number for each component.
Numbers = tuple[float, ...]


@dataclass(frozen=True)
class Uniform:
    """The same probability everywhere between the limits `low` and `high`, each component independently."""

    low: Numbers
    high: Numbers


@dataclass(frozen=True)
class LogUniform:
    """A value whose logarithm is uniform between the logarithms of `low` and `high`, each component independently."""

    low: Numbers
    high: Numbers


@dataclass(frozen=True)
class Normal:
    """The normal distribution, each component independently."""

    mean: Numbers
    standard_deviation: Numbers


@dataclass(frozen=True)
class OnSphere:
    """A vector (3,) that is distributed uniformly over the surface of the sphere with this radius about the origin."""

    radius: float


@dataclass(frozen=True)
class AnyAttitude:
    """A unit quaternion, uniformly over all rotations."""


@dataclass(frozen=True)
class Choice:
    """One of the given values, all with the same probability; each value has a number for each component."""

    values: tuple[Numbers, ...]


#: Every distribution.
Distribution = Uniform | LogUniform | Normal | OnSphere | AnyAttitude | Choice


@dataclass(frozen=True)
class Variation:
    """A key of the case file, and the distribution that its number or vector is drawn from."""

    key: Key
    distribution: Distribution


@dataclass(frozen=True)
class Ensemble:
    """The number of members that are drawn from a case, and their distributions.

    Attributes
    ----------
    members
        The number of members.
    seed
        The seed of the random numbers.
    vary
        The keys that vary. No two of them are about the same quantity.
    """

    members: int
    seed: int
    vary: tuple[Variation, ...]
