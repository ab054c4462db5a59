"""The command `bodycheck diff`.

It imports what it needs when it runs, so that `--help` answers at once.
"""

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from bodycheck.console.options import Json
from bodycheck.errors import FAILED, OK

if TYPE_CHECKING:
    pass


def diff(base: Path, now: Path, /, *, json: Json = False) -> int:
    """Say what has changed between two baselines, beyond what rounding and the truth's own error explain; else say nothing.

    Exit codes: 0 nothing got worse; 1 a figure or a status got worse, or a run is gone; 2 no baselines of the same cases.
    What got better or is new is told, and what steps cost where both were made on one machine: neither fails.

    Parameters
    ----------
    base
        What `bodycheck run --save` wrote before.
    now
        What it wrote later, elsewhere, or with other versions.
    """
    from bodycheck.console import terminal
    from bodycheck.judging import baseline
    from bodycheck.reports.runs import github

    found = baseline.diff(baseline.read(base), baseline.read(now))
    if json:
        terminal.print_json(baseline.as_json(found))
    elif found.changes or found.paces:
        terminal.print_difference(found)
    if found.changes and github.is_running(os.environ):
        print(github.annotation("error" if found.worse else "notice", found.text, "bodycheck diff"), file=sys.stderr)
    return FAILED if found.worse else OK
