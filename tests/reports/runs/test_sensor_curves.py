"""The curves of sensors over time in a report: those of the truth, and of runs where the difference is seen."""

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
import vl_convert

from bodycheck.adapters.contract import Method
from bodycheck.casefile.case import load
from bodycheck.figures.sensors import true_readings
from bodycheck.reference.sensors.readings import Sensed
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truths import NoTruth, Truth
from bodycheck.reports.runs.charts import sensor_curves, time_charts
from bodycheck.reports.runs.charts.joint_curves import MOST_RUNS, SEEN, TRUTH
from bodycheck.results.outcome import Completed, Run
from bodycheck.running.truths import truth

#: The sensors of a brick that spins: its accelerometer, its gyroscope, and its velocimeter.
SENSORS = load("sensor-brick").sensors

#: The most instants of a curve.
MOST = 60


@cache
def exact() -> tuple[Truth, tuple[Array, ...]]:
    computed = truth(load("sensor-brick"))
    known = true_readings(computed, SENSORS)
    assert not isinstance(known, NoTruth)
    return computed, tuple(each.values for each in known)


def ran(*readings: Array) -> tuple[Run, Truth]:
    """Return a run with these readings of the sensors, whose motion is that of the truth, and the truth at its instants."""
    at = exact()[0]
    sensed = Sensed(("",) * len(readings), readings, at.trajectory, readings)
    outcome = Completed(at.trajectory, 100, 1.0, readings=sensed)
    return Run("sensor-brick", "planted", "1.0", Method("rk4", 0.02), outcome), at


def curves(**runs: tuple[Run, Truth]) -> list[dict[str, Any]]:
    return sensor_curves.rows(SENSORS, exact()[0], runs, MOST)


def test_the_truth_has_a_curve_of_each_component() -> None:
    rows = curves()
    assert [(row["sensor"], row["component"], row["method"]) for row in rows] == [
        (number, axis, TRUTH) for number in range(3) for axis in "xyz"
    ]
    t, columns = exact()[0].trajectory.t, np.concatenate([values.T for values in exact()[1]])
    for row, values in zip(rows, columns, strict=True):
        assert len(row["t"]) <= MOST
        # The instants that are left out lie on the lines between the others, to a part of the range.
        assert np.interp(t, row["t"], row["value"]) == pytest.approx(values, abs=0.05 * np.ptp(values))


def test_a_run_has_curves_of_the_sensors_that_are_seen_to_differ() -> None:
    acceleration, rate, speed = exact()[1]
    late = np.vstack([speed[:1], speed[:-1]])
    rows = curves(same=ran(acceleration, rate, speed), late=ran(acceleration, rate * (1 + 0.1 * SEEN), late))
    assert {(row["sensor"], row["method"]) for row in rows if row["method"] != TRUTH} == {(2, "late")}
    described = sensor_curves.described(rows, SENSORS)
    assert described[1] == ("gyro, gyroscope, rad/s", "Readings over time: gyro, gyroscope, rad/s.", ())
    assert described[2][2] == ("Dashed: late, where the difference is seen.",)


def test_the_reading_after_a_reset_is_not_drawn() -> None:
    """It is zero in many engines, and would hide the rest of the curve."""
    values = [np.vstack([np.full((1, 3), 1e6), each[1:]]) for each in exact()[1]]
    assert all(row["method"] == TRUTH for row in curves(reset=ran(*values)))


def test_readings_that_are_no_numbers_are_left_out() -> None:
    acceleration, rate, speed = exact()[1]
    nothing = np.full_like(acceleration, np.nan)
    half = np.where(np.arange(len(rate))[:, None] < 50, rate + 1.0, np.nan)
    rows = [row for row in curves(lost=ran(nothing, half, speed)) if row["method"] == "lost"]
    assert [(row["sensor"], row["component"]) for row in rows] == [(1, "x"), (1, "y"), (1, "z")]
    assert max(rows[0]["t"]) == pytest.approx(exact()[0].trajectory.t[49])


def test_a_run_without_readings_has_no_curve() -> None:
    run, at = ran(*exact()[1])
    assert isinstance(run.outcome, Completed)
    silent = replace(run, outcome=replace(run.outcome, readings=None))
    assert all(row["method"] == TRUTH for row in curves(silent=(silent, at)))


def test_a_chart_has_few_runs() -> None:
    beside = [values + 1.0 for values in exact()[1]]
    rows = curves(**{f"run-{number}": ran(*beside) for number in range(MOST_RUNS + 2)})
    assert {row["method"] for row in rows} == {TRUTH, *(f"run-{number}" for number in range(MOST_RUNS))}


def test_a_wrench_has_a_chart_of_its_force_and_one_of_its_moment() -> None:
    wrenches = [Sensor(f"wrench {number}", "force_torque", 0, 0) for number in range(sensor_curves.MOST_CHARTS)]
    charts = sensor_curves.charts([*wrenches, Sensor("effort", "joint_effort", 0, 0)])
    assert len(charts) == sensor_curves.MOST_CHARTS
    assert [(chart.title, chart.names) for chart in charts[:2]] == [
        ("wrench 0.force, force_torque, N", ("fx", "fy", "fz")),
        ("wrench 0.moment, force_torque, N m", ("tx", "ty", "tz")),
    ]
    (effort,) = sensor_curves.charts([Sensor("effort", "joint_effort", 0, 0)])
    assert effort.names == ("value",)


def test_charts_draw_each_curve() -> None:
    acceleration, rate, speed = exact()[1]
    rows = curves(beside=ran(acceleration, rate + 1.0, speed))
    svg = vl_convert.vegalite_to_svg(time_charts.readings(1) | {"datasets": {"sensors": rows}})
    assert svg.count('stroke-dasharray="5,4"') == 3
