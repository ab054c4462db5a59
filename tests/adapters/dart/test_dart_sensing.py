"""Sensors in DART: frames on bodies, forces in joints, and forces of contacts."""

import numpy as np
import pytest

from bodycheck.adapters import registry
from bodycheck.adapters.contract import Method, Sensing
from bodycheck.reference.kinematics import conjugate, rotate
from bodycheck.reference.scene import Body, Brick, Plane, Scene, State
from bodycheck.reference.sensors.sensor import Sensor
from tests.support.sensor_readings import readings, reasons

DART = registry.load("dart")
STEP, FORWARD = "semi-implicit-euler", "semi-implicit-euler:sensors=forward"
UP = np.array([0.0, 0.0, 9.81])


def test_at_rest_the_wrench_and_the_effort_are_right_and_the_acceleration_lacks_gravity() -> None:
    seen = readings(DART, "sensor-rest", STEP, 0.002, 3)
    for name in ("wrench", "effort", "gyro"):
        assert seen.given[name][1:] == pytest.approx(seen.expected[name][1:], abs=1e-12)  # rounding of 20 N
    assert np.linalg.norm(seen.given["imu"][1:], axis=1) == pytest.approx(np.zeros(3), abs=1e-12)
    assert np.linalg.norm(seen.expected["imu"], axis=1) == pytest.approx(np.full(4, 9.81))


def test_before_the_first_step_no_force_is_known() -> None:
    seen = readings(DART, "sensor-rest", STEP, 0.002, 0)
    assert not seen.given["wrench"].any()
    assert not seen.given["effort"].any()


def test_the_acceleration_of_a_brick_after_forward_dynamics_lacks_gravity_alone() -> None:
    seen = readings(DART, "sensor-brick", FORWARD, 0.002, 5)
    weight = rotate(conjugate(seen.quaternion[0]), np.broadcast_to(UP, (6, 3)))
    assert seen.given["imu"] + weight == pytest.approx(seen.expected["imu"], abs=1e-12)
    known = [-2.5159379845, 0.7909406456, 0.0323383085]
    assert seen.given["imu"][0] + UP == pytest.approx(known, abs=1e-9)  # the digits of the known values
    for name in ("gyro", "speed"):
        assert seen.given[name] == pytest.approx(seen.expected[name], abs=1e-12)


def test_a_sensor_has_its_own_axes() -> None:
    """The sensors at the rim are turned on the body."""
    seen = readings(DART, "sensor-constant-velocity", STEP, 0.002, 3)
    for name in ("centre", "rim", "gyro", "speed"):
        assert seen.given[name] == pytest.approx(seen.expected[name], abs=1e-12)


def test_a_wrench_after_a_step_is_that_of_the_start_of_the_step() -> None:
    seen = readings(DART, "sensor-fixed-tool", STEP, 0.002, 5)
    assert seen.given["flange"][1:] == pytest.approx(seen.expected["flange"][:-1], abs=1e-10)  # rounding of the solution
    assert np.abs(seen.given["flange"][1:] - seen.expected["flange"][1:]).max() > 1e-3


def test_a_wrench_after_forward_dynamics_is_that_of_the_present_state() -> None:
    for case, name in (("sensor-fixed-tool", "flange"), ("sensor-floating-arm", "wrench"), ("sensor-centrifuge", "wrench")):
        seen = readings(DART, case, FORWARD, 0.002, 5)
        assert seen.given[name] == pytest.approx(seen.expected[name], abs=1e-10)


def test_forward_dynamics_lacks_the_forces_of_contacts() -> None:
    assert all("constraints" in reason for reason in reasons(DART, "sensor-block-on-ramp", FORWARD).values())
    assert not any(reasons(DART, "sensor-block-on-ramp", STEP).values())


def test_a_block_that_slides_is_borne_and_braked() -> None:
    """The contacts are soft, and their friction is in a box along x and y: along x it is Coulomb's."""
    body = Body(2.0, (0.05 / 6, 0.05 / 6, 0.08 / 6), shape=Brick((0.1, 0.1, 0.05)))
    scene = Scene(body, State((0.0, 0.0, 0.05), velocity=(1.0, 0.0, 0.0)), 9.81, Plane(0.3))
    assert isinstance(DART, Sensing)
    sensing = DART.prepare_sensing(scene, (Sensor("contact", "contact_force"),), Method.parse(STEP, 0.001))
    sensing.simulation.advance(np.array([20]))
    assert sensing.read()[0] == pytest.approx(19.62 * np.array([-0.3, 0.0, 1.0]), abs=0.2)
