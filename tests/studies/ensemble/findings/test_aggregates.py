"""Counts, quantiles and tails of made ensembles, against what is known of them."""

from pathlib import Path

import numpy as np
import pytest

from bodycheck.studies.ensemble.findings.aggregates import BROKEN, aggregate
from tests.support.ensembles import EULER, RK4, EngineMethod, made

MEMBERS = 1000


@pytest.fixture(scope="module")
def errors() -> tuple[np.ndarray, np.ndarray]:
    """The errors of two methods, of which the second is better in most members; ten runs of the first have none."""
    random = np.random.default_rng(5)
    first, second = random.lognormal(-7, 2, MEMBERS), random.lognormal(-12, 2, MEMBERS)
    first[::100] = np.nan
    return first, second


def test_quantiles_the_worst_member_and_the_failures(tmp_path: Path, errors: tuple[np.ndarray, np.ndarray]) -> None:
    first, second = errors
    status = np.where(np.isnan(first), "diverged", "ok").tolist()
    passed = [False if place % 100 in (0, 1) else None for place in range(MEMBERS)]
    runs = {
        EULER: {"attitude_error": first, "status": status, "passed": passed, "reason": status},
        RK4: {"attitude_error": second, "wall_time": np.full(MEMBERS, 2e-6)},
    }
    found = aggregate(made(tmp_path, {"body.mass": np.ones(MEMBERS)}, runs))
    euler, rk4 = found.rows()
    for row, values in ((euler, first[~np.isnan(first)]), (rk4, second)):
        assert (row.case, row.members, row.figure) == ("spin", MEMBERS, "attitude_error")
        wanted = np.quantile(values, [0.05, 0.5, 0.95, 0.99])
        assert (row.q05, row.q50, row.q95, row.q99) == tuple(wanted)
        assert row.max == values.max()
    assert euler.worst_member == int(np.nanargmax(first))
    assert (euler.failed, rk4.failed) == (0.02, 0.0)
    assert euler.failed_low <= 0.02 <= euler.failed_high
    assert (rk4.failed_low, rk4.failed_high) == (0.0, 3 / MEMBERS)
    ways = {way.name: way for way in found.methods[0].ways}
    assert {name: (way.count, way.first) for name, way in ways.items()} == {"diverged": (10, 0), BROKEN: (10, 1)}
    assert found.methods[1].wall_time == pytest.approx(2e-6 * MEMBERS)
    assert found.ranked == [1, 0]


def test_the_best_method_of_each_member(tmp_path: Path, errors: tuple[np.ndarray, np.ndarray]) -> None:
    first, second = errors
    runs = {EULER: {"attitude_error": first}, RK4: {"attitude_error": second}}
    figure = aggregate(made(tmp_path, {"body.mass": np.ones(MEMBERS)}, runs)).figures["attitude_error"]
    wins = np.mean(np.isnan(first) | (second < first))
    assert figure.best == pytest.approx({0: 1 - wins, 1: wins})


def test_tails_count_the_members_without_a_value(tmp_path: Path, errors: tuple[np.ndarray, np.ndarray]) -> None:
    first, _ = errors
    status = np.where(np.isnan(first), "diverged", "ok").tolist()
    runs = {EULER: {"attitude_error": first, "status": status}}
    figure = aggregate(made(tmp_path, {"body.mass": np.ones(MEMBERS)}, runs)).figures["attitude_error"]
    own = figure.distributions[0]
    values, shares = own.tail
    assert values[-1] == np.nanmax(first)
    for value, share in zip(values, shares, strict=True):
        assert share == np.mean(np.isnan(first) | (first >= value))
    assert own.histogram.sum() == own.count == MEMBERS - 10
    assert own.intervals["q50"][0] < own.quantiles["q50"] < own.intervals["q50"][1]


def test_members_that_an_engine_does_not_support_are_no_failures(tmp_path: Path) -> None:
    refused = {"status": ["unsupported"] * 40, "reason": ["other 1 does not model drag"] * 40}
    runs = {EULER: {"attitude_error": np.ones(40)}, EngineMethod("other", "1", "step", 0.002): refused}
    found = aggregate(made(tmp_path, {"body.mass": np.ones(40)}, runs))
    assert [row.engine for row in found.rows()] == ["mujoco"]
    assert found.methods[1].unsupported == "other 1 does not model drag"
    assert found.ranked == [0]


def test_a_method_without_any_figure_has_a_row_of_its_failures(tmp_path: Path) -> None:
    found = aggregate(made(tmp_path, {"body.mass": np.ones(40)}, {EULER: {"status": ["crashed"] * 40}}))
    (row,) = found.rows()
    assert (row.failed, row.failed_low, row.figure, row.max, row.worst_member) == (1.0, 1 - 3 / 40, "", None, None)


def test_values_of_zero_and_infinity(tmp_path: Path) -> None:
    values = np.array([0.0, 1.0, np.inf] + [2.0] * 61)
    figure = aggregate(made(tmp_path, {"body.mass": np.ones(64)}, {EULER: {"energy_drift": values}})).figures["energy_drift"]
    own = figure.distributions[0]
    assert (own.zeros, own.largest, own.worst, own.quantiles["q50"]) == (1, np.inf, 2, 2.0)
    assert own.histogram.sum() == 62
