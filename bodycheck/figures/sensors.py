"""The figure of sensors: the largest error of their readings."""

from functools import lru_cache

from bodycheck.figures.definition import Comparison, Figure
from bodycheck.reference.errors import NotModelled, OutOfReach
from bodycheck.reference.sensors.errors import ReadingError, after_reset, reading_errors
from bodycheck.reference.sensors.readings import SensorTruth
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.truths import NoTruth, Truth


@lru_cache(maxsize=2)
def true_readings(truth: Truth, sensors: tuple[Sensor, ...]) -> tuple[SensorTruth, ...] | NoTruth:
    """Return the true readings of sensors, or why there are none. Those of the last truths are kept for other runs."""
    from bodycheck.reference.sensors.truth import sensor_truth  # commands import the figures, but not the mechanics

    try:
        return sensor_truth(truth, sensors)
    except (NotModelled, OutOfReach) as error:
        return NoTruth(str(error))


def errors_of(compared: Comparison) -> tuple[ReadingError, ...]:
    """Return the errors of the readings of a run, without those at its start, which follow a reset and no step."""
    if compared.sensed is None or not isinstance(compared.truth, Truth):
        return ()
    if isinstance(known := true_readings(compared.truth, compared.sensors), NoTruth):
        return ()
    errors: list[ReadingError] = []
    for sensor, exactly, readings in zip(compared.sensors, known, compared.sensed.readings, strict=True):
        if not exactly.reason:
            errors += reading_errors(compared.truth, sensor, exactly, after_reset(readings))
    return tuple(errors)


def sensor_error(compared: Comparison) -> float | None:
    """Return the largest relative error of a sensor; None if there is none."""
    return max((each.relative_error for each in errors_of(compared) if each.relative_error is not None), default=None)


FIGURES = (
    Figure(
        name="sensor_error",
        title="Sensor error",
        meaning="distance of a reading of a sensor from the truth, relative to the largest true reading of the sensor",
        largest=True,
        remark="of a case with sensors",
        compute=sensor_error,
    ),
)
