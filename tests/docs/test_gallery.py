"""The notebooks of the gallery: every cell runs, and the last one of each holds its text against its numbers."""

import ast
import contextlib
import io
import re
import struct
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

from bodycheck.interface.plots import SIZE_IN_PNG
from docs.gallery.showing import terminal
from tests.support import ROOT
from tests.support.processes import calls_here

GALLERY = ROOT / "docs" / "gallery"

#: Those that run in this process. The others start commands, each of which imports the engines anew.
HERE = ("flip", "sliding-brick")
SLOW = ("trade", "robot-parity", "ensemble", "upgrade")

CELL = re.compile(r"^```\{code-cell\} python\n(?:---\n.*?^---\n)?(.*?)^```$", re.DOTALL | re.MULTILINE)


@pytest.fixture
def _gallery(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """The working folder of the notebooks, as Sphinx and Jupyter have it."""
    monkeypatch.chdir(GALLERY)
    monkeypatch.syspath_prepend(str(GALLERY))
    with calls_here():
        yield
    sys.modules.pop("showing", None)


def cells(name: str) -> list[str]:
    return CELL.findall((GALLERY / f"{name}.md").read_text("utf-8"))


def shown(name: str) -> list[Any]:
    """Run a notebook, and return what its cells show."""
    names: dict[str, Any] = {}
    values = []
    for source in cells(name):
        *statements, last = ast.parse(source).body
        if not isinstance(last, ast.Expr):
            exec(compile(source, name, "exec"), names)
            continue
        exec(compile(ast.Module(statements, []), name, "exec"), names)
        values.append(eval(compile(ast.Expression(last.value), name, "eval"), names))
    return values


def check(name: str) -> None:
    """Run a notebook, and say that its charts are pictures with a text, in the colours of the page."""
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        values = shown(name)
    assert "/tmp" not in printed.getvalue()  # a page is the same wherever it is built
    charts = [value for value in values if type(value).__name__ == "Chart"]
    assert charts
    for chart in charts:
        svg = chart.svg()
        element = ElementTree.fromstring(svg)
        assert element.get("role") == "img"
        assert element.get("aria-label") == chart.alt
        assert len(chart.alt) > 40
        assert "currentColor" in svg
        assert "NaN" not in svg
        assert not re.search(r'"(black|#000|#1a1a1a)"', svg)
        assert len(svg) < 60_000


def test_every_notebook_is_tested_and_checks_its_numbers() -> None:
    pages = {path.stem for path in GALLERY.glob("*.md")} - {"index"}
    assert pages == {*HERE, *SLOW}
    for name in pages:
        assert "assert " in cells(name)[-1], name
        assert (GALLERY / f"{name}.md").read_text("utf-8").count("```{code-cell}") == len(cells(name))


def test_every_notebook_has_a_card_with_pictures() -> None:
    index = (GALLERY / "index.md").read_text("utf-8")
    for name in (*HERE, *SLOW):
        assert f":link: {name}\n" in index
        for scheme in ("light", "dark"):
            assert f"images/{name}-{scheme}.png" in index
            assert (GALLERY / "images" / f"{name}-{scheme}.png").stat().st_size < 40_000


def test_the_pictures_of_the_readme_are_large_enough_to_read_and_small_enough_to_load() -> None:
    for scheme in ("light", "dark"):
        picture = (ROOT / "docs" / "images" / f"first-screen-{scheme}.png").read_bytes()
        width, height = struct.unpack(">II", picture[SIZE_IN_PNG])
        assert 1200 < width < 1700
        assert height < 0.75 * width
        assert len(picture) <= 250_000


@pytest.mark.usefixtures("_gallery")
@pytest.mark.parametrize("name", HERE)
def test_a_notebook_that_calls_functions_runs(name: str) -> None:
    check(name)


@pytest.mark.slow
@pytest.mark.usefixtures("_gallery")
@pytest.mark.parametrize("name", SLOW)
def test_a_notebook_that_starts_commands_runs(name: str) -> None:
    check(name)


def test_a_command_that_ends_otherwise_than_said_fails_its_page(tmp_path: Path) -> None:
    with pytest.raises(RuntimeError, match="exit code 2"):
        terminal("bodycheck validate missing.case.toml", tmp_path)
    with pytest.raises(ValueError, match="not a command of bodycheck"):
        terminal("rm -r .", tmp_path)
