"""The commands `bodycheck site` and `bodycheck submit`.

Their imports are inside the functions, so that `--help` answers at once.
"""

import sys
from pathlib import Path

from bodycheck.errors import OK, BadInput


def site(*folders: Path, out: Path) -> int:
    """Make a static site of results.

    It is made from results folders of runs and studies, of several dates, machines and versions, and from the files of
    `bodycheck submit`. What is not as bodycheck writes it is left out, and errors.html says why. The site opens from disk and
    from any web host.

    Exit codes: 0 the site was written, whatever was left out; 2 bad input or usage.

    Parameters
    ----------
    folders
        Results folders, files of `bodycheck submit`, and folders that contain such.
    out
        The folder for the site: a new one, or that of an earlier site, which is renewed.
    """
    from bodycheck.site import build, catalogue
    from bodycheck.site.submissions import gathering

    if not folders:
        raise BadInput("site: give at least one folder of results")
    submissions, left_out = gathering.gathered(folders)
    found = catalogue.catalogued(submissions, left_out)
    made = list(build.files(found))
    build.write(made, out)
    for one in found.left_out:
        print(f"left out: {one.name}: {one.reason}", file=sys.stderr)
    print(f"site: {out / 'index.html'}", file=sys.stderr)
    return OK


def submit(folder: Path, /, *, out: Path) -> int:
    """Check a results folder, and pack it for others.

    The zip file has the tables, the case files, versions and machine, with a digest of each file. Paths, e-mail addresses and
    the names of the machine and its user are removed from its texts. `bodycheck site` reads it.

    Exit codes: 0 the file was written; 2 the folder is not as bodycheck writes it, or bad usage.

    Parameters
    ----------
    folder
        A folder that `--out` of a command wrote.
    out
        The file (.zip) to write.
    """
    from bodycheck.files import writing
    from bodycheck.site.submissions import packing

    if out.suffix != ".zip":
        raise BadInput(f"--out {out}: the name of the file must end in .zip")
    if not folder.is_dir():
        raise BadInput(f"{folder}: there is no such folder")
    packed = packing.packed(folder)
    writing.write_named(out, packed.content)
    for line in packing.told(packed):
        print(line, file=sys.stderr)
    print(f"submission: {out}", file=sys.stderr)
    return OK
