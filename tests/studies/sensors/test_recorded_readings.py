"""Readings of sensors in CSV files of strangers: errors, conventions, and faults."""

import csv
import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from bodycheck.casefile.case import MAX_FAULTS, load
from bodycheck.casefile.content import Case
from bodycheck.errors import BadInput, Failed
from bodycheck.judging.sensors.rows import SensorRow
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.sensors.truth import sensor_truth
from bodycheck.reference.trajectory import Array
from bodycheck.running.truths import truth
from bodycheck.studies.sensors import recorded

#: The time step (s) of the recorded engine.
STEP = 0.002


@cache
def brick() -> Case:
    case = load("sensor-brick")
    return replace(case, duration=0.1, samples=11)


@cache
def exact() -> tuple[Array, tuple[Array, ...]]:
    """The instants and the true readings at them."""
    times = np.asarray(np.arange(31) * STEP, dtype=np.float64)
    return times, tuple(each.values for each in sensor_truth(truth(brick(), times), brick().sensors))


def written(path: Path, columns: dict[str, Array]) -> Path:
    lines = [",".join(columns), *(",".join(map(repr, row)) for row in np.column_stack(list(columns.values())).tolist())]
    path.write_text("\n".join(lines) + "\n", "utf-8")
    return path


def columns_of(*readings: Array) -> dict[str, Array]:
    """Return the columns of readings of the first sensors of the case."""
    named = {"t": exact()[0][: len(readings[0])]}
    for sensor, values in zip(brick().sensors, readings, strict=False):
        named |= dict(zip(sensor.columns, values.T, strict=True))
    return named


def rows(path: Path, timestep: float | None) -> list[SensorRow]:
    answer = recorded.evaluated(recorded.read(path, brick(), "isaac", "5.0", timestep)[0])
    assert isinstance(answer, list)
    return answer


def test_exact_readings_have_no_error(tmp_path: Path) -> None:
    file = written(tmp_path / "a.csv", columns_of(*exact()[1]))
    found = rows(file, STEP)
    assert [(row.engine, row.version, row.integrator, row.sign, row.age_steps) for row in found] == [
        ("isaac", "5.0", "recorded", "+", 0.0)
    ] * 3
    # The same truth at the same instants.
    assert all(row.error is not None and row.error < 1e-13 and row.source == "solver" for row in found)


def test_readings_of_the_step_before_need_the_time_step_for_their_age(tmp_path: Path) -> None:
    late = [np.vstack([values[:1], values[:-1]]) for values in exact()[1]]
    file = written(tmp_path / "a.csv", columns_of(*late))
    assert [row.age_steps for row in rows(file, STEP)] == [1.0, 1.0, 1.0]
    assert [(row.age_steps, row.source) for row in rows(file, None)] == [(None, "")] * 3


def test_a_sensor_without_columns_is_left_out_and_its_sign_is_found(tmp_path: Path) -> None:
    file = written(tmp_path / "a.csv", columns_of(-exact()[1][0]))
    (row,) = rows(file, STEP)
    assert (row.sensor, row.sign, row.age_steps) == ("imu", "-", 0.0)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("t,imu.x,imu.y\n0,1,2\n0.1,1,2\n", ":1: lacks the columns imu.z of the sensor imu"),
        ("t,imu.x,imu.y,imu.w\n0,1,2,3\n0.1,1,2,3\n", ":1: read the column 'imu.w'; allowed: t, imu.x"),
        ("t,imu.x,imu.y,imu.z,extra\n0,1,2,3,4\n0.1,1,2,3,4\n", ":1: read the column 'extra'; allowed: t, imu.x"),
        ("t\n0\n0.1\n", ":1: has no readings; allowed: t, imu.x"),
        ("t,imu.x,imu.y,imu.z\n0,1,2,nan\n0.1,1,2,3\n", ":2: imu.z: read 'nan'; allowed: a finite number"),
        ("t,imu.x,imu.y,imu.z\n0,1,2\n", ":2: has 3 values; allowed: 4"),
        ("imu.x,imu.y,imu.z\n1,2,3\n", ":1: read 'imu.x, imu.y, imu.z'; allowed: different names of columns, among them t"),
        ("t,imu.x,imu.y,imu.z\n0.1,1,2,3\n0,1,2,3\n", ":3: t: read 0; allowed: ascending numbers"),
    ],
)
def test_a_fault_of_a_file_has_its_line(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "a.csv").write_text(text, "utf-8")
    with pytest.raises(BadInput, match=re.escape(f"{tmp_path / 'a.csv'}{message}")):
        rows(tmp_path / "a.csv", STEP)


