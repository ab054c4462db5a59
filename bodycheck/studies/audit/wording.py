"""Findings of the audit as sentences, for the terminal and the report."""

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from bodycheck.adapters.contract import Kind
from bodycheck.reports.quantities import listing, number
from bodycheck.studies.audit.classes import Classes
from bodycheck.studies.audit.probe import Property
from bodycheck.studies.audit.rows import PROPERTIES, Row, is_finding

#: What an engine does that has a property, as a predicate.
DOES: dict[Property, str] = {
    "single-precision": "computes in single precision",
    "linear-damping": "damps the velocity",
    "angular-damping": "damps the angular velocity",
    "quadratic-damping": "damps a motion in proportion to its square",
    "speed-limit": "limits the speed",
    "spin-limit": "limits the angular velocity",
    "turn-limit": "limits the turn in a step",
    "no-gyroscopic-torque": "leaves out the gyroscopic torque",
    "substeps": "divides each step",
    "gravity-after-position": "moves the body before it applies gravity",
    "sleeping": "puts a slow body to sleep",
    "frame": "returns a velocity along the axes of another frame",
    "order": "returns components in another order",
    "quaternion-norm": "returns quaternions whose norm is not 1",
    "nondeterminism": "gives another motion when a flight is repeated",
    "time-base": "advances by another time than its steps",
    "silent-reset": "starts over and does not say so",
    "energy-per-turn": "changes the energy of rotation in each turn",
    "scale-dependence": "depends on the scale of mass and length",
    "origin-dependence": "depends on the distance from the origin",
    "representation": "depends on the form in which the body is given",
}

#: The heading of findings by their status.
HEADINGS = {"deviates": "Deviates", "default": "By default"}


@dataclass(frozen=True)
class Sentence:
    """What several methods of an engine have in common.

    Parameters
    ----------
    status
        The status of their rows.
    property
        The property.
    text
        The sentence, whose subject is the engine and is left out.
    """

    status: str
    property: Property
    text: str


@dataclass(frozen=True)
class MethodClass:
    """Methods, each with its engine, that are one algorithm in scenes of one kind.

    Parameters
    ----------
    kind
        The kind of the scenes.
    name
        The name of the class.
    methods
        The methods, each as engine and integrator.
    distance
        The largest difference of two motions in the class.
    """

    kind: Kind
    name: str
    methods: tuple[str, ...]
    distance: float


def method_classes(found: Classes) -> list[MethodClass]:
    """Return classes with their methods, in their order."""
    methods: dict[tuple[Kind, str, float], list[str]] = defaultdict(list)
    for row in found.rows:
        methods[row.kind, row.name, row.distance].append(f"{row.engine} {row.integrator}")
    return [MethodClass(kind, name, tuple(own), distance) for (kind, name, distance), own in methods.items()]


def sentences(rows: Iterable[Row]) -> list[Sentence]:
    """Return the findings among the rows of one engine, what deviates first, each property once for each status."""
    groups: dict[tuple[str, Property], list[Row]] = defaultdict(list)
    for row in rows:
        if is_finding(row):
            groups[row.status, row.property].append(row)
    order = list(HEADINGS)
    keys = sorted(groups, key=lambda key: (order.index(key[0]), PROPERTIES.index(key[1])))
    return [Sentence(*key, f"{DOES[key[1]]}{_sized(groups[key])}, with {_methods(groups[key])}.") for key in keys]


def value(row: Row) -> str:
    """Return the value of a row with its unit; empty if it has none."""
    return "" if row.value is None else f"{number(row.value, 3)} {row.unit}".rstrip()


def _sized(rows: Sequence[Row]) -> str:
    """Return the size of what was found, and of what it should be."""
    ranges = []
    for unit in dict.fromkeys(row.unit for row in rows if row.value is not None):
        values = sorted(row.value for row in rows if row.value is not None and row.unit == unit)
        ends = dict.fromkeys(number(end, 3) for end in (values[0], values[-1]))
        ranges.append(f"{' to '.join(ends)} {unit}".rstrip())
    expected = [text for text in dict.fromkeys(row.expected for row in rows) if text]
    told = f" ({'; '.join(expected)} expected)" if expected and ranges else ""
    return f": {' and '.join(ranges)}{told}" if ranges else ""


def _methods(rows: Sequence[Row]) -> str:
    """Return the methods of rows, with what each is off by in the flip."""
    errors = {row.integrator: row.attitude_error for row in rows}
    known = sorted(error for error in errors.values() if error is not None)
    ends = " to ".join(dict.fromkeys(number(end, 2) for end in (known[0], known[-1]))) if known else ""
    return listing(list(errors)) + (f" (flip off by {ends} rad)" if ends else "")
