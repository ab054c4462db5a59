"""Each planted fault of a miniature engine is found and named, and an engine without faults has none."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from bodycheck.adapters.contract import Method
from bodycheck.casefile.case import load
from bodycheck.casefile.content import Case
from bodycheck.judging.sensors.measurement import Known, rows_of, with_readings
from bodycheck.judging.sensors.rows import SensorRow
from bodycheck.reference.mechanisms.mechanism import alone
from bodycheck.reference.truths import NoTruth
from bodycheck.results.outcome import Completed, Run
from bodycheck.running.instants import sampling_times
from bodycheck.running.sensing import sensed
from bodycheck.running.simulation import outcome_in
from bodycheck.running.truths import truth
from tests.support.planted_sensors import ON_BODY, ON_HINGE, Fault, PlantedSensors, hinge

METHOD = Method("rk4", 0.002)

#: The conventions in a row without a fault.
CLEAN = ("+", 0.0, "solver", "")


@cache
def brick() -> Case:
    """The free body: it flies, spins about all axes, and falls."""
    case = load("free-brick")
    scene = alone(case.scene)
    inertia = replace(scene.body, mass=1.2, moments=(0.0134, 0.0105, 0.0043), shape=None)
    start = replace(
        scene.initial,
        quaternion=(1.0, 0.0, 0.0, 0.0),
        velocity=(0.3, -0.7, 2.0),
        angular_velocity=(1.0, 5.0, 1.0),
    )
    scene = replace(scene, body=inertia, initial=start, gravity=9.81, definition=None)
    return replace(case, name="brick", scene=scene, duration=0.1, samples=6, sensors=ON_BODY, expectations=())


@cache
def swing() -> Case:
    return replace(brick(), name="swing", scene=hinge(), sensors=ON_HINGE)


@cache
def exact() -> Known:
    """The truth of the free body with its readings."""
    return with_readings(truth(brick(), sampling_times(brick().instants, METHOD.sampling)), brick().sensors)


def sheet(fault: Fault, case: Case, known: Known | None = None) -> dict[str, SensorRow]:
    """Return the rows of a case in the miniature engine, by the name of the sensor."""
    adapter = PlantedSensors(fault)
    times = sampling_times(case.instants, METHOD.sampling)
    outcome = outcome_in(adapter, "planted", case.scene, METHOD, times)
    assert isinstance(outcome, Completed)
    read = sensed(adapter, case.scene, case.sensors, METHOD, outcome.trajectory)
    assert read is not None
    run = Run(case.name, "planted", "1.0", METHOD, outcome, scene=case.scene)
    return {row.sensor: row for row in rows_of(case, run, read, known or NoTruth("not computed"))}


def conventions(row: SensorRow) -> tuple[str, float | None, str, str]:
    """Return sign, age, source and the departures of a row."""
    parts = [part for part in row.note.split("; ") if not part.startswith(("the scene cannot tell", "no truth"))]
    return row.sign, row.age_steps, row.source, "; ".join(parts)


def test_an_engine_without_faults_has_no_findings() -> None:
    rows = sheet("none", brick(), exact())
    assert [conventions(row) for row in rows.values()] == [CLEAN] * 3
    assert {row.frame for row in rows.values()} == {"sensor"}
    for row in rows.values():
        # The scheme of the fourth order leaves an error of (h ω)^4 = 1e-8 per unit of time, and rounding.
        assert row.error is not None
        assert row.error < 1e-6
        assert row.reset_error is not None
        assert row.reset_error < 1e-13


@pytest.mark.parametrize("fault", ["without ω × v", "gravity with the other sign", "in units of g"])
def test_a_dropped_or_changed_term_of_an_accelerometer_is_named(fault: Fault) -> None:
    row = sheet(fault, brick(), exact())["imu"]
    assert (conventions(row), row.frame) == (("+", 0.0, "solver", fault), "sensor")
    assert row.relative_error is not None
    assert row.relative_error > 0.1


def test_readings_one_step_old_are_found() -> None:
    rows = sheet("old", brick())
    assert [conventions(row) for row in rows.values()] == [("+", 1.0, "solver", "")] * 3
    assert all(row.age_uncertainty is not None and row.age_uncertainty < 1e-6 for row in rows.values())


@pytest.mark.parametrize(("fault", "source", "age"), [("velocities", "velocities", 0.5), ("positions", "positions", 1.0)])
def test_differences_are_found_with_the_age_of_their_middle(fault: str, source: str, age: float) -> None:
    row = sheet(f"differences of {fault}", brick())["imu"]  # type: ignore[arg-type]
    assert (row.sign, row.frame, row.source) == ("+", "sensor", source)
    assert row.age_steps is not None
    assert row.age_uncertainty is not None
    # A difference is exact for the middle up to the third derivative of the velocity.
    assert abs(row.age_steps - age) <= 2 * row.age_uncertainty < 0.01


def test_the_axes_of_the_world_are_found() -> None:
    rows = sheet("along the axes of the world", brick())
    assert [(row.sign, row.frame, row.note[:8]) for row in rows.values()] == [("+", "world", "no truth")] * 3


def test_readings_of_zero_are_found() -> None:
    rows = sheet("zero", brick(), exact())
    assert all(row.note == "reads zero" and not row.sign and row.relative_error == pytest.approx(1) for row in [rows["gyro"]])


def test_the_wrench_of_an_engine_without_faults_has_no_findings() -> None:
    rows = sheet("none", swing())
    assert [conventions(row) for row in rows.values()] == [CLEAN] * 2
    assert {row.frame for row in rows.values()} == {"body"}


@pytest.mark.parametrize("fault", ["about the centre of mass", "with the armature"])
def test_another_moment_is_named(fault: Fault) -> None:
    rows = sheet(fault, swing())
    assert conventions(rows["wrench.force"]) == CLEAN
    assert conventions(rows["wrench.moment"]) == ("+", 0.0, "solver", fault)


def test_the_wrench_of_the_child_on_the_parent_has_the_other_sign() -> None:
    rows = sheet("of the child on the parent", swing())
    assert [conventions(row) for row in rows.values()] == [("-", 0.0, "solver", "")] * 2


def test_a_wrench_along_the_axes_of_the_world_is_found() -> None:
    rows = sheet("along the axes of the world", swing())
    assert [(row.sign, row.frame) for row in rows.values()] == [("+", "world")] * 2


def test_what_a_scene_cannot_tell_is_empty() -> None:
    case, scene = brick(), alone(brick().scene)
    still = replace(scene.initial, velocity=(0.0, 0.0, 0.0), angular_velocity=(0.0, 0.0, 0.0))
    falling = replace(case, scene=replace(scene, initial=still))
    rows = sheet("none", falling)
    assert rows["imu"].note.startswith("the scene cannot tell: the sensor should read zero, and does")
    assert (rows["speed"].sign, rows["speed"].frame, rows["speed"].age_steps) == ("+", "", 0.0)
    assert "the scene cannot tell the frame" in rows["speed"].note


def test_a_sensor_that_the_engine_lacks_has_its_reason() -> None:
    touch = replace(ON_HINGE[0], name="touch", type="contact_force", joint=None)
    row = sheet("none", replace(swing(), sensors=(touch, *ON_HINGE)))["touch"]
    assert row.note.startswith("planted has no sensor of contact forces")
    assert np.all([value in (None, "") for value in (row.error, row.sign, row.frame, row.source)])
