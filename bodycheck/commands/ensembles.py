"""The commands `bodycheck gather` and `query`, for the results of an ensemble.

The imports are inside the functions, so that `--help` answers at once.
"""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from bodycheck.console.options import AS_USUAL, Figures, Jobs, Json, Quiet, Viewed
from bodycheck.errors import FAILED, OK, BadInput

if TYPE_CHECKING:
    from bodycheck.studies.ensemble.findings.queries import Answer

if TYPE_CHECKING:
    from bodycheck.casefile.case import Case
    from bodycheck.studies.ensemble.header import EnsembleHeader


def gather(
    *folders: Path,
    out: Path,
    figures: Figures = (),
    jobs: Jobs = None,
    json: Json = False,
    view: Viewed = AS_USUAL,
    quiet: Quiet = False,
) -> int:
    """Make the tables and the report of an ensemble that several jobs ran, each with `bodycheck ensemble --shard I/N`.

    The folders may be one that all jobs shared, or one of each. They must be of the same ensemble, and have all members
    together; members that are missing are named. Only the worst members are run again, where the engines are installed and
    the members were drawn as the case says. Exit codes are those of `bodycheck ensemble`.

    Parameters
    ----------
    folders
        Folders that `--out` of the jobs named.
    out
        The folder for the tables, which may be one of these.
    """
    from bodycheck.console import tables, terminal
    from bodycheck.console.arguments import processes
    from bodycheck.console.output import say_where
    from bodycheck.studies.ensemble import header, printing
    from bodycheck.studies.ensemble.execution.result_tables import case_of
    from bodycheck.studies.ensemble.execution.result_tables import gather as gather_chunks
    from bodycheck.studies.ensemble.report import publishing, reporting

    tables.check(view, printing.ROWS, printing.DEPENDENCES)
    folder = gather_chunks(folders, out, processes(jobs))
    head = header.read(folder)
    case = case_of(head)
    ensemble = reporting.read(folder, case, head)
    with terminal.progress("worst members", ensemble.worst, quiet) as progress:
        publishing.write(ensemble, folder, case, head, _text_of(case, head), processes(jobs), progress, figures)
    printing.print_made(ensemble, json, view, quiet)
    say_where(folder, quiet)
    return FAILED if ensemble.broken else OK


def _text_of(case: "Case", head: "EnsembleHeader") -> Callable[[int], str] | None:
    """Return a function from the number of a member to its case file; None where members cannot be run again here."""
    from functools import partial

    from bodycheck.running import engines
    from bodycheck.studies.ensemble.drawing import members
    from bodycheck.studies.ensemble.header import in_words

    if case.ensemble is None or engines.describe(list(head["engines"]))[1]:
        return None
    source = members.drawn(case, head["members"])
    return partial(members.text, case, source) if in_words(source) == head["source"] else None


#: Most rows of the table on a terminal, and elsewhere. All are kept until the widths of the columns are known.
TERMINAL_ROWS, TABLE_ROWS = 100, 100_000

#: Most characters of a cell of the table. --csv and --json print all.
CELL_CHARACTERS = 300


def query(
    question: str,
    folder: Path,
    *,
    json: Json = False,
    csv: Annotated[bool, Parameter(help="Print CSV instead of tables.")] = False,
    show: bool = False,
) -> int:
    """Ask a question in SQL about the results of an ensemble. This needs bodycheck[scale].

    The tables are runs, members and truths. DuckDB answers the question from the files of the folder, and neither reads other
    files nor writes any. An example, with the mean and the largest error of each method:

    bodycheck query "SELECT engine, integrator, avg(attitude_error), max(attitude_error) FROM runs GROUP BY ALL" results

    Parameters
    ----------
    question
        One SELECT statement in the SQL of DuckDB.
    folder
        The folder with the results of `bodycheck ensemble`.
    show
        Print the question in SQL with the definitions of its tables, for other programs, and do not answer it.
    """
    from bodycheck.studies.ensemble.findings import queries

    if json and csv:
        raise BadInput("--json and --csv: give one of them")
    if show:
        print(queries.sql(folder, question), end="")
        return OK
    with queries.answer(folder, question) as answer:
        if json:
            _print_json(answer)
        elif csv:
            _print_csv(answer)
        else:
            _print_table(answer)
    return OK


def _print_table(answer: "Answer") -> None:
    from itertools import islice
    from operator import itemgetter

    from bodycheck.console import tables
    from bodycheck.console.output import tell

    def column(index: int, name: str) -> tables.Column[tuple[Any, ...]]:
        return tables.Column(name, name, lambda row: _text(row[index]), itemgetter(index))

    most = TERMINAL_ROWS if sys.stdout.isatty() else TABLE_ROWS
    rows = list(islice(answer.rows, most))
    tables.show([column(index, name) for index, name in enumerate(answer.columns)], rows)
    if next(answer.rows, None) is not None:
        tell(f"these are the first {most} rows; --csv and --json print all")


def _print_csv(answer: "Answer") -> None:
    import csv

    from bodycheck.results.csv_tables import entry

    writer = csv.writer(sys.stdout, lineterminator="\n")
    writer.writerow(map(entry, answer.columns))
    writer.writerows(map(entry, row) for row in answer.rows)


def _print_json(answer: "Answer") -> None:
    """Print an array of objects, one on a line, as they are computed."""
    import json

    before = "["
    for row in answer.rows:
        values = {name: _plain(value) for name, value in zip(answer.columns, row, strict=True)}
        print(before, json.dumps(values, ensure_ascii=False, allow_nan=False), sep="\n", end="")
        before = ","
    print("\n]" if before == "," else "[]")


def _text(value: Any) -> str:
    """Return a value as the text of a cell, shortened to `CELL_CHARACTERS`."""
    text = "" if value is None else f"{value:.6g}" if isinstance(value, float) else str(value)
    return text if len(text) <= CELL_CHARACTERS else f"{text[: CELL_CHARACTERS - 1]}…"


def _plain(value: Any) -> Any:
    """Return a value of DuckDB as one that JSON has. Numbers that are infinite or none become None."""
    from decimal import Decimal
    from math import isfinite

    match value:
        case Decimal():
            return float(value)
        case float():
            return value if isfinite(value) else None
        case None | bool() | int() | str():
            return value
        case dict():
            return {str(name): _plain(one) for name, one in value.items()}
        case list() | tuple():
            return [_plain(one) for one in value]
        case _:
            return str(value)
