"""The tutorial is followed: every command of it runs, in order, and prints what the page shows."""

from pathlib import Path

import pytest

from tests.support import ROOT
from tests.support.processes import calls_here
from tests.support.walkthrough import failures, follow_here

PAGE = ROOT / "docs" / "start" / "tutorial.md"


def test_the_tutorial_prints_what_it_shows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """All but what needs a network, with bodycheck as it is here. Its engines are those of a new user."""
    monkeypatch.setenv("BODYCHECK_CACHE", str(tmp_path / "cache"))
    (tmp_path / "bodycheck").symlink_to(ROOT)
    (tmp_path / "tutorial").mkdir()
    with calls_here():
        done = follow_here(PAGE, tmp_path / "tutorial")
    assert len(done) > 20
    assert not failures(done), "\n\n".join(failures(done))
