"""What an ensemble of a case is: how many members are drawn, and the keys that vary with their distributions.

The parameters of a distribution are tuples with a number for each component: one for a key that is a single number.
"""

from collections.abc import Mapping
from typing import Any

from bodycheck.casefile.distributions import (
    AnyAttitude,
    Choice,
    Distribution,
    Ensemble,
    Key,
    LogUniform,
    Normal,
    Numbers,
    OnSphere,
    Uniform,
    Variation,
)
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
from bodycheck.casefile.key_paths import ATTITUDE, find, keys


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
