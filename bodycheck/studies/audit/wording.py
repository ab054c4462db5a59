"""Findings of the audit as sentences, for the terminal and the report."""

from collections import defaultdict
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass

from bodycheck.adapters.contract import Kind
from bodycheck.reports.quantities import listing, number
from bodycheck.results.verdicts import AUDIT
from bodycheck.studies.audit.probe import Property
from bodycheck.studies.audit.rows import ANSWERED, PROPERTIES, Classes, Row, is_finding

#: A predicate for each property, which says what an engine with the property does.
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
    "representation": "moves otherwise if the body is given in another form",
    "friction-anisotropy": "brakes a sliding box by a force that depends on the direction",
    "sideways-friction": "pushes a sliding box sideways by friction",
    "impact_energy_error": "changes the energy in a frictionless elastic impact",
    "impact_momentum_error": "changes the momentum in an impact",
    "impact_angular_momentum_error": "changes the angular momentum in an impact",
    "hidden-state": "moves otherwise after a restart from positions and velocities",
    "order-of-bodies": "moves otherwise if bodies or joints are listed in another order",
    "long-time-base": "advances by another time than its steps in very many steps",
    "long-quaternion-norm": "returns quaternions whose norm is not 1 after very many steps",
}

#: The heading of findings by their status.
HEADINGS = {status: AUDIT[status].title.capitalize() for status in ("deviates", "default")}


@dataclass(frozen=True)
class Sentence:
    """A sentence about a property that several methods of an engine have in common.

    Parameters
    ----------
    status
        The status of the rows of these methods.
    property
        The property.
    text
        The sentence without its subject, which is the engine.
    """

    status: str
    property: Property
    text: str


@dataclass(frozen=True)
class MethodClass:
    """A class of methods that are the same algorithm on scenes of one kind.

    Parameters
    ----------
    kind
        The kind of the scenes.
    name
        The name of the class.
    methods
        The names of the methods: engine and integrator.
    distance
        The largest difference of two motions in the class.
    """

    kind: Kind
    name: str
    methods: tuple[str, ...]
    distance: float


def method_classes(classes: Classes) -> list[MethodClass]:
    """Return the classes, each with its methods, in the order of the rows."""
    methods: dict[tuple[Kind, str, float], list[str]] = defaultdict(list)
    for row in classes.rows:
        methods[row.kind, row.name, row.distance].append(f"{row.engine} {row.integrator}")
    return [MethodClass(kind, name, tuple(members), distance) for (kind, name, distance), members in methods.items()]


def sentences(rows: Iterable[Row]) -> list[Sentence]:
    """Return sentences about the findings among the rows of one engine: one for each status and property.

    Findings that deviate come first. Findings about representations are also grouped by whether the difference vanishes with
    the time step.
    """
    given = list(rows)
    every = {row.integrator for row in given}
    groups: dict[tuple[str, Property, str], list[Row]] = defaultdict(list)
    for row in given:
        if is_finding(row):
            groups[row.status, row.property, _kind(row)].append(row)
    order = list(HEADINGS)
    keys = sorted(groups, key=lambda key: (order.index(key[0]), PROPERTIES.index(key[1])))
    texts = []
    for key in keys:
        status, name, kind = key
        text = f"{DOES[name]}{_forms(groups[key], kind)}{_sized(groups[key])}, {_methods(groups[key], every)}."
        texts.append(Sentence(status, name, text))
    return texts


def without_findings(rows: Iterable[Row]) -> str:
    """Return a sentence about an engine without findings, from its rows."""
    answered = any(row.status in ANSWERED for row in rows)
    return "Nothing was found that mechanics does not have." if answered else "No probe gave an answer."


def _kind(row: Row) -> str:
    """Return words that say whether the difference in a row about a representation vanishes with the time step.

    They are empty for rows about other properties.
    """
    if row.property != "representation":
        return ""
    if "not numbers" in row.probe:
        return "with states that are not numbers"
    lasts = "does not vanish" in row.probe
    return f"by a difference that {'does not vanish' if lasts else 'vanishes'} with the time step"


def _forms(rows: Sequence[Row], kind: str) -> str:
    """Return the representations in rows, in brackets, followed by the words `kind` of `_kind`; empty if `kind` is empty."""
    if not kind:
        return ""
    forms = [row.probe.partition(": ")[2].partition(": ")[0] for row in rows]
    return f" ({'; '.join(dict.fromkeys(forms))}), {kind}"


def value(row: Row) -> str:
    """Return the value of a row with its unit; empty if it has none."""
    return "" if row.value is None else f"{number(row.value, 3)} {row.unit}".rstrip()


def ranges(rows: Iterable[Row]) -> str:
    """Return the range of the values of rows, for each unit, as text; empty if no row has a value."""
    given = [row for row in rows if row.value is not None]
    texts = []
    for unit in dict.fromkeys(row.unit for row in given):
        values = sorted(row.value for row in given if row.value is not None and row.unit == unit)
        ends = dict.fromkeys(number(end, 3) for end in (values[0], values[-1]))
        texts.append(f"{' to '.join(ends)} {unit}".rstrip())
    return listing(texts)


def _sized(rows: Sequence[Row]) -> str:
    """Return the range of the values of rows and the expected value, as the end of a phrase; empty if no row has a value."""
    sizes = ranges(rows)
    expected = [text for text in dict.fromkeys(row.expected for row in rows) if text]
    wanted = f" ({'; '.join(expected)} expected)" if expected and sizes else ""
    return f": {sizes}{wanted}" if sizes else ""


def _methods(rows: Sequence[Row], every: Collection[str]) -> str:
    """Return the methods of rows and the range of their errors in the flip, in words. every: all methods of the engine."""
    errors = {row.integrator: row.attitude_error for row in rows}
    known = sorted(error for error in errors.values() if error is not None)
    ends = " to ".join(dict.fromkeys(number(end, 2) for end in (known[0], known[-1]))) if known else ""
    where = "in every method" if len(every) > 1 and len(errors) == len(every) else f"with {listing(list(errors))}"
    return where + (f" (flip off by {ends} rad)" if ends else "")
