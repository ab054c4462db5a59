"""Reports as a person sees them: in a real browser, from disk."""

from pathlib import Path
from typing import Any

from browser import visiting


def test_a_report(browser: Any, tmp_path: Path) -> None:
    path = tmp_path / "a.html"
    path.write_text("<!DOCTYPE html><link rel=icon href='data:,'><h1>hello</h1>")
    with visiting(browser, path) as visit:
        assert visit.page.inner_text("h1") == "hello"
