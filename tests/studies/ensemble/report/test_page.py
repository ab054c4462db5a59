"""The report and the terminal tables of ensembles: their sizes, and what they say."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import vl_convert

from bodycheck.console.options import AS_USUAL
from bodycheck.console.tables import layout
from bodycheck.reports import html, markdown
from bodycheck.reports.study import Animation, StudyReport
from bodycheck.studies.ensemble import printing
from bodycheck.studies.ensemble.findings.analysis import Analysis, analyse
from bodycheck.studies.ensemble.findings.stored import EngineMethod
from bodycheck.studies.ensemble.report import page
from tests.support import pages
from tests.support.ensembles import EULER, RK4, made, many_methods
from tests.support.pages import HOSTILE, Page
from tests.support.terminals import terminal
from tests.support.tradeoff_rows import HEADER
from tests.support.wording import facts

#: The largest size of a report that is promised, in bytes.
LARGEST = 6_000_000

FIGURES = ("attitude_error", "position_error", "energy_drift", "angular_momentum_drift", "velocity_error", "truth_error")


def ensemble_of(folder: Path, members: int, methods: list[EngineMethod], failing: float = 0.01) -> Analysis:
    random = np.random.default_rng(members)
    given = {f"initial.angular_velocity.{i}": random.normal(0, 3, members) for i in range(3)}
    given["body.mass"] = random.uniform(1, 2, members)
    spin = sum(values**2 for name, values in given.items() if "velocity" in name)

    def columns() -> dict[str, Any]:
        wrong = random.random(members) < failing
        figures = {name: np.where(wrong, np.nan, 1e-6 * spin * random.lognormal(size=members)) for name in FIGURES}
        reasons = np.where(wrong, HOSTILE, "").tolist()
        return figures | {"status": np.where(wrong, "diverged", "ok").tolist(), "reason": reasons}

    return analyse(made(folder, given, {flown: columns() for flown in methods}))


def reported(analysis: Analysis, **more: Any) -> StudyReport:
    return page.present(page.Material(HEADER, "turning", analysis, **more))


def test_the_report_is_small_whatever_the_number_of_members(tmp_path: Path) -> None:
    """From some 4600 members on, maps have all of their cells, and nothing else depends on the number."""
    few, many = (
        html.render_study(reported(ensemble_of(tmp_path / str(members), members, [EULER, RK4]))) for members in (5000, 20_000)
    )
    assert len(many) < 1.02 * len(few)


def test_a_report_of_many_methods_is_small(tmp_path: Path) -> None:
    report = reported(ensemble_of(tmp_path, 5000, many_methods(20)))
    text = html.render_study(report)
    assert len(text.encode()) < LARGEST
    pages.check(text)
    assert len(markdown.render_study(report)) < 65_536


def test_what_the_report_says(tmp_path: Path) -> None:
    analysis = ensemble_of(tmp_path, 2000, [EULER, RK4])
    files = (page.File(17, "spin-17.case.toml", HOSTILE), page.File(3, "", "not when it is run alone"))
    report = reported(analysis, files=files, animations=(Animation("Member 17", {"a": "</script>"}, HOSTILE),))
    text = html.render_study(report)
    pages.check(text)
    seen = Page(text)
    for wanted in (HOSTILE, "spin-17.case.toml", "|initial.angular_velocity|", "Share of the variance", "1 case file"):
        assert wanted in seen.text
    assert [part.name for part in report.parts] == ["methods", "distributions", "causes", "worst"]
    assert {finding.subject for finding in report.findings} == {"Failures", "Rank", "Worst member", "Causes"}
    failed = sum(way.count for method in analysis.aggregates.methods for way in method.ways)
    assert report.headline == f"2000 members with 2 methods: {failed} of 4000 runs failed"
    for part in report.parts:
        for chart in part.charts:
            svg = vl_convert.vegalite_to_svg(chart.specification)
            assert "<path" in svg
            assert "NaN" not in svg
            assert "undefined" not in svg


def test_an_ensemble_without_failures(tmp_path: Path) -> None:
    report = reported(ensemble_of(tmp_path, 1000, [EULER], failing=0.0))
    assert facts(report.headline, "no run failed") == ["1000", "1", "no run failed"]
    assert facts(report.findings[0].text, "No member failed", "mujoco Euler") == ["No member failed", "mujoco Euler", "0.3"]
    assert not any(table.columns[3] == "How" for part in report.parts for _, table in part.tables)


@pytest.mark.parametrize("members", [1, 2, 20])
@pytest.mark.parametrize("failing", [0.0, 1.0])
def test_few_members_and_nothing_measured(tmp_path: Path, members: int, failing: float) -> None:
    report = reported(ensemble_of(tmp_path, members, [EULER, RK4], failing))
    text = html.render_study(report)
    pages.check(text)
    assert "nan" not in Page(text).text.lower().split()
    assert markdown.render_study(report).startswith("# bodycheck: ")


def test_tables_fit_a_terminal_of_80_columns(tmp_path: Path) -> None:
    analysis = ensemble_of(tmp_path, 1000, [EULER, EngineMethod("pinocchio", "3.7.0", "rkmk4:settings=engine", 0.0005)])
    findings = page.findings(page.Material(HEADER, "turning", analysis))
    with terminal(80) as stream:
        sentences = [f"{finding.subject}: {finding.text}" for finding in findings]
        printing.print_ensemble(analysis.aggregates, analysis.dependence_rows(), sentences, AS_USUAL)
    assert max(map(len, stream.lines)) <= 80
    text = stream.getvalue()
    assert "1000 members, attitude_error, the best method first" in text
    assert "|initial.angular_velocity|" in text


def test_a_terminal_of_80_columns_names_the_engine_of_each_method() -> None:
    """Several engines have integrators of one name; the longest names there are leave room for the errors."""
    names = {"engine": "mujoco_warp", "integrator": "SemiExplicitEuler2:settings=engine", "failed": "100 %"}
    columns = [column for column in printing.ROWS if not column.asked]
    cells = [[f"{names.get(column.name, '1.23e-1')[:-1]}{place}" for column in columns] for place in (1, 2)]
    found = layout(columns, cells, 80)
    assert not found.listed
    assert {"engine", "integrator", "failed", "q50", "q99"} <= {columns[place].name for place in found.shown}
