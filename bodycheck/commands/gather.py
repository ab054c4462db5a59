"""The command `bodycheck gather`.

Its imports are inside the functions, so that `--help` answers at once.
"""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from bodycheck.console.options import AS_USUAL, Figures, Jobs, Json, Quiet, Viewed
from bodycheck.errors import FAILED, OK

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
    made = reporting.read(folder, case, head)
    with terminal.progress("worst members", made.worst, quiet) as progress:
        publishing.write(made, folder, case, head, _text_of(case, head), processes(jobs), progress, figures)
    printing.print_made(made, json, view, quiet)
    say_where(folder, quiet)
    return FAILED if made.broken else OK


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
