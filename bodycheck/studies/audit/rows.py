"""The rows of the audit: properties of methods, statements of engines about themselves, and classes of equal methods."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal, get_args

from bodycheck.adapters.contract import Kind
from bodycheck.results import records
from bodycheck.results.tables import Meaning, table_of
from bodycheck.studies.audit.probe import Property

#: The file with the records of the study.
RECORDS = "audit.jsonl"

#: The properties, in the order in which they are listed.
PROPERTIES: tuple[Property, ...] = get_args(Property)

#: The status of a row. "default" and "deviates" are findings: the engine has the property at its own settings or states that it
#: has it, or a method has it although the engine's defaults do not explain it. The other statuses are not findings.
Status = Literal["default", "deviates", "none", "not-probed"]

#: The statuses that are findings.
FINDINGS: tuple[Status, ...] = ("default", "deviates")

#: The statuses of rows for which a probe gave an answer.
ANSWERED: tuple[Status, ...] = (*FINDINGS, "none")


@dataclass(frozen=True)
class Row:
    """The finding of the audit about one property of a method."""

    engine: str
    version: str
    integrator: str
    timestep: float
    property: Annotated[Property, Meaning("Property", "what the probe looks for that mechanics does not have")]
    value: Annotated[
        float | None, Meaning("Value", "its size, in the unit that the row names; empty if it has none", signed=True)
    ]
    unit: Annotated[str, Meaning("Unit", "unit of the values of the row")]
    expected: Annotated[str, Meaning("Expected", "value of an engine that computes mechanics alone")]
    status: Annotated[
        Status,
        Meaning("Status", "default and deviates are findings; none, for as mechanics has it; not-probed, for unknown"),
    ]
    probe: Annotated[str, Meaning("Probe", "probe that gave the answer, with what it saw or why it could not tell")]
    attitude_error: Annotated[
        float | None,
        Meaning(
            "Attitude error",
            "largest attitude error of the method in intermediate-axis-flip; empty without a finding, or if the flight did "
            "not end",
            "rad",
        ),
    ]


ROWS = table_of(Row, "audit", "audit", filled=("engine", "version", "integrator", "timestep", "property", "status"))


@dataclass(frozen=True)
class ClassRow:
    """A method, and its class of equal methods on scenes of one kind."""

    kind: Annotated[Kind, Meaning("Kind", "kind of the scenes")]
    name: Annotated[
        str,
        Meaning(
            "Class",
            'name of the class: its scheme, or "not identified" with a number; no other class of the kind has it',
            column="class",
        ),
    ]
    scheme: Annotated[str, Meaning("Scheme", "textbook scheme with which the class agrees; empty if there is none")]
    engine: str
    version: str
    integrator: str
    distance: Annotated[
        float, Meaning("Distance", "largest difference of the motions of two methods in the class, relative to their size")
    ]
    scene_timestep: Annotated[float, Meaning("Time step", "time step of the scenes", "s")]


#: The table of classes.
CLASSES = table_of(ClassRow, "classes", "methods that are the same algorithm", key=("kind", "engine", "integrator"))


@dataclass(frozen=True)
class Unclassed:
    """A method without a class on one kind of scenes, because a run failed or was refused, and the reason."""

    kind: Kind
    engine: str
    integrator: str
    reason: str


@dataclass(frozen=True)
class Classes:
    """The classes of methods: their rows by class, the largest class of a kind first, and the methods without a class."""

    rows: tuple[ClassRow, ...]
    unclassed: tuple[Unclassed, ...]


#: The tables of the study, the main one first.
TABLES = (ROWS, CLASSES)


def is_finding(row: Row) -> bool:
    """Return whether a row is a finding, that is, whether the property was found."""
    return row.status in FINDINGS


@dataclass(frozen=True)
class Facts:
    """The statements of an engine about itself, which are read and not probed.

    Parameters
    ----------
    precision
        The precision of the engine's arithmetic, as its adapter states it.
    defaults
        The default settings of the engine; see `bodycheck.adapters.contract.Engine`.
    """

    precision: str
    defaults: dict[str, str] = field(default_factory=dict)

    @property
    def text(self) -> str:
        """The default settings of the engine as a list for a sentence; empty if it states none."""
        return ", ".join(f"{name} {value}" for name, value in self.defaults.items())


@dataclass(frozen=True)
class Fault:
    """A probe that gave no answer, because its process died, it raised an exception or it took too long."""

    engine: str
    integrator: str
    probe: str
    reason: str

    @property
    def text(self) -> str:
        """The fault as a sentence without a full stop."""
        return f"{self.engine} {self.integrator}: the probe {self.probe} gave no answer: {self.reason}"


def read_classes(record: Mapping[str, Any]) -> Classes:
    """Return the classes in a record. Raises `ValueError` if an entry of the record is missing or has the wrong type."""
    return Classes(
        tuple(records.typed(ClassRow, row) for row in record["rows"]),
        tuple(records.typed(Unclassed, one) for one in record["unclassed"]),
    )
