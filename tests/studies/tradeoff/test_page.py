"""The page of the tradeoff study of real runs: its charts, tables and sentences have what was measured."""

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

from bodycheck import load, reports
from bodycheck.adapters import offers
from bodycheck.adapters.contract import Engine, Method
from bodycheck.judging import judgement
from bodycheck.judging.schemes.run_classes import classes_of
from bodycheck.reports import html, markdown
from bodycheck.reports.quantities import bound, milliseconds, number
from bodycheck.reports.study import Part, StudyReport
from bodycheck.studies.orders import Order
from bodycheck.studies.tradeoff import study as tradeoff
from bodycheck.studies.tradeoff.measurements import CaseMeasurements
from bodycheck.studies.tradeoff.page import present
from tests.support import campaigns, pages
from tests.support.cases import shortened
from tests.support.pages import Page, attributes_of, markdown_tables
from tests.support.tradeoff_rows import Row, drawn, measurements
from tests.support.wording import facts

FLIP, FLIGHT, SLIDE = "intermediate-axis-flip", "projectile", "sliding-brick"

#: The part by which a number that a page shows may differ from the number itself: half a unit of the second digit.
SHOWN = 0.05


STEPS = (0.02, 0.01, 0.005, 0.002, 0.001)


@dataclass(frozen=True)
class Study:
    """What a tradeoff study measured, and its report."""

    rows: list[Row]
    orders: list[Order]
    report: StudyReport

    def part(self, name: str) -> Part:
        return next(part for part in self.report.parts if part.name == name)

    def case(self, name: str) -> CaseMeasurements:
        return measurements([row for row in self.rows if row["case"] == name], self.orders)

    def told(self, subject: str) -> str:
        return "\n".join(finding.text for finding in self.report.findings if finding.subject == subject)


@pytest.fixture(scope="session")
def study(tmp_path_factory: pytest.TempPathFactory) -> Study:
    """A flip, a flight in which nothing turns, and a slide, of a second or less, through both engines at five time steps."""
    engines = campaigns.records("mujoco", "pinocchio")
    flip, flight = (shortened(load(name), 1.0, 51) for name in (FLIP, FLIGHT))
    slide = replace(load(SLIDE), expectations=())
    methods = {
        flip: ("Euler", "RK4", "semi-implicit-euler", "rk4-naive"),
        flight: ("RK4", "semi-implicit-euler"),
        slide: ("Euler", "law-force"),
    }
    tasks = [task for case, own in methods.items() for task in tradeoff.plan((case,), engines, own, STEPS)]
    results = campaigns.results(tasks, tmp_path_factory.mktemp("tradeoff"), command=("bodycheck", "tradeoff"))
    verdicts = judgement.judge(results)
    rows = [timed_once(own, engines) for own in judgement.records(verdicts)]
    orders = tradeoff.orders(results, verdicts, engines)
    return Study(rows, orders, present(results.header, rows, orders, classes_of(results, results.runs())))


@pytest.fixture(scope="session")
def page(study: Study) -> str:
    return html.render_study(study.report)


def timed_once(row: Row, engines: Mapping[str, Engine]) -> Row:
    """A row of the study, its cost that of the run itself: to time runs in turn and repeatedly takes half a minute."""
    taken = row["time_per_step"]
    own = offers.integrator_of(engines[row["engine"]], Method.parse(row["integrator"], row["timestep"]))
    assert own is not None
    cost = {"time_per_step_low": taken, "time_per_step_high": taken, "cost": taken / row["timestep"]}
    return row | cost | {"evaluations": own.evaluations}


def test_written_side_by_side_and_small(study: Study, tmp_path: Path) -> None:
    paths = reports.write_study(study.report, tmp_path)
    assert [path.name for path in paths] == ["report.html", "report.md"]
    assert 0.3e6 < paths[0].stat().st_size < 1.5e6  # the library of charts is compressed
    assert paths[1].stat().st_size < 60_000


