"""What is expected of an engine that is not installed has not been checked, and every summary says what it counts as."""

import json
from pathlib import Path
from xml.etree import ElementTree

import pytest

from bodycheck.casefile.case import is_shipped
from tests.support import ROOT
from tests.support.cases import a_case, expecting
from tests.support.commands import Done, bodycheck
from tests.support.planted_engines import UNINSTALLED, plant

REASON = "uninstalled is not installed: there is no Python package 'no_such_engine'"
HELD = expecting("mujoco", "RK4", 0.01, position_error=1.0)
LOST = [expecting("uninstalled", "RK4", step, attitude_error=1.0) for step in (0.01, 0.02)]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, calls_here: None) -> Path:
    """A folder with a case that expects something of MuJoCo, and something of an engine that is not installed."""
    plant(tmp_path / "planted", {"uninstalled": UNINSTALLED})
    monkeypatch.syspath_prepend(tmp_path / "planted")
    (tmp_path / "spin.case.toml").write_text(a_case(expect=[HELD, *LOST]), "utf-8")
    return tmp_path


def run(folder: Path, *options: str) -> Done:
    into = ("--out", "out", "--junit", "junit.xml")
    return bodycheck("run", "spin.case.toml", "--integrator", "RK4", *into, *options, folder=folder)


def flowing(text: str) -> str:
    """A text without its line ends, which depend on the width."""
    return " ".join(text.split())


def summaries(folder: Path) -> tuple[str, str, str, dict[str, str | None]]:
    """The headline, the notices, the report, and the failed and skipped tests of JUnit with their messages."""
    document = json.loads((folder / "out" / "results.json").read_text())
    told = {
        f"{kind} {test.get('name')}": found.get("message")
        for test in ElementTree.parse(folder / "junit.xml").iter("testcase")
        for kind in ("failure", "skipped")
        if (found := test.find(kind)) is not None
    }
    return document["headline"], " ".join(document["notices"]), (folder / "out" / "report.md").read_text(), told


def test_a_missing_engine_fails_what_is_expected_of_it(folder: Path) -> None:
    done = run(folder)
    assert done.returncode == 1
    sentence = f"2 expectations of uninstalled were not checked and count as failed unless --allow-missing is given: {REASON}."
    assert sentence in flowing(done.stdout)
    headline, notices, report, tests = summaries(folder)
    assert headline.endswith("1 met all expectations; 2 expectations could not be checked, which counts as failed")
    assert sentence in notices
    assert headline in report
    assert tests == {f"failure uninstalled RK4 {step} s": f"not checked: {REASON}" for step in (0.01, 0.02)}
    again = bodycheck("report", "out", folder=folder)
    assert (again.returncode, sentence in again.stderr) == (1, True)


def test_a_missing_engine_may_be_allowed_and_that_is_told(folder: Path) -> None:
    done = run(folder, "--allow-missing")
    assert done.returncode == 0
    sentence = f"2 expectations of uninstalled were not checked (--allow-missing): {REASON}."
    assert sentence in flowing(done.stdout)
    headline, notices, report, tests = summaries(folder)
    assert headline.endswith("; 2 expectations were not checked")
    assert sentence in notices
    assert "expectations not checked 2" in report
    assert tests == {f"skipped uninstalled RK4 {step} s": f"not checked (--allow-missing): {REASON}" for step in (0.01, 0.02)}
    assert bodycheck("report", "out", folder=folder).returncode == 0


def test_only_what_was_selected_counts(folder: Path) -> None:
    assert run(folder, "--engine", "mujoco").returncode == 0
    finer = run(folder, "--timestep", "0.01")
    assert "1 expectation of uninstalled was not checked and counts as failed" in flowing(finer.stdout)


def test_junit_says_that_nothing_was_checked(folder: Path) -> None:
    (folder / "spin.case.toml").write_text(a_case(), "utf-8")
    assert run(folder).returncode == 0
    *_, tests = summaries(folder)
    assert tests == {"skipped expectations": "none of its runs has expectations: nothing was checked"}


def test_shipped_cases_are_known_by_name_and_by_path(tmp_path: Path) -> None:
    name = "free-brick"
    assert is_shipped(name)
    assert is_shipped(ROOT / "cases" / f"{name}.case.toml")
    copy = tmp_path / f"{name}.case.toml"
    copy.write_text("")
    assert not is_shipped(copy)
