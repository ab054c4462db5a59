"""The rows of the audit, which its table and its report contain, and what an engine says of itself."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, get_args

from bodycheck.results import records
from bodycheck.studies.audit.class_rows import Classes, ClassRow, Unclassed
from bodycheck.studies.audit.probe import Property

#: The file with the records of the study.
RECORDS = "audit.jsonl"

#: The properties, in the order in which they are listed.
PROPERTIES: tuple[Property, ...] = get_args(Property)

#: The status of a row. "default" and "deviates" are findings: what the engine does by its own settings or without a switch for
#: it, and what a method does besides. The others are no findings.
Status = Literal["default", "deviates", "none", "not-probed"]

#: The statuses that are findings.
FINDINGS: tuple[Status, ...] = ("default", "deviates")


@dataclass(frozen=True)
class Row:
    """What the audit says of one property of a method.

    Parameters
    ----------
    engine, version, integrator, timestep
        The method; the time step is in s.
    property
        The property.
    value, unit
        The size of what was found, with its unit; None where there is none.
    expected
        What the value is of an engine that computes mechanics alone, as it is printed.
    status
        The status.
    probe
        The name of the probe, with what it saw or why it could not tell.
    attitude_error
        The largest error of the attitude (rad) of the method's flight in the shipped case intermediate-axis-flip, which lasts
        10 s, with this time step. None where nothing was found, and where the flight did not end.
    """

    engine: str
    version: str
    integrator: str
    timestep: float
    property: Property
    value: float | None
    unit: str
    expected: str
    status: Status
    probe: str
    attitude_error: float | None


def is_finding(row: Row) -> bool:
    """Return whether a row says that something was found."""
    return row.status in FINDINGS


@dataclass(frozen=True)
class Facts:
    """What an engine says of itself, which is read and not probed.

    Parameters
    ----------
    precision
        The precision of its arithmetic, as its adapter states it.
    defaults
        Its own choices where a user makes none; see `bodycheck.adapters.contract.Engine`.
    """

    precision: str
    defaults: dict[str, str] = field(default_factory=dict)

    @property
    def text(self) -> str:
        """What the engine chooses where a user makes no choice, for a sentence; empty if it has no such choices."""
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
    """Return recorded classes. Raises `ValueError` for a record that has not what is read of it."""
    return Classes(
        tuple(records.typed(ClassRow, row) for row in record["rows"]),
        tuple(records.typed(Unclassed, one) for one in record["unclassed"]),
    )
