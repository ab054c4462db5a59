"""MuJoCo's sensors: their age after a step, their delay, and motors that exert what applied forces exert without sensors."""

import numpy as np
import pytest

from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import Method
from bodycheck.adapters.mujoco import sensing
from bodycheck.casefile.case import load
from bodycheck.casefile.content import Case
from bodycheck.reference.sensors.readings import Sensed
from bodycheck.results.outcome import Completed
from bodycheck.running.sensing import WINDOW
from bodycheck.running.simulation import run

STEP = 0.002


def readings(case: Case, spelling: str) -> Sensed:
    """Return the readings of a run."""
    done = run(case, "mujoco", Method.parse(spelling, STEP)).outcome
    assert isinstance(done, Completed)
    assert done.sensed is not None
    return done.sensed


@pytest.mark.parametrize("integrator", ["Euler", "RK4", "implicit", "implicitfast", "discrete"])
@pytest.mark.parametrize("name", ["sensor-brick", "sensor-pendulum"])
def test_after_a_step_sensors_are_those_of_its_start(name: str, integrator: str) -> None:
    if integrator not in {each.name for each in registry.load("mujoco").engine.integrators if each.kinds}:
        pytest.skip("this release has no such integrator")
    case = load(name)
    stepped, forward = readings(case, integrator), readings(case, f"{integrator}:sensors=forward")
    for after_step, present in zip(stepped.stepwise, forward.stepwise, strict=True):
        assert not after_step[0].any()  # nothing is computed by a reset
        # The pass computes the same from the same numbers; only the order of sums in a step of the solver may differ.
        np.testing.assert_allclose(after_step[1:], present[:-1], rtol=1e-12, atol=1e-12)


@pytest.mark.skipif(not sensing.OPTIONS, reason="this release has no delay of sensors")
def test_the_delay_and_the_interval_of_sensors_are_in_steps() -> None:
    case = load("sensor-pendulum")
    plain, late, rare = (readings(case, f"Euler{option}") for option in ("", ":sensordelay=2", ":sensorinterval=3"))
    for present, delayed, held in zip(plain.stepwise, late.stepwise, rare.stepwise, strict=True):
        np.testing.assert_array_equal(delayed[3:], present[1:-2])
        np.testing.assert_array_equal(held[1:61], np.repeat(present[1:61:3], 3, axis=0))


def test_motors_exert_the_efforts_that_applied_forces_exert_without_sensors() -> None:
    case = load("sensor-driven-joint")
    method = Method.parse("RK4", STEP)
    plain = offers.prepare(registry.load("mujoco"), [case.scene], method).advance(np.ones(WINDOW, dtype=np.int64))
    window = readings(case, "RK4").window
    # The same numbers are added in another order.
    np.testing.assert_allclose(window.position[:, 1:], plain[0].swapaxes(0, 1)[..., :3], rtol=0, atol=1e-13)


def test_effort_sensors_read_the_sampled_law_at_its_instants() -> None:
    case = load("sensor-driven-joint")
    stepped, forward = readings(case, "RK4"), readings(case, "RK4:sensors=forward")
    elbow = [sensor.name for sensor in case.sensors].index("elbow-effort")
    steps = round(1 / (100 * STEP))
    (jumps,) = np.nonzero(np.diff(forward.stepwise[elbow][:, 0]))
    assert ((jumps + 1) % steps == 0).all()  # the effort of an instant acts from this instant on
    (late,) = np.nonzero(np.diff(stepped.stepwise[elbow][1:, 0]))
    assert ((late + 1) % steps == 0).all()  # the same step, as readings after a step are one step old


def test_sensors_that_a_model_lacks_are_named() -> None:
    case = load("sensor-three-link-wrench")
    reason = sensing.lacking(case.scene, case.sensors[0], Method.parse("Euler:model=free-bodies", STEP))
    assert reason == "has no joint yaw in the model free-bodies"
    assert sensing.lacking(case.scene, case.sensors[0], Method.parse("Euler", STEP)) is None


def test_the_contact_sensor_sums_normal_and_friction_forces() -> None:
    case = load("sensor-rolling-ball")
    touch = readings(case, "Euler:sensors=forward").readings[2]
    settled = touch[len(touch) // 2 :]
    # The plane bears the weight less what accelerates the ball down the ramp.
    pull = 9.81 * np.sin(0.2) * 5 / 7
    expected = np.array([pull * np.cos(0.2), 0.0, 9.81 - pull * np.sin(0.2)])
    np.testing.assert_allclose(settled, np.tile(expected, (len(settled), 1)), atol=0.02)  # the contact is soft
