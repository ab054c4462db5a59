"""The command `bodycheck diff`.

Its imports are inside the function, so that `--help` answers at once.
"""

import os
from pathlib import Path

from bodycheck.console.options import AS_USUAL, Json, Viewed
from bodycheck.errors import FAILED, OK
from bodycheck.runner_log import print_command


def diff(base: Path, now: Path, /, *, fail_on: tuple[str, ...] = (), json: Json = False, view: Viewed = AS_USUAL) -> int:
    """Compare two baselines, and print the changes that exceed the effect of rounding and the error of the truth.

    The worst change comes first; the last line summarises the changes, or says that there are none. A figure whose definition
    has changed between the versions of bodycheck that made the baselines is named and not compared. The command also prints
    improvements and new runs, which do not make it fail.

    Exit codes: 0 nothing got worse; 1 an error or a status got worse, or a run is missing; 2 the files are not baselines of
    the same cases, or a figure of --fail-on could not be compared.

    Parameters
    ----------
    base
        The older baseline: a file that `bodycheck run --save` wrote.
    now
        The newer baseline, made later, on another machine, or with other versions.
    fail_on
        A figure and by how much its error may grow, for example attitude_error:10%. May be given several times. Other figures
        then do not make the command fail; a worse status and a missing run still do. Default: any growth of any figure fails.
    """
    from bodycheck.console import tables, terminal
    from bodycheck.judging.baselines import baseline, tolerances
    from bodycheck.reports.runs import github

    allowed = tolerances.parse(fail_on)
    tables.check(view, terminal.DIFFERENCES)
    found = baseline.diff(baseline.read(base), baseline.read(now))
    broken = tolerances.failing(found, allowed)
    summary = [found.text, *((tolerances.text(broken, allowed),) if allowed else ())]
    if json:
        terminal.print_json(baseline.as_json(found) | {"failed": len(broken)})
    else:
        terminal.print_difference(found, summary, view)
    if found.changes and github.is_running(os.environ):
        print_command(github.annotation("error" if broken else "notice", "; ".join(summary), "bodycheck diff"))
    return FAILED if broken else OK
