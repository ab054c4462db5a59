"""What Rapier reports as sensors: velocities in the world, impulses of joints, and impulses of contacts without friction."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck.adapters import registry
from bodycheck.adapters.contract import Method
from bodycheck.casefile.case import load
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.mechanisms.exact import nearest_turn
from bodycheck.reference.scene import Plane
from tests.support.sensor_readings import readings

RAPIER = registry.load("rapier")

#: A hundred roundings of single precision of readings of some 10 units.
CLOSE = 1e-4


@pytest.mark.parametrize("case", ["sensor-brick", "sensor-constant-velocity"])
def test_velocities_are_along_the_axes_of_the_world(case: str) -> None:
    seen = readings(RAPIER, case, "symplectic-euler", 0.002, 3)
    turns = {sensor.name: np.array(nearest_turn(sensor.attitude)) for sensor in load(case).sensors}
    for name in ("gyro", "speed"):
        along_body = rotate(turns[name], seen.expected[name])
        assert seen.given[name] == pytest.approx(rotate(seen.quaternion[0], along_body), abs=CLOSE)


@pytest.mark.parametrize(("method", "part"), [("symplectic-euler", 1.0), ("symplectic-euler:settings=engine", 0.25)])
def test_a_joint_reports_the_force_of_the_child_in_the_last_substep(method: str, part: float) -> None:
    """The vertical force of the hub bears the arm's weight; with Rapier's own settings, a step has four substeps."""
    seen = readings(RAPIER, "sensor-centrifuge", method, 0.002, 3)
    assert seen.expected["wrench"][:, 2] == pytest.approx(np.full(4, 3 * 9.81), abs=CLOSE)
    assert seen.given["wrench"][1:, 2] == pytest.approx(np.full(3, -part * 3 * 9.81), abs=10 * CLOSE)


def test_a_contact_bears_the_weight_and_does_not_report_friction() -> None:
    ramp = load("sensor-block-on-ramp")
    moving = replace(ramp.scene.initial, position=(0.0, 0.0, 0.05), quaternion=(1.0, 0.0, 0.0, 0.0), velocity=(1.0, 0.0, 0.0))
    scene = replace(ramp.scene, plane=Plane(friction=0.3), initial=moving)
    (contact,) = (sensor for sensor in ramp.sensors if sensor.type == "contact_force")
    method = Method.parse("symplectic-euler", 0.002)
    sensing = RAPIER.prepare_sensing(scene, (contact,), method)
    states = sensing.simulation.advance(np.array([100, 100]))
    assert states[0, 1, 0, 7] < 0.8  # friction brakes the brick
    (force,) = sensing.read()
    assert force == pytest.approx([0.0, 0.0, 9.81], abs=1e-2)  # the accuracy of Rapier's iterations


def test_what_rapier_lacks() -> None:
    case = load("sensor-rest")
    imu, _, _, effort = case.sensors
    method = Method.parse("symplectic-euler", 0.002)
    assert RAPIER.lacking(case.scene, imu, method) == "has no accelerations of bodies"
    assert RAPIER.lacking(case.scene, effort, method) == "has no efforts in joints"
