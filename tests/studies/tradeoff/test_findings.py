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
from tests.support.wording import facts

EULER = "semi-implicit Euler"

#: What a sentence may name besides methods.
NAMES = (EULER, "attitude", "position", "spin", "limit", "rounding")
METHODS = ("mujoco Euler", "mujoco RK4")

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
    methods = ("mujoco one", "mujoco two", "mujoco three")
    told = [facts(text, *methods, *NAMES) for text in texts(present(HEADER, rows, orders), "Order")]
    assert told == [
        ["mujoco one", "mujoco two", "2.00", "attitude", "4", "spin", "1"],
        ["mujoco three", "1.50", "attitude", "4", "spin", "1"],
    ]


def test_orders_as_claimed() -> None:
    report = present(HEADER, curve("Euler", [1e-1, 1e-2], [1e-3, 1e-2]), [order(), order(quantity="position")])
    (sentence,) = texts(report, "Order")
    assert facts(sentence, "None", *METHODS, *NAMES) == ["None", "2", "attitude", "position", "0.25"]
    assert report.parts[0].tables[0][1].failed == (False,)


@pytest.mark.parametrize(
    ("residual", "explains"),
    [(2e-13, True), (0.02, False)],
)
def test_a_scheme_explains_what_it_leaves_nothing_of(residual: float, explains: bool) -> None:
    rows = curve("Euler", [1e-1, 1e-2], [1e-3, 1e-2])
    report = present(HEADER, rows, [order(scheme=EULER, nearest_scheme=EULER, scheme_residual=residual)])
    (sentence,) = texts(report, "Scheme")
    assert facts(sentence, *METHODS, *NAMES) == ["mujoco Euler", EULER, number(residual), "spin", "0.1"]
    assert ("agrees" in sentence, "explains" in sentence) == (True, explains)


def test_a_scheme_that_is_only_near_is_called_near() -> None:
    rows = [*curve("Euler", [1e-1, 1e-2], [1e-3, 1e-2]), *curve("RK4", [1e-1, 1e-2], [1e-3, 1e-2])]
    report = present(HEADER, rows, [order(nearest_scheme=EULER, scheme_residual=1e-4), order(integrator="RK4")])
    (sentence,) = texts(report, "Scheme")
    assert facts(sentence, *METHODS, *NAMES) == ["mujoco Euler", EULER, "0.0001", "spin", "0.1"]
    assert ("near" in sentence, "agrees" in sentence, "explains" in sentence) == (True, False, True)
    words = [[entry.text for entry in row[2:4]] for row in report.parts[0].tables[0][1].rows]
    assert words == [["near semi-implicit Euler", "0.0001"], ["not identified", "–"]]


def test_floors_above_rounding_are_told() -> None:
    rows = [*curve("Euler", [1e-1, 2.7e-4], [1e-3, 1e-2]), *curve("RK4", [1e-9, 1e-12], [1e-3, 1e-2])]
    orders = [order(floor=2.7e-4), order(integrator="RK4", floor=1e-12)]
    (sentence,) = texts(present(HEADER, rows, orders), "Floor")
    assert facts(sentence, *METHODS, *NAMES) == ["mujoco Euler", "attitude", "0.00027", "5", "spin"]
    assert "tend" not in sentence


@pytest.mark.parametrize(
    ("cause", "word"),
    [("limit", "tend"), ("rounding", "rounding")],
)
def test_the_cause_of_a_floor_is_told(cause: str, word: str) -> None:
    report = present(HEADER, curve("Euler", [1e-1, 2.7e-4], [1e-3, 1e-2]), [order(floor=2.7e-4, floor_cause=cause)])
    (sentence,) = texts(report, "Floor")
    assert facts(sentence, word, *METHODS, "spin") == ["mujoco Euler", "0.00027", "5", "spin", word]
    assert {"tend", "rounding"} & set(sentence.replace(",", " ").split()) == {word}
    assert f"0.00027 ({cause})" in [entry.text for entry in report.parts[0].tables[0][1].rows[0]]


