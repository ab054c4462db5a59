"""Reports of studies: what the tradeoff study's says of real runs, and what it makes of any rows that it may be given."""

import json
import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import pytest
import vl_convert
from hypothesis import given, settings
from hypothesis import strategies as st

from bodycheck import load, reports
from bodycheck.adapters import offers
from bodycheck.adapters.contract import Adapter, Method
from bodycheck.judging import judgement
from bodycheck.judging.convergence import UNITS
from bodycheck.reports import html, markdown
from bodycheck.reports.charts import Spec
from bodycheck.reports.quantities import milliseconds, number
from bodycheck.reports.study import Part, StudyReport
from bodycheck.studies.orders import Order
from bodycheck.studies.tradeoff import study as tradeoff
from bodycheck.studies.tradeoff.findings import falls_short
from bodycheck.studies.tradeoff.measurements import CaseMeasurements
from bodycheck.studies.tradeoff.page import present
from tests.support import campaigns, pages
from tests.support.cases import shortened
from tests.support.pages import HOSTILE, Page, attributes_of, markdown_tables

FLIP, FLIGHT, SLIDE = "intermediate-axis-flip", "projectile", "sliding-brick"
STEPS = (0.02, 0.01, 0.005, 0.002, 0.001)
HEADER = {
    "bodycheck": "0",
    "started": "2026-01-01T00:00:00+00:00",
    "command": ["bodycheck", "tradeoff", "<b>"],
    "machine": {"processor": "abacus"},
    "packages": {},
    "engines": {"mujoco": "4", "pinocchio": "4"},
    "missing": {},
}

Row = dict[str, Any]


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
    engines = campaigns.adapters("mujoco", "pinocchio")
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
    return Study(rows, orders, present(results.header, rows, orders))


@pytest.fixture(scope="session")
def page(study: Study) -> str:
    return html.render_study(study.report)


def timed_once(row: Row, engines: dict[str, Adapter]) -> Row:
    """A row of the study, its cost that of the run itself: to time runs in turn and repeatedly takes half a minute."""
    taken = row["time_per_step"]
    own = offers.integrator_of(engines[row["engine"]].engine, Method.parse(row["integrator"], row["timestep"]))
    assert own is not None
    cost = {"time_per_step_low": taken, "time_per_step_high": taken, "cost": taken / row["timestep"]}
    return row | cost | {"evaluations": own.evaluations}


def measurements(rows: list[Row], orders: list[Order] | None = None) -> CaseMeasurements:
    name = rows[0]["case"]
    return CaseMeasurements(name, tuple(rows), tuple(order for order in orders or () if order.case == name))


def row(**values: Any) -> Row:
    """A completed run; its costs follow from `cost`."""
    defaults = dict.fromkeys(judgement.COLUMNS) | {
        "case": "spin",
        "engine": "mujoco",
        "version": "4",
        "integrator": "Euler",
        "timestep": 0.01,
        "status": "ok",
        "reason": "",
        "attitude_error": 1e-2,
        "position_error": 1e-2,
        "energy_drift": 1e-3,
        "angular_momentum_drift": 1e-4,
        "truth_error": 1e-14,
        "evaluations": 1,
        "cost": 1e-3,
    }
    made = defaults | values
    cost = made["cost"]
    steps = dict.fromkeys(("time_per_step_low", "time_per_step_high"))
    if cost is not None:
        steps = {name: share * cost * made["timestep"] for name, share in zip(steps, (0.9, 1.2), strict=True)}
    return steps | made


def failed(**values: Any) -> Row:
    figures = ("attitude_error", "position_error", "energy_drift", "angular_momentum_drift", "truth_error", "cost")
    return row(**{"status": "diverged", "reason": "not a number"} | dict.fromkeys(figures) | values)


def order(**values: Any) -> Order:
    defaults = {
        "case": "spin",
        "engine": "mujoco",
        "version": "4",
        "integrator": "Euler",
        "quantity": "attitude",
        "order": 1.0,
        "order_low": 0.98,
        "order_high": 1.02,
        "floor": None,
        "claimed": 1,
        "scheme": "",
        "scheme_residual": None,
    }
    return Order(**defaults | values)


def curve(integrator: str, errors: list[float], costs: list[float], **values: Any) -> list[Row]:
    """A method through as many time steps, from 10 ms each a half of the one before."""
    return [
        row(integrator=integrator, timestep=0.01 / 2**place, attitude_error=error, cost=cost, **values)
        for place, (error, cost) in enumerate(zip(errors, costs, strict=True))
    ]


def texts(report: StudyReport, subject: str) -> list[str]:
    return [finding.text for finding in report.findings if finding.subject == subject]


