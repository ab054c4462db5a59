"""The tradeoff study with the real engines: orders, schemes, floors, costs and the Pareto front."""

import time
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bodycheck import Case, load
from bodycheck.adapters.contract import Method
from bodycheck.casefile.case import shipped
from bodycheck.errors import BadInput
from bodycheck.judging import judgement
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.results import csv_tables
from bodycheck.results.store import Results
from bodycheck.running import campaign
from bodycheck.studies import cost
from bodycheck.studies.cost import Stretch
from bodycheck.studies.orders import Order
from bodycheck.studies.timesteps import fastest_spin, fitted, ladder
from bodycheck.studies.tradeoff import study as tradeoff
from bodycheck.studies.tradeoff.measurements import measured, pareto
from bodycheck.studies.tradeoff.rows import BATCH_COLUMNS, COST_COLUMNS, ORDERS, RUNS
from tests.support import campaigns
from tests.support.campaigns import records
from tests.support.cases import shortened
from tests.support.processes import calls_here

ENGINES = records("mujoco", "pinocchio")
EULERS = [("mujoco", "Euler"), ("mujoco", "implicit"), ("mujoco", "implicitfast"), ("pinocchio", "semi-implicit-euler")]


def run(cases: list[Case], folder: Path, integrators: tuple[str, ...] = (), timesteps: tuple[float, ...] = ()) -> Results:
    return campaigns.results(tradeoff.plan(cases, ENGINES, integrators, timesteps), folder)


