"""Sensors in Simbody: OpenSim's IMU, and the reactions of its joints along the axes of the ground."""

import numpy as np
import pytest

from bodycheck.adapters.contract import Method
from bodycheck.adapters.simbody import engine as adapter
from bodycheck.reference.bodies import of_bodies
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.sensors.expected import expected
from bodycheck.reference.sensors.sensor import Sensor
from tests.support.driven_hinge import PD, hinge
from tests.support.sensed_scenes import BRICK_AT_START, GRAVITY, HOLDING, MASS, WRENCH, after, differences, shipped, swung

#: A hundred roundings of readings of some 10 to 100 units.
CLOSE = 1e-12


@pytest.mark.parametrize("spelling", ["RungeKuttaMerson", "Verlet:settings=engine"])
def test_the_known_brick(spelling: str) -> None:
    case = shipped("brick")
    (imu, _, _), _ = after(adapter, case.scene, case.sensors, spelling, 0)
    assert imu == pytest.approx(BRICK_AT_START, abs=CLOSE)


@pytest.mark.parametrize("spelling", ["RungeKuttaMerson", "RungeKuttaMerson:accuracy=1e-6"])
def test_at_rest_the_specific_force_points_upwards(spelling: str) -> None:
    case = shipped("rest")
    (imu, gyro, wrench, effort), _ = after(adapter, case.scene, case.sensors, spelling, 5)
    assert np.linalg.norm(imu) == pytest.approx(GRAVITY, abs=CLOSE)
    assert gyro == pytest.approx([0.0, 0.0, 0.0], abs=CLOSE)
    assert wrench == pytest.approx([0.0, 0.0, 2 * GRAVITY, 0.0, HOLDING, 0.0], abs=CLOSE)
    assert effort == pytest.approx([HOLDING], abs=CLOSE)


def test_the_rod_of_a_pendulum_bears_three_times_the_weight() -> None:
    (wrench,), _ = after(adapter, swung(), (WRENCH,), "RungeKuttaMerson", 0)
    assert wrench == pytest.approx([0.0, 0.0, 3 * MASS * GRAVITY, 0.0, 0.0, 0.0], abs=10 * CLOSE)


@pytest.mark.parametrize("name", ["brick", "constant-velocity", "free-fall", "centrifuge", "fixed-tool", "floating-arm"])
def test_motions_are_those_of_the_present_state(name: str) -> None:
    """Simbody lets the norm of a quaternion drift, here by some 1e-12."""
    case = shipped(name)
    mounted = tuple(sensor for sensor in case.sensors if sensor.form.mounted)
    off = differences(adapter, case.scene, mounted, "RungeKuttaMerson", 20)
    assert off == pytest.approx(dict.fromkeys(off, 0.0), abs=1e-10)


@pytest.mark.parametrize("name", ["centrifuge", "fixed-tool", "floating-arm"])
def test_reactions_are_along_the_axes_of_the_ground(name: str) -> None:
    case = shipped(name)
    sensors = tuple(sensor for sensor in case.sensors if sensor.type == "force_torque")
    (wrench,), states = after(adapter, case.scene, sensors, "RungeKuttaMerson", 20)
    (wanted,) = expected(case.scene, sensors, states)
    turn = of_bodies(states).quaternion[sensors[0].body]
    turned = np.concatenate([rotate(turn, wanted[:, :3]), rotate(turn, wanted[:, 3:])], axis=1)[0]
    assert wrench == pytest.approx(turned, abs=1e-10)
    assert np.abs(wrench - wanted[0]).max() > 0.1


def test_an_effort_is_that_of_the_actuator() -> None:
    effort = Sensor("effort", "joint_effort", 0, 0)
    (reading,), _ = after(adapter, hinge(PD), (effort,), "RungeKuttaMerson", 0)
    assert reading == pytest.approx([PD.kp * PD.target])


def test_what_opensim_lacks() -> None:
    method = Method.parse("Verlet", 0.001)
    brick, force = shipped("brick").scene, shipped("block-on-ramp").sensors[1]
    assert adapter.lacking(brick, force, method) == "has no contacts in the model of this scene"
    effort = Sensor("effort", "joint_effort", 0, 0)
    assert adapter.lacking(swung(), effort, method) == "has no force on the coordinate of the joint pin"
