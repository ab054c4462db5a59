"""Reports for the tests that open them in a browser."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from bodycheck import load, reports
from bodycheck.adapters.contract import Method
from bodycheck.casefile.case import parse
from bodycheck.judging import attribution, judgement
from bodycheck.judging.result_set import ResultSet
from bodycheck.processes.failures import Crashed
from bodycheck.reports.runs import matrix
from bodycheck.running import plan
from tests.support import campaigns
from tests.support.browser import Visit, visiting
from tests.support.pages import HOSTILE
from tests.support.report_cases import BROKEN, FLIGHT, FLIP, LONG, SLIDE, two_seconds
from tests.support.saved_results import once
from tests.support.tradeoff_rows import hostile_report


def sets(folder: Path) -> list[ResultSet]:
    """A flip with a broken expectation and a run that crashed, and a slide at two time steps, by both engines; a flight."""
    engines = campaigns.records("mujoco", "pinocchio")
    flip = parse(two_seconds(FLIP).text + BROKEN, FLIP)
    slide = replace(load(SLIDE), expectations=())
    tasks = plan.plan((flip,), engines, ("Euler", "RK4", "implicit", "discrete", "semi-implicit-euler", "rk4", "rk4-naive"), ())
    tasks += plan.plan((two_seconds(FLIGHT),), engines, ("RK4",), ())
    tasks += plan.plan((slide,), engines, ("Euler", "law-force"), (0.002, 0.001))
    results = campaigns.results(tasks, folder)
    verdicts = judgement.judge(results)
    crashed = replace(verdicts[0].run, method=Method.parse("gone", 0.002))
    reason = f"RuntimeError: {LONG}\n{HOSTILE}"
    verdicts.insert(
        1, replace(verdicts[0], run=crashed, outcome=Crashed(reason), discrepancy=None, passed=False, reason=reason)
    )
    case = replace(results.cases[FLIP], title=f"{HOSTILE} {LONG}", source=HOSTILE, tags=(HOSTILE, LONG, "tumbling"))
    results.__dict__["cases"] = results.cases | {FLIP: case}
    return [ResultSet(results, verdicts, attribution.attribute(results, verdicts))]


@pytest.fixture(scope="session")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The report of runs, in which more methods than fit are folded, as if there were room for four."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(matrix, "MOST_COLUMNS", 4)
        folder = once(tmp_path_factory, "browsed", lambda folder: reports.write(sets(folder), folder))
    return folder / "report.html"


@pytest.fixture(scope="session")
def study(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The report of a study, with hostile names."""
    return reports.write_study(hostile_report(), tmp_path_factory.mktemp("study"))[0]


@pytest.fixture
def visit(browser: Any, report: Path) -> Iterator[Visit]:
    """The report of runs in a wide window."""
    with visiting(browser, report) as visit:
        yield visit
