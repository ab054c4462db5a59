"""Guides and explanations: their commands run and print what the pages show, and their tables are those of the source code."""

import os
import re
import sys
from pathlib import Path

import pytest

from bodycheck.reference.schemes.catalogue import CATALOGUE
from tests.support import ROOT
from tests.support.processes import calls_here
from tests.support.walkthrough import Command, failures, follow_afresh, follow_here, steps

PAGES = sorted([*(ROOT / "docs" / "howto").glob("*.md"), *(ROOT / "docs" / "explanation").glob("*.md")])


@pytest.mark.slow
@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_guide_prints_what_it_shows(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("BODYCHECK_CACHE", str(tmp_path / "cache"))
    (tmp_path / "bodycheck").symlink_to(ROOT)
    if any(isinstance(step, Command) and step.downloads for step in steps(page)):
        path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
        done = follow_afresh(steps(page), tmp_path / "guide", os.environ | {"PATH": path, "PYTHONPATH": str(ROOT)})
    else:
        (tmp_path / "guide").mkdir()
        with calls_here():
            done = follow_here(page, tmp_path / "guide")
    assert not failures(done), "\n\n".join(failures(done))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_guide_has_commands_that_show_what_they_print(page: Path) -> None:
    commands = [step for step in steps(page) if isinstance(step, Command)]
    assert commands
    assert any(command.shown for command in commands)


def test_orders_of_schemes_are_those_of_the_catalogue() -> None:
    text = (ROOT / "docs" / "explanation" / "schemes.md").read_text("utf-8")
    rows = re.findall(r"^\| ([\w -]+) \| (\d) \|", text, re.MULTILINE)
    assert len(rows) > 10
    assert [(name, CATALOGUE[name].order) for name, _ in rows] == [(name, int(order)) for name, order in rows]
    assert f"has {len(CATALOGUE)} combinations" in text