def drawn(specification: Spec) -> tuple[int, int, int]:
    """How many curves, rings and points a diagram has."""
    svg = vl_convert.vegalite_to_svg(specification)
    assert "NaN" not in svg
    assert "undefined" not in svg
    symbols = re.findall(r'<g class="mark-symbol role-mark [^"]*"[^>]*>(.*?)</g>', svg)
    rings, points = (group.count("<path") for group in symbols)
    lines = "".join(re.findall(r'<g class="mark-line role-mark [^"]*"[^>]*>(.*?)</g>', svg))
    front = len(re.findall(r'<path [^>]*stroke="currentColor"', lines))  # the front's own line, which has the ink of the text
    return lines.count("<path") - front, rings, points


def test_written_side_by_side_and_small(study: Study, tmp_path: Path) -> None:
    paths = reports.write_study(study.report, tmp_path)
    assert [path.name for path in paths] == ["report.html", "report.md"]
    assert 0.5e6 < paths[0].stat().st_size < 1.5e6
    assert paths[1].stat().st_size < 60_000


def test_a_page_stands_alone(page: str, study: Study) -> None:
    pages.check(page)
    scripts = attributes_of(page, "script")
    assert len(scripts) == 4  # sorting, the charts, the library, the page's own
    assert page.lower().count("</script") == len(scripts)
    assert page.count('class="chart"') == sum(len(part.charts) for part in study.report.parts)


def test_every_chart_is_stored_once_under_its_name(page: str, study: Study) -> None:
    stored = json.loads(page.partition('id="charts">')[2].partition("</script>")[0])
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


def test_the_truths_own_error_is_drawn_under_attitudes_alone(study: Study) -> None:
    for part in study.report.parts:
        for chart in part.charts:
            named = "the truth's own error" in json.dumps(chart.specification)
            assert named == (chart.title == "Attitude error")


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


def test_findings_have_the_measured_numbers(study: Study) -> None:
    naive = {o.quantity: o for o in study.orders if (o.case, o.integrator) == (FLIP, "rk4-naive")}
    for quantity in ("attitude", "position"):
        assert naive[quantity].order == pytest.approx(2, abs=0.1)  # at five time steps of a second of tumbling
        assert f"{naive[quantity].order:.2f}" in study.told("Order")
    assert "pinocchio rk4-naive has an observed order of " in study.told("Order")
    assert f"instead of the claimed 4, on {FLIP}." in study.told("Order")
    assert "mujoco" not in study.told("Order")

    euler = [o for o in study.orders if o.case == FLIP and o.scheme == "semi-implicit Euler"]
    assert {o.engine for o in euler} == {"mujoco", "pinocchio"}
    (sentence,) = [text for text in study.told("Scheme").splitlines() if " semi-implicit Euler to within " in text]
    coarsest = next(r for r in study.rows if (r["case"], r["integrator"], r["timestep"]) == (FLIP, "Euler", STEPS[0]))
    assert sentence.startswith("mujoco Euler and pinocchio semi-implicit-euler agree with semi-implicit Euler to within ")
    assert sentence.endswith(f"on {FLIP}. This explains a discrepancy of up to {number(coarsest['attitude_error'], 2)} rad.")
    residual = float(sentence.partition(" Euler to within ")[2].split()[0])
    largest = max(o.scheme_residual or 0.0 for o in euler)
    assert largest <= residual <= 1.1 * largest  # rounded up to two digits


def test_the_soft_contact_has_a_floor(study: Study) -> None:
    """A soft contact tends to another motion than a rigid one's, whatever the time step."""
    for sentence in study.told("Floor").splitlines():
        assert re.match(r"With mujoco .* the \w+ error does not fall below .* at any time step down to 1 ms, on ", sentence)
        assert sentence.endswith(f"{SLIDE}.")
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
            assert own in values
        for o in case.orders:
            if o.quantity in case.quantities and o.order is not None:
                assert any(o.order in line for line in values)


def test_markdown_says_the_same(study: Study) -> None:
    text = markdown.render_study(study.report)
    for finding in study.report.findings:
        assert markdown.escape(finding.text, len(finding.text)) in text
    for part in study.report.parts:
        assert f"<b>{part.title}</b>" in text
    for table in markdown_tables(text):
        assert len({len(re.findall(r"(?<!\\)\|", line)) for line in table}) == 1


def hostile_report() -> StudyReport:
    rows = [
        *curve(HOSTILE, [1e-1, 1e-2], [1e-3, 1e-2]),
        failed(engine="</script><script>alert(2)</script>", status=HOSTILE, reason="</dl>"),
        failed(status="unsupported", reason=HOSTILE),
    ]
    orders = [order(integrator=HOSTILE, scheme=HOSTILE, scheme_residual=1e-3, claimed=4, floor=1e-2)]
    return present(HEADER | {"missing": {"drake": HOSTILE}}, rows, orders)


