"""Readings of sensors beside a run: when they are read, how they are stored, and what is refused."""

import shutil
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest

from bodycheck.adapters import registry
from bodycheck.adapters.contract import Method, SceneUnsupported, SensingSimulation
from bodycheck.casefile.case import load, parse
from bodycheck.casefile.content import Case
from bodycheck.errors import BadFolder
from bodycheck.judging.comparison import compare
from bodycheck.judging.judgement import judge
from bodycheck.reference.mechanisms.mechanism import AnyScene
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truth import truth
from bodycheck.results import sensor_files, store
from bodycheck.results.outcome import AdapterFault, Completed
from bodycheck.running.sensing import WINDOW, sensed
from bodycheck.running.simulation import run
from bodycheck.running.tasks import Task
from tests.support import campaigns

METHOD = Method.parse("RK4", 0.002)
FORWARD = Method.parse("RK4:sensors=forward", 0.002)
EXPECT = '[[expect]]\nengine = "mujoco"\nintegrator = "{}"\ntimestep = 0.002\n{}\n'


def fall(more: str = "") -> Case:
    """Return the case of a falling brick with three sensors, with another end of its text."""
    text = load("sensor-free-fall").text.partition("[[expect]]")[0]
    return parse(text.replace("samples = 51", "samples = 6") + more, "fall")


def completed(case: Case, method: Method) -> Completed:
    """Return the outcome of a run of MuJoCo."""
    outcome = run(case, "mujoco", method).outcome
    assert isinstance(outcome, Completed), outcome
    return outcome


@dataclass
class Reading:
    """An adapter that reads sensors of MuJoCo's simulations in its own way."""

    read: Any
    reason: str = ""
    asked: list[str] = field(default_factory=list)

    engine = registry.load("mujoco").engine

    def prepare(self, scenes: Sequence[AnyScene], method: Method) -> Any:
        """Return MuJoCo's simulation."""
        return registry.load("mujoco").prepare(scenes, method)

    def lacking(self, _scene: AnyScene, sensor: Sensor, _method: Method) -> str | None:
        """Return that the gyroscope is missing."""
        return "has no gyroscope" if sensor.type == "gyroscope" else None

    def prepare_sensing(self, scene: AnyScene, sensors: Sequence[Sensor], method: Method) -> SensingSimulation:
        """Return MuJoCo's simulation with the reading of this adapter."""
        self.asked += [sensor.name for sensor in sensors]
        if self.reason:
            raise SceneUnsupported(self.reason)
        return SensingSimulation(self.prepare([scene], method), self.read)


def test_readings_are_at_the_instants_of_the_run_and_after_its_first_steps() -> None:
    case, states = fall(), completed(fall(), FORWARD)
    assert states.sensed is not None
    speed, window = states.sensed.readings[2], states.sensed.window
    np.testing.assert_array_equal(window.t, np.arange(WINDOW + 1) * METHOD.timestep)
    assert [len(each) for each in states.sensed.readings] == [case.samples] * 3
    assert [len(each) for each in states.sensed.stepwise] == [WINDOW + 1] * 3
    # The body does not turn, so that every point has the velocity of the centre of mass; a few roundings of 10 m/s.
    for velocity, reading in ((states.trajectory.velocity, speed), (window.velocity, states.sensed.stepwise[2])):
        np.testing.assert_allclose(np.linalg.norm(reading, axis=1), np.linalg.norm(velocity, axis=1), atol=1e-13)


def test_the_forward_pass_has_no_use_without_sensors() -> None:
    outcome = run(replace(fall(), sensors=()), "mujoco", FORWARD).outcome
    assert outcome.reason == "the option sensors=forward has no use in a case without sensors"


def test_a_run_shorter_than_the_window_is_read_to_its_end() -> None:
    case = replace(fall(), duration=0.02)
    states = completed(case, METHOD)
    assert states.sensed is not None
    assert len(states.sensed.window) == 11


def test_sensors_change_neither_the_states_nor_the_steps_of_a_run() -> None:
    case = load("sensor-driven-joint")
    plain, with_sensors = completed(replace(case, sensors=()), METHOD), completed(case, METHOD)
    assert plain.sensed is None
    np.testing.assert_array_equal(with_sensors.trajectory.position, plain.trajectory.position)
    np.testing.assert_array_equal(with_sensors.trajectory.quaternion, plain.trajectory.quaternion)
    assert with_sensors.steps == plain.steps


def test_a_sensor_that_the_engine_lacks_has_its_reason_and_no_readings() -> None:
    case, states = fall(), completed(fall(), METHOD)
    adapter = Reading(lambda: (np.ones(3), np.full(3, 2.0)))
    result = sensed(adapter, case.scene, case.sensors, METHOD, states.trajectory)
    assert result is not None
    assert adapter.asked == ["imu", "speed"]
    assert result.lacking == ("", "has no gyroscope", "")
    assert np.isnan(result.readings[1]).all()
    assert (result.readings[0] == 1).all()
    assert (result.readings[2] == 2).all()