def test_too_many_instants_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(recorded, "MAX_INSTANTS", allowed := 30)
    count = allowed + 1
    times = np.linspace(0, 0.1, count)
    file = written(tmp_path / "a.csv", {"t": times, **{f"imu.{axis}": times for axis in "xyz"}})
    with pytest.raises(BadInput, match=f"has {count} instants; allowed: at most {allowed}"):
        rows(file, STEP)


def test_a_case_without_sensors_is_refused(tmp_path: Path) -> None:
    file = written(tmp_path / "a.csv", columns_of(*exact()[1]))
    with pytest.raises(BadInput, match="has no sensors"):
        recorded.rows(file, replace(brick(), sensors=()), "isaac", "5.0", None)


def test_all_faults_of_a_file_are_reported_at_once(tmp_path: Path) -> None:
    file = tmp_path / "a.csv"
    file.write_text("t,imu.x,imu.y,imu.w\n0,1,2\n0.1,1,two,inf\n", "utf-8")
    with pytest.raises(BadInput) as refused:
        rows(file, STEP)
    begun = [line.removeprefix(f"{file}:").partition("; ")[0] for line in str(refused.value).splitlines()]
    assert begun == [
        "1: read the column 'imu.w'",
        "1: lacks the columns imu.z of the sensor imu",
        "2: has 3 values",
        "3: imu.y: read 'two'",
        "3: imu.w: read 'inf'",
    ]


def test_a_file_with_too_many_faults_is_not_read_to_its_end(tmp_path: Path) -> None:
    file = tmp_path / "a.csv"
    file.write_text("t,imu.x,imu.y,imu.z\n" + "0,1,2,x\n" * 10_000, "utf-8")
    with pytest.raises(BadInput, match=r"has more faults$") as refused:
        rows(file, STEP)
    assert len(str(refused.value).splitlines()) == MAX_FAULTS + 1


def test_the_evaluation_has_a_time_limit(tmp_path: Path) -> None:
    """A new process needs longer than a millisecond to begin."""
    file = written(tmp_path / "a.csv", columns_of(*exact()[1]))
    with pytest.raises(Failed, match=r"longer than the limit of 0\.001 s"):
        recorded.rows(file, brick(), "isaac", "5.0", None, limit=1e-3)


@pytest.mark.parametrize("name", ["t", "gyro.x"])
def test_sensors_whose_columns_have_the_same_names_are_refused(tmp_path: Path, name: str) -> None:
    file = written(tmp_path / "a.csv", columns_of(*exact()[1]))
    number = Sensor(name, "joint_effort", joint=0)
    with pytest.raises(BadInput, match=f"two columns of readings would have the name {re.escape(name)};"):
        recorded.read(file, replace(brick(), sensors=(*brick().sensors, number)), "isaac", "5.0", None)


def test_sensors_may_have_any_printable_names(tmp_path: Path) -> None:
    names = ["a,b", 'a"b', "=cmd()", "<script>alert(1)</script>", " ", "имя", "../../x", "y" * 100]
    case = replace(brick(), sensors=tuple(replace(brick().sensors[1], name=name) for name in names))
    times, (_, rates, _) = exact()
    columns = [column for sensor in case.sensors for column in sensor.columns]
    with (tmp_path / "a.csv").open("w", encoding="utf-8", newline="") as opened:
        csv.writer(opened).writerows([("t", *columns), *np.column_stack([times, *[rates] * len(names)]).tolist()])
    rows_of_all = recorded.evaluated(recorded.read(tmp_path / "a.csv", case, "isaac", "5.0", None)[0])
    assert isinstance(rows_of_all, list)
    assert [row.sensor for row in rows_of_all] == names
    assert all(row.error is not None and row.error < 1e-13 for row in rows_of_all)  # rounding
