"""Curves of reports of runs, and the charts that are drawn of them."""

import json
import re
from dataclasses import replace

import pytest
import vl_convert

from bodycheck.adapters.contract import Method
from bodycheck.figures.columns import FIGURES
from bodycheck.judging.judgement import Verdict
from bodycheck.judging.result_set import ResultSet
from bodycheck.reports.charts import without_legend
from bodycheck.reports.runs import contents as contents_module
from bodycheck.reports.runs import html_report
from bodycheck.reports.runs.charts import time_charts
from bodycheck.reports.runs.charts.curves import FAR
from bodycheck.reports.runs.contents import Contents, gather
from bodycheck.results.outcome import Completed
from bodycheck.results.store import Results
from tests.support.report_cases import FLIGHT, FLIP


def test_a_large_report_stays_small(results: Results, verdicts: list[Verdict], monkeypatch: pytest.MonkeyPatch) -> None:
    """With a tenth of all limits, so that a tenth of the runs is large."""
    for limit in ("MOST_NUMBERS", "MOST_INSTANTS"):
        monkeypatch.setattr(contents_module, limit, getattr(contents_module, limit) // 10)
    many = [
        replace(verdict, run=replace(verdict.run, method=Method.parse(f"{verdict.run.method.name}-{copy}", 0.002)))
        for copy in range(3)
        for verdict in verdicts
    ]
    assert 4 * contents_module.MOST_POINTS * len(many) > contents_module.MOST_NUMBERS, (
        "curves have fewer points in a large report"
    )
    contents = gather([ResultSet(results, many)])
    stored = sum(len(json.dumps(section.curves.datasets, separators=(",", ":"))) for section in contents.sections)
    assert 0.1e6 < stored < 0.9e6


def test_charts_hold_no_data_and_each_is_stored_once(page: str, contents: Contents) -> None:
    specifications = html_report.specifications(contents)
    assert set(specifications) == {
        *("attitude_error", "position_error", "energy_drift", "angular_momentum_drift"),
        *("momentum_body", "momentum_inertial"),
        *(f"trade-{name}" for name in contents.trades),
    }
    assert "values" not in json.dumps({name: own for name, own in specifications.items() if not name.startswith("trade-")})
    assert page.count('id="charts"') == 1


@pytest.mark.parametrize("case", [FLIP, FLIGHT])
def test_charts_draw(contents: Contents, case: str) -> None:
    section = next(section for section in contents.sections if section.name == case)
    drawn = {*section.curves.drawn, *(("momentum_body", "momentum_inertial") if section.curves.momentum else ())}
    assert ("momentum_body" in drawn) == (case == FLIP)
    for name, specification in html_report.specifications(contents).items():
        if name not in drawn:
            continue
        svg = vl_convert.vegalite_to_svg(specification | {"datasets": section.curves.datasets})
        # Lines of methods and of components have dashes; the edge of the floor has none, and is drawn where it is above zero.
        assert len(re.findall(r'<path d="[^>]*stroke-dasharray="', svg)) == (3 if name.startswith("momentum") else 5), name
        floor = any(value > 0 for value in section.curves.datasets["floor"][0].get(name, ()))
        assert len(re.findall(r'<path [^>]*stroke="#888888"', svg)) == floor, name
        assert "NaN" not in svg
        assert "undefined" not in svg


def test_the_floor_is_drawn_where_errors_come_near_it(contents: Contents, verdicts: list[Verdict]) -> None:
    specifications = html_report.specifications(contents)
    names = [name for name, value in specifications.items() if '"floor"' in json.dumps(value)]
    assert names == ["attitude_error", "position_error", "energy_drift", "angular_momentum_drift"]
    drawn = []
    for section in contents.sections:
        rows = [verdict.row() for verdict in verdicts if verdict.run.case == section.name]
        for name in names:
            floor, own = section.curves.datasets["floor"][0][name], max(row[FIGURES[name].bounded_by] for row in rows)
            drawn.append(name == "attitude_error" or min(row[name] for row in rows) < FAR * own)
            assert floor == [] or max(floor) == float(f"{own:.4g}")
            assert (floor != []) == drawn[-1], (section.name, name)
    assert set(drawn) == {True, False}, "else nothing was tried"


def test_curves_keep_the_largest_error(contents: Contents, verdicts: list[Verdict]) -> None:
    for verdict in verdicts:
        section = next(section for section in contents.sections if section.name == verdict.run.case)
        label = f"{verdict.run.engine} {verdict.run.method.name}"
        row = next(row for row in section.curves.datasets["series"] if row["method"] == label)
        (times,) = section.curves.datasets["times"]
        assert len(times["t"]) == len(row["attitude_error"]) <= 256
        for name in ("attitude_error", "position_error", "angular_momentum_drift"):
            assert max(row[name]) == float(f"{verdict.row()[name]:.4g}")


def test_a_legend_only_where_asked(contents: Contents) -> None:
    specification = time_charts.over_time(contents.plotted[0], contents.lines)
    datasets = contents.sections[0].curves.datasets
    with_legend = vl_convert.vegalite_to_svg(specification | {"datasets": datasets})
    without = vl_convert.vegalite_to_svg(without_legend(specification) | {"datasets": datasets})
    assert "role-legend" in with_legend
    assert "role-legend" not in without


def test_completed_runs_only_have_curves(contents: Contents, verdicts: list[Verdict]) -> None:
    completed = sum(isinstance(verdict.outcome, Completed) for verdict in verdicts)
    assert sum(len(section.curves.datasets["series"]) for section in contents.sections) == completed
