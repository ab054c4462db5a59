"""What Pinocchio computes for sensors: in the data that a step leaves, and by `rnea` at the present state."""

import numpy as np
import pytest

from bodycheck.adapters.contract import Method
from bodycheck.adapters.pinocchio import engine as adapter
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.sensors.sensor import Sensor, SensorType
from tests.support.coupled_joints import gripper
from tests.support.jointed import four_bar
from tests.support.sensed_scenes import BRICK_AT_START, GRAVITY, MASS, WRENCH, after, differences, shipped, swung

#: A hundred roundings of readings of some 10 to 100 units.
CLOSE = 1e-12

#: An accelerometer, a gyroscope and a velocimeter at one place of the first body.
MOUNTED: tuple[SensorType, ...] = ("accelerometer", "gyroscope", "velocimeter")
MOTION = tuple(Sensor(type, type, position=(0.1, -0.05, 0.02), attitude=(0.5, 0.5, -0.5, 0.5)) for type in MOUNTED)


@pytest.mark.parametrize("scheme", ["semi-implicit-euler", "body-twist-euler", "rk4"])
def test_the_known_brick(scheme: str) -> None:
    case = shipped("brick")
    (imu, _, _), _ = after(adapter, case.scene, case.sensors, f"{scheme}:sensors=forward", 0)
    assert imu == pytest.approx(BRICK_AT_START, abs=CLOSE)


def test_at_rest_the_specific_force_points_upwards() -> None:
    case = shipped("rest")
    sensors = case.sensors[:3]
    (imu, gyro, wrench), _ = after(adapter, case.scene, sensors, "rk4", 5)
    assert np.linalg.norm(imu) == pytest.approx(GRAVITY, abs=CLOSE)
    assert gyro == pytest.approx([0.0, 0.0, 0.0], abs=CLOSE)
    assert wrench == pytest.approx([0.0, 0.0, 2 * GRAVITY, 0.0, -4.905, 0.0], abs=CLOSE)


def test_the_rod_of_a_pendulum_bears_three_times_the_weight() -> None:
    (wrench,), _ = after(adapter, swung(), (WRENCH,), "rk4:sensors=forward", 0)
    assert wrench == pytest.approx([0.0, 0.0, 3 * MASS * GRAVITY, 0.0, 0.0, 0.0], abs=CLOSE)


@pytest.mark.parametrize(
    "name",
    ["brick", "constant-velocity", "free-fall", "centrifuge", "pendulum", "fixed-tool", "floating-arm", "three-link-wrench"],
)
@pytest.mark.parametrize("scheme", ["semi-implicit-euler", "rk4"])
def test_readings_after_rnea_are_those_of_the_present_state(name: str, scheme: str) -> None:
    case = shipped(name)
    off = differences(adapter, case.scene, case.sensors, f"{scheme}:sensors=forward", 20)
    assert off == pytest.approx(dict.fromkeys(off, 0.0), abs=10 * CLOSE)


@pytest.mark.parametrize("name", ["brick", "pendulum", "fixed-tool"])
def test_a_step_of_euler_leaves_the_readings_of_its_start(name: str) -> None:
    case = shipped(name)
    after_step, _ = after(adapter, case.scene, case.sensors, "semi-implicit-euler", 11)
    before, _ = after(adapter, case.scene, case.sensors, "semi-implicit-euler:sensors=forward", 10)
    for one, other in zip(after_step, before, strict=True):
        assert one == pytest.approx(other, abs=CLOSE)


def test_data_that_were_just_created_are_zero() -> None:
    case = shipped("pendulum")
    readings, _ = after(adapter, case.scene, case.sensors, "rk4", 0)
    assert not any(reading.any() for reading in readings)


@pytest.mark.parametrize("mechanism", [four_bar(), gripper()], ids=["four-bar", "gripper"])
def test_accelerations_of_coupled_joints(mechanism: Mechanism) -> None:
    off = differences(adapter, mechanism, MOTION, "rk4:sensors=forward", 20)
    assert off == pytest.approx(dict.fromkeys(off, 0.0), abs=1e-9)  # the accuracy of the constraints of a loop


def test_the_force_of_contacts_on_a_ramp() -> None:
    case = shipped("block-on-ramp")
    (force,), _ = after(adapter, case.scene, case.sensors[1:], "admm", 3)
    normal = GRAVITY * np.cos(0.5)  # the mass is 1 kg
    up, uphill = np.array([np.sin(0.5), 0.0, np.cos(0.5)]), np.array([-np.cos(0.5), 0.0, np.sin(0.5)])
    assert force == pytest.approx(normal * (up + 0.3 * uphill), abs=1e-8)  # the accuracy of the contact solver


def test_what_pinocchio_lacks() -> None:
    rest, ramp = shipped("rest"), shipped("block-on-ramp")
    step, forward, admm = (Method.parse(text, 0.001) for text in ("rk4", "rk4:sensors=forward", "admm"))
    assert "arguments of its functions" in (adapter.lacking(rest.scene, rest.sensors[3], step) or "")
    assert "only impulses" in (adapter.lacking(ramp.scene, ramp.sensors[0], admm) or "")
    assert "forward dynamics" in (adapter.lacking(gripper(), MOTION[0], step) or "")
    assert adapter.lacking(gripper(), MOTION[0], forward) is None
    assert "constraints of loops" in (adapter.lacking(four_bar(), WRENCH, forward) or "")
    assert "loops" in (adapter.lacking(four_bar(), MOTION[1], step) or "")
