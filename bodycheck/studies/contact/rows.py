"""The rows of contact.csv."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Literal

from bodycheck.results import csv_tables
from bodycheck.results.origin import Origins

#: The file with the rows.
FILE_NAME = "contact.csv"

#: Which method a row is of: what the engine does where its user chooses nothing, or that with the smallest value of the figure.
Setting = Literal["defaults", "best"]


@dataclass(frozen=True)
class ContactRow:
    """A figure of a scene in an engine with one method.

    Attributes
    ----------
    engine, version, integrator, timestep
        The method; the time step is in s. They are empty in the row of best settings where no method ran.
    scene
        The name of the case.
    setting
        Which method it is.
    figure, value, unit
        The name of the figure, its value and unit; no figure where the run did not complete.
    truth, truth_error
        What the figure's subject is in mechanics, such as the instant of an impact, and the bound of its error, in the unit.
    status
        How the run ended.
    """

    engine: str
    version: str
    integrator: str
    timestep: float | None
    scene: str
    setting: Setting
    figure: str
    value: float | None
    unit: str
    truth: float | None
    truth_error: float | None
    status: str


COLUMNS = tuple(field.name for field in fields(ContactRow))


def write(rows: Sequence[ContactRow], folder: Path, origins: Origins) -> None:
    """Write contact.csv into a folder, with where its numbers come from."""
    csv_tables.write(folder / FILE_NAME, COLUMNS, map(asdict, rows), origins)
