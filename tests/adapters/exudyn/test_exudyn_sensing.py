"""Sensors in Exudyn: of bodies, of links of trees, and of joints between bodies."""

import numpy as np
import pytest

from bodycheck.adapters import registry
from bodycheck.casefile.case import load
from bodycheck.reference.kinematics import conjugate, multiply, rotate
from bodycheck.reference.mechanisms.exact import nearest_turn
from tests.support.sensor_readings import readings, reasons

EXUDYN = registry.load("exudyn")
UP = np.array([0.0, 0.0, 9.81])


@pytest.mark.parametrize("spelling", ["RK44", "GeneralizedAlpha", "GeneralizedAlpha:formulation=EP"])
def test_the_acceleration_of_a_brick_lacks_gravity_alone(spelling: str) -> None:
    """The tolerance is that of Exudyn's own Newton iterations: accelerations of 10 m/s^2 to some 1e-6."""
    seen = readings(EXUDYN, "sensor-brick", spelling, 0.002, 5)
    weight = rotate(conjugate(seen.quaternion[0]), np.broadcast_to(UP, (6, 3)))
    assert (seen.given["imu"] + weight)[1:] == pytest.approx(seen.expected["imu"][1:], abs=1e-4)
    for name in ("gyro", "speed"):
        assert seen.given[name] == pytest.approx(seen.expected[name], abs=1e-12)


def test_an_explicit_solver_has_no_acceleration_before_the_first_step() -> None:
    """What is there are the centripetal accelerations of the initial velocity alone."""
    seen = readings(EXUDYN, "sensor-brick", "RK44", 0.002, 0)
    spin, arm = np.array([1.0, 5.0, 1.0]), np.array([0.1, 0.05, 0.02])
    assert seen.given["imu"][0] == pytest.approx(np.cross(spin, np.cross(spin, arm)), abs=1e-12)


def test_sensors_of_links_are_along_the_axes_of_the_body() -> None:
    case = load("sensor-centrifuge")
    imu = case.sensors[0]
    seen = readings(EXUDYN, "sensor-centrifuge", "RK44", 0.002, 5)
    own = conjugate(np.array(nearest_turn(imu.attitude)))
    assert rotate(own, seen.given["gyro"]) == pytest.approx(seen.expected["gyro"], abs=1e-12)
    weight = np.broadcast_to(UP, (6, 3))  # the arm turns about the vertical
    assert rotate(own, seen.given["imu"] + weight)[1:] == pytest.approx(seen.expected["imu"][1:], abs=1e-12)


def test_the_force_of_a_joint_is_that_on_the_parent_along_the_axes_of_the_parent() -> None:
    """Without numerical damping the multipliers of `GeneralizedAlpha` alternate from step to step, so that it is on here."""
    seen = readings(EXUDYN, "sensor-floating-arm", "GeneralizedAlpha:settings=engine", 0.001, 20)
    base, arm = seen.quaternion
    on_child = rotate(multiply(conjugate(base), arm), seen.expected["wrench"][:, :3])
    # The multipliers are those of the scheme, which differ by its error of second order.
    assert seen.given["wrench"][:, :3] == pytest.approx(-on_child, abs=0.01)


def test_trees_have_no_wrenches_and_no_joint_has_a_sensor_of_efforts() -> None:
    why = reasons(EXUDYN, "sensor-rest", "RK44")
    assert not why["imu"]
    assert "kinematic trees" in why["wrench"]
    assert "efforts" in why["effort"]
