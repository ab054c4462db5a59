"""What the tradeoff study says first of measured rows: fronts, orders, schemes, floors and the cheapest methods."""

from collections.abc import Iterator

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bodycheck.reports import html, markdown
from bodycheck.reports.quantities import number
from bodycheck.studies.tradeoff.findings import falls_short
from bodycheck.studies.tradeoff.measurements import CaseMeasurements
from bodycheck.studies.tradeoff.page import present
from tests.support.pages import Page
from tests.support.tradeoff_rows import HEADER, Row, curve, drawn, failed, measurements, order, row, texts

EULER = "semi-implicit Euler"

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
    report = present(HEADER, rows, [order(scheme=EULER, nearest_scheme=EULER, scheme_residual=residual)])
    (sentence,) = texts(report, "Scheme")
    assert sentence == (
        f"mujoco Euler agrees with semi-implicit Euler to within {number(residual)} rad over the whole run, on spin. {meaning}"
    )


def test_a_scheme_that_is_only_near_is_called_near() -> None:
    rows = [*curve("Euler", [1e-1, 1e-2], [1e-3, 1e-2]), *curve("RK4", [1e-1, 1e-2], [1e-3, 1e-2])]
    report = present(HEADER, rows, [order(nearest_scheme=EULER, scheme_residual=1e-4), order(integrator="RK4")])
    (sentence,) = texts(report, "Scheme")
    assert sentence == (
        "mujoco Euler is near semi-implicit Euler to within 0.0001 rad over the whole run, on spin. "
        "This explains a discrepancy of 0.1 rad."
    )
    words = [[entry.text for entry in row[2:4]] for row in report.parts[0].tables[0][1].rows]
    assert words == [["near semi-implicit Euler", "0.0001"], ["not identified", "–"]]


def test_floors_above_rounding_are_told() -> None:
    rows = [*curve("Euler", [1e-1, 2.7e-4], [1e-3, 1e-2]), *curve("RK4", [1e-9, 1e-12], [1e-3, 1e-2])]
    orders = [order(floor=2.7e-4), order(integrator="RK4", floor=1e-12)]
    (sentence,) = texts(present(HEADER, rows, orders), "Floor")
    assert (
        sentence
        == "With mujoco Euler the attitude error does not fall below 0.00027 rad at any time step down to 5 ms, on spin."
    )


@pytest.mark.parametrize(
    ("cause", "words"),
    [("limit", ", to which its runs tend"), ("rounding", ", because of rounding in the engine's precision")],
)
def test_the_cause_of_a_floor_is_told(cause: str, words: str) -> None:
    report = present(HEADER, curve("Euler", [1e-1, 2.7e-4], [1e-3, 1e-2]), [order(floor=2.7e-4, floor_cause=cause)])
    (sentence,) = texts(report, "Floor")
    assert sentence.endswith(f"does not fall below 0.00027 rad at any time step down to 5 ms{words}, on spin.")
    assert f"0.00027 ({cause})" in [entry.text for entry in report.parts[0].tables[0][1].rows[0]]


def test_an_order_of_the_beginning_is_told_as_such() -> None:
    rows = curve("Euler", [3.1, 2.9], [1e-3, 1e-2])
    report = present(HEADER, rows, [order(horizon=2.5, floor=1e-3, floor_cause="limit")])
    assert texts(report, "Order")[-1] == (
        "With mujoco Euler the attitude is lost by the end at any time step; "
        "the order is that of the first 2.5 s of the same runs, on spin."
    )
    assert texts(report, "Floor") == []
    assert "1.00 (0.98–1.02) in 2.5 s" in [entry.text for entry in report.parts[0].tables[0][1].rows[0]]


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
        "Without results: by drake (it does not model drag).",
    )
    for text in (Page(html.render_study(report)).text, markdown.render_study(report)):
        assert "dart is not installed" in text
        assert "Runs with the status unsupported have no results: drake Euler at 10 ms." in text
