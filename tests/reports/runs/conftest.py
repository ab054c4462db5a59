"""Results of two cases and two engines, and their report."""

from pathlib import Path

import pytest

from bodycheck.casefile.case import parse
from bodycheck.judging import judgement
from bodycheck.judging.judgement import Verdict
from bodycheck.judging.result_set import ResultSet
from bodycheck.reports.runs import html_report
from bodycheck.reports.runs.contents import Contents, gather
from bodycheck.results import store
from bodycheck.results.store import Results
from bodycheck.running import plan
from tests.support import campaigns
from tests.support.report_cases import BROKEN, FLIGHT, FLIP, two_seconds
from tests.support.saved_results import once


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two cases through both engines: a flip that Euler's method gets wrong, and a flight in which nothing turns."""
    engines = campaigns.records("mujoco", "pinocchio")
    cases = (parse(two_seconds(FLIP).text + BROKEN, FLIP), two_seconds(FLIGHT))
    tasks = plan.plan(cases, engines, ("Euler", "RK4", "semi-implicit-euler", "body-twist-euler", "rk4"), ())
    return once(
        tmp_path_factory, "reported", lambda place: campaigns.results(tasks, place, command=("bodycheck", "run", "<b>"))
    )


@pytest.fixture(scope="session")
def results(folder: Path) -> Results:
    return store.read(folder)


@pytest.fixture(scope="session")
def verdicts(results: Results) -> list[Verdict]:
    return judgement.judge(results)


@pytest.fixture(scope="session")
def contents(results: Results, verdicts: list[Verdict]) -> Contents:
    return gather([ResultSet(results, verdicts)])


@pytest.fixture(scope="session")
def page(contents: Contents) -> str:
    return html_report.render(contents)