def test_an_order_of_the_beginning_is_told_as_such() -> None:
    rows = curve("Euler", [3.1, 2.9], [1e-3, 1e-2])
    report = present(HEADER, rows, [order(horizon=2.5, floor=1e-3, floor_cause="limit")])
    assert facts(texts(report, "Order")[-1], *METHODS, *NAMES, "lost") == ["mujoco Euler", "attitude", "lost", "2.5", "spin"]
    assert texts(report, "Floor") == []
    assert "1.00 (0.98–1.02) in 2.5 s" in [entry.text for entry in report.parts[0].tables[0][1].rows[0]]


def test_the_cheapest_on_one_case() -> None:
    rows = [*curve("Euler", [1e-1, 1e-4], [1e-4, 1e-2]), *curve("RK4", [1e-4, 1e-7], [4e-4, 5e-3])]
    first, second = texts(present(HEADER, rows, []), "Cheapest")
    assert facts(first, *METHODS, *NAMES) == [
        *("attitude", "0.001", "mujoco RK4", "10", "spin"),
        *("0.0001", "0.0004", "0.00036", "0.00048"),
        *("mujoco Euler", "5", "25"),
    ]
    assert "overlap" not in first
    assert facts(second, *METHODS, *NAMES)[:5] == ["attitude", "1e-6", "mujoco RK4", "5", "spin"]
    rows = [*curve("Euler", [1e-7], [1e-3]), *curve("RK4", [1e-7], [1.1e-3])]
    (only,) = texts(present(HEADER, rows, []), "Cheapest")
    assert facts(only, *METHODS, "overlap")[-4:] == ["mujoco RK4", "10", "1.1", "overlap"]


def test_the_cheapest_on_many_cases() -> None:
    def best(case: str, integrator: str) -> Iterator[Row]:
        for name in ("Euler", "RK4"):
            yield from curve(name, [1e-4], [1e-3 if name == integrator else 1e-2], case=case)

    rows = [*best("a", "Euler"), *best("b", "RK4"), *best("c", "RK4"), row(case="d", attitude_error=1.0)]
    first, second = texts(present(HEADER, rows, []), "Cheapest")
    names = ("attitude", "no method", "No method", *METHODS)
    assert facts(first, *names) == [
        *("attitude", "0.001", "mujoco RK4", "10", "2", "4", "mujoco Euler", "10", "1"),
        *("1", "no method"),
    ]
    assert facts(second, *names) == ["No method", "attitude", "1e-6", "4"]
    (only,) = texts(present(HEADER, [row(attitude_error=1.0)], []), "Cheapest")
    assert facts(only, *names) == ["No method", "attitude", "0.001"]


def test_what_limits_the_study_is_said_first() -> None:
    rows = [row(), failed(engine="drake", status="unsupported", reason="it does not model drag")]
    report = present(HEADER | {"missing": {"dart": "dart is not installed"}}, rows, [])
    missing, refused = report.notices
    assert "dart is not installed" in missing
    assert facts(refused, "Without results", "drake", "it does not model drag") == [
        "Without results",
        "drake",
        "it does not model drag",
    ]
    for text in (Page(html.render_study(report)).text, markdown.render_study(report)):
        assert "dart is not installed" in text
        assert facts(text.partition("unsupported")[2], "drake Euler")[:2] == ["drake Euler", "10"]


def test_costs_are_compared_only_where_efforts_are_computed_in_the_same_way() -> None:
    staged = [one | {"efforts": "at stages"} for one in curve("RK4", [1e-3, 1e-5], [2e-2, 4e-2])]
    between = [one | {"efforts": "between steps"} for one in curve("Euler", [1e-2, 1e-3], [1e-2, 3e-2])]
    apart = measurements([*staged, *between])
    assert [(point.integrator, point.cost) for point in apart.front("attitude")] == [
        ("Euler", 1e-2),
        ("RK4", 2e-2),
        ("Euler", 3e-2),
        ("RK4", 4e-2),
    ]
    (told,) = texts(present(HEADER, [*staged, *between], []), "Cheapest")
    assert told.startswith("Costs of methods that compute efforts between steps and at stages are not compared")
    alike = measurements([one | {"efforts": "between steps"} for one in [*staged, *between]])
    assert [point.cost for point in alike.front("attitude")] == [1e-2, 2e-2, 4e-2]
