"""Print the sheet of contact to the terminal."""

from typing import Any

from bodycheck.console.figures import figure_text
from bodycheck.console.options import View
from bodycheck.console.output import say
from bodycheck.console.tables import Column, attribute, chosen, show
from bodycheck.studies.contact.interface import ContactResults
from bodycheck.studies.contact.rows import ContactRow, Line, PropertyRow, Setting, SettingRow, lines, property_lines


def print_sheet(results: ContactResults, view: View) -> None:
    """Print the settings, the properties of their contacts, and one line for each figure of each scene and engine."""
    tables: tuple[Any, ...] = (results.settings, property_lines(results.properties), lines(results.rows))
    first = True
    for columns, rows in zip(TABLES, tables, strict=True):
        if rows and chosen(columns, view):
            if not first:
                say("")
            show(columns, rows, view)
            first = False


def _value(setting: Setting, head: str) -> Column[Line[Any]]:
    """Return the column with the values of a setting."""
    return Column(setting, head, lambda line: figure_text(line.value(setting)), lambda line: line.value(setting))


#: The columns of the table of settings.
SETTINGS: tuple[Column[SettingRow], ...] = (
    attribute("engine"),
    attribute("group"),
    attribute("setting"),
    attribute("integrator", "method"),
    Column("timestep", "step, ms", lambda row: f"{1e3 * row.timestep:.4g}", lambda row: row.timestep),
    attribute("error", "error / defaults"),
    attribute("tried", goes=3),
    attribute("contact_terms", "law given", goes=1, wraps=True),
)

#: The columns with the values of all settings.
VALUES: tuple[Column[Line[Any]], ...] = (
    _value("defaults", "at defaults"),
    _value("recommended", "recommended"),
    _value("best", "best"),
)

#: The columns of the table of properties.
PROPERTIES: tuple[Column[Line[PropertyRow]], ...] = (
    attribute("engine", at="row.engine", goes=3),
    attribute("property", at="row.property"),
    attribute("condition", at="row.condition"),
    *VALUES,
    attribute("unit", at="row.unit", goes=2),
    attribute("expected", "in mechanics", at="row.expected", goes=1),
)

#: The columns of the table of figures.
LINES: tuple[Column[Line[ContactRow]], ...] = (
    attribute("engine", at="row.engine", goes=4),
    attribute("scene", at="row.scene"),
    attribute("figure", at="row.figure"),
    *VALUES,
    attribute("unit", at="row.unit", goes=3),
    attribute("truth", "in mechanics", at="row.truth", goes=2),
    attribute("status", at="row.status", goes=5),
)

#: All tables.
TABLES: tuple[tuple[Column[Any], ...], ...] = (SETTINGS, PROPERTIES, LINES)
