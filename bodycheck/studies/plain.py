"""Studies whose folder has only the modules `rows` and `study`: their command, Python function, page and saved results.

The module `rows` of such a study has `TABLES`, the descriptions of its tables, and `RECORDS`, the name of the journal in its
folder. Its module `study` has

- `prepare(cases, engines, integrators)`, which returns the plan of the work; its `size` is the number of parts, and its
  `methods` are pairs of the name of an engine and a method, of which every run is made;
- `results(plan, folder, header, jobs, progress)`, a context that does the work and provides the rows of each table;
- `suits(case)`, which is needed only if the study is not made of every case. It returns whether the study is made of a shipped
  case when the user names no case.

The rows of the main table are recorded in the journal, as the entry `row` of records. If they have a status, `MEASURED` in the
module `rows` names the statuses that are results; without it, this is ok alone. The docstring of the folder, up to its
first list, is the help of the command.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bodycheck.casefile.content import Case
from bodycheck.console import tables as terminal
from bodycheck.console.arguments import Engines, Robots, load_engines
from bodycheck.console.options import View
from bodycheck.console.output import say
from bodycheck.console.robots import noticed
from bodycheck.interface import arguments
from bodycheck.interface.arguments import Cases, Names
from bodycheck.interface.results import StudyResults
from bodycheck.interface.results import Table as FrameTable
from bodycheck.results import origin
from bodycheck.results.tables import Table
from bodycheck.running import campaign, named
from bodycheck.running.named import Decision
from bodycheck.studies import plain_report, registry
from bodycheck.studies.output import Output


@dataclass(frozen=True, eq=False, repr=False)
class PlainResults(StudyResults):
    """The results of a study.

    Attributes
    ----------
    rows_by_table
        The rows of each table.
    described
        The descriptions of the tables, the main one first.
    """

    rows_by_table: Sequence[Sequence[Any]]
    described: Sequence[Table[Any]]

    @property
    def tables(self) -> dict[str, FrameTable]:
        """The tables by name, the main one first."""
        return {table.name: FrameTable.of(table, rows) for table, rows in zip(self.described, self.rows_by_table, strict=True)}


def suited(name: str, cases: Iterable[Case], *, named: bool) -> list[Case]:
    """Return the cases of a study: all given cases if the user named them (`named`), or else the cases that suit the study."""
    suits: Callable[[Case], bool] = getattr(registry.required(name, "study"), "suits", lambda case: True)
    return [case for case in cases if named or suits(case)]


def carry_out(
    name: str,
    cases: Sequence[Case],
    engines: Engines,
    integrators: Sequence[str],
    command: Sequence[str],
    jobs: int,
    output: Output,
) -> PlainResults:
    """Make a study, and write its tables and its report.

    Parameters
    ----------
    name
        The name of the study.
    cases, engines
        The cases and the engines of the study.
    integrators
        Spellings of methods; all methods of the engines if it is empty.
    command
        The words of the command, for the header of the results.
    jobs
        The number of processes.
    output
        The folder and the formats of the results, and the display of progress. An interrupted study in the folder is resumed.

    Raises
    ------
    BadInput, BadJournal
        As the functions `prepare` and `results` of the study raise them.
    """
    study, described = registry.required(name, "study"), registry.required(name, "rows").TABLES
    planned = study.prepare(cases, engines.records, integrators)
    engines.check_planned(cases, planned.methods)
    robots = noticed(cases, jobs, output.quiet)
    header = campaign.header(command, engines.records, engines.missing, robots=robots)
    with (
        output.work(name, planned.size) as (folder, progress),
        study.results(planned, folder, header, jobs, progress) as rows,
    ):
        report = plain_report.present(name, header, rows)
        origins = [origin.origin(header, {case.name: case.text for case in cases})]
        output.write(report, tuple(zip(described, rows, strict=True)), origins)
    return PlainResults(report, rows, described)


def decided(name: str, results: PlainResults, engines: Engines, cases: Iterable[Case], failed: bool) -> Decision:
    """Return the decision on the command of a study from the rows of its main table. failed: whether a file was left out."""
    (main, *_), (rows, *_) = results.described, results.rows_by_table
    measured = getattr(registry.required(name, "rows"), "MEASURED", named.MEASURED)
    return engines.decided(main.records(rows), cases, failed, measured=measured)


def function(name: str) -> Callable[..., PlainResults]:
    """Return the Python function of a study, with the parameters of its command."""

    def study(
        cases: Cases = (),
        *,
        engine: Names = (),
        integrator: Names = (),
        package_path: str | Path | Iterable[str | Path] = (),
        ignore: Names = (),
        out: str | Path | None = None,
        jobs: int | None = None,
    ) -> PlainResults:
        return called(name, cases, engine, integrator, arguments.robots(package_path, ignore), out, jobs)

    study.__name__ = study.__qualname__ = name
    study.__doc__ = registry.about(name)
    return study


def called(
    name: str,
    cases: Cases,
    engine: Names,
    integrator: Names,
    robots: Robots,
    out: str | Path | None,
    jobs: int | None,
) -> PlainResults:
    """Make a study with the arguments of its Python function.

    Raises `BadInput` with the same messages as the command line.
    """
    each = arguments.listed(cases)
    chosen, spellings = arguments.names("--engine", engine), arguments.names("--integrator", integrator)
    processes = arguments.jobs_of(jobs)
    given = suited(name, arguments.given_cases(each, robots).cases, named=bool(each))
    command = arguments.command(name, each, engine=chosen, integrator=spellings, **arguments.of_robots(robots))
    output = Output(arguments.path("--out", out))
    return carry_out(name, given, load_engines(chosen, integrators=spellings), spellings, command, processes, output)


def check_view(name: str, view: View) -> None:
    """Raise `BadInput` if a view names a column that none of the study's tables on the terminal has."""
    printing = registry.part(name, "printing")
    terminal.check(
        view, *(printing.TABLES if printing is not None else map(_terminal_columns, registry.required(name, "rows").TABLES))
    )


def print_tables(name: str, results: PlainResults, view: View) -> None:
    """Print the tables of a study by its module `printing`, or with all their columns if it has no such module."""
    if (printing := registry.part(name, "printing")) is not None:
        printing.print_rows(*results.rows_by_table, view)
        return
    for position, (table, rows) in enumerate(zip(results.described, results.rows_by_table, strict=True)):
        if position:
            say("")
        terminal.show(_terminal_columns(table), table.records(rows), view)


def _terminal_columns(table: Table[Any]) -> list[terminal.Column[Any]]:
    """Return the columns of a table on the terminal. If the terminal is narrow, the last columns are left out first."""
    heads = [(column.name, f"{column.name} {column.unit}".rstrip()) for column in table.columns]
    return [terminal.entry(name, head, ".6g", goes=goes) for goes, (name, head) in enumerate(heads)]
