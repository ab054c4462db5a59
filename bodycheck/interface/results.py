"""The common base of the results of all functions of the Python interface."""

import math
from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from itertools import islice
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from bodycheck.errors import BadInput
from bodycheck.interface.plots import Plot, chosen
from bodycheck.reports import plot_files
from bodycheck.reports.study import StudyReport
from bodycheck.results import tables
from bodycheck.suggestion import did_you_mean

if TYPE_CHECKING:
    import pandas as pd


#: Units for tables without units.
NO_UNITS: Mapping[str, str] = MappingProxyType({})


#: The largest number of rows of a table that are shown, and the significant digits of its numbers.
MOST_ROWS, DIGITS = 12, 4


def shown(
    headline: str, sentences: Iterable[str], rows: Sequence[Mapping[str, Any]], columns: Sequence[str], units: Mapping[str, str]
) -> str:
    """Return HTML for a notebook with the statements of results and a table.

    Parameters
    ----------
    headline, sentences
        The statements of the results.
    rows, columns
        The rows of the table, and its columns; a column is shown if any row has a value.
    units
        The units of columns.
    """
    used = [name for name in columns if any(row.get(name) not in (None, "") for row in rows)]
    heads = "".join(f"<th>{escape(f'{name} {units.get(name, str())}'.rstrip())}</th>" for name in used)
    body = "".join(
        f"<tr>{''.join(f'<td>{escape(_text(row.get(name)))}</td>' for name in used)}</tr>" for row in islice(rows, MOST_ROWS)
    )
    left = len(rows) - MOST_ROWS
    more = f"<p>{left} more rows are in <code>to_frame()</code>.</p>" if left > 0 else ""
    said = "".join(f"<li>{escape(sentence)}</li>" for sentence in sentences)
    return (
        f"<p><b>{escape(headline)}</b></p>{f'<ul>{said}</ul>' if said else ''}"
        f"<table><thead><tr>{heads}</tr></thead><tbody>{body}</tbody></table>{more}"
    )


def _text(value: object) -> str:
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return "–"
    return f"{value:.{DIGITS}g}" if isinstance(value, float) else str(value)


@dataclass(frozen=True)
class Table:
    """A table of results.

    Attributes
    ----------
    rows
        The rows. Missing values are None.
    columns
        The names of all columns, in order.
    numbers
        The names of the columns with numbers that are not integers.
    units
        The units of the columns that have a unit, by name.
    shown
        The columns that a notebook shows.
    """

    rows: Sequence[Mapping[str, Any]]
    columns: Sequence[str]
    numbers: frozenset[str]
    units: Mapping[str, str]
    shown: Sequence[str]

    @classmethod
    def of(cls, described: tables.Table[Any], rows: Sequence[Any], units: Mapping[str, str] = NO_UNITS) -> "Table":
        """Return rows as a table.

        Parameters
        ----------
        described
            The description of the table.
        rows
            The rows, in the form that the description expects.
        units
            The units of columns whose unit depends on the rows.
        """
        columns = described.names(rows)
        known = {name: described.by_name[name] for name in columns}
        return cls(
            described.records(rows),
            columns,
            frozenset(name for name, column in known.items() if column.kind == "number"),
            {name: column.unit for name, column in known.items() if column.unit} | dict(units),
            described.shown or columns,
        )

    def to_frame(self) -> "pd.DataFrame":
        """Return the table as a data frame; `attrs["units"]` has its units. Raises `BadInput` if pandas is missing."""
        try:
            import pandas as pd  # it is large, and nothing else needs it
        except ModuleNotFoundError as error:
            raise BadInput("a data frame needs pandas: pip install 'bodycheck[frames]'") from error
        frame = pd.DataFrame.from_records([dict(row) for row in self.rows], columns=list(self.columns))
        # With a nullable type, pandas prints small numbers as 0.0.
        frame = frame.astype({name: "float64" for name in self.columns if name in self.numbers})
        frame.attrs["units"] = dict(self.units)
        return frame


class Results(ABC):
    """The results of a function of the Python interface: their statements, tables and plots."""

    @property
    @abstractmethod
    def headline(self) -> str:
        """The result in one sentence."""

    @property
    @abstractmethod
    def findings(self) -> tuple[str, ...]:
        """Further findings, in sentences."""

    @property
    @abstractmethod
    def tables(self) -> Mapping[str, Table]:
        """The tables by name, the main one first."""

    @property
    @abstractmethod
    def plots(self) -> Sequence[Plot]:
        """The charts of the report."""

    def to_frame(self, table: str = "") -> "pd.DataFrame":
        """Return a table as a data frame of pandas, with the units of its columns in `attrs["units"]`.

        Parameters
        ----------
        table
            The name of the table; the main one if it is empty.

        Raises
        ------
        BadInput
            If there is no such table, or if pandas is not installed.
        """
        tables = self.tables
        if table and table not in tables:
            raise BadInput(f"there is no table {table!r}; there are: {', '.join(tables)}{did_you_mean(table, list(tables))}")
        return tables[table or next(iter(tables))].to_frame()

    def plot(self, quantity: str = "", *, case: str = "") -> Plot:
        """Return a chart of the report.

        Parameters
        ----------
        quantity
            The name of a figure, or the beginning of the title of the chart; the first chart if it is empty.
        case
            The case; the first one if it is empty.

        Raises
        ------
        BadInput
            If there is no such chart.
        """
        return chosen(self.plots, quantity, case)

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {self.headline}>"

    def _repr_html_(self) -> str:
        main = next(iter(self.tables.values()))
        return shown(self.headline, self.findings, main.rows, main.shown, main.units)


@dataclass(frozen=True, eq=False, repr=False)
class StudyResults(Results):
    """The results of a study, with its report.

    Attributes
    ----------
    report
        The contents of the report.
    """

    report: StudyReport

    @property
    def headline(self) -> str:
        """The result in one sentence."""
        return self.report.headline

    @property
    def findings(self) -> tuple[str, ...]:
        """Further findings, in sentences."""
        return tuple(f"{finding.subject}: {finding.text}" for finding in self.report.findings)

    @property
    def plots(self) -> tuple[Plot, ...]:
        """The charts of the report."""
        parts = [(part.name, chart.title) for part in self.report.parts for chart in part.charts]
        charts = plot_files.of_study(self.report)
        return tuple(Plot(*heading, chart) for heading, (_, chart) in zip(parts, charts, strict=True))
