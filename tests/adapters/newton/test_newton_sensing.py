"""Newton's sensors and observables: its IMU, wrenches about the centre of mass in the world, and forces of contacts."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck.adapters import registry
from bodycheck.adapters.contract import Method
from bodycheck.casefile.case import load
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.scene import Plane
from tests.support.sensor_readings import readings

NEWTON = registry.load("newton")

#: A hundred roundings of single precision of readings of some 20 units.
CLOSE = 2e-4


def test_at_rest() -> None:
    """The effort holds the weight about the shoulder, and about the centre of mass there is no moment."""
    seen = readings(NEWTON, "sensor-rest", "MuJoCo-euler", 0.002, 3)
    assert np.linalg.norm(seen.given["imu"][1:], axis=1) == pytest.approx(np.full(3, 9.81), abs=CLOSE)
    assert seen.given["wrench"][1:] == pytest.approx(np.tile([0.0, 0.0, 19.62, 0.0, 0.0, 0.0], (3, 1)), abs=CLOSE)


def test_the_imu_of_the_known_brick() -> None:
    seen = readings(NEWTON, "sensor-brick", "MuJoCo-euler", 1e-4, 3)
    known = [-2.5159379844961242, 0.7909406456091635, 0.0323383084577115]
    # The acceleration is that of the start of the step, and the angular velocity that of its end: 5 rad/s, for 0.1 ms.
    assert seen.given["imu"][1] == pytest.approx(known, abs=5e-3)
    assert seen.given["gyro"] == pytest.approx(seen.expected["gyro"], abs=CLOSE)
    assert seen.given["speed"] == pytest.approx(rotate(seen.quaternion[0], seen.expected["speed"]), abs=CLOSE)


@pytest.mark.parametrize("spelling", ["MuJoCo-euler", "XPBD", "Steel"])
def test_a_contact_bears_the_weight(spelling: str) -> None:
    ramp = load("sensor-block-on-ramp")
    at_rest = replace(ramp.scene.initial, position=(0.0, 0.0, 0.05), quaternion=(1.0, 0.0, 0.0, 0.0))
    scene = replace(ramp.scene, plane=Plane(friction=0.3), initial=at_rest)
    (contact,) = (sensor for sensor in ramp.sensors if sensor.type == "contact_force")
    sensing = NEWTON.prepare_sensing(scene, (contact,), Method.parse(spelling, 0.002))
    sensing.simulation.advance(np.array([500]))
    assert sensing.read()[0] == pytest.approx([0.0, 0.0, 9.81], abs=0.1)  # soft contacts, and iterations of solvers


def test_what_solvers_lack() -> None:
    brick, rest = load("sensor-brick"), load("sensor-rest")
    method = Method.parse("Featherstone", 0.002)
    assert "no observable of accelerations" in NEWTON.lacking(brick.scene, brick.sensors[0], method)
    assert NEWTON.lacking(brick.scene, brick.sensors[1], method) is None
    assert "efforts" in NEWTON.lacking(rest.scene, rest.sensors[3], method)
