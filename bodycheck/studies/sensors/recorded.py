"""Readings of sensors that somebody recorded, in any engine or on a robot, as a CSV file that may come from a stranger."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from bodycheck.adapters.contract import Method
from bodycheck.casefile.case import MAX_FAULTS
from bodycheck.casefile.content import Case
from bodycheck.errors import BadInput, Failed
from bodycheck.judging.sensors.identification import Convention, identify
from bodycheck.judging.sensors.measurement import sensor_rows, with_readings
from bodycheck.judging.sensors.past import of_truth
from bodycheck.judging.sensors.rows import SensorRow
from bodycheck.processes import pool
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.reference.errors import NotModelled, OutOfReach
from bodycheck.reference.sensors.errors import parts
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truths import NoTruth, Truth
from bodycheck.results.outcome import RECORDED
from bodycheck.running import campaign, engines, logs
from bodycheck.running.logs import TIME
from bodycheck.running.truths import truth as truth_of
from bodycheck.suggestion import did_you_mean, first_names

#: The largest number of instants of a file, and of those from which conventions are identified.
MAX_INSTANTS, MOST_IDENTIFIED = 20_000, 500


@dataclass(frozen=True, eq=False)
class Recorded:
    """Readings that were recorded, of some sensors of a case.

    Attributes
    ----------
    case
        The case.
    sensors
        The sensors that have readings.
    t
        The instants (n,), s.
    readings
        The readings (n, k) of each of the sensors.
    engine, version
        What gave them.
    timestep
        The time step (s) of the engine; 0 if it is not known.
    """

    case: Case
    sensors: tuple[Sensor, ...]
    t: Array
    readings: tuple[Array, ...]
    engine: str
    version: str
    timestep: float


def rows(
    path: Path, case: Case, engine: str, version: str, timestep: float | None, limit: float = campaign.TIME_LIMIT_S
) -> tuple[list[SensorRow], tuple[str, ...]]:
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
    limit
        The time limit (s) for the truth and the evaluation, which a process of their own makes.

    Raises
    ------
    BadInput
        If the case has no sensors or no truth, or the file cannot be read or has faults; the text has all of these.
    Failed
        If the evaluation exceeds the time limit or fails.
    """
    recorded, notes = read(path, case, engine, version, timestep)
    with pool.Workers(evaluated, 1, limit, home=engines.home) as workers:
        answer = workers.call(recorded)
    match answer:
        case TimedOut():
            raise Failed(f"{case.name}: its truth and the evaluation take longer than the limit of {limit:g} s")
        case Crashed(reason):
            raise Failed(f"{case.name}: the evaluation failed: {reason}")
        case NoTruth(reason):
            raise BadInput(f"{case.name}: there is no truth: {reason}")
    return answer, notes


def read(path: Path, case: Case, engine: str, version: str, timestep: float | None) -> tuple[Recorded, tuple[str, ...]]:
    """Return the readings in a file, and notes, with the parameters and exceptions of `rows`."""
    if not case.sensors:
        raise BadInput(f"{case.name}: has no sensors; allowed: a case with [[sensors]]")
    names = [TIME, *(column for sensor in case.sensors for column in _columns(sensor))]
    if twice := next((name for name in names if names.count(name) > 1), None):
        raise BadInput(f"{case.name}: two columns of readings would have the name {twice}; allowed: other names of sensors")
    columns = logs.columns_of(path, partial(_faults, case.sensors))
    t, columns, notes = logs.within(path, columns, case.duration)
    if len(t) > MAX_INSTANTS:
        raise BadInput(f"{path}: has {len(t)} instants; allowed: at most {MAX_INSTANTS}")
    sensors = tuple(sensor for sensor in case.sensors if _columns(sensor)[0] in columns)
    readings = tuple(np.stack([columns[name] for name in _columns(sensor)], axis=-1) for sensor in sensors)
    return Recorded(case, sensors, t, readings, engine, version, timestep or 0.0), notes


def evaluated(recorded: Recorded) -> list[SensorRow] | NoTruth:
    """Return the rows of recorded readings, or why the case has no truth."""
    case, sensors, t = recorded.case, recorded.sensors, recorded.t
    try:
        truth = truth_of(case, t)
    except (NotModelled, OutOfReach) as error:
        return NoTruth(str(error))
    known = with_readings(truth, sensors)
    conventions = _conventions(truth, sensors, recorded.readings, recorded.timestep)
    step = recorded.timestep or float(f"{(t[-1] - t[0]) / (len(t) - 1):.9g}")
    method = Method(RECORDED, step)
    head = (case.name, recorded.engine, recorded.version, method.name, method.timestep)
    by_sensor = (
        sensor_rows(head, sensor, known, index, recorded.readings[index], conventions[index], reset=t[0] == 0)
        for index, sensor in enumerate(sensors)
    )
    return [row for each in by_sensor for row in each]


def _columns(sensor: Sensor) -> tuple[str, ...]:
    """Return the names of the columns of a sensor in a file, whose names are read without spaces around them."""
    return tuple(name.strip() for name in sensor.columns)


def _faults(sensors: Sequence[Sensor], names: Sequence[str]) -> list[str]:
    """Return the faults of the names of a file's columns: what is no column of a sensor, and what sensors lack."""
    allowed, there = [name for sensor in sensors for name in _columns(sensor)], set(names)
    listed = ", ".join(first_names([TIME, *allowed]))
    unknown = [name for name in names if name not in {TIME, *allowed}][: MAX_FAULTS + 1]
    faults = [f"read the column {name[:100]!r}; allowed: {listed}{did_you_mean(name, allowed)}" for name in unknown]
    for sensor in sensors:
        lacking = [name for name in _columns(sensor) if name not in there]
        if lacking and len(lacking) < len(sensor.columns):
            faults.append(f"lacks the columns {', '.join(lacking)} of the sensor {sensor.name}")
    return faults or ([] if there.intersection(allowed) else [f"has no readings; allowed: {listed}"])


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
