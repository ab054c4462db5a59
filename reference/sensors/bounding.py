"""The bounds of the readings of sensors, from the changes of the readings within the bounds of the states."""

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.bounds import EPS
from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.exact.pairs import WideArray
from bodycheck.reference.sensors.readings import SensorTruth
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.truths import Truth

#: The factor by which bounds exceed the sum of the changes.
CAUTION = 2.0

#: The bound of an attitude or angle (rad) above which changes by it are not nearly linear.
LARGEST = 0.05

#: The number of bounds of a quantity up to which it may be zero.
NEAR = 4.0

#: The number of roundings of a reading to double precision, and of its terms in the wide type.
ROUNDINGS, WIDE_ROUNDINGS = 2.0, 2.0**10


def with_bounds(truth: Truth, values: WideArray, changes: WideArray, sizes: WideArray, known: NDArray[np.bool_]) -> SensorTruth:
    """Return the truth of a sensor from its readings and the sums of their changes (n, k) at the instants of a truth.

    sizes: (n, k) or (n, 1) of the terms whose sums are the readings, which may be much smaller. known: (n,) whether an instant
    is not that of an impact.
    """
    rounding = ROUNDINGS * EPS * np.abs(values)
    rounding = rounding + WIDE_ROUNDINGS * np.finfo(Wide).eps * np.maximum(np.abs(values).max(axis=1, keepdims=True), sizes)
    large = truth.bounds.error > LARGEST
    bounds = np.where(large[:, None], np.inf, CAUTION * changes + rounding)
    printed, limits = (np.where(known[:, None], each, np.nan).astype(float) for each in (values, bounds))
    return SensorTruth(printed, limits, int((~known).sum()))


def without(sensor: Sensor, reason: str) -> SensorTruth:
    """Return the truth of a sensor of which the reference has no model."""
    nothing = np.empty((0, len(sensor.form.components)))
    return SensorTruth(nothing, nothing, reason=reason)
