"""The rows of the tables of contact, and the lines of the sheet, each of which joins the rows of a figure at all settings."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Generic, Literal, TypeVar

from bodycheck.figures.columns import FIGURES
from bodycheck.results.tables import Meaning, table_of
from bodycheck.studies.contact.property import NAMES
from bodycheck.studies.contact.sheet import Group

#: The name of the journal of the search and of the probes.
RECORDS = "contact.jsonl"

#: The setting of a row: the method that the engine uses if its user chooses nothing, the method that its documentation
#: recommends, or the best method that the search found.
Setting = Literal["defaults", "recommended", "best"]

#: The meaning of the column with the setting.
SETTING = Meaning(
    "Setting",
    "defaults, for what the engine does by itself; recommended, for what its documentation recommends; best, for the best "
    "setting that the search found",
)


@dataclass(frozen=True)
class ContactRow:
    """A figure of a scene in an engine with the method of a setting."""

    engine: str
    version: str
    integrator: str
    timestep: Annotated[float | None, Meaning("Time step", "time step; empty if no method ran", "s")]
    scene: Annotated[str, Meaning("Scene", "name of the case")]
    setting: Annotated[Setting, SETTING]
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


@dataclass(frozen=True)
class SettingRow:
    """A setting of an engine for a group of scenes: its method, and its errors relative to the defaults."""

    engine: str
    version: str
    group: Annotated[
        Group,
        Meaning(
            "Group",
            "group of the scenes: plane, for a body that slides flat on a level plane; contact, for bodies that touch; impact, "
            "for bodies that bounce",
        ),
    ]
    setting: Annotated[Setting, SETTING]
    integrator: str
    timestep: Annotated[float, Meaning("Time step", "time step", "s")]
    error: Annotated[
        float | None,
        Meaning(
            "Error",
            "geometric mean, over the scenes of the search, of the largest error of the position relative to that of the first "
            "setting of the engine; empty if the method does not complete one of these scenes",
        ),
    ]
    scenes: Annotated[int, Meaning("Scenes", "number of scenes of the search", counts="scenes")]
    tried: Annotated[int, Meaning("Tried", "number of methods that were tried", counts="methods")]
    contact_terms: str


SETTINGS = table_of(
    SettingRow,
    "contact_settings",
    "settings for contact",
    key=("engine", "group", "setting"),
    filled=("engine", "group", "setting", "integrator", "timestep"),
)


@dataclass(frozen=True)
class PropertyRow:
    """A property of the contacts of an engine with the method of a setting, from a probe."""

    engine: str
    version: str
    setting: Annotated[Setting, SETTING]
    integrator: str
    timestep: Annotated[float, Meaning("Time step", "time step of the method", "s")]
    property: Annotated[str, Meaning("Property", "what the probe measures", words=frozenset(NAMES))]
    condition: Annotated[str, Meaning("Condition", "conditions of the measurement")]
    value: Annotated[
        float | None, Meaning("Value", "its value, in the unit that the row names; empty if there is none", signed=True)
    ]
    unit: Annotated[str, Meaning("Unit", "unit of the value")]
    expected: Annotated[float | None, Meaning("Expected", "value in mechanics, in the row's unit")]
    note: Annotated[str, Meaning("Note", "why there is no value, or the numbers from which it follows")]


MEASURED = table_of(
    PropertyRow,
    "contact_properties",
    "properties of contacts",
    key=("engine", "setting", "property", "condition"),
    filled=("engine", "setting", "property"),
)


@dataclass(frozen=True)
class Sheet:
    """The rows of all tables of the study."""

    figures: Sequence[ContactRow]
    settings: Sequence[SettingRow]
    properties: Sequence[PropertyRow]


#: A row of a setting with a value.
Row = TypeVar("Row", ContactRow, PropertyRow)

#: The tables of the study.
TABLES = (SHEET, SETTINGS, MEASURED)


@dataclass(frozen=True)
class Line(Generic[Row]):
    """A figure of a scene, or a property, in an engine, with the rows of the settings that have it."""

    rows: Mapping[Setting, Row]

    @property
    def row(self) -> Row:
        """Return one of the rows, from which the entries that all rows share are read."""
        return next(iter(self.rows.values()))

    def value(self, setting: Setting) -> float | None:
        """Return the value of a setting; None without a row of it."""
        return self.rows[setting].value if setting in self.rows else None

    def method(self, setting: Setting) -> str:
        """Return the method of a setting in words; empty without a row of it."""
        row = self.rows.get(setting)
        return "" if row is None or row.timestep is None else method_in_words(row.integrator, row.timestep)


def method_in_words(integrator: str, timestep: float) -> str:
    """Return a method with its time step (s) in words."""
    return f"{integrator} at {1e3 * timestep:.4g} ms"


def lines(rows: Sequence[ContactRow]) -> list[Line[ContactRow]]:
    """Return one line for each figure of each scene and engine, with its rows at all settings."""
    return _joined(rows, lambda row: (row.engine, row.scene, row.figure))


def property_lines(rows: Sequence[PropertyRow]) -> list[Line[PropertyRow]]:
    """Return one line for each property of each engine, with its rows at all settings."""
    return _joined(rows, lambda row: (row.engine, row.property, row.condition))


def _joined(rows: Sequence[Row], key: Callable[[Row], tuple[str, ...]]) -> list[Line[Row]]:
    joined: dict[tuple[str, ...], dict[Setting, Row]] = {}
    for row in rows:
        joined.setdefault(key(row), {})[row.setting] = row
    return [Line(together) for together in joined.values()]
