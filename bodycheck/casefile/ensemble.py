"""Check the table `[ensemble]` of a case, and build its ensemble: the number of members, and the keys that vary.

The grammar of single keys cannot express all rules: each key path leads to a number or vector of the file, no two are about the
same quantity, and the parameters of each distribution fit its key and one another. In an ensemble, these parameters are tuples
with a number for each component: one number for a key that is a single number.
"""

from collections.abc import Iterator, Mapping
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
    distribution_of,
)
from bodycheck.casefile.formats import is_mechanism
from bodycheck.casefile.key_paths import ATTITUDE, Unknown, find, is_complete, keys
from bodycheck.casefile.raw_values import mapping, numbers
from bodycheck.casefile.toml_positions import Path
from bodycheck.casefile.values import MAX_CHOICES, MAX_VARIATIONS


def build_ensemble(table: EnsembleTable, document: Mapping[str, Any]) -> Ensemble:
    """Return the ensemble of a table. Neither the table nor its document may have faults."""
    keys_of_document = keys(document)
    vary = []
    for variation in table.vary:
        key = find(ATTITUDE if isinstance(variation, AttitudeTable) else variation.key, document, keys_of_document)
        vary.append(Variation(key, _distribution(variation, key)))
    return Ensemble(table.members, table.seed, tuple(vary))


def _distribution(table: AnyVariation, key: Key) -> Distribution:
    match table:
        case UniformTable():
            return Uniform(_repeated(table.low, key), _repeated(table.high, key))
        case LogUniformTable():
            return LogUniform(_repeated(table.low, key), _repeated(table.high, key))
        case NormalTable():
            return Normal(_repeated(table.mean, key), _repeated(table.standard_deviation, key))
        case OnSphereTable():
            return OnSphere(table.radius)
        case AttitudeTable():
            return AnyAttitude()
        case ChoiceTable():
            return Choice(tuple(_repeated(value, key) for value in table.values))


def _repeated(value: float | Numbers, key: Key) -> Numbers:
    """Return a number for each component; a single number is repeated for all components."""
    return value if isinstance(value, tuple) else (value,) * (key.components or 1)


#: The parameters of each distribution that are numbers or vectors.
PARAMETERS = {"uniform": ("low", "high"), "log-uniform": ("low", "high"), "normal": ("mean", "standard_deviation")}

#: The first parts of the key paths of bodies and joints.
OF_BODIES = ("body.", "bodies.", "joints.")


def ensemble_faults(document: Mapping[str, Any]) -> Iterator[tuple[Path, str]]:
    """Yield the faults of the ensemble of a raw document, which may have other faults, as pairs of path and message."""
    vary = mapping(document.get("ensemble")).get("vary")
    if not isinstance(vary, list):
        return
    keys_of_document = keys(document)
    incomplete = not is_complete(document)  # reported as another fault
    taken: list[Key] = []
    for index, variation in enumerate(map(mapping, vary[:MAX_VARIATIONS])):
        path: Path = ("ensemble", "vary", index)
        attitude = distribution_of(variation) == "attitude"
        text = ATTITUDE if attitude else variation.get("key")
        if not isinstance(text, str) or (incomplete and text.startswith(OF_BODIES)):
            continue
        at = path if attitude else (*path, "key")
        if attitude and is_mechanism(document):
            yield at, "draws the attitude of one body; of a mechanism, draw the components of a quaternion by normal"
            continue
        try:
            key = find(text, document, keys_of_document)
        except Unknown as error:
            yield at, str(error)
            continue
        if (other := next((other for other in taken if other.is_about(key)), None)) is not None:
            what = "the attitude" if attitude else key.text
            too = "" if key.text == other.text else f", as {other.text} is drawn too"
            yield at, f"{what} is drawn twice{too}; give only one"
        taken.append(key)
        for name, message in _of_distribution(variation, key):
            yield (*path, *name), message


def _of_distribution(variation: Mapping[str, Any], key: Key) -> Iterator[tuple[Path, str]]:
    """Yield the faults of the parameters of a distribution with their paths below its table."""
    distribution = distribution_of(variation)
    parameters = {name: variation[name] for name in PARAMETERS.get(distribution, ()) if name in variation}
    expanded = {}
    for name, value in parameters.items():
        if (fault := _misfit(value, key)) is not None:
            yield (name,), fault
        elif (each := _each(value, key)) is not None:
            expanded[name] = each
    low, high = expanded.get("low"), expanded.get("high")
    if low is not None and high is not None and any(one >= other for one, other in zip(low, high, strict=True)):
        yield ("high",), f"must be above low, {variation['low']}{', in every component' if key.components else ''}"
    if distribution == "uniform" and key.sign != "any" and low is not None and min(low) < 0:
        yield ("low",), f"draws negative numbers; {_allowed(key)}"
    if distribution == "normal" and key.sign != "any" and min(expanded.get("mean", [1.0])) <= 0:
        yield ("mean",), f"draws negative numbers; {_allowed(key)}"
    if distribution == "sphere":
        if key.components != 3:
            yield (), f"a sphere draws vectors of three components, and {key.text} is {_form(key)}"
        elif key.sign != "any":
            yield (), f"a sphere draws negative numbers; {_allowed(key)}"
    values = variation.get("values")
    if distribution == "choice" and isinstance(values, list):
        for index, value in enumerate(values[:MAX_CHOICES]):
            if (fault := _misfit_of_choice(value, key)) is not None:
                yield ("values", index), fault


def _misfit(value: Any, key: Key) -> str | None:
    """Return why a parameter does not have the form of a key; None if it has, or if the grammar reports the fault."""
    if isinstance(value, list) and len(value) != key.components:
        return f"{key.text} is {_form(key)}; allowed: a number{f', or {key.components} numbers' if key.components else ''}"
    return None


def _misfit_of_choice(value: Any, key: Key) -> str | None:
    """Return why a key cannot have a value; None if it can, or if the grammar reports the fault."""
    if isinstance(value, list) != (key.components is not None) or (isinstance(value, list) and len(value) != key.components):
        return f"{key.text} is {_form(key)}; allowed: {'a number' if key.components is None else f'{key.components} numbers'}"
    each = _each(value, key)
    if each is not None and (min(each) < 0 or (min(each) == 0 and key.sign == "positive")) and key.sign != "any":
        return _allowed(key)
    return None


def _each(value: Any, key: Key) -> list[float] | None:
    """Return a number for each component; None if the grammar reports the value as a fault."""
    size = key.components or 1
    return numbers(value if isinstance(value, list) else [value] * size, size)


def _form(key: Key) -> str:
    return "a number" if key.components is None else f"a vector of {key.components} components"


def _allowed(key: Key) -> str:
    return f"{key.text} is {'positive' if key.sign == 'positive' else 'not negative'}"
