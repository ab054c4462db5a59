"""A study that has only `rows` and `study` has a command, a Python function, a page, and is resumed and read again."""

import importlib
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import bodycheck
from bodycheck import studies
from bodycheck.commands import saved
from bodycheck.commands.command_line import app
from bodycheck.errors import BadFolder
from bodycheck.reports.study import StudyReport
from bodycheck.studies import plain, plain_command, registry
from docs.extensions import result_columns
from tests.support import ROOT
from tests.support.processes import calls_here

NAME = "last_height"
METHODS = {"engine": "mujoco", "integrator": ("Euler", "RK4")}


@pytest.fixture(autouse=True)
def _registered(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """The study is found as any other is, by its name and its folder."""
    monkeypatch.setattr(studies, "__path__", [*studies.__path__, str(ROOT / "tests" / "support" / "miniature_study")])
    monkeypatch.setattr(registry, "STUDIES", [*registry.STUDIES, NAME])
    importlib.invalidate_caches()
    with calls_here():
        yield


def command(*words: str) -> int:
    """Run the command of the study, and return its exit code."""
    alone = app.__class__(name="bodycheck", default_parameter=app.default_parameter)
    for each in plain_command.of_studies():
        alone.command(each)
    code: int = alone([NAME.replace("_", "-"), *words], exit_on_error=False, print_error=False, result_action="return_value")
    return code


def test_the_function_and_the_command_find_the_same(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    results: Any = getattr(bodycheck, NAME)("projectile", **METHODS, out=tmp_path / "function")
    (rows,) = results.rows_by_table
    assert [row.integrator for row in rows] == ["Euler", "RK4"]
    assert results.tables[NAME].units["height"] == "m"
    assert results.to_frame()["height"].tolist() == [row.height for row in rows]
    words = ("projectile", "--engine", "mujoco", "--integrator", "Euler", "--integrator", "RK4")
    assert command(*words, "--out", str(tmp_path / "command"), "--json") == 0
    assert json.loads(capsys.readouterr().out)["rows"] == [dict(row) for row in results.tables[NAME].rows]
    tables = [(tmp_path / folder / f"{NAME}.csv").read_text() for folder in ("function", "command")]
    assert tables[0] == tables[1]
    assert command(*words) == 0
    printed = capsys.readouterr().out
    assert "height m" in printed
    assert "RK4" in printed


def test_its_report_is_written_again_from_its_folder(tmp_path: Path) -> None:
    results: Any = getattr(bodycheck, NAME)("projectile", **METHODS, out=tmp_path)
    again = saved.read(tmp_path)
    assert isinstance(again, StudyReport)
    assert (again.headline, again.parts) == (results.report.headline, results.report.parts)
    assert "Heights at the end" in (tmp_path / "report.md").read_text()
    table = tmp_path / f"{NAME}.csv"
    table.write_text(table.read_text().replace("RK4", "Euler"))
    with pytest.raises(BadFolder, match=r"last_height\.csv does not list the same runs as last_height\.jsonl"):
        saved.read(tmp_path)


def test_it_resumes_where_it_was_interrupted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    study = importlib.import_module(f"bodycheck.studies.{NAME}.study")
    runs: list[str] = []
    simulate = study.run

    def interrupted_in_the_second(case: Any, engine: str, method: Any) -> Any:
        runs.append(method.name)
        if len(runs) == 2:
            raise KeyboardInterrupt
        return simulate(case, engine, method)

    monkeypatch.setattr(study, "run", interrupted_in_the_second)
    with pytest.raises(KeyboardInterrupt):
        getattr(bodycheck, NAME)("projectile", **METHODS, out=tmp_path)
    with pytest.raises(BadFolder, match="was interrupted before its report was written"):
        saved.read(tmp_path)
    getattr(bodycheck, NAME)("projectile", **METHODS, out=tmp_path)
    assert runs == ["Euler", "RK4", "RK4"]
    assert f"resuming the interrupted study in {tmp_path}" in capsys.readouterr().err


def test_its_help_is_what_its_folder_says() -> None:
    text = "Measure how high the body is at the end of each case.\n\nCases with a mechanism are left out."
    assert registry.about(NAME) == text == plain_command.command(NAME).__doc__ == plain.function(NAME).__doc__


def test_shipped_cases_that_it_is_not_for_are_left_out() -> None:
    cases = [bodycheck.load(name) for name in ("projectile", "double-pendulum")]
    assert [case.name for case in plain.suited(NAME, cases, named=False)] == ["projectile"]
    assert plain.suited(NAME, cases, named=True) == cases


def test_the_reference_of_columns_has_its_table() -> None:
    section = result_columns.page().partition(f"### {NAME}.csv\n")[2]
    assert "height at the end; empty if the run failed (m)" in section
