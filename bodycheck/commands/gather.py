"""The command `bodycheck gather`.

Its imports are inside the function, so that `--help` answers at once.
"""

from pathlib import Path

from bodycheck.console.options import Jobs, Quiet
from bodycheck.errors import OK


def gather(*folders: Path, out: Path, jobs: Jobs = None, quiet: Quiet = False) -> int:
    """Make the tables of an ensemble that several jobs ran, each with `bodycheck ensemble --shard I/N`.

    The folders may be one that all jobs shared, or one of each. They must be of the same ensemble, and have all members
    together; members that are missing are named. Nothing is simulated again.

    Parameters
    ----------
    folders
        Folders that `--out` of the jobs named.
    out
        The folder for the tables, which may be one of these.
    """
    import sys

    from bodycheck.console.arguments import processes
    from bodycheck.studies.ensemble import gathering

    made = gathering.gather(folders, out, processes(jobs))
    if not quiet:
        print(f"gathered: {made}", file=sys.stderr)
    return OK
