"""The feed of changes (Atom, RFC 4287): an entry for each engine and submission in which something changed beyond rounding.

The feed does not contain the address of the site: identifiers are made from contents, and links are relative references, which
readers resolve against the address of the feed.
"""

from collections.abc import Iterator, Sequence
from uuid import UUID, uuid5
from xml.etree import ElementTree

from bodycheck.reports.quantities import count
from bodycheck.site import changes, links, telling
from bodycheck.site.catalogue import Catalogue, Entry, Scene
from bodycheck.site.changes import Change
from bodycheck.site.render import File
from bodycheck.site.submissions.submission import Submission
from bodycheck.site.telling import Sentence

ATOM, XHTML = "http://www.w3.org/2005/Atom", "http://www.w3.org/1999/xhtml"

#: The name space for the identifiers of the feed and its entries: a random number that must never change.
IDENTIFIERS = UUID("6d1f5bd1-66c5-4c1b-9f0c-3f2b8c0a7e55")

#: The date of a feed without submissions; a feed must have a date.
NEVER = "1970-01-01T00:00:00+00:00"

TITLE = "bodycheck: changes of physics engines beyond rounding"


def pages(catalogue: Catalogue) -> Iterator[File]:
    """Yield the feed."""
    feed = ElementTree.Element("feed", xmlns=ATOM)
    _add(feed, "id", uuid5(IDENTIFIERS, "feed").urn)
    _add(feed, "title", TITLE)
    _add(feed, "updated", catalogue.submissions[-1].header.started if catalogue.submissions else NEVER)
    _add(_add(feed, "author"), "name", "bodycheck")
    _add(feed, "link", rel="self", type="application/atom+xml", href=links.FEED)
    _add(feed, "link", rel="alternate", type="text/html", href=links.INDEX)
    for source in reversed(catalogue.submissions):
        for engine, version in releases_of(source):
            _entry(feed, catalogue, source, engine, version)
    yield File(links.FEED, ElementTree.tostring(feed, "utf-8", xml_declaration=True) + b"\n")


def releases_of(source: Submission) -> Sequence[tuple[str, str]]:
    """Return the engines and versions for which a submission has runs or measured changes, in alphabetical order."""
    runs = {(entry.engine, entry.version) for entry in _entries(source, "results.csv")}
    studied = {(entry.engine, entry.row["to_version"]) for entry in _entries(source, "changes.csv")}
    return sorted(runs | studied)


def _entry(feed: ElementTree.Element, catalogue: Catalogue, source: Submission, engine: str, version: str) -> None:
    """Add an entry about a release in a submission to the feed, if anything changed beyond rounding."""
    found, compared = _changes(catalogue, source, engine, version)
    studied = [
        entry for entry in _entries(source, "changes.csv") if (entry.engine, entry.row["to_version"]) == (engine, version)
    ]
    orders = list(telling.orders(catalogue, studied))
    if not (found or orders):
        return
    entry = _add(feed, "entry")
    _add(entry, "id", uuid5(IDENTIFIERS, f"{source.key} {engine} {version}").urn)
    _add(entry, "title", f"{engine} {version}: {_title(found, orders)}")
    _add(entry, "updated", source.header.started)
    _add(entry, "link", rel="alternate", type="text/html", href=links.release(engine, version))
    content = _add(_add(entry, "content", type="xhtml"), "div", xmlns=XHTML)
    told = list(telling.tally(found, compared, "before")) if found else []
    for sentence in (*orders, *told, _origin(source)):
        _paragraph(content, sentence)


def _changes(catalogue: Catalogue, source: Submission, engine: str, version: str) -> tuple[list[tuple[Scene, Change]], int]:
    """Return the changes of runs of a submission from earlier runs, and the number of runs that have an earlier run."""
    found, compared = [], 0
    for entry in _entries(source, "results.csv"):
        if (entry.engine, entry.version) != (engine, version):
            continue
        scene = catalogue.scenes[entry.row["case"]]
        earlier = changes.before(catalogue.runs[engine, scene.name], entry)
        compared += earlier is not None
        change = changes.change(catalogue, scene, entry, earlier) if earlier is not None else None
        if change is not None:
            found.append((scene, change))
    return found, compared


def _title(found: Sequence[tuple[Scene, Change]], orders: Sequence[Sentence]) -> str:
    """Return the title of an entry, which counts its changes."""
    numbers = {"smaller error": False, "larger error": True}
    told = [
        count(amount, word)
        for word, worse in numbers.items()
        if (amount := sum(one.quantity != changes.STATUS and one.worse is worse for _, one in found))
    ]
    if ended := sum(one.quantity == changes.STATUS for _, one in found):
        told.append(f"{count(ended, 'run')} with another end")
    if orders:
        told.append("another order of convergence")
    return ", ".join(told)


def _origin(source: Submission) -> Sentence:
    """Return the sentence about the submission from which an entry comes."""
    return (
        telling.Piece("Submission "),
        telling.Piece(source.key, f"{links.data(source)}.json"),
        telling.Piece(f" of {source.date}: {source.command}, on {source.machine}."),
    )


def _paragraph(parent: ElementTree.Element, sentence: Sentence) -> None:
    """Add a paragraph of XHTML with a sentence."""
    paragraph = _add(parent, "p")
    last: ElementTree.Element | None = None
    for piece in sentence:
        if piece.address:
            last = _add(paragraph, "a", href=piece.address)
            last.text, last.tail = piece.text, ""
        elif last is None:
            paragraph.text = (paragraph.text or "") + piece.text
        else:
            last.tail = (last.tail or "") + piece.text


def _add(parent: ElementTree.Element, name: str, text: str | None = None, **attributes: str) -> ElementTree.Element:
    """Add an element to its parent and return it."""
    made = ElementTree.SubElement(parent, name, attributes)
    made.text = text
    return made


def _entries(source: Submission, table: str) -> Iterator[Entry]:
    return (Entry(source, table, place) for place in range(len(source.tables.get(table, ()))))
