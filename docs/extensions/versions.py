"""The choice among published versions, which works without a server.

Every version is a folder with a file `versions.js`, a script that names all versions and the pages that each of them has. A
build names itself alone. After the folders of all versions have been put beside each other,

    python -m docs.extensions.versions FOLDER

writes these scripts again, and an `index.html` that leads to the newest release.
"""

import json
import re
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from packaging.version import InvalidVersion, Version
from sphinx.application import Sphinx

FILE_NAME = "versions.js"

#: What a version is called by its folder; others are refused, as names become parts of addresses.
FOLDER = re.compile(r"[A-Za-z0-9][A-Za-z0-9.+-]*")

#: The page beside the folders of versions. Without scripts its link is left.
FRONT = """\
<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta http-equiv="refresh" content="0; url={folder}/index.html">
<title>bodycheck</title>
<p><a href="{folder}/index.html">The documentation of bodycheck {folder}</a></p>
</html>
"""


def setup(app: Sphinx) -> dict[str, Any]:
    """Write the script of a build that is alone."""
    app.connect("build-finished", _write)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def script(versions: Mapping[str, Sequence[str]]) -> str:
    """Return the script for the pages of each version by the name of its folder, in the order of the choice."""
    listed = [{"folder": folder, "pages": list(pages)} for folder, pages in versions.items()]
    return f"window.publishedVersions = {json.dumps(listed, indent=1)};\n"


def join(folder: Path) -> list[str]:
    """Let all versions in a folder know each other, and return their names, the newest first.

    Raises `ValueError` if there is no version, or a folder has a name that no version has.
    """
    found = sorted((path.parent for path in folder.glob(f"*/{FILE_NAME}")), key=lambda path: _age(path.name), reverse=True)
    if not found:
        raise ValueError(f"{folder}: there is no version of the documentation in it")
    if strange := [path.name for path in found if not FOLDER.fullmatch(path.name)]:
        raise ValueError(f"{folder}: {strange[0]!r} is no name of a version")
    text = script({path.name: pages(path) for path in found})
    for path in found:
        (path / FILE_NAME).write_text(text, "utf-8")
    names = [path.name for path in found]
    (folder / "index.html").write_text(FRONT.format(folder=names[0]), "utf-8")
    return names


def pages(version: Path) -> list[str]:
    """Return the names of the pages in the folder of a version."""
    found = (path.relative_to(version) for path in version.rglob("*.html"))
    return sorted(path.with_suffix("").as_posix() for path in found if not path.parts[0].startswith("_"))


def _age(name: str) -> tuple[bool, Version]:
    """Return the key by which versions are ordered: names without a number, such as `main`, and then releases by number."""
    try:
        return True, Version(name)
    except InvalidVersion:
        return False, Version("0")


def _write(app: Sphinx, failure: Exception | None) -> None:
    if failure is None and app.builder.name == "html":
        (Path(app.outdir) / FILE_NAME).write_text(script({app.config.release: pages(Path(app.outdir))}), "utf-8")


if __name__ == "__main__":
    print("\n".join(join(Path(sys.argv[1]))))