def test_a_simulation_that_cannot_be_made_is_the_reason_of_each_sensor() -> None:
    case, states = fall(), completed(fall(), METHOD)
    result = sensed(Reading(None, "too many sites"), case.scene, case.sensors, METHOD, states.trajectory)
    assert result is not None
    assert result.lacking[1] == "has no gyroscope"
    assert result.lacking[0] == result.lacking[2] == "does not simulate the scene with sensors: too many sites"
    assert all(np.isnan(each).all() and len(each) == case.samples for each in result.readings)
    assert len(result.window) == 1


@pytest.mark.parametrize(
    ("reading", "said"),
    [
        ((np.ones(3),), "readings of 1 sensors, not of 2"),
        ((np.ones(3), np.ones(2)), "sensor speed"),
        ((np.ones(3), np.array(["a", "b", "c"])), "not numbers"),
    ],
)
def test_readings_that_no_sensor_can_have_are_a_fault_of_the_adapter(reading: tuple[Array, ...], said: str) -> None:
    case, states = fall(), completed(fall(), METHOD)
    with pytest.raises(AdapterFault, match=said):
        sensed(Reading(lambda: reading), case.scene, case.sensors, METHOD, states.trajectory)


def test_readings_after_a_step_are_worse_than_those_of_the_forward_pass() -> None:
    case = fall()
    exact = truth(case.scene, case.instants)
    late, present = (compare(exact, run(case, "mujoco", method)) for method in (METHOD, FORWARD))
    assert late.sensors["speed"] == pytest.approx(case.scene.gravity * METHOD.timestep, rel=1e-9)  # one step of gravity
    assert present.figures["sensor_error"] < 1e-13  # a few roundings
    assert "gyro" in present.sensors  # the true reading is 0, so that it has no relative error


@pytest.fixture
def results(tmp_path: Path) -> store.Results:
    """A results folder with runs after a step and after the forward pass, and limits of their sensors."""
    case = fall(
        EXPECT.format("RK4", "sensors = {speed = 1e-3}") + EXPECT.format("RK4:sensors=forward", "sensors = {speed = 1e-3}")
    )
    return campaigns.results([Task(case, "mujoco", method) for method in (METHOD, FORWARD)], tmp_path / "results")


def test_stored_readings_are_those_of_the_run(results: store.Results) -> None:
    case = results.cases["sensor-free-fall"]
    for stored in results.runs():
        again = completed(case, stored.method).sensed
        assert isinstance(stored.outcome, Completed)
        assert again is not None
        assert stored.outcome.sensed is not None
        assert stored.outcome.sensed.lacking == again.lacking
        read = stored.outcome.sensed.readings + stored.outcome.sensed.stepwise
        for one, other in zip(read, again.readings + again.stepwise, strict=True):
            np.testing.assert_array_equal(one, other)
        np.testing.assert_array_equal(stored.outcome.sensed.window.velocity, again.window.velocity)


def test_limits_of_sensors_are_in_their_units(results: store.Results) -> None:
    late, present = judge(results)
    assert present.passed
    assert not late.passed
    assert late.reason == "sensors.speed is 0.01962 m/s, expected at most 0.001 m/s"
    assert late.row()["sensor_error"] > 1e-3


def test_damaged_readings_are_refused(results: store.Results, tmp_path: Path) -> None:
    folder = tmp_path / "copy"
    shutil.copytree(results.folder, folder)
    (file,) = (path for path in folder.rglob("mujoco-RK4-*.parquet") if not path.stem.endswith(" steps"))
    table = pq.read_table(file)
    assert table.column_names[-9:] == [f"{name}:{axis}" for name in ("imu", "gyro", "speed") for axis in "xyz"]
    pq.write_table(table.drop_columns(["imu:y"]), file)
    first, second = (one.outcome for one in store.read(folder).runs())
    assert isinstance(first, Completed)
    assert isinstance(second, Completed)
    with pytest.raises(BadFolder, match="imu:y"):
        assert first.sensed
    assert len(first.trajectory) == 6
    for steps in folder.rglob("* steps.parquet"):
        steps.unlink()
    with pytest.raises(BadFolder, match="cannot be read"):
        assert second.sensed


def test_columns_of_sensors_are_never_those_of_bodies() -> None:
    hostile = [Sensor("a.x", "joint_effort"), Sensor("a.x:x", "gyroscope"), Sensor("t", "joint_effort")]
    names = sensor_files.names_of(hostile)
    assert names == ["a.x:value", "a.x:x:x", "a.x:x:y", "a.x:x:z", "t:value"]
    assert len(set(names)) == len(names)