def test_hostile_strings_show_as_text() -> None:
    report = hostile_report()
    text = html.render_study(report)
    pages.check(text)
    seen = Page(text)
    assert seen.text.count(HOSTILE) >= 6
    assert text.lower().count("</script") == len(attributes_of(text, "script")) == 4
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
    assert part.charts[1].notes == ("Errors of zero, which are not drawn, occur with mujoco Euler.",)
    assert part.texts == ("Runs with the status diverged have no results: mujoco RK4 at 5 ms and 1 ms.",)
    assert [line.label for line in part.lines] == ["mujoco Euler"]
    assert report.headline == "2 methods on 1 case: 5 runs, 2 of them without results"
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


errors = st.one_of(st.just(0.0), st.sampled_from([1e-3, 2e-3]), st.floats(1e-17, 10))
runs = st.lists(st.tuples(errors, st.sampled_from([1e-4, 2e-4, 5e-3, 1.0]) | st.floats(1e-6, 10)), min_size=1, max_size=12)


def front_of(measured: list[tuple[float, float]]) -> tuple[CaseMeasurements, list[tuple[float, float]]]:
    case = measurements(curve("Euler", *map(list, zip(*measured, strict=True))))
    return case, [(point.error, point.cost) for point in case.front("attitude")]


@given(runs)
def test_a_front_is_what_nothing_dominates(measured: list[tuple[float, float]]) -> None:
    case, front = front_of(measured)
    told = [(float(f"{max(error, case.truth_error('attitude')):.4g}"), cost) for error, cost in measured]

    def dominated(error: float, cost: float) -> bool:
        return any(e <= error and c <= cost and (e, c) != (error, cost) for e, c in told)

    assert set(front) == {run for run in told if not dominated(*run)}
    assert front == sorted(set(front), key=lambda run: run[1])


@settings(max_examples=20)
@given(runs.filter(lambda measured: any(error > 1e-14 for error, _ in measured)))
def test_rings_are_the_front(measured: list[tuple[float, float]]) -> None:
    """In the diagram Vega finds the front, so that it can leave out methods that are switched off."""
    measured = [(max(error, 1e-18), float(f"{cost:.6g}")) for error, cost in measured]  # nothing undrawn; costs as stored
    (part,) = present(HEADER, curve("Euler", *map(list, zip(*measured, strict=True))), []).parts
    chart = next(chart for chart in part.charts if chart.title == "Attitude error")
    alike = {(float(f"{max(error, 1e-14):.4g}"), cost) for error, cost in measured}
    if len(alike) == len(measured):
        assert drawn(chart.specification)[1] == len(front_of(measured)[1])


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ({}, False),
        ({"claimed": 2}, True),
        ({"claimed": 2, "order_high": 1.75}, False),
        ({"claimed": 2, "order_high": 1.7499}, True),
        ({"claimed": None}, False),
        ({"claimed": 2, "order": None, "order_low": None, "order_high": None}, False),
        ({"claimed": 2, "quantity": "energy"}, False),
        ({"claimed": 2, "integrator": "RK4"}, False),  # of which nothing was measured
    ],
)
def test_an_order_falls_short(values: Row, expected: bool) -> None:
    case = measurements(curve("Euler", [1e-1, 1e-2], [1e-3, 1e-2]))
    assert falls_short(case, order(**values)) == expected


def test_an_order_that_could_not_be_seen_does_not_fall_short() -> None:
    claimed = order(claimed=2)
    assert falls_short(measurements(curve("Euler", [3e-12, 1e-12], [1e-3, 1e-2])), claimed)
    assert not falls_short(measurements(curve("Euler", [3e-13, 1e-13], [1e-3, 1e-2])), claimed), "near the truth's own error"
    assert not falls_short(measurements(curve("Euler", [0.1 + 1e-13, 0.1], [1e-3, 1e-2])), claimed), "a floor, and rounding"
    assert not falls_short(measurements(curve("Euler", [1e-1, 1e-2], [1e-3, 1e-2], penetration=1e-4)), claimed), "in contact"


def test_methods_that_fall_short_alike_are_told_together() -> None:
    rows, orders = [], []
    for case in ("spin", "tumble"):
        for integrator in ("one", "two", "three"):
            rows += curve(integrator, [1e-1, 1e-2], [1e-3, 1e-2], case=case)
            observed = 2.0 if integrator != "three" else 1.5
            spread = {"order": observed, "order_low": observed, "order_high": observed, "claimed": 4}
            orders.append(order(case=case, integrator=integrator, **spread))
    assert texts(present(HEADER, rows, orders), "Order") == [
        "mujoco one and mujoco two have an observed order of 2.00 in attitude instead of the claimed 4, "
        "on spin and 1 other case.",
        "mujoco three has an observed order of 1.50 in attitude instead of the claimed 4, on spin and 1 other case.",
    ]


