"""Pages as tests of reports read them, and what every page must keep."""

import re
import zlib
from base64 import b64decode
from collections.abc import Iterator
from html.parser import HTMLParser
from itertools import pairwise

HOSTILE = "<script>alert(1)</script> \"quoted\" 'single' \u202eשלום\u202c | `code` [link](x) & <b>"

#: As hostile as the name of an integrator can be: it begins with a letter and can be printed.
HOSTILE_NAME = "x" + "".join(letter for letter in HOSTILE if letter.isprintable())

NUMBER = re.compile(r"-?[\d.]+(e-?\d+)?")


class Page(HTMLParser):
    """What a browser would see: attributes, texts outside scripts and styles, and table cells with their numbers as shown."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.attributes: list[tuple[str, str, str]] = []
        self.tags: list[str] = []
        self.text = ""
        self.rows: list[list[str]] = []
        self.values: list[list[float]] = []
        self.foreign = ""
        self.measured = False
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.attributes += [(tag, name, value or "") for name, value in attrs]
        if tag in ("script", "style"):
            self.foreign = tag
        if tag == "tr":
            self.rows.append([])
            self.values.append([])
        if tag in ("td", "th") and self.rows:
            self.rows[-1].append("")
        if tag == "td":
            self.measured = "class" not in dict(attrs)  # a bound is shown calmly, and words have a class of their own

    def handle_endtag(self, tag: str) -> None:
        if tag == "td" and self.measured and NUMBER.fullmatch(self.rows[-1][-1]):
            self.values[-1].append(float(self.rows[-1][-1]))
        if tag == self.foreign:
            self.foreign = ""

    def handle_data(self, data: str) -> None:
        if self.foreign:
            return
        self.text += data
        if self.rows and self.rows[-1]:
            self.rows[-1][-1] += data


def inflated(page: str, name: str) -> str:
    """The text that a script element of a page has compressed."""
    stored = page.partition(f'id="{name}">')[2].partition("</script>")[0]
    return zlib.decompress(b64decode(stored), -zlib.MAX_WBITS).decode()


def check(page: str) -> None:
    """It loads nothing, its links lead somewhere, and its headings, tables and figures say what they are."""
    seen = Page(page)
    loading = ("src", "href", "srcset", "action", "data", "poster", "background")
    for tag, name, value in seen.attributes:
        assert name not in loading or value.startswith(("#", "data:")), (tag, name, value)
        assert not name.startswith("on"), (tag, name)
    style = page.partition("<style>")[2].partition("</style>")[0]
    assert "url(" not in style
    assert "@import" not in style
    policy = next(value for tag, _, value in seen.attributes if tag == "meta" and "default-src" in value)
    assert "default-src 'none'" in policy
    assert "http" not in policy

    ids = [value for _, name, value in seen.attributes if name == "id"]
    assert len(ids) == len(set(ids))
    assert {value[1:] for _, name, value in seen.attributes if name == "href" and value.startswith("#")} <= set(ids)
    assert {value for _, name, value in seen.attributes if name == "aria-labelledby"} <= set(ids)

    levels = [int(tag[1]) for tag in seen.tags if tag in ("h1", "h2", "h3", "h4")]
    assert levels[0] == 1
    assert levels.count(1) == 1
    assert all(after <= before + 1 for before, after in pairwise(levels))
    tables = [dict(attrs) for attrs in attributes_of(page, "table")]
    assert len(tables) == seen.tags.count("caption") + sum("aria-labelledby" in attrs for attrs in tables)
    assert all(("scope" in dict(attrs)) for attrs in attributes_of(page, "th"))
    assert all(attrs.get("aria-label") for attrs in map(dict, attributes_of(page, "figure")))


def attributes_of(page: str, wanted: str) -> list[list[tuple[str, str | None]]]:
    found: list[list[tuple[str, str | None]]] = []

    class Parser(HTMLParser):
        def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
            if tag == wanted:
                found.append(attrs)

    Parser().feed(page)
    return found


def markdown_tables(text: str) -> Iterator[list[str]]:
    """The lines of each."""
    for block in text.split("\n\n"):
        if block.startswith("|"):
            yield block.splitlines()
