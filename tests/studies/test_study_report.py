"""Reports of studies: what the tradeoff study's says of real runs, and what it makes of any rows that it may be given."""

import math
import re

import pytest

from bodycheck.judging.schemes.convergence import UNITS
from bodycheck.reports import html, markdown
from bodycheck.studies.orders import Order
from bodycheck.studies.tradeoff.page import present
from tests.support import pages
from tests.support.pages import HOSTILE, HOSTILE_NAME, Page, attributes_of, markdown_tables
from tests.support.tradeoff_rows import HEADER, Row, curve, drawn, failed, hostile_report, order, row
from tests.support.wording import facts


def test_hostile_strings_show_as_text() -> None:
    report = hostile_report()
    text = html.render_study(report)
    pages.check(text)
    seen = Page(text)
    assert seen.text.count(HOSTILE) + seen.text.count(HOSTILE_NAME) >= 6
    assert HOSTILE_NAME in seen.text
    assert text.lower().count("</script") == len(attributes_of(text, "script")) == 6
    for part in report.parts:
        for chart in part.charts:
            assert drawn(chart.specification)[0] == 1


def test_hostile_strings_in_markdown() -> None:
    text = markdown.render_study(hostile_report())
    assert "<script" not in text
    assert "\u202e" not in text
    for table in markdown_tables(text):
        assert len({len(re.findall(r"(?<!\\)\|", line)) for line in table}) == 1


def test_what_was_not_measured_is_left_out() -> None:
    unmeasured = {"energy_drift": math.nan, "angular_momentum_drift": None}
    rows = [
        row(**unmeasured),
        row(timestep=0.005, attitude_error=math.inf, position_error=0.0, cost=2e-3, **unmeasured),
        row(integrator="RK4", cost=None),
        failed(integrator="RK4", timestep=0.005),
        failed(integrator="RK4", timestep=0.001),
    ]
    report = present(HEADER, rows, [order(order=None, order_low=None, order_high=None, claimed=None)])
    (part,) = report.parts
    assert [chart.title for chart in part.charts] == ["Attitude error", "Position error"]
    assert [drawn(chart.specification) for chart in part.charts] == [(1, 1, 1), (1, 1, 1)]
    ((note,), (text,)) = part.charts[1].notes, part.texts
    assert facts(note, "zero", "not drawn", "mujoco Euler", "mujoco RK4") == ["zero", "not drawn", "mujoco Euler"]
    assert facts(text, "diverged", "mujoco Euler", "mujoco RK4") == ["diverged", "mujoco RK4", "5", "1"]
    assert [line.label for line in part.lines] == ["mujoco Euler"]
    assert facts(report.headline, "methods", "case", "runs", "without results") == [
        *("2", "methods", "1", "case", "5", "runs", "2", "without results"),
    ]
    text = html.render_study(report)
    pages.check(text)
    assert "nan" not in Page(text).text.lower().split()


@pytest.mark.parametrize("rows", [[], [failed()], [row(cost=None)]], ids=["nothing", "failed", "no costs"])
def test_nothing_measured(rows: list[Row]) -> None:
    report = present(HEADER, rows, [])
    assert report.findings == ()
    assert [part.charts for part in report.parts] == [()] * len(rows)
    pages.check(html.render_study(report))
    assert markdown.render_study(report).startswith("# bodycheck: ")


def many_cases(amount: int) -> tuple[list[Row], list[Order]]:
    rows, orders = [], []
    for case in map("case-{}".format, range(amount)):
        for place in range(16):
            method = {"case": case, "integrator": f"Euler:option={place}", "engine": "mujoco" if place < 11 else "pinocchio"}
            errors = [10.0**-step * (1 + place) for step in range(10)]
            named = {name: value for name, value in method.items() if name != "integrator"}
            rows += curve(method["integrator"], errors, [1e-4 * 2**step for step in range(10)], **named)
            orders += [order(**method, quantity=quantity) for quantity in UNITS]
    return rows, orders


def test_as_many_cases_as_are_shipped() -> None:
    rows, orders = many_cases(23)
    report = present(HEADER, rows, orders)
    assert len(report.parts) == 23
    assert len({(line.colour, line.dash) for line in report.parts[0].lines}) == 16
    assert len(html.render_study(report)) < 3.5e6
    text = markdown.render_study(report)
    assert len(text) < 65_536
    left_out = int(re.findall(r"(\d+) tables were left out", text)[0])
    assert text.count("<details>") + left_out == 23