def test_orders_as_claimed() -> None:
    report = present(HEADER, curve("Euler", [1e-1, 1e-2], [1e-3, 1e-2]), [order(), order(quantity="position")])
    (sentence,) = texts(report, "Order")
    assert sentence == "None of 2 observed orders of attitude and position is lower than claimed by more than 0.25."
    assert report.parts[0].tables[0][1].failed == (False,)


@pytest.mark.parametrize(
    ("residual", "meaning"),
    [(2e-13, "This explains a discrepancy of 0.1 rad."), (0.02, "The discrepancy is 0.1 rad.")],
)
def test_a_scheme_explains_what_it_leaves_nothing_of(residual: float, meaning: str) -> None:
    rows = curve("Euler", [1e-1, 1e-2], [1e-3, 1e-2])
    report = present(HEADER, rows, [order(scheme="semi-implicit Euler", scheme_residual=residual)])
    (sentence,) = texts(report, "Scheme")
    assert sentence == (
        f"mujoco Euler agrees with semi-implicit Euler to within {number(residual)} rad over the whole run, on spin. {meaning}"
    )


def test_floors_above_rounding_are_told() -> None:
    rows = [*curve("Euler", [1e-1, 2.7e-4], [1e-3, 1e-2]), *curve("RK4", [1e-9, 1e-12], [1e-3, 1e-2])]
    orders = [order(floor=2.7e-4), order(integrator="RK4", floor=1e-12)]
    (sentence,) = texts(present(HEADER, rows, orders), "Floor")
    assert (
        sentence
        == "With mujoco Euler the attitude error does not fall below 0.00027 rad at any time step down to 5 ms, on spin."
    )


def test_the_cheapest_on_one_case() -> None:
    rows = [*curve("Euler", [1e-1, 1e-4], [1e-4, 1e-2]), *curve("RK4", [1e-4, 1e-7], [4e-4, 5e-3])]
    first, second = texts(present(HEADER, rows, []), "Cheapest")
    assert first == (
        "The cheapest method with an attitude error of at most 0.001 rad is mujoco RK4 at 10 ms on spin. "
        "Its error is 0.0001 rad, and a simulated second takes 0.0004 s (0.00036 to 0.00048 s in repeated timings). "
        "The next is mujoco Euler at 5 ms, at 25 times the cost."
    )
    assert "an attitude error of at most 1e-6 rad is mujoco RK4 at 5 ms on spin" in second
    rows = [*curve("Euler", [1e-7], [1e-3]), *curve("RK4", [1e-7], [1.1e-3])]
    (only,) = texts(present(HEADER, rows, []), "Cheapest")
    assert only.endswith("The next is mujoco RK4 at 10 ms, at 1.1 times the cost, although their timings overlap.")


def test_the_cheapest_on_many_cases() -> None:
    def best(case: str, integrator: str) -> Iterator[Row]:
        for name in ("Euler", "RK4"):
            yield from curve(name, [1e-4], [1e-3 if name == integrator else 1e-2], case=case)

    rows = [*best("a", "Euler"), *best("b", "RK4"), *best("c", "RK4"), row(case="d", attitude_error=1.0)]
    first, second = texts(present(HEADER, rows, []), "Cheapest")
    assert first == (
        "Over 4 cases, the cheapest method with an attitude error of at most 0.001 rad is mujoco RK4 in 2 (at 10 ms) and "
        "mujoco Euler in 1 (at 10 ms). In 1 no method achieves this."
    )
    assert second == "No method has an attitude error of at most 1e-6 rad in any of 4 cases."
    (only,) = texts(present(HEADER, [row(attitude_error=1.0)], []), "Cheapest")
    assert only == "No method has an attitude error of at most 0.001 rad."


def test_what_limits_the_study_is_said_first() -> None:
    rows = [row(), failed(engine="drake", status="unsupported", reason="it does not model drag")]
    report = present(HEADER | {"missing": {"dart": "dart is not installed"}}, rows, [])
    assert report.notices == (
        "The engine dart was not used: dart is not installed.",
        "1 run is not supported by the engine: it does not model drag.",
    )
    for text in (Page(html.render_study(report)).text, markdown.render_study(report)):
        assert "dart is not installed" in text
        assert "Runs with the status unsupported have no results: drake Euler at 10 ms." in text
