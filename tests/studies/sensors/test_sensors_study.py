"""The study of sensors: what is run, and the lines of the sheet."""

from dataclasses import replace

import pytest

from bodycheck.adapters import registry
from bodycheck.casefile.case import load
from bodycheck.errors import BadInput
from bodycheck.judging.sensors.rows import SENSORS, SensorRow
from bodycheck.studies.sensors.rows import lines
from bodycheck.studies.sensors.study import plan

ROW = SensorRow(
    *("rest", "mujoco", "4.0.0", "Euler", 0.002, "imu", "accelerometer", 1.0, 0.1),
    *("+", "sensor", 1.0, "solver", "", 1e-12, 9.81),
)


def test_the_columns_are_those_of_the_rows() -> None:
    named = "case engine version integrator timestep sensor type error relative_error sign frame age_steps source note"
    assert [column.name for column in SENSORS.columns] == [*named.split(), "age_uncertainty", "reset_error"]


def test_each_method_is_run_after_a_step_and_after_the_forward_pass() -> None:
    tasks = plan([load("sensor-brick")], {"mujoco": registry.load("mujoco").engine}, (), ())
    assert [task.method.option("sensors") for task in tasks] == [None, "forward"]
    assert len({task.method.integrator for task in tasks}) == 1


def test_a_case_without_sensors_is_refused() -> None:
    with pytest.raises(BadInput, match="free-brick: has no sensors"):
        plan([load("free-brick")], {"mujoco": registry.load("mujoco").engine}, (), ())


def test_a_line_joins_scenes_and_names_those_of_notes() -> None:
    untold = replace(ROW, case="fall", frame="", age_steps=None, source="", note="the scene cannot tell the frame, the age")
    named = replace(ROW, case="brick", sign="-", note="without ω × v; the scene cannot tell the axes y", relative_error=0.5)
    (line,) = lines([ROW, untold, named])
    assert (line.read, line.sign, line.frame, line.age_steps, line.source) == ("step", "+, -", "sensor", "1", "solver")
    assert (line.error, line.note, line.scenes) == (0.5, "without ω × v (brick)", 3)


def test_readings_after_the_forward_pass_have_a_line_of_their_own() -> None:
    forward = replace(ROW, integrator="Euler:sensors=forward", age_steps=0.0)
    assert [(line.integrator, line.read, line.age_steps) for line in lines([ROW, forward])] == [
        ("Euler", "step", "1"),
        ("Euler", "forward", "0"),
    ]
