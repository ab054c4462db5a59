"""The command `bodycheck truth` for cases with sensors."""

import json
from pathlib import Path

import numpy as np
import pytest

from bodycheck.casefile.case import load
from tests.support.commands import bodycheck

#: The brick whose reading at t = 0 is known, with an accelerometer beside its centre of mass.
BRICK = """
format = 1
name = "felt"
title = "A brick in flight"

[body]
shape = "none"
mass = 1.0
inertia = [0.0134, 0.0105, 0.0043]

[initial]
angular_velocity = [1.0, 5.0, 1.0]

[scene]
gravity = 9.81

[run]
duration = 0.2
samples = 3

[[sensors]]
name = "imu"
type = "accelerometer"
position = [0.1, 0.05, 0.02]
"""

GYRO = """
[[sensors]]
name = "gyro"
type = "gyroscope"

[[sensors]]
name = "felt"
type = "accelerometer"
"""


def test_readings_and_bounds_are_in_the_json(tmp_path: Path) -> None:
    file = tmp_path / "felt.case.toml"
    file.write_text(BRICK, "utf-8")
    printed = json.loads(bodycheck("truth", file, "--json").stdout)
    (rows,), (bounds,) = (list(printed[key].values()) for key in ("sensors", "sensor_bounds"))
    assert list(printed["sensors"]) == list(printed["sensor_bounds"]) == ["imu"]
    assert np.shape(rows) == np.shape(bounds) == (3, 3)
    assert np.abs(np.subtract(rows[0], (-2.5159379844961242, 0.7909406456091635, 0.0323383084577115))).max() < 1e-13
    assert printed["sensors_not_modelled"] == {}


@pytest.mark.slow
def test_readings_at_an_instant_are_those_of_the_whole_truth(tmp_path: Path) -> None:
    file = tmp_path / "felt.case.toml"
    file.write_text(BRICK, "utf-8")
    rows = json.loads(bodycheck("truth", file, "--json").stdout)["sensors"]["imu"]
    assert rows[1] == pytest.approx(
        json.loads(bodycheck("truth", file, "--at", 0.1, "--json").stdout)["sensors"]["imu"][0], abs=1e-13
    )


def test_a_sensor_has_a_line_with_its_largest_reading_or_the_reason(tmp_path: Path) -> None:
    file = tmp_path / "rod.case.toml"
    file.write_text(load("falling-rod").text + GYRO, "utf-8")
    printed = bodycheck("truth", file, "--at", 0.1)
    assert printed.returncode == 0
    assert "sensor gyro: at most " in printed.stdout
    assert " rad/s, error at most " in printed.stdout
    assert "sensor felt: not modelled: accelerations and forces of such a motion of bodies that touch" in printed.stdout


@pytest.mark.slow
def test_a_sensor_without_a_truth_is_named_in_the_json(tmp_path: Path) -> None:
    file = tmp_path / "rod.case.toml"
    file.write_text(load("falling-rod").text + GYRO, "utf-8")
    told = json.loads(bodycheck("truth", file, "--at", 0.1, "--json").stdout)
    assert list(told["sensors"]) == ["gyro"]
    assert list(told["sensors_not_modelled"]) == ["felt"]