@pytest.fixture(scope="module", params=["osrf-boxes-complex", "intermediate-axis-flip"])
def orders(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> dict[tuple[str, str, str], Order]:
    # Half of the ten seconds, in which errors of first order leave their range at twice the step.
    case = shortened(load(request.param), 5.0, 501)
    results = run([case], tmp_path_factory.mktemp("ladder"), timesteps=tuple(step for step in ladder(case) if step >= 5e-4))
    found = tradeoff.orders(results, judgement.judge(results), ENGINES)
    return {(order.engine, order.integrator, order.quantity): order for order in found}


def test_orders_of_attitude(orders: dict[tuple[str, str, str], Order]) -> None:
    expected = dict.fromkeys(EULERS, (1, 0.1)) | {
        ("mujoco", "RK4"): (4, 0.2),
        ("pinocchio", "rk4"): (4, 0.2),
        ("pinocchio", "rk4-naive"): (2, 0.1),
    }
    for method, (order, tolerance) in expected.items():
        found = orders[*method, "attitude"]
        assert found.order == pytest.approx(order, abs=tolerance), method
        assert found.order_low is not None
        assert found.order_high is not None
        assert found.order_low <= found.order <= found.order_high
    # Of all these only one falls short of what is claimed of it.
    seen = [order for order in orders.values() if order.quantity == "attitude" and order.order is not None]
    assert [order.integrator for order in seen if order.order < (order.claimed or 0) - 0.5] == ["rk4-naive"]


def test_position_has_the_order_of_the_formulation(orders: dict[tuple[str, str, str], Order]) -> None:
    for method in EULERS:
        assert orders[*method, "position"].order == pytest.approx(1, abs=1e-3), "g h t / 2 exactly, but for rounding"
    assert orders["pinocchio", "rk4", "position"].order == pytest.approx(4, abs=0.05)
    exact = orders["mujoco", "RK4", "position"]
    assert exact.order is None, "Runge and Kutta's scheme integrates a parabola without error"
    assert exact.floor is not None
    assert exact.floor < 1e-10, "rounding of some hundred metres"


def test_schemes_are_named(orders: dict[tuple[str, str, str], Order]) -> None:
    named = {(engine, integrator): order.scheme for (engine, integrator, _), order in orders.items()}
    assert named["mujoco", "Euler"] == named["pinocchio", "semi-implicit-euler"] == "semi-implicit Euler"
    assert named["mujoco", "implicit"] == named["mujoco", "implicitfast"] == "linearly implicit Euler"
    assert named["mujoco", "RK4"] == "Runge-Kutta-Munthe-Kaas 4"
    assert named["pinocchio", "body-twist-euler"] == "semi-implicit Euler on the body twist"
    assert named["pinocchio", "rk4"] == "Runge-Kutta-Munthe-Kaas 4 on the body twist"
    assert named["pinocchio", "rk4-naive"].endswith("on the body twist")
    for order in orders.values():
        assert order.scheme_residual is not None
        assert order.scheme_residual < 1e-6  # rounding, which the flip makes grow


def test_a_soft_contact_has_a_floor_and_rigid_ones_have_an_order(tmp_path: Path) -> None:
    case, found = load("sliding-brick"), list[Order]()
    # A floor is seen where steps are small.
    for smallest, integrators in ((2e-5, ("Euler", "RK4")), (1e-4, ("admm", "law-force"))):
        steps = tuple(step for step in ladder(case) if step >= smallest)
        results = run([case], tmp_path / integrators[0], integrators, steps)
        found += tradeoff.orders(results, judgement.judge(results), ENGINES)
    orders = {(order.integrator, order.quantity): order for order in found}
    for integrator in ("Euler", "RK4"):
        soft = orders[integrator, "position"]
        assert soft.order is None, "what a contact does from step to step is no power of the step"
        # The way that the brick goes too far whatever the step, a quarter of a millimetre: docs/contacts.md.
        assert soft.floor == pytest.approx(2.5e-4, rel=0.15)
    for integrator in ("admm", "law-force"):
        rigid = orders[integrator, "position"]
        assert rigid.order == pytest.approx(1, abs=0.05)
        assert rigid.floor is None
    assert {order.scheme for order in found} == {""}


CASES = [("osrf-boxes-complex", "attitude"), ("free-brick", "energy"), ("spinning-brick-corners", "attitude")]


@pytest.fixture(scope="module")
def priced(tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[dict[str, object]]]:
    """Three cases on short ladders, with costs that are measured roughly: nothing that is said of them needs their digits."""
    cases = [load(name) for name, _ in CASES]
    results = run(cases, tmp_path_factory.mktemp("priced"), timesteps=(0.01, 0.002))
    verdicts = judgement.judge(results)
    with calls_here(), pytest.MonkeyPatch.context() as patch:
        patch.setattr(cost, "MIN_TIMING_S", cost.MIN_TIMING_S / 10)
        rows = tradeoff.price(results, verdicts, ENGINES)
    return {case.name: [row for row in rows if row["case"] == case.name] for case in cases}


def test_the_front_is_what_nothing_beats(priced: dict[str, list[dict[str, object]]]) -> None:
    for name, quantity in CASES:
        methods, front = measured(priced[name], quantity), pareto(priced[name], quantity)
        assert front
        for method in methods:
            beaten = any(other.error <= method.error and other.cost <= method.cost and other != method for other in methods)
            assert (method in front) != beaten or method.error == min(other.error for other in methods)


def test_what_is_not_ok_has_no_speed(calls_here: None, tmp_path: Path) -> None:
    # A hundred times the spin of the flip, at which the largest steps end in a reset.
    text = load("intermediate-axis-flip").text.partition("[[expect]]")[0]
    fast = text.replace("[0.0, 0.1, 10.0]", "[0.0, 1.0, 1000.0]").replace("duration = 10.0", "duration = 1.0")
    path = tmp_path / "fast.case.toml"
    path.write_text(fast)
    results = run([load(path)], tmp_path / "out", integrators=("Euler",), timesteps=(0.01, 1e-5))
    rows = tradeoff.price(results, judgement.judge(results), ENGINES)
    status = {row["timestep"]: row["status"] for row in rows}
    assert status == {0.01: "diverged", 1e-5: "ok"}
    for row in rows:
        speeds = [row[name] for name in ("time_per_step", "wall_time", "realtime_factor", "cost")]
        assert all(speed is not None for speed in speeds) == (row["status"] == "ok")
        assert any(speed is None for speed in speeds) == (row["status"] != "ok")
        assert (row["attitude_error"] is None) == (row["cost"] is None)


def test_a_timing_that_fails_leaves_no_speed_and_says_why(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    results = run([load("projectile")], tmp_path, integrators=("rk4",), timesteps=(0.01,))
    monkeypatch.setattr(campaign, "TIME_LIMIT_S", 1e-3)
    (row,) = tradeoff.price(results, judgement.judge(results), ENGINES)
    assert row["status"] == "ok"
    assert row["attitude_error"] is not None
    assert row["cost"] is row["time_per_step"] is None
    assert row["reason"] == "its cost could not be measured: stopped after 0.001 s"


def test_a_method_timed_twice_costs_the_same_within_the_spread(monkeypatch: pytest.MonkeyPatch) -> None:
    # Seconds of the processor, which do not go by while it does other things.
    monkeypatch.setattr(cost, "time", SimpleNamespace(perf_counter=time.thread_time, process_time=time.process_time))
    scene = load("osrf-boxes-complex").scene
    euler = Stretch(scene, "mujoco", Method.parse("Euler", 0.001), 10_000)
    rk4 = Stretch(scene, "pinocchio", Method.parse("rk4", 0.001), 10_000)
    with calls_here():
        measured = cost.measure([euler, rk4, euler], limit=60.0)
    assert all(isinstance(own, cost.Measured) for own in measured)
    once, other, twice = (cost.summarise(own.times) for own in measured if isinstance(own, cost.Measured))
    # The least and the most of nine turns each: that both medians lie outside of the other's has a chance below 1e-4.
    spread = max(once.high - once.low, twice.high - twice.low)
    assert abs(once.median - twice.median) < spread
    for found in (once, other, twice):
        assert found.low <= found.median <= found.high
    assert other.low > once.high, "four evaluations in Python against one in C"


def test_costs_are_told_with_the_error_they_came_with(priced: dict[str, list[dict[str, object]]], tmp_path: Path) -> None:
    rows = [row for own in priced.values() for row in own]
    csv_tables.write(tmp_path, RUNS, rows)
    csv_tables.write(tmp_path, ORDERS, [])
    table = pd.read_csv(tmp_path / "tradeoff.csv")
    assert tuple(table.columns[: len(judgement.COLUMNS)]) == judgement.COLUMNS
    assert tuple(table.columns[-len(COST_COLUMNS + BATCH_COLUMNS) :]) == COST_COLUMNS + BATCH_COLUMNS
    assert list(BATCH_COLUMNS[-3:]) == ["batch", "device", "precision"]
    assert table["batch"].isna().all(), "a run of one scene is no batch"
    assert set(table["device"]) == {"cpu"}
    assert set(table["precision"]) == {"float64"}
    ok = table[table["status"] == "ok"]
    assert ok["cost"].to_numpy() == pytest.approx(ok["time_per_step"] / ok["timestep"])
    assert (ok["time_per_step_low"] <= ok["time_per_step"]).all()
    assert (ok["time_per_step"] <= ok["time_per_step_high"]).all()
    assert set(ok[ok["integrator"].isin(["RK4", "rk4", "rk4-naive"])]["evaluations"]) == {4}
    assert list(pd.read_csv(tmp_path / "orders.csv").columns) == [
        *("case", "engine", "version", "integrator", "quantity", "order", "order_low", "order_high", "floor"),
        *("floor_cause", "horizon", "claimed"),
        *("scheme", "nearest_scheme", "scheme_residual"),
    ]


@pytest.mark.parametrize("name", shipped())
def test_a_ladder_fits_its_case(name: str) -> None:
    case = load(name)
    steps = np.array(ladder(case))
    interval = case.duration / (case.samples - 1)
    assert (np.diff(steps) < 0).all()
    assert len(steps) >= 6
    parts = np.where(steps < interval, interval / steps, steps / interval)
    assert parts == pytest.approx(np.rint(parts), rel=1e-9)
    assert fastest_spin(case.scene) * steps[0] <= 0.25 * 1.3  # the nearest that fits


@given(st.floats(1e-6, 1), st.floats(1e-5, 1))
def test_a_fitted_step_is_near_the_wanted_one(wanted: float, interval: float) -> None:
    step = fitted(wanted, interval)
    assert 0.6 < step / wanted < 1.6  # between one part and two, the worst that rounding to whole parts does is 3/2


def test_a_plan_that_cannot_be_run_is_refused() -> None:
    case = load("projectile")
    with pytest.raises(BadInput, match="no engine has an integrator 'Verlet'"):
        tradeoff.plan([case], ENGINES, ("Verlet",), ())
    with pytest.raises(BadInput, match="time step"):
        tradeoff.plan([case], ENGINES, (), (100.0,))
    with pytest.raises(BadInput, match="nothing to run"):
        tradeoff.plan([case], ENGINES, ("admm",), ())
    assert len(tradeoff.plan([case, load("sliding-brick")], ENGINES, ("admm",), (0.01, 0.001))) == 2


@pytest.mark.parametrize("name", ["driven-hinge-sampled", "driven-leg", "driven-slider-linear-targets"])
def test_the_steps_of_sampled_cases_divide_the_periods_of_their_controllers(name: str) -> None:
    case = load(name)
    assert isinstance(case.scene, Mechanism)
    steps, interval = np.array(ladder(case)), case.duration / (case.samples - 1)
    for rate in (each.rate for each in case.scene.controllers):
        assert rate is not None
        np.testing.assert_allclose(np.round(1 / rate / steps) * steps, 1 / rate, rtol=1e-10)  # steps have 12 digits
    np.testing.assert_allclose(np.round(interval / steps) * steps, interval, rtol=1e-10)
