"""The conventions by which an engine may give the readings of a sensor, as data."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from bodycheck.judging.sensors.past import Past
from bodycheck.reference.trajectory import Array

#: How a reading is computed: from a state and the accelerations of the solver, or from differences of states over steps.
Source = Literal["solver", "velocities", "positions"]

#: The frames along whose axes a vector may be given.
Frame = Literal["sensor", "body", "joint", "world"]

#: The texts of sources and frames in tables; empty where they are not identified.
SOURCES, FRAMES = frozenset(get_args(Source)), frozenset(get_args(Frame))

#: The rounding errors of a reading, in units of the roundoff of its size.
ROUNDINGS = 64.0

#: A departure is a hypothesis if it changes readings by this multiple of their rounding error.
NOTICEABLE = 1e3


@dataclass(frozen=True, eq=False)
class Laws:
    """What a sensor would read by several conventions. Readings and vectors are along the axes of the type of the sensor.

    Attributes
    ----------
    sources
        The readings (lags, n, k) by their source, at the lags for which they are known: instants before those of the readings.
    departures
        What is added to readings (lags, n, k) if a term is dropped or added, by the name of the departure.
    factors
        The factors of readings in other units, by the name of the departure.
    frames
        The quaternions (lags, n, 4) to the world from each frame, that of the type of the sensor first; none for a number.
    size
        The size of readings in the scene, such as the gravitational acceleration.
    rounding
        The rounding error of readings by each source.
    delayed
        The readings (lags, n, k) along the present axes with accelerations, or velocities, of each lag, by the source that
        replaces these by differences.
    """

    sources: Mapping[Source, Array]
    departures: Mapping[str, Array]
    factors: Mapping[str, float]
    frames: Mapping[Frame, Array]
    size: float
    rounding: Mapping[Source, float]
    delayed: Mapping[Source, Array]


def laws(
    past: Past,
    sources: Mapping[Source, Array],
    frames: Mapping[Frame, Array],
    departures: Mapping[str, Array] | None = None,
    factors: Mapping[str, float] | None = None,
    size: float = 0.0,
    differenced: Mapping[Source, float] | None = None,
    delayed: Mapping[Source, Array] | None = None,
) -> Laws:
    """Return laws, with the sources that are known, and the departures that change readings noticeably.

    differenced: the size of what is differenced for each source, divided by the power of the step that divides it.
    """
    size = max(size, largest(sources["solver"]))
    rounding: dict[Source, float] = {
        source: ROUNDINGS * past.roundoff * (size + (differenced or {}).get(source, 0.0)) for source in sources
    }
    noticeable = {
        name: change for name, change in (departures or {}).items() if largest(change) > NOTICEABLE * rounding["solver"]
    }
    known = {source: values for source, values in sources.items() if source == "solver" or np.isfinite(values).any()}
    return Laws(known, noticeable, factors or {}, frames, size, rounding, delayed or {})


def largest(values: Array) -> float:
    """Return the largest absolute value; 0 without values."""
    return float(np.nanmax(np.abs(values), initial=0.0))


def differences(values: Array) -> Array:
    """Return the differences of values (lags, n, 3) over the step that ends at each lag but the last."""
    return np.asarray(values[:-1] - values[1:])
