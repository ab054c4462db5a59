"""MuJoCo Warp's sensors: one step old after a step, and of the present state after its forward pass."""

import numpy as np
import pytest

from bodycheck.adapters import registry
from tests.support.sensor_readings import readings

WARP = registry.load("mujoco_warp")

#: A hundred roundings of single precision of readings of some 5 units.
CLOSE = 5e-5


def test_the_known_brick_and_the_age_of_its_readings() -> None:
    after_step = readings(WARP, "sensor-brick", "Euler", 0.002, 4)
    present = readings(WARP, "sensor-brick", "Euler:sensors=forward", 0.002, 4)
    known = [-2.5159379844961242, 0.7909406456091635, 0.0323383084577115]
    assert present.given["imu"][0] == pytest.approx(known, abs=CLOSE)
    for name in ("imu", "gyro", "speed"):
        assert present.given[name] == pytest.approx(present.expected[name], abs=CLOSE)
        assert after_step.given[name][1:] == pytest.approx(after_step.expected[name][:-1], abs=CLOSE)
        assert np.abs(after_step.given[name][1:] - after_step.expected[name][1:]).max() > 50 * CLOSE


def test_at_rest() -> None:
    """The wrench bears the weight, the effort holds the arm, and the specific force points upwards."""
    seen = readings(WARP, "sensor-rest", "Euler", 0.002, 2)
    assert np.linalg.norm(seen.given["imu"][1:], axis=1) == pytest.approx(np.full(2, 9.81), abs=CLOSE)
    for name in ("wrench", "effort"):
        assert seen.given[name][1:] == pytest.approx(seen.expected[name][1:], abs=CLOSE)


def test_the_wrench_of_a_pendulum() -> None:
    seen = readings(WARP, "sensor-pendulum", "Euler:sensors=forward", 0.002, 20)
    assert seen.given["wrench"] == pytest.approx(seen.expected["wrench"], abs=CLOSE)
