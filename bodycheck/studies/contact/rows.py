"""The rows of contact.csv, and the lines of the sheet, each of which joins the rows of a figure at defaults and at best."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Literal

from bodycheck.figures.columns import FIGURES
from bodycheck.results.tables import Meaning, table_of

#: The setting of a row: the method that the engine uses if its user chooses nothing, or the method with the smallest value.
Setting = Literal["defaults", "best"]


@dataclass(frozen=True)
class ContactRow:
    """A figure of a scene in an engine with one method.

    If no method ran, the row at the best settings has no method.
    """

    engine: str
    version: str
    integrator: str
    timestep: Annotated[float | None, Meaning("Time step", "time step; empty if no method ran", "s")]
    scene: Annotated[str, Meaning("Scene", "name of the case")]
    setting: Annotated[
        Setting,
        Meaning("Setting", "defaults, for what the engine does by itself, or best, for the smallest value found"),
    ]
    figure: Annotated[
        str,
        Meaning("Figure", "name of the figure of results; empty where the run did not complete", words=frozenset(FIGURES)),
    ]
    value: Annotated[float | None, Meaning("Value", "its value, in the unit that the row names")]
    unit: Annotated[str, Meaning("Unit", "unit of the values of the row")]
    truth: Annotated[
        float | None,
        Meaning(
            "Truth",
            "what the figure is about in mechanics, such as the instant of an impact, in the row's unit",
            signed=True,
        ),
    ]
    truth_error: Annotated[float | None, Meaning("Bound", "bound of the error of the truth, in the row's unit")]
    status: str


SHEET = table_of(
    ContactRow,
    "contact",
    "contact sheet",
    key=("engine", "scene", "setting", "figure", "integrator", "timestep"),
    filled=("engine", "scene", "setting", "status"),
)

#: The tables of the study.
TABLES = (SHEET,)


@dataclass(frozen=True)
class Line:
    """A figure of a scene in an engine, which has a row at the defaults, a row at the best settings, or both."""

    at_defaults: ContactRow | None
    at_best: ContactRow | None

    @property
    def row(self) -> ContactRow:
        """Return one of the rows, from which the entries that both rows share are read."""
        row = self.at_defaults or self.at_best
        assert row is not None  # a line has a row
        return row

    @property
    def engine(self) -> str:
        """Return the name of the engine."""
        return self.row.engine

    @property
    def scene(self) -> str:
        """Return the name of the scene."""
        return self.row.scene

    @property
    def figure(self) -> str:
        """Return the name of the figure; empty where the run did not complete."""
        return self.row.figure

    @property
    def unit(self) -> str:
        """Return the unit of the values."""
        return self.row.unit

    @property
    def truth(self) -> float | None:
        """Return the exact value of the figure's subject in mechanics; None if it is not known."""
        return self.row.truth

    @property
    def default(self) -> float | None:
        """Return the value at the defaults; None without a row at the defaults."""
        return None if self.at_defaults is None else self.at_defaults.value

    @property
    def best(self) -> float | None:
        """Return the smallest value over all methods; None without a row at the best settings."""
        return None if self.at_best is None else self.at_best.value

    @property
    def method(self) -> str:
        """Return the method with the smallest value, in words; empty if no method ran."""
        if self.at_best is None or self.at_best.timestep is None:
            return ""
        return f"{self.at_best.integrator} at {1e3 * self.at_best.timestep:g} ms"

    @property
    def status(self) -> str:
        """Return the status of the run."""
        return self.row.status


def lines(rows: Sequence[ContactRow]) -> list[Line]:
    """Return one line for each figure of each scene and engine, from its rows at the defaults and at the best settings."""
    best = {(row.engine, row.scene, row.figure): row for row in rows if row.setting == "best"}
    usual = {(row.engine, row.scene, row.figure): row for row in rows if row.setting == "defaults"}
    return [Line(usual.get(key), best.get(key)) for key in dict.fromkeys((row.engine, row.scene, row.figure) for row in rows)]