def test_a_page_stands_alone(page: str, study: Study) -> None:
    pages.check(page)
    scripts = attributes_of(page, "script")
    assert len(scripts) == 6  # folds, sorting, unpacking, the charts, the library, the page's own
    assert page.lower().count("</script") == len(scripts)
    assert page.count('class="chart"') == sum(len(part.charts) for part in study.report.parts)


def test_every_chart_is_stored_once_under_its_name(page: str, study: Study) -> None:
    stored = json.loads(pages.inflated(page, "charts"))
    named = [dict(attrs)["data-chart"] for attrs in attributes_of(page, "div") if "data-chart" in dict(attrs)]
    assert sorted(stored) == sorted(str(name) for name in named)
    for part in study.report.parts:
        for place, chart in enumerate(part.charts, start=1):
            assert stored[f"{part.name}-{place}"]["layer"] == chart.specification["layer"]


def test_every_chart_draws_what_was_measured(study: Study) -> None:
    for part in study.report.parts:
        case = study.case(part.name)
        assert len(part.charts) == len(case.quantities) > 0
        for chart, quantity in zip(part.charts, case.quantities, strict=True):
            points = [point for point in case.points(quantity) if point.error > 0]
            methods = {(point.engine, point.integrator) for point in points}
            front = [point for point in case.front(quantity) if point.error > 0]
            # A run that errs by nothing at all has no place in the diagram, but on the front where attitudes have a floor.
            unseen = sum(point.error == 0 for point in case.points(quantity)) > 0
            curves, rings, seen = drawn(chart.specification)
            assert (curves, seen) == (len(methods), len(points)), chart.title
            assert rings == len(front) or (unseen and rings < len(front)), chart.title


def test_quantities_in_which_nothing_errs_have_no_diagram(study: Study) -> None:
    assert [chart.title for chart in study.part(FLIGHT).charts] == ["Position error", "Energy drift"]
    assert [chart.title for chart in study.part(SLIDE).charts][1:] == [
        *("Position error", "Energy error", "Angular momentum error"),
    ]
    assert study.case(FLIGHT).primary == "position"
    assert study.case(FLIP).primary == "attitude"


def test_the_truths_own_error_is_drawn_under_errors_with_its_unit(study: Study) -> None:
    for part in study.report.parts:
        case = study.case(part.name)
        for chart, (name, quantity) in zip(part.charts, case.quantities.items(), strict=True):
            own = case.truth_error(name)
            label = f"the truth's own error, {bound(own, 2)} {quantity.unit}".rstrip()
            assert (json.dumps(label) in json.dumps(chart.specification)) == (own > 0), chart.title
    assert all(study.case(FLIP).truth_error(name) > 0 for name in study.case(FLIP).quantities)


def test_nothing_dominates_a_front(study: Study) -> None:
    for part in study.report.parts:
        case = study.case(part.name)
        for quantity in case.quantities:
            front, least = case.front(quantity), case.truth_error(quantity)
            for kept in front:
                for other in case.points(quantity):
                    nearer = float(f"{max(other.error, least):.4g}")  # as it is printed
                    cheaper = other.cost <= kept.cost and nearer <= kept.error
                    assert not (cheaper and (other.cost < kept.cost or nearer < kept.error))
            for point in case.points(quantity):
                assert any(kept.cost <= point.cost and kept.error <= max(point.error, least) * (1 + 1e-3) for kept in front)


def test_methods_that_are_the_same_algorithm_are_told_together(study: Study) -> None:
    (told,) = study.told("Same algorithm").split("; ")
    names = ("flight", "mujoco Euler", "pinocchio semi-implicit-euler", "one algorithm")
    assert facts(told, *names)[:4] == list(names)


