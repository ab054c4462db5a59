"""What an ensemble of a case is: how many members are drawn, and the keys that vary with their distributions.

The parameters of a distribution are tuples with a number for each component: one for a key that is a single number.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from bodycheck.casefile.ensemble_grammar import (
    AnyVariation,
    AttitudeTable,
    ChoiceTable,
    EnsembleTable,
    LogUniformTable,
    NormalTable,
    OnSphereTable,
    UniformTable,
)
from bodycheck.casefile.key_paths import ATTITUDE, Key, find, keys

#: One number for each component.
Numbers = tuple[float, ...]


@dataclass(frozen=True)
class Uniform:
    """The same probability everywhere between the limits `low` and `high`, each component independently."""

    low: Numbers
    high: Numbers


@dataclass(frozen=True)
class LogUniform:
    """A logarithm with the same probability everywhere between those of `low` and `high`, each component independently."""

    low: Numbers
    high: Numbers


@dataclass(frozen=True)
class Normal:
    """The normal distribution, each component independently."""

    mean: Numbers
    standard_deviation: Numbers


@dataclass(frozen=True)
class OnSphere:
    """A vector of three components, uniformly on the surface of the sphere of this radius about 0."""

    radius: float


@dataclass(frozen=True)
class AnyAttitude:
    """A unit quaternion, uniformly over all rotations."""


@dataclass(frozen=True)
class Choice:
    """One of these values, each with the same probability; each has a number for each component."""

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
    """What many members are drawn from a case with.

    Attributes
    ----------
    members
        How many.
    seed
        The seed of the random numbers.
    vary
        The keys that vary. No two of them are about the same quantity.
    """

    members: int
    seed: int
    vary: tuple[Variation, ...]


def build_ensemble(table: EnsembleTable, document: Mapping[str, Any]) -> Ensemble:
    """Return the ensemble of a table that has no faults, nor does its document."""
    known = keys(document)
    vary = []
    for variation in table.vary:
        key = find(ATTITUDE if isinstance(variation, AttitudeTable) else variation.key, document, known)
        vary.append(Variation(key, _distribution(variation, key)))
    return Ensemble(table.members, table.seed, tuple(vary))


def _distribution(table: AnyVariation, key: Key) -> Distribution:
    match table:
        case UniformTable():
            return Uniform(_each(table.low, key), _each(table.high, key))
        case LogUniformTable():
            return LogUniform(_each(table.low, key), _each(table.high, key))
        case NormalTable():
            return Normal(_each(table.mean, key), _each(table.standard_deviation, key))
        case OnSphereTable():
            return OnSphere(table.radius)
        case AttitudeTable():
            return AnyAttitude()
        case ChoiceTable():
            return Choice(tuple(_each(value, key) for value in table.values))


def _each(value: float | Numbers, key: Key) -> Numbers:
    """Return a number for each component; a single one counts for all of them."""
    return value if isinstance(value, tuple) else (value,) * (key.components or 1)
