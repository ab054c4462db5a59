"""The whole site: making all its files from a catalogue, and writing them into a folder."""

import json
from collections.abc import Iterator, Sequence
from pathlib import Path

from bodycheck.errors import BadInput
from bodycheck.files import reading, writing
from bodycheck.reports.html import shared_style
from bodycheck.site.catalogue import Catalogue
from bodycheck.site.pages import badges, compare, contact, data, engines, feed, index, releases, robots, scenes
from bodycheck.site.render import File, asset

#: The file that lists the files that bodycheck has written into the folder of a site.
LIST = "site.json"

#: The most bytes of the file `LIST`.
MOST_BYTES = 1 << 24

#: Styles and scripts.
ASSETS = ("site.css", "site.js", "index.js", "compare.js", "row.js", "sorting.js", "scene.js", "scenes.js")

#: The modules that make pages from a catalogue.
PAGES = (index, scenes, contact, robots, compare, data, engines, releases, feed, badges)


def files(catalogue: Catalogue) -> Iterator[File]:
    """Yield the files of the site."""
    yield File("assets/shared.css", shared_style().encode())
    for name in ASSETS:
        yield asset(name)
    for module in PAGES:
        yield from module.pages(catalogue)


def write(made: Sequence[File], folder: Path) -> None:
    """Write files into a folder, and remove the files of an earlier site that are not among them.

    Raises
    ------
    BadInput
        The folder contains files but is not the folder of a site, or it cannot be written.
    """
    there = reading.names_in(folder)
    before: set[str] = set()
    if there:
        if LIST not in there:
            raise BadInput(f"--out {folder}: is not empty, and not the folder of a site; give a new folder")
        reading.refuse_links(folder)
        before = _listed(folder / LIST)
    for one in made:
        path = folder / one.path
        writing.make_folder(path.parent)
        writing.write(path, one.content)
    paths = {one.path for one in made}
    for gone in before - paths:
        (folder / gone).unlink(missing_ok=True)
    writing.write(folder / LIST, (json.dumps(sorted(paths), indent=1) + "\n").encode())


def _listed(path: Path) -> set[str]:
    """Return the paths in the list of an earlier site, without paths that lead out of its folder."""
    try:
        listed = json.loads(reading.content(path, MOST_BYTES))
        if not isinstance(listed, list) or not all(isinstance(one, str) for one in listed):
            raise ValueError("is no list of paths")
    except (ValueError, RecursionError) as error:
        raise BadInput(f"{path}: is not as bodycheck writes it") from error
    inside = [one for one in listed if not Path(one).is_absolute() and ".." not in Path(one).parts]
    return set(inside)
