"""The rows of the table of a parity study."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path

from bodycheck.results import csv_tables
from bodycheck.results.origin import Origins
from bodycheck.robots.elements import printable
from bodycheck.studies.parity.quantities import Cause, Quantity, Status

#: The file with the rows.
FILE_NAME = "parity.csv"


@dataclass(frozen=True)
class Compared:
    """A quantity as an engine has it and as the file has it.

    Parameters
    ----------
    status
        What came of it.
    quantity
        The quantity; empty in a row about a file that an engine does not read at all.
    subject
        The name of the body or joint; "model" for the whole.
    engine_value, truth_value
        The numbers or words of both sides. Of what is compared at states, they are those of the largest difference.
    difference
        The largest difference of a component, in the unit of the quantity; None where there are no numbers.
    relative
        The difference relative to the size of the quantity, which the tolerance limits; None where there are no numbers.
    cause
        Why it differs.
    """

    status: Status
    quantity: Quantity | None
    subject: str
    engine_value: str = ""
    truth_value: str = ""
    difference: float | None = None
    relative: float | None = None
    cause: Cause = ""


@dataclass(frozen=True)
class ParityRow:
    """A row of parity.csv: what was compared, with the model and the engine; see `Compared`.

    The engine of a row about the file itself is "file".
    """

    model: str
    engine: str
    version: str
    status: Status
    quantity: Quantity | None
    subject: str
    engine_value: str
    truth_value: str
    difference: float | None
    relative: float | None
    cause: Cause


COLUMNS = tuple(field.name for field in fields(ParityRow))


def row(model: str, engine: str, version: str, compared: Compared) -> ParityRow:
    """Return a row of the table. Names of bodies and joints and words of engines are a stranger's: they are made printable."""
    shown = replace(
        compared,
        subject=printable(compared.subject),
        engine_value=printable(compared.engine_value),
        truth_value=printable(compared.truth_value),
    )
    return ParityRow(printable(model), engine, version, **asdict(shown))


def failed(one: ParityRow | Compared) -> bool:
    """Return whether a row says that something differs or is refused."""
    return one.status in ("differs", "refused")


def write(rows: Sequence[ParityRow], folder: Path, origins: Origins) -> None:
    """Write parity.csv into a folder, with where its numbers come from."""
    csv_tables.write(folder / FILE_NAME, COLUMNS, map(asdict, rows), origins)
