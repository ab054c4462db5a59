"""The tables of docs/mechanisms.md of engines besides MuJoCo and Pinocchio, measured again where that takes a minute."""

import runpy
from typing import Any

import pytest

from bodycheck.environments import environments
from tests.support import ROOT

#: Errors below this are rounding, which differs from one processor to the next (rad or m).
ROUNDED = 1e-9

Cells = list[str]


@pytest.fixture(scope="module")
def script() -> dict[str, Any]:
    return runpy.run_path(str(ROOT / "docs" / "mechanism_engines.py"))


def tables(text: str) -> dict[str, list[Cells]]:
    """The cells of all rows of tables by the first cell, in order."""
    found: dict[str, list[Cells]] = {}
    for line in text.splitlines():
        if line.startswith("| "):
            first, *cells = (cell.strip() for cell in line.strip("|").split("|"))
            found.setdefault(first, []).append(cells)
    return found


def number(cell: str) -> float | None:
    """The error at the beginning of a cell; None for one without an error."""
    try:
        return float(cell.replace(",", " ").split()[0])
    except (ValueError, IndexError):
        return None


def test_what_is_left_for_vanishing_steps_is_extrapolated(script: dict[str, Any]) -> None:
    """An error of first order and a constant one: the constant is left. What does not converge has no limit."""
    import numpy as np

    steps, constant = (4.0, 2.0, 1.0), np.array([[0.3], [0.5]])
    found = script["_extrapolated"](*(constant + step * np.array([[1.0], [2.0]]) for step in steps))
    assert found == pytest.approx(0.5)
    assert np.isnan(script["_extrapolated"](*(np.array([[value]]) for value in (1.0, -1.0, 1.0))))


def test_settings_of_the_engine_have_a_row_unless_they_change_nothing(script: dict[str, Any]) -> None:
    cells = {"A": ["1"], "A:settings=engine": ["1"], "B": ["1"], "B:settings=engine": ["2"], "C": ["–"]}
    rows = list(script["_rows"]("toy", cells))
    assert rows == ["| toy A | 1 |", "| toy B | 1 |", "| toy B:settings=engine | 2 |"]


def test_the_page_has_a_row_for_each_engine_with_mechanisms(script: dict[str, Any]) -> None:
    rows = tables((ROOT / "docs" / "mechanisms.md").read_text("utf-8"))
    engines = ["brax", "dart", "drake", "exudyn", "mjx", "mujoco_warp", "newton", "pybullet", "rapier", "sapien", "simbody"]
    assert [name for name in engines if name not in rows] == []
    for name in engines:
        assert any(first.startswith(f"{name} ") for first in rows), name


@pytest.mark.engines
@pytest.mark.parametrize("name", ["dart", "pybullet", "sapien"])
def test_the_page_has_what_is_measured(name: str, script: dict[str, Any], capsys: pytest.CaptureFixture[str]) -> None:
    environments.obtain(name, environments.newest(name))
    script["main"]([name])
    measured, page = tables(capsys.readouterr().out), tables((ROOT / "docs" / "mechanisms.md").read_text("utf-8"))
    compared = 0
    for first, rows in measured.items():
        if first.split()[0] != name:
            continue  # the head of a table
        for own, stated in zip(rows, page.get(first, []), strict=False):
            for one, other in zip(map(number, own), map(number, stated), strict=True):
                assert (one is None) == (other is None), (first, own, stated)
                if one is not None and other is not None and max(one, other) > ROUNDED:
                    compared += 1
                    # The page has one digit.
                    assert 0.5 < one / other < 2, (first, own, stated)
    assert compared > 4
