"""Large reports draw the cases that matter, and any other case when it is asked for."""

import re
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from bodycheck.commands import saved as saved_folders
from bodycheck.errors import BadInput
from bodycheck.judging import result_set
from bodycheck.reports.finding import Finding
from bodycheck.reports.runs import comparison
from bodycheck.reports.runs.charts import drawn_cases
from bodycheck.results.store import Results
from tests.support import saved_results
from tests.support.saved_results import call


@pytest.fixture(scope="session")
def saved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Results of two cases, `spin` and `slide`."""
    return saved_results.made(tmp_path_factory, "run")


def drawn(page: Path) -> set[str]:
    """Return the names of the cases of which a page has curves over time."""
    return {
        name for name in ("spin", "slide") if re.search(f'id="curve-{name}-position_error"', (page / "report.html").read_text())
    }


def test_a_case_that_is_not_drawn_says_how_to_draw_it(saved: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "run"
    shutil.copytree(saved / "run", folder)
    assert drawn(folder) == {"spin", "slide"}
    monkeypatch.setattr(drawn_cases, "MOST_DRAWN", 1)
    assert call("report", folder) == 1
    (shown,) = drawn(folder)
    other = ({"spin", "slide"} - {shown}).pop()
    page = (folder / "report.html").read_text()
    assert page.count("Left out") == 1
    assert f"bodycheck report FOLDER --case {other} --out OTHER" in page
    assert f'id="case-{other}"' in page
    # Its figures, which have no curve to lead to, lead to the commands that make the runs, which are there.
    assert set(re.findall(rf'href="#(run-{other}-\d+)"', page)) <= set(re.findall(r' id="([^"]+)"', page))
    for name in ("spin", "slide"):
        assert call("report", folder, "--case", name, "--out", tmp_path / name) == (name == "spin")  # whose runs fail
        assert drawn(tmp_path / name) == {name}
        assert ({"spin", "slide"} - {name}).pop() not in (tmp_path / name / "results.csv").read_text()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--case", "spin"), "needs --out, another folder"),
        (("--case", "spin", "--out", "run"), "needs --out, another folder"),
        (("--case", "spinn", "--out", "new"), "no such case in these results of 2 cases; did you mean 'spin'"),
    ],
)
def test_a_case_that_cannot_be_drawn_alone_is_refused(
    saved: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, words: tuple[str, ...], said: str
) -> None:
    shutil.copytree(saved / "run", tmp_path / "run")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(BadInput, match=re.escape(said)):
        call("report", "run", *words)


def test_drawn_first_are_the_cases_that_findings_name_then_those_that_failed_then_the_worst(
    saved: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    results = saved_folders.read(saved / "run")
    assert isinstance(results, Results)
    spin = next(case for case in comparison.shown([result_set.judged(results)]) if case.name == "spin")
    ok = next(verdict for verdict in spin.verdicts if verdict.discrepancy is not None)
    assert ok.discrepancy is not None
    cases = []
    for place, (error, passed) in enumerate([(1e-3, True), (1e-1, True), (1e-9, False), (1e-6, True), (float("nan"), True)]):
        largest = dict(ok.discrepancy.largest) | {"attitude_error": error}
        verdict = replace(ok, discrepancy=replace(ok.discrepancy, largest=largest), passed=passed)
        cases.append(replace(spin, name=f"case-{place}", verdicts=(verdict,)))
    assert set(drawn_cases.drawn_cases(cases, ())) == {case.name for case in cases}
    monkeypatch.setattr(drawn_cases, "MOST_DRAWN", 4)
    assert drawn_cases.drawn_cases(cases, (Finding("Attitude", "in ", "case-3"),)) == ["case-3", "case-2", "case-4", "case-1"]
