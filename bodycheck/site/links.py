"""The addresses of pages inside the site, relative to its root. All links between pages are made by these functions."""

import re
from hashlib import sha256
from urllib.parse import quote

from bodycheck.site.catalogue import Catalogue, Entry
from bodycheck.site.submissions.submission import Submission

INDEX, COMPARE, ERRORS, ROW, FEED = "index.html", "compare.html", "errors.html", "row.html", "feed.atom"
SCENES, ROBOTS, CONTACT = "scenes/index.html", "robots/index.html", "contact.html"

#: The folder of data.
DATA = "data/"

#: The most characters of the file name of a page, without its extension.
LONGEST = 80

#: Names that no file can have on Windows, with any extension.
DEVICE = re.compile(r"(?:con|prn|aux|nul|com[0-9]|lpt[0-9])(?:$|\.)")


def main(catalogue: Catalogue) -> tuple[tuple[str, str], ...]:
    """Return the addresses of the pages to which the head of every page links, with their titles.

    The page of contact is among them if there is a contact sheet, and the page of what is left out if anything is.
    """
    contact = ((CONTACT, "Contact"),) if any(catalogue.entries("contact.csv")) else ()
    left_out = ((ERRORS, "Left out"),) if catalogue.left_out else ()
    return (INDEX, "Results"), (SCENES, "Scenes"), *contact, (ROBOTS, "Robots"), (COMPARE, "Compare"), *left_out


def engine(name: str) -> str:
    """Return the address of the page of an engine."""
    return f"engines/{slug(name)}.html"


def scene(name: str) -> str:
    """Return the address of the page of a case."""
    return f"scenes/{slug(name)}.html"


def motion(name: str) -> str:
    """Return the address of the script with the motions of a case."""
    return f"data/motion-{slug(name)}.js"


def robot(model: str) -> str:
    """Return the address of the page of a robot model."""
    return f"robots/{slug(model)}.html"


def release(name: str, version: str) -> str:
    """Return the address of the page of a release of an engine."""
    return f"releases/{slug(f'{name}-{version}')}.html"


def badge(name: str) -> str:
    """Return the address of the badge of an engine."""
    return f"badges/{slug(name)}.svg"


def endpoint(name: str, version: str | None = None) -> str:
    """Return the address of the data of the badge of an engine: of its newest release with runs, or of a release."""
    return f"badges/{slug(name if version is None else f'{name}-{version}')}.json"


def data(source: Submission) -> str:
    """Return the address of the data of a submission, without the extension: .json for programs, .js for pages."""
    return f"{DATA}{source.key}"


def changes(name: str) -> str:
    """Return the address of the differences between results of an engine, without the extension; see `data`."""
    return f"{DATA}changes/{slug(name)}"


def compare(name: str, before: Entry, after: Entry) -> str:
    """Return the address of the page that compares two results of an engine: the results with the rows `before` and `after`."""
    sides = (f"{side}={one.source.key}:{quote(one.version)}:{one.table}" for side, one in (("left", before), ("right", after)))
    return f"{COMPARE}#engine={quote(name)}&{'&'.join(sides)}"


def row(entry: Entry) -> str:
    """Return the address of the page of a raw row; the page also shows the case file and the command of the row."""
    return f"{ROW}#{entry.source.key}/{quote(entry.table)}/{entry.place}"


def slug(name: str) -> str:
    """Return a file name, without extension, for a name: different names have different file names, even if case is ignored."""
    plain = re.sub(r"[^a-z0-9._-]+", "-", name.lower()).strip("-.")
    if plain == name and len(plain) <= LONGEST and not DEVICE.match(plain):
        return plain
    return f"{'_' if DEVICE.match(plain) else ''}{plain[:LONGEST]}-{sha256(name.encode('utf-8', 'replace')).hexdigest()[:8]}"
