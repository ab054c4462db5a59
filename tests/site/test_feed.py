"""The feed follows RFC 4287, has an entry only for what changed beyond rounding, and is the same for the same submissions."""

from datetime import datetime
from xml.etree import ElementTree

from bodycheck.site import build
from bodycheck.site.catalogue import Catalogue
from bodycheck.site.pages import feed
from tests.site import submissions as make
from tests.site import upgrades as example
from tests.support.wording import facts

ATOM, XHTML = "{http://www.w3.org/2005/Atom}", "{http://www.w3.org/1999/xhtml}"


def read(catalogue: Catalogue) -> ElementTree.Element:
    """The feed of a catalogue."""
    (made,) = feed.pages(catalogue)
    return ElementTree.fromstring(made.content)


def text(element: ElementTree.Element, name: str) -> str:
    """The text of the only child with a name."""
    (found,) = element.findall(f"{ATOM}{name}")
    return found.text or ""


def check(root: ElementTree.Element) -> None:
    """What RFC 4287 demands of feeds (4.1.1), entries (4.1.2), identifiers (4.2.6), dates (3.3) and links (4.2.7)."""
    assert root.tag == f"{ATOM}feed"
    entries = root.findall(f"{ATOM}entry")
    for one in (root, *entries):
        assert text(one, "title")
        assert text(one, "id").startswith("urn:uuid:")
        assert datetime.fromisoformat(text(one, "updated")).tzinfo is not None
        alternates = [link for link in one.findall(f"{ATOM}link") if link.attrib["rel"] == "alternate"]
        assert len(alternates) == 1, "no two with the same type and language"
    identifiers = [text(one, "id") for one in (root, *entries)]
    assert len(set(identifiers)) == len(identifiers)
    (author,) = root.findall(f"{ATOM}author")
    assert text(author, "name")
    assert [link.attrib["rel"] for link in root.findall(f"{ATOM}link")] == ["self", "alternate"]
    for entry in entries:
        (content,) = entry.findall(f"{ATOM}content")
        assert content.attrib["type"] == "xhtml"
        (inside,) = content
        assert inside.tag == f"{XHTML}div"


def test_an_upgrade_and_a_study_have_an_entry_each() -> None:
    root = read(example.catalogue())
    check(root)
    entries = root.findall(f"{ATOM}entry")
    names = ("mujoco", "another order", "smaller error", "larger error", "another end")
    assert [facts(text(one, "title"), *names) for one in entries] == [
        ["mujoco", "4.0.0", "another order"],
        ["mujoco", "4.0.0", "1", "smaller error", "1", "larger error", "1", "another end"],
    ]
    assert [text(one, "updated") for one in entries] == ["2026-01-03T12:00:00+00:00", "2026-01-02T12:00:00+00:00"]
    assert text(root, "updated") == "2026-01-03T12:00:00+00:00"
    names = ("From", "RK4", "fourth", "attitude")
    told = facts(" ".join(entries[0].itertext()), *names)
    assert told[told.index("From") :][:5] == ["From", "4.0.0", "RK4", "fourth", "attitude"]
    assert "5e-9 rad, 2e4 times smaller." in "".join(entries[1].itertext())


def test_links_are_relative_and_lead_to_files_of_the_site() -> None:
    catalogue = example.catalogue()
    root = read(catalogue)
    made = {one.path for one in build.files(catalogue)}
    addresses = [one.attrib["href"] for one in root.iter() if "href" in one.attrib]
    assert len(addresses) > 8
    for address in addresses:
        assert not address.startswith(("http", "/"))
        assert address.partition("#")[0] in made or address.startswith(("scenes/", "row.html", "data/"))


def test_rounding_alone_makes_no_entry() -> None:
    runs = [make.run(), make.run(integrator="RK4", attitude_error=1e-11)]
    moved = [make.run(attitude_error=2.1251), make.run(integrator="RK4", attitude_error=1.2e-11)]
    root = read(make.catalogued(make.submission(runs), make.submission(moved, day="2026-01-02")))
    check(root)
    assert not root.findall(f"{ATOM}entry")


def test_a_feed_without_submissions_is_valid() -> None:
    check(read(make.catalogued()))


def test_identifiers_stay_when_submissions_are_added() -> None:
    before, after = example.catalogue(), example.catalogue(make.submission([make.run(version="4.1.0")], day="2026-02-01"))
    first, second = ({text(one, "id") for one in read(each).iter(f"{ATOM}entry")} for each in (before, after))
    assert first <= second
    assert feed.TITLE in text(read(before), "title")


def test_the_same_submissions_give_the_same_feed() -> None:
    first, second = (next(feed.pages(example.catalogue())).content for _ in range(2))
    assert first == second
