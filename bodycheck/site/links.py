"""The addresses of pages inside the site, relative to its root. Every page names others through these functions alone."""

import re
from hashlib import sha256
from urllib.parse import quote

from bodycheck.site.catalogue import Entry
from bodycheck.site.submissions.submission import Submission

INDEX, COMPARE, ERRORS, ROW, FEED = "index.html", "compare.html", "errors.html", "row.html", "feed.atom"
SCENES, ROBOTS = "scenes/index.html", "robots/index.html"

#: The folder of data.
DATA = "data/"

#: The pages that the head of every page leads to, with their titles.
MAIN = (
    (INDEX, "Results"),
    (SCENES, "Scenes"),
    (ROBOTS, "Robots"),
    (COMPARE, "Compare"),
    (ERRORS, "Left out"),
)

#: Most characters of the name of a page.
LONGEST = 80

#: Names that no file can have on Windows, whatever follows a dot.
DEVICE = re.compile(r"(?:con|prn|aux|nul|com[0-9]|lpt[0-9])(?:$|\.)")


def engine(name: str) -> str:
    """Return the address of the page of an engine."""
    return f"engines/{slug(name)}.html"


def scene(name: str) -> str:
    """Return the address of the page of a case."""
    return f"scenes/{slug(name)}.html"


def motion(name: str) -> str:
    """Return the address of the motions of a case, as a script."""
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


def data(source: Submission) -> str:
    """Return the address of the data of a submission, without its end: .json for programs, .js for pages."""
    return f"{DATA}{source.key}"


def changes(name: str) -> str:
    """Return the address of what differs between the results of an engine, without its end; see `data`."""
    return f"{DATA}changes/{slug(name)}"


def compare(name: str, before: Entry, after: Entry) -> str:
    """Return the address of the comparison of the results of an engine that two rows are in."""
    sides = (f"{side}={one.source.key}:{quote(one.version)}:{one.table}" for side, one in (("left", before), ("right", after)))
    return f"{COMPARE}#engine={quote(name)}&{'&'.join(sides)}"


def row(entry: Entry) -> str:
    """Return the address of the page of a raw row, which has its case file and its command."""
    return f"{ROW}#{entry.source.key}/{quote(entry.table)}/{entry.place}"


def slug(name: str) -> str:
    """Return the name of a file for a name. Different names have different files, also where capitals do not count."""
    plain = re.sub(r"[^a-z0-9._-]+", "-", name.lower()).strip("-.")
    if plain == name and len(plain) <= LONGEST and not DEVICE.match(plain):
        return plain
    return f"{'_' if DEVICE.match(plain) else ''}{plain[:LONGEST]}-{sha256(name.encode('utf-8', 'replace')).hexdigest()[:8]}"
