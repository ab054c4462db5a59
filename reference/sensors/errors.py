"""The errors of readings of sensors, absolute and relative to the largest reading of the truth."""

from dataclasses import dataclass

import numpy as np

from bodycheck.reference.bodies import of_bodies
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.sensors.readings import SensorTruth
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truths import Truth

#: The components of the force, and those of the moment, in the readings of a wrench.
FORCE, MOMENT = slice(0, 3), slice(3, 6)


@dataclass(frozen=True)
class ReadingError:
    """The error of the readings of a sensor, or of the force or the moment of a wrench.

    Attributes
    ----------
    name
        The name of the sensor; of a wrench with the suffix ".force" or ".moment".
    part
        The components of the readings.
    error
        The largest distance of a reading from the truth, in the unit of the sensor; None if no reading can be compared.
    relative_error
        The error divided by the largest true reading; of an accelerometer by the largest of that, the gravitational
        acceleration, and the square of the angular velocity times the distance from the centre of mass. None if that is 0.
    """

    name: str
    part: slice
    error: float | None
    relative_error: float | None


def parts(sensor: Sensor) -> tuple[tuple[str, slice], ...]:
    """Return the names of the parts of a sensor that have errors of their own, with the components of each."""
    if sensor.type == "force_torque":
        return (f"{sensor.name}.force", FORCE), (f"{sensor.name}.moment", MOMENT)
    return ((sensor.name, slice(0, len(sensor.form.components))),)


def after_reset(readings: Array) -> Array:
    """Return readings (n, k) of a run without the first one, which follows a reset and no step, and becomes NaN."""
    return np.concatenate([np.full_like(readings[:1], np.nan), readings[1:]])


def reading_errors(truth: Truth, sensor: Sensor, exactly: SensorTruth, readings: Array) -> tuple[ReadingError, ...]:
    """Return the errors of readings (n, k) of a sensor, of which those that are not numbers are left out.

    Parameters
    ----------
    truth
        The truth of the motion at the instants of the readings.
    sensor
        The sensor.
    exactly
        The true readings. A reading within its bound of 0 is 0.
    """
    errors = []
    for name, part in parts(sensor):
        values = exactly.values[:, part]
        distances = np.linalg.norm(readings[:, part] - values, axis=-1)
        sizes = np.where(np.abs(values) > exactly.bounds[:, part], values, 0.0)
        known, size = distances[~np.isnan(distances)], _size(truth, sensor, sizes)
        error = float(known.max()) if len(known) else None
        errors.append(ReadingError(name, part, error, error / size if error is not None and size else None))
    return tuple(errors)


def _size(truth: Truth, sensor: Sensor, exactly: Array) -> float:
    """Return the size to which errors are relative, from the true readings (n, k)."""
    size = float(np.linalg.norm(exactly, axis=-1).max(initial=0.0))
    if sensor.type != "accelerometer":
        return size
    from bodycheck.reference.mechanisms import exact  # commands import this module, but not the exact arithmetic

    scene = truth.scene
    centre = exact.nearest_inertia(scene.bodies[sensor.body]).centre if isinstance(scene, Mechanism) else (0.0, 0.0, 0.0)
    arm = float(np.linalg.norm(np.array(sensor.position) - np.array(centre)))
    rate = np.linalg.norm(of_bodies(truth.trajectory).angular_velocity[sensor.body], axis=-1)
    return max(size, scene.gravity, arm * float(np.nanmax(rate, initial=0.0)) ** 2)
