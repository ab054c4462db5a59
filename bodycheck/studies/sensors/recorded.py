"""Readings of sensors that somebody recorded, in any engine or on a robot, as a CSV file that may come from a stranger."""

from collections.abc import Collection, Sequence
from pathlib import Path

import numpy as np

from bodycheck.adapters.contract import Method
from bodycheck.casefile.content import Case
from bodycheck.errors import BadInput
from bodycheck.judging.sensors.identification import Convention, identify
from bodycheck.judging.sensors.measurement import sensor_rows, with_readings
from bodycheck.judging.sensors.past import of_truth
from bodycheck.judging.sensors.rows import SensorRow
from bodycheck.reference.errors import NotModelled, OutOfReach
from bodycheck.reference.sensors.errors import parts
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truths import Truth
from bodycheck.results.outcome import RECORDED
from bodycheck.running import logs
from bodycheck.running.truths import truth as truth_of
from bodycheck.suggestion import did_you_mean

#: The largest number of instants of a file, and of those from which conventions are identified.
MAX_INSTANTS, MOST_IDENTIFIED = 20_000, 500


def rows(path: Path, case: Case, engine: str, version: str, timestep: float | None) -> tuple[list[SensorRow], tuple[str, ...]]:
    """Return the rows of the recorded readings of a case's sensors, and notes about what of the file was not used.

    Parameters
    ----------
    path
        The file, with the column `t` (s) and the columns of the components of sensors, such as `imu.x`.
    case
        The case.
    engine, version
        What gave the readings.
    timestep
        The time step (s) of the engine, from which the age of readings is identified; None if it is not known.

    Raises
    ------
    BadInput
        If the case has no sensors, the file cannot be read or lacks a column, or has a value that is not allowed.
    """
    if not case.sensors:
        raise BadInput(f"{case.name}: has no sensors; allowed: a case with [[sensors]]")
    t, columns, notes = logs.within(path, logs.columns_of(path), case.duration)
    if len(t) > MAX_INSTANTS:
        raise BadInput(f"{path}: has {len(t)} instants; allowed: at most {MAX_INSTANTS}")
    sensors = tuple(sensor for sensor in case.sensors if _has(path, columns.keys(), sensor))
    _check_names(path, case, sensors, list(columns))
    try:
        truth = truth_of(case, t)
    except (NotModelled, OutOfReach) as error:
        raise BadInput(f"{case.name}: there is no truth: {error}") from error
    known = with_readings(truth, sensors)
    readings = [np.stack([columns[name] for name in sensor.columns], axis=-1) for sensor in sensors]
    conventions = _conventions(truth, sensors, readings, timestep or 0.0)
    step = timestep or float(f"{(t[-1] - t[0]) / (len(t) - 1):.9g}")
    method = Method(RECORDED, step)
    head = (case.name, engine, version, method.name, method.timestep)
    by_sensor = (
        sensor_rows(head, sensor, known, index, readings[index], conventions[index], reset=t[0] == 0)
        for index, sensor in enumerate(sensors)
    )
    return [row for each in by_sensor for row in each], notes


def _has(path: Path, names: Collection[str], sensor: Sensor) -> bool:
    """Return whether a file has the columns of a sensor. Raises `BadInput` if it has some of them alone."""
    lacking = [name for name in sensor.columns if name not in names]
    if lacking and len(lacking) < len(sensor.columns):
        raise BadInput(f"{path}:1: lacks the columns {', '.join(lacking)} of the sensor {sensor.name}")
    return not lacking


def _check_names(path: Path, case: Case, sensors: Sequence[Sensor], names: Sequence[str]) -> None:
    """Raise `BadInput` if a file has no column of a sensor, or a column that is not that of a sensor."""
    allowed = [name for sensor in case.sensors for name in sensor.columns]
    for name in names:
        if name not in (logs.TIME, *allowed):
            hint = did_you_mean(name, allowed)
            raise BadInput(f"{path}:1: read the column {name[:100]!r}; allowed: t, {', '.join(allowed[:20])}{hint}")
    if not sensors:
        raise BadInput(f"{path}:1: has no readings; allowed: t, {', '.join(allowed[:20])}")


def _conventions(
    truth: Truth, sensors: Sequence[Sensor], readings: Sequence[Array], timestep: float
) -> list[tuple[Convention, ...]]:
    """Return the conventions that explain recorded readings, by the states of the truth. timestep: in s; 0 if not known."""
    try:
        past, chosen = of_truth(truth, sensors, truth.trajectory.t[:MOST_IDENTIFIED], timestep)
    except (NotModelled, OutOfReach) as error:
        return [tuple(Convention(note=f"not identified: {error}") for _ in parts(sensor)) for sensor in sensors]
    return [
        identify(past, sensor, index, values[:MOST_IDENTIFIED][chosen])
        for index, (sensor, values) in enumerate(zip(sensors, readings, strict=True))
    ]