def test_findings_have_the_measured_numbers(study: Study) -> None:
    naive = {o.quantity: o for o in study.orders if (o.case, o.integrator) == (FLIP, "rk4-naive")}
    for quantity in ("attitude", "position"):
        assert naive[quantity].order == pytest.approx(2, abs=0.1)  # at five time steps of a second of tumbling
        assert f"{naive[quantity].order:.2f}" in study.told("Order")
    for sentence in study.told("Order").splitlines():
        assert facts(sentence, "pinocchio rk4-naive", "claimed")[0] == "pinocchio rk4-naive"
        assert facts(sentence, "claimed", FLIP)[-3:] == ["claimed", "4", FLIP]
    assert "mujoco" not in study.told("Order")

    euler = [o for o in study.orders if o.case == FLIP and o.scheme == "semi-implicit Euler"]
    assert {o.engine for o in euler} == {"mujoco", "pinocchio"}
    (sentence,) = [text for text in study.told("Scheme").splitlines() if " semi-implicit Euler to within " in text]
    coarsest = next(r for r in study.rows if (r["case"], r["integrator"], r["timestep"]) == (FLIP, "Euler", STEPS[0]))
    names = ("mujoco Euler", "pinocchio semi-implicit-euler", "agree", "semi-implicit Euler")
    *methods, residual_told, case, explains, explained = facts(sentence, *names, FLIP, "explains")
    assert (methods, case, explains) == (list(names), FLIP, "explains")
    assert explained == number(coarsest["attitude_error"], 2)
    residual = float(residual_told)
    largest = max(o.scheme_residual or 0.0 for o in euler)
    assert largest <= residual <= 1.1 * largest  # rounded up to two digits


def test_the_soft_contact_has_a_floor(study: Study) -> None:
    """A soft contact tends to another motion than a rigid one's, whatever the time step."""
    for sentence in study.told("Floor").splitlines():
        told = facts(sentence, "mujoco", "error", SLIDE)
        assert told[:2] == ["mujoco", "error"]
        assert told[-2:] == ["1", SLIDE]
    slid = [o for o in study.orders if (o.case, o.integrator) == (SLIDE, "Euler") and o.floor is not None]
    told = [o.quantity for o in slid if o.quantity in ("attitude", "position")]
    assert told
    for quantity in told:
        least = min(r[f"{quantity}_error"] for r in study.rows if (r["case"], r["integrator"]) == (SLIDE, "Euler"))
        assert number(least, 2) in study.told("Floor")


def test_the_cheapest_keeps_the_error(study: Study) -> None:
    sentences = study.told("Cheapest").splitlines()
    assert sentences
    (flight,) = [text for text in sentences if FLIGHT in text]
    error = 1e-6 if "at most 1e-6 m" in flight else 1e-3
    keeping = [point for point in study.case(FLIGHT).points("position") if point.error <= error]
    best = min(keeping, key=lambda point: point.cost)
    assert f"is {best.engine} {best.integrator} at {milliseconds(best.timestep, 4)} on {FLIGHT}" in flight
    assert f"a simulated second takes {number(best.cost, 2)} s" in flight


def test_tables_have_the_measured_numbers(study: Study, page: str) -> None:
    values = Page(page).values
    for name in (FLIP, FLIGHT):
        case = study.case(name)
        assert case.primary is not None
        for point in case.front(case.primary):
            evaluations = float(case.row(point)["evaluations"])
            own = [point.error, point.cost, point.cost_low, point.cost_high, 1 / point.cost, evaluations]
            assert any(line == pytest.approx(own, rel=SHOWN) for line in values if len(line) == len(own))
        for o in case.orders:
            if o.quantity in case.quantities and o.order is not None:
                assert any(cell.strip().startswith(f"{o.order:.2f}") for row in Page(page).rows for cell in row), o.order


def test_markdown_says_the_same(study: Study) -> None:
    text = markdown.render_study(study.report)
    for finding in study.report.findings:
        assert markdown.escape(finding.text, len(finding.text)) in text
    for part in study.report.parts:
        assert f"<b>{part.title}</b>" in text
    for table in markdown_tables(text):
        assert len({len(re.findall(r"(?<!\\)\|", line)) for line in table}) == 1
