"""Whoever reads how to install bodycheck also reads what holds as long as it is on no package index."""

import re
from pathlib import Path

import pytest
import yaml

from tests.support import ROOT

DOCS = ROOT / "docs"

#: The note, which pages include.
NOTE = DOCS / "_includes" / "installing.md"

#: Commands that install bodycheck by its name.
INSTALLS = re.compile(r"pip install\s+'?(bodycheck|pytest-bodycheck)\b")

PAGES = [path for path in sorted(DOCS.rglob("*.md")) if path != NOTE and INSTALLS.search(path.read_text("utf-8"))]


def test_there_are_such_pages() -> None:
    assert DOCS / "start" / "install.md" in PAGES
    assert len(PAGES) > 4


@pytest.mark.parametrize("page", PAGES, ids=lambda path: path.stem)
def test_a_page_that_installs_bodycheck_includes_the_note(page: Path) -> None:
    (included,) = re.findall(r"```\{include\} (\S+)\n```", page.read_text("utf-8"))
    assert (page.parent / included).resolve() == NOTE


def test_workflows_to_copy_say_it_at_their_top() -> None:
    for path in (DOCS / "ci").glob("*.yml"):
        text = path.read_text("utf-8")
        assert "As long as bodycheck is on no package index" in text.partition("jobs:")[0]
        assert yaml.safe_load(text)["env"]["BODYCHECK"] == "bodycheck"
