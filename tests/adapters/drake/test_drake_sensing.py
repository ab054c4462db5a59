"""Sensors in Drake: those of a continuous plant at the present state, and those of a discrete plant after a step."""

import numpy as np
import pytest

from bodycheck.adapters.contract import Method
from bodycheck.adapters.drake import engine as adapter
from tests.support.sensed_scenes import (
    BRICK_AT_START,
    GRAVITY,
    HOLDING,
    MASS,
    UNDRIVEN,
    WRENCH,
    after,
    differences,
    shipped,
    swung,
)

#: A hundred roundings of readings of some 10 to 100 units.
CLOSE = 1e-12


@pytest.mark.parametrize("spelling", ["runge_kutta3", "lagged:sensors=forward"])
def test_the_known_brick(spelling: str) -> None:
    case = shipped("brick")
    (imu, _, _), _ = after(adapter, case.scene, case.sensors, spelling, 0)
    assert imu == pytest.approx(BRICK_AT_START, abs=CLOSE)


@pytest.mark.parametrize("spelling", ["runge_kutta3", "runge_kutta3:accuracy=1e-6", "lagged", "lagged:sensors=forward"])
def test_at_rest_the_specific_force_points_upwards(spelling: str) -> None:
    case = shipped("rest")
    (imu, gyro, wrench, effort), _ = after(adapter, case.scene, case.sensors, spelling, 5)
    assert np.linalg.norm(imu) == pytest.approx(GRAVITY, abs=CLOSE)
    assert gyro == pytest.approx([0.0, 0.0, 0.0], abs=CLOSE)
    assert wrench == pytest.approx([0.0, 0.0, 2 * GRAVITY, 0.0, HOLDING, 0.0], abs=CLOSE)
    assert effort == pytest.approx([HOLDING], abs=CLOSE)


@pytest.mark.parametrize("spelling", ["runge_kutta3", "lagged:sensors=forward"])
def test_the_rod_of_a_pendulum_bears_three_times_the_weight(spelling: str) -> None:
    (wrench,), _ = after(adapter, swung(), (WRENCH,), spelling, 0)
    assert wrench == pytest.approx([0.0, 0.0, 3 * MASS * GRAVITY, 0.0, 0.0, 0.0], abs=10 * CLOSE)


@pytest.mark.parametrize("name", UNDRIVEN)
def test_readings_of_a_continuous_plant_are_those_of_the_present_state(name: str) -> None:
    """The states are those of unit quaternions, from which the quaternions of the plant may differ by 1e-9."""
    case = shipped(name)
    off = differences(adapter, case.scene, case.sensors, "runge_kutta3", 20)
    assert off == pytest.approx(dict.fromkeys(off, 0.0), abs=1e-9)


def test_ports_of_a_discrete_plant_keep_the_accelerations_of_its_last_step_and_no_velocities() -> None:
    case = shipped("brick")
    before, _ = after(adapter, case.scene, case.sensors, "lagged", 0)
    # The accelerations are zero, but the accelerometer adds w x (w x r), r = (0.1, 0.05, 0.02), of the present w = (1, 5, 1).
    assert before[0] == pytest.approx([-2.33, 0.5, GRAVITY - 0.17], abs=CLOSE)
    kept, _ = after(adapter, case.scene, case.sensors, "lagged", 11)
    present, _ = after(adapter, case.scene, case.sensors, "lagged:sensors=forward", 11)
    assert np.abs(kept[0] - present[0]).max() > 1e-3  # a step changes it by some 1e-2
    assert kept[1] == pytest.approx(present[1], abs=CLOSE)
    assert kept[2] == pytest.approx(present[2], abs=CLOSE)


def test_before_the_first_step_reactions_and_efforts_of_a_discrete_plant_are_zero() -> None:
    case = shipped("rest")
    (_, _, wrench, effort), _ = after(adapter, case.scene, case.sensors, "lagged", 0)
    assert not wrench.any()
    assert not effort.any()


def test_efforts_are_those_after_saturation_and_delay() -> None:
    case = shipped("driven-joint")
    (shoulder, elbow, _, _), _ = after(adapter, case.scene, case.sensors, "runge_kutta3", 0)
    assert shoulder == pytest.approx([-18.0])
    assert elbow == pytest.approx([-0.5])


def test_drake_has_no_contacts_where_nothing_touches() -> None:
    brick = shipped("brick").scene
    force = shipped("block-on-ramp").sensors[1]
    assert adapter.lacking(brick, force, Method.parse("lagged", 0.001)) == "has no contacts in the model of this scene"
