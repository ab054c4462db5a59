"""Sensors in PyBullet: force and torque sensors of joints, and forces of contacts."""

import numpy as np
import pytest

from bodycheck.adapters import registry
from bodycheck.adapters.contract import Method, Sensing
from bodycheck.adapters.pybullet.engine import jointed
from bodycheck.casefile.case import load
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.scene import Body, Brick, Plane, Scene, State
from bodycheck.reference.sensors.sensor import Sensor
from tests.support.sensor_readings import readings, reasons

PYBULLET = registry.load("pybullet")


def test_the_wrench_at_rest_is_that_of_the_weight() -> None:
    """PyBullet balances the effort to rounding, so that the arm stays where it is."""
    seen = readings(PYBULLET, "sensor-rest", "multibody", 0.002, 3)
    assert not seen.given["wrench"][0].any()  # before the first step there is none
    # The weight is 2 kg x 9.81 m/s^2, and acts 0.25 m beside the joint.
    assert np.linalg.norm(seen.given["wrench"][1:, :3], axis=1) == pytest.approx(np.full(3, 19.62), abs=1e-9)
    assert np.linalg.norm(seen.given["wrench"][1:, 3:], axis=1) == pytest.approx(np.full(3, 4.905), abs=1e-9)


def test_the_wrench_is_along_the_principal_axes_of_the_child() -> None:
    """The force on the arm of a centrifuge is horizontal and its weight, which are known along the body's axes."""
    scene = load("sensor-centrifuge").scene
    assert isinstance(scene, Mechanism)
    seen = readings(PYBULLET, "sensor-centrifuge", "multibody", 0.0005, 5)
    given, exactly = seen.given["wrench"][2:, :3], seen.expected["wrench"][2:, :3]
    assert np.abs(given - exactly).max() > 1.0  # N, of 48 N
    _, _, (arm,) = jointed(scene, Method.parse("multibody", 0.0005))
    # Steps of 0.5 ms turn the arm by 2.5 mrad, and the readings are of the start of a step.
    assert rotate(arm.axes, given) == pytest.approx(exactly, abs=5e-3 * 48)


@pytest.mark.parametrize("integrator", ["maximal", "multibody"])
def test_the_friction_in_the_list_of_contacts_has_the_sign_of_the_force_on_the_plane(integrator: str) -> None:
    body = Body(2.0, (0.05 / 6, 0.05 / 6, 0.08 / 6), shape=Brick((0.1, 0.1, 0.05)))
    scene = Scene(body, State((0.0, 0.0, 0.05), velocity=(1.0, 0.5, 0.0)), 9.81, Plane(0.3))
    method, sensor = Method.parse(integrator, 0.001), Sensor("contact", "contact_force")
    assert isinstance(PYBULLET, Sensing)
    sensing = PYBULLET.prepare_sensing(scene, (sensor,), method)
    sensing.simulation.advance(np.array([20]))
    (force,) = sensing.read()
    weight = scene.body.mass * 9.81
    # The contacts are soft, and the plane is held by 50 iterations.
    assert force[2] == pytest.approx(weight, rel=1e-3)
    assert force[:2] == pytest.approx(0.3 * weight * np.array([1.0, 0.5]) / np.hypot(1.0, 0.5), rel=1e-2)


def test_what_pybullet_has_as_states_is_lacking() -> None:
    why = reasons(PYBULLET, "sensor-rest", "multibody")
    assert not why.pop("wrench")
    assert all(why.values())
