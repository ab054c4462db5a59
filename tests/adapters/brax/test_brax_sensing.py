"""What Brax has in its states for sensors: motions of links in the world, and forces of contacts at the start of a step."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck.adapters import registry
from bodycheck.adapters.contract import Method
from bodycheck.casefile.case import load
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.scene import Plane
from tests.support.sensor_readings import readings

BRAX = registry.load("brax")


def test_velocities_are_along_the_axes_of_the_world() -> None:
    seen = readings(BRAX, "sensor-brick", "generalized", 0.002, 3)
    for name in ("gyro", "speed"):
        along_world = rotate(seen.quaternion[0], seen.expected[name])
        assert seen.given[name] == pytest.approx(along_world, abs=1e-12)  # rounding of some 5 units


def test_a_plane_bears_the_weight() -> None:
    ramp = load("sensor-block-on-ramp")
    at_rest = replace(ramp.scene.initial, position=(0.0, 0.0, 0.05), quaternion=(1.0, 0.0, 0.0, 0.0))
    scene = replace(ramp.scene, plane=Plane(friction=0.3), initial=at_rest)
    (contact,) = (sensor for sensor in ramp.sensors if sensor.type == "contact_force")
    sensing = BRAX.prepare_sensing(scene, (contact,), Method.parse("generalized", 0.002))
    assert not sensing.read()[0].any()
    sensing.simulation.advance(np.array([500]))
    # The projected gradients of Brax's contacts leave a part of the force in steps of 2 ms.
    assert sensing.read()[0] == pytest.approx([0.0, 0.0, 9.81], rel=0.05, abs=0.1)


def test_what_brax_lacks() -> None:
    case, ramp = load("sensor-pendulum"), load("sensor-block-on-ramp")
    imu, _, _, wrench = case.sensors
    method = Method.parse("generalized", 0.002)
    assert BRAX.lacking(case.scene, imu, method) == "has no accelerations of links"
    assert BRAX.lacking(case.scene, wrench, method) == "has no wrenches of joints"
    assert "no forces of contacts" in BRAX.lacking(ramp.scene, ramp.sensors[1], Method.parse("spring", 0.002))
