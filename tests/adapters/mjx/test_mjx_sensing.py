"""MJX's sensors: of the last evaluation of accelerations, and zero for forces if a model can have no constraint."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck.adapters import registry
from bodycheck.adapters.contract import Method
from bodycheck.casefile.case import load
from bodycheck.reference.scene import Plane
from tests.support.sensor_readings import readings

MJX = registry.load("mjx")
CLOSE = 1e-12  # a hundred roundings of readings of some 10 units


def test_a_brick_in_flight_reads_its_velocities_one_step_late_and_no_acceleration() -> None:
    """MJX computes sensors of accelerations only in a model that can have a constraint."""
    seen = readings(MJX, "sensor-brick", "Euler", 0.002, 3)
    for name in ("gyro", "speed"):
        assert seen.given[name][1:] == pytest.approx(seen.expected[name][:-1], abs=CLOSE)
    assert not seen.given["imu"].any()
    assert np.abs(seen.expected["imu"]).max() > 1


def test_on_a_plane_the_accelerometer_reads_the_weight() -> None:
    ramp = load("sensor-block-on-ramp")
    at_rest = replace(ramp.scene.initial, position=(0.0, 0.0, 0.05), quaternion=(1.0, 0.0, 0.0, 0.0))
    scene = replace(ramp.scene, plane=Plane(friction=0.3), initial=at_rest)
    imu, contact = ramp.sensors
    method = Method.parse("Euler:sensors=forward", 0.002)
    assert "net force" in MJX.lacking(scene, contact, method)
    sensing = MJX.prepare_sensing(scene, (imu,), method)
    sensing.simulation.advance(np.array([1000]))
    assert sensing.read()[0] == pytest.approx([0.0, 0.0, 9.81], abs=1e-3)  # what is left of the settling of soft contacts
