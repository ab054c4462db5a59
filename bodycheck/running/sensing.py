"""Read the sensors of a case in an engine, in a simulation beside the timed one."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from bodycheck.adapters import offers
from bodycheck.adapters.contract import (
    Adapter,
    EngineDiverged,
    ErrorControlled,
    Method,
    SceneUnsupported,
    Sensing,
)
from bodycheck.adapters.scheduling import exert
from bodycheck.reference.bodies import bodies
from bodycheck.reference.mechanisms.mechanism import AnyScene
from bodycheck.reference.sensors.readings import Sensed
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.results.outcome import AdapterFault
from bodycheck.running.states import of_scene, states_of, steps_to, trajectory_of

#: Largest number of steps at the start of a run after each of which the sensors are read.
WINDOW = 64


def sensed(
    adapter: Adapter, scene: AnyScene, sensors: Sequence[Sensor], method: Method, trajectory: Trajectory
) -> Sensed | None:
    """Return the readings of sensors at the n instants of a completed run, and after its first steps.

    The result is None if the adapter reads no sensors. With error control, steps have no fixed length, and the window has only
    the start. If the simulation with sensors cannot be made or does not reach its end, that is the reason for each sensor.

    Parameters
    ----------
    adapter
        The adapter.
    scene
        The scene, as engines get it.
    sensors
        The sensors of the case.
    method, trajectory
        The method and the trajectory of the run.

    Raises
    ------
    AdapterFault
        If the readings or the states cannot be those of the engine.
    """
    if not isinstance(adapter, Sensing):
        return None
    lacking = tuple(adapter.lacking(scene, sensor, method) or "" for sensor in sensors)
    if all(lacking):
        return _unread(sensors, lacking, trajectory)
    readable = [sensor for sensor, reason in zip(sensors, lacking, strict=True) if not reason]
    try:
        readings, window, rows = _read(adapter, scene, readable, method, trajectory.t)
    except (SceneUnsupported, EngineDiverged) as error:
        reason = f"does not simulate the scene with sensors: {error}"
        return _unread(sensors, tuple(each or reason for each in lacking), trajectory)
    series, count = iter(readings), len(readings[0])
    each = [_nothing(sensor, count) if reason else next(series) for sensor, reason in zip(sensors, lacking, strict=True)]
    first = len(window)
    return Sensed(lacking, tuple(one[rows] for one in each), window, tuple(one[:first] for one in each))


def _unread(sensors: Sequence[Sensor], lacking: tuple[str, ...], trajectory: Trajectory) -> Sensed:
    """Return the result for sensors of which none is read. lacking: the reason for each."""
    start = trajectory.part(slice(1))
    nothing, first = (tuple(_nothing(sensor, count) for sensor in sensors) for count in (len(trajectory), 1))
    return Sensed(lacking, nothing, start, first)


def _nothing(sensor: Sensor, count: int) -> Array:
    """Return the readings (n, k) of a sensor that is not read, at a number n of instants."""
    return np.full((count, len(sensor.form.components)), np.nan)


def _read(
    adapter: Sensing, scene: AnyScene, sensors: Sequence[Sensor], method: Method, times: Array
) -> tuple[list[Array], Trajectory, NDArray[np.int64]]:
    """Return the readings (m, k) of each sensor at m instants of a simulation, its first states, and the rows of times (n,).

    The first of the m instants are those of the states. Raises as `sensed` does, `SceneUnsupported` and `EngineDiverged`.
    """
    sensing = offers.prepare_sensing(adapter, scene, sensors, method)
    simulation = sensing.simulation
    if method.accuracy is None:
        ends = steps_to(times, method)
        first = min(WINDOW, int(ends[-1])) + 1
        marks = np.union1d(ends, np.arange(first))
        moves = (simulation.advance(np.array([stride])) for stride in np.diff(marks, prepend=0))
        instants, rows = marks.astype(np.float64) * method.timestep, np.searchsorted(marks, ends)
    else:
        assert isinstance(simulation, ErrorControlled)
        first, instants, rows = 1, times, np.arange(len(times))
        moves = (simulation.reach(times[row : row + 1]) for row in rows)
    states, readings = [], []
    for count, state in enumerate(moves, start=1):
        if count <= first:
            states.append(states_of(state, 1, 1, len(bodies(scene))))
        exert(simulation)
        readings.append(_checked(sensing.read(), sensors))
    window = trajectory_of(instants[:first], of_scene(np.concatenate(states, axis=1), scene))
    return [np.array(each) for each in zip(*readings, strict=True)], window, rows


def _checked(readings: Sequence[Array], sensors: Sequence[Sensor]) -> list[Array]:
    """Return the present readings as arrays of numbers. Raises `AdapterFault` if they do not have the form of the sensors."""
    if len(readings) != len(sensors):
        raise AdapterFault(f"it has readings of {len(readings)} sensors, not of {len(sensors)}")
    arrays = [np.asarray(each) for each in readings]
    for array, sensor in zip(arrays, sensors, strict=True):
        wanted = (len(sensor.form.components),)
        if array.dtype.kind not in "fiu" or array.shape != wanted:
            given = f"of the type {array.dtype} and the shape {array.shape}"
            raise AdapterFault(f"its reading of the sensor {sensor.name} is {given}, not numbers of the shape {wanted}")
    return [array.astype(np.float64) for array in arrays]
