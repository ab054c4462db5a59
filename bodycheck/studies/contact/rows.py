"""The rows of contact.csv."""

from dataclasses import dataclass
from typing import Annotated, Literal

from bodycheck.figures.columns import FIGURES
from bodycheck.results.tables import Meaning, table_of

#: Which method a row is of: what the engine does where its user chooses nothing, or that with the smallest value of the figure.
Setting = Literal["defaults", "best"]


@dataclass(frozen=True)
class ContactRow:
    """A figure of a scene in an engine with one method.

    The method is empty in the row of best settings if no method ran.
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
