"""The command `bodycheck diff`.

Its imports are inside the function, so that `--help` answers at once.
"""

import os
from pathlib import Path

from bodycheck.console.options import AS_USUAL, Json, Viewed
from bodycheck.errors import FAILED, OK
from bodycheck.runner_log import print_command


def diff(base: Path, now: Path, /, *, json: Json = False, view: Viewed = AS_USUAL) -> int:
    """Compare two baselines, and print the changes that exceed the effect of rounding and the error of the truth.

    The command prints nothing if there is no such change. A figure whose definition has changed between the versions of
    bodycheck that made the baselines is named and not compared. The command also prints improvements and new runs, and, if
    both baselines were made on the same machine, changes of the time per step; these do not make it fail.

    Exit codes: 0 nothing got worse; 1 an error or a status got worse, or a run is missing; 2 the files are not baselines of
    the same cases.

    Parameters
    ----------
    base
        The older baseline: a file that `bodycheck run --save` wrote.
    now
        The newer baseline, made later, on another machine, or with other versions.
    """
    from bodycheck.console import tables, terminal
    from bodycheck.judging import baseline
    from bodycheck.reports.runs import github

    tables.check(view, terminal.DIFFERENCES)
    found = baseline.diff(baseline.read(base), baseline.read(now))
    if json:
        terminal.print_json(baseline.as_json(found))
    elif found.changes or found.paces or found.redefined:
        terminal.print_difference(found, view)
    if found.changes and github.is_running(os.environ):
        print_command(github.annotation("error" if found.worse else "notice", found.text, "bodycheck diff"))
    return FAILED if found.worse else OK
