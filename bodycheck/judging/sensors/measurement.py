"""Make the rows of sensors.csv of runs: errors from the truth at their instants, and conventions from the first steps."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np

from bodycheck.casefile.content import Case
from bodycheck.figures.sensors import true_readings
from bodycheck.judging.judgement import LABEL, Verdict
from bodycheck.judging.sensors.identification import Convention, identify
from bodycheck.judging.sensors.past import of_truth, of_window
from bodycheck.judging.sensors.rows import SENSORS, SensorRow
from bodycheck.reference.errors import NotModelled, OutOfReach
from bodycheck.reference.requirements import touches
from bodycheck.reference.sensors.errors import ReadingError, after_reset, parts, reading_errors
from bodycheck.reference.sensors.readings import Sensed, SensorTruth
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truths import NoTruth, Truth
from bodycheck.results import csv_tables
from bodycheck.results.origin import Origins
from bodycheck.results.outcome import Completed, Run
from bodycheck.results.store import Results
from bodycheck.results.tables import RESULTS, Table

#: The same table for several sets of results.
SENSORS_OF_SETS: Table[Mapping[str, Any]] = Table(
    SENSORS.name, SENSORS.title, None, (RESULTS.by_name[LABEL], *SENSORS.columns), (LABEL, *SENSORS.key), SENSORS.filled
)


#: The truth of a motion with the true readings of its sensors, or why there is none.
Known = tuple[Truth, tuple[SensorTruth, ...]] | NoTruth


def measure(results: Results, verdicts: Iterable[Verdict]) -> list[SensorRow]:
    """Return the rows of all completed runs of cases with sensors whose engine reads sensors."""
    rows: list[SensorRow] = []
    truths: dict[tuple[str, float], Known] = {}
    for run in (verdict.run for verdict in verdicts):
        case = results.cases[run.case]
        if not case.sensors or not isinstance(run.outcome, Completed) or run.outcome.sensed is None:
            continue
        key = run.case, run.method.sampling
        if key not in truths:
            truths[key] = with_readings(results.truth(*key), case.sensors)
        rows += rows_of(case, run, run.outcome.sensed, truths[key])
    return rows


def with_readings(truth: Truth | NoTruth, sensors: Sequence[Sensor]) -> Known:
    """Return a truth with the true readings of sensors, or why there are none."""
    if isinstance(truth, NoTruth):
        return truth
    readings = true_readings(truth, tuple(sensors))
    return readings if isinstance(readings, NoTruth) else (truth, readings)


def rows_of(case: Case, run: Run, sensed: Sensed, known: Known) -> list[SensorRow]:
    """Return the rows of one completed run. known: the truth at its instants."""
    timestep = run.method.timestep if run.method.accuracy is None else 0.0
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):  # states of a run may be large
        conventions = _conventions(case, sensed, known, timestep)
    rows = []
    for index, sensor in enumerate(case.sensors):
        reason = sensed.lacking[index] and f"{run.engine} {sensed.lacking[index]}"
        each = [Convention(note=reason) for _ in parts(sensor)] if reason else conventions[index]
        head = (run.case, run.engine, run.version, run.method.name, run.method.timestep)
        rows += sensor_rows(head, sensor, known, index, sensed.readings[index], each)
    return rows


def sensor_rows(
    head: tuple[str, str, str, str, float],
    sensor: Sensor,
    known: Known,
    index: int,
    readings: Array,
    conventions: Sequence[Convention],
    reset: bool = True,
) -> list[SensorRow]:
    """Return the rows of one sensor: one, or those of the force and the moment of a wrench.

    Parameters
    ----------
    head
        The first five columns.
    sensor, index
        The sensor, and its index in the case.
    known
        The truth at the instants of the readings.
    readings
        The readings (n, k).
    conventions
        The conventions that explain the readings, one for each row.
    reset
        Whether the first reading is that after a reset, which does not count in the error.
    """
    reason = known.reason if isinstance(known, NoTruth) else known[1][index].reason
    pairs = zip(parts(sensor), conventions, strict=True)
    if isinstance(known, NoTruth) or reason:
        noted = [replace(each, note="; ".join(filter(None, (each.note, f"no truth: {reason}")))) for each in conventions]
        pairs = zip(parts(sensor), noted, strict=True)
        return [_row(head, name, sensor, None, each, None) for (name, _), each in pairs]
    truth, exactly = known[0], known[1][index]
    errors = reading_errors(truth, sensor, exactly, after_reset(readings) if reset else readings)
    return [
        _row(head, name, sensor, error, convention, _distance(readings[0, part], exactly.values[0, part]) if reset else None)
        for ((name, part), convention), error in zip(pairs, errors, strict=True)
    ]


def _row(
    head: tuple[str, str, str, str, float],
    name: str,
    sensor: Sensor,
    error: ReadingError | None,
    convention: Convention,
    reset_error: float | None,
) -> SensorRow:
    errors = (None, None) if error is None else (error.error, error.relative_error)
    return SensorRow(*head, name, sensor.type, *errors, **asdict(convention), reset_error=reset_error)


def _distance(reading: Array, exactly: Array) -> float | None:
    """Return the distance of a reading (k,) from the truth; None if one of them is not known."""
    distance = float(np.linalg.norm(reading - exactly))
    return None if np.isnan(distance) else distance


def _conventions(case: Case, sensed: Sensed, known: Known, timestep: float) -> list[tuple[Convention, ...]]:
    """Return the conventions that explain the readings of each sensor after the first steps.

    The states are those of the engine; where bodies touch, whose accelerations do not follow from their states, those of the
    truth. timestep: that of the steps (s); 0 if they have no fixed length, and nothing is identified.
    """
    window = sensed.window
    if not timestep:
        return _unidentified(case, "steps have no fixed length")
    if not all(np.isfinite(values).all() for values in (window.position, window.quaternion, window.velocity)):
        return _unidentified(case, "a state is not a number")
    try:
        if touches(case.scene):
            if isinstance(known, NoTruth):
                return _unidentified(case, known.reason)
            past, chosen = of_truth(known[0], case.sensors, window.t, timestep)
        else:
            past, chosen = of_window(case.scene, case.sensors, window, timestep)
    except (NotModelled, OutOfReach, np.linalg.LinAlgError) as error:
        return _unidentified(case, str(error))
    return [
        identify(past, sensor, index, readings[chosen])
        for index, (sensor, readings) in enumerate(zip(case.sensors, sensed.stepwise, strict=True))
    ]


def _unidentified(case: Case, reason: str) -> list[tuple[Convention, ...]]:
    """Return conventions without anything but the reason for that."""
    return [tuple(Convention(note=f"not identified: {reason}") for _ in parts(sensor)) for sensor in case.sensors]


def write(rows_by_label: Mapping[str, Sequence[SensorRow]], folder: Path, origins: Origins) -> None:
    """Write sensors.csv into a folder if there are any rows, with the label of each set of results if there are several.

    origins: the origins of the numbers, which are written too.
    """
    if len(rows_by_label) > 1:
        records = [{LABEL: label} | asdict(row) for label, rows in rows_by_label.items() for row in rows]
        if records:
            csv_tables.write(folder, SENSORS_OF_SETS, records, origins)
    elif rows := [row for each in rows_by_label.values() for row in each]:
        csv_tables.write(folder, SENSORS, rows, origins)
