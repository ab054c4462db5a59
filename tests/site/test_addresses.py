"""Every address on every page leads to a file of the site, or to a part of a page that is there, and to no other host."""

import re
from urllib.parse import unquote

import pytest

from bodycheck.site import build
from bodycheck.site.catalogue import Catalogue
from bodycheck.site.render import File
from tests.site import submissions
from tests.site.submissions import CONTACT, FREE, MECHANISM, catalogued, ended, run, submission

#: Where links may lead outside of the site: a reader follows them, the page asks nothing of them.
OUTSIDE = re.compile(r"https?://")


def catalogue() -> Catalogue:
    """Rows of every table, two versions of an engine, and an engine of which there is a reading of a robot alone."""
    before = submission([run(version="3.0"), run(case=CONTACT, version="3.0")], day="2026-01-01")
    rows = {
        "results.csv": [run(attitude_error=1e-9), ended("diverged", case=CONTACT), run(case=MECHANISM, engine="drake")],
        "attribution.csv": [submissions.attribution()],
        "tradeoff.csv": [submissions.tradeoff(step) for step in (0.002, 0.001)],
        "orders.csv": [submissions.order()],
        "releases.csv": [submissions.release("3.0"), submissions.release("4.0.0")],
        "changes.csv": [submissions.change()],
        "contact.csv": [submissions.contact()],
        "parity.csv": [submissions.parity(), submissions.parity(engine="rapier", version="0.36.1")],
        "audit.csv": [submissions.audit()],
        "ensemble.csv": [submissions.ensemble()],
    }
    return catalogued(before, submission(rows, day="2026-02-01"))


@pytest.fixture(scope="module")
def files() -> dict[str, File]:
    return {file.path: file for file in build.files(catalogue())}


def test_every_address_leads_somewhere(files: dict[str, File]) -> None:
    pages = {path: file.content.decode() for path, file in files.items() if path.endswith(".html")}
    parts = {path: set(re.findall(r'\bid="([^"]+)"', text)) for path, text in pages.items()}
    lost = []
    for page, text in pages.items():
        for address in re.findall(r'\b(?:href|src)="([^"]*)"', text):
            if address.startswith("data:") or OUTSIDE.match(address):
                continue
            path, _, part = unquote(address.replace("&amp;", "&")).partition("#")
            there = _joined(page, path) if path else page
            has_state = "=" in part or there == "row.html"
            if there not in files or (part and not has_state and part not in parts[there]):
                lost.append(f"{page}: {address}")
    assert lost == []


def test_pages_ask_nothing_of_other_hosts(files: dict[str, File]) -> None:
    for path, file in files.items():
        if path.endswith(".html"):
            text = file.content.decode()
            assert not re.search(r'\bsrc="(?!data:)[^"]*//', text), path
            assert not re.search(r'<link[^>]*href="[a-z]+://', text), path
            assert "default-src 'none'" in text, path
        if path.endswith(".css"):
            assert b"url(" not in file.content, path
            assert b"@import" not in file.content, path


def test_rows_that_pages_name_exist(files: dict[str, File]) -> None:
    known = catalogue()
    sources = {source.key: source for source in known.submissions}
    named = {
        found
        for path, file in files.items()
        if path.endswith((".html", ".atom"))
        for found in re.findall(r"row\.html#([0-9a-f]+)/([a-z]+\.csv)/(\d+)", file.content.decode())
    }
    assert FREE in {sources[key].tables[table][int(place)].get("case") for key, table, place in named}
    assert all(int(place) < len(sources[key].tables[table]) for key, table, place in named)


def _joined(page: str, address: str) -> str:
    """The path in the site to which an address on a page leads."""
    parts = page.split("/")[:-1]
    for one in address.split("/"):
        if one == "..":
            parts.pop()
        elif one != ".":
            parts.append(one)
    return "/".join(parts)
