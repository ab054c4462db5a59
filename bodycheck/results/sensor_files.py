"""The readings of sensors in a results folder.

The trajectory file of a run of a case with sensors also has their readings at its instants. A second file beside it has the
states and the readings after each of the first steps.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bodycheck.reference.sensors.readings import Sensed
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.results import trajectory_files

#: The separator between the name of a sensor and the name of a component of its readings, as in "imu:x". The last separator in
#: the name of a column thus tells it from those of the states of bodies.
OF_SENSOR = ":"

#: The name of the component of a sensor that reads one number.
NUMBER = "value"


@dataclass(frozen=True)
class StoredSensed:
    """The readings of sensors in the files of a run, which are read each time they are needed.

    Attributes
    ----------
    file, bodies
        The trajectory file of the run, and the names of the bodies if the scene is a mechanism.
    sensors, lacking
        The sensors, and as in `Sensed` why the engine does not read them.
    """

    file: Path
    bodies: tuple[str, ...]
    sensors: tuple[Sensor, ...]
    lacking: tuple[str, ...]

    def read(self) -> Sensed:
        """Return the readings in the files. Raises `BadFolder` if a file is missing or damaged."""
        _, readings = self._read(self.file)
        window, stepwise = self._read(of_steps(self.file))
        return Sensed(self.lacking, readings, window, stepwise)

    def _read(self, file: Path) -> tuple[Trajectory, tuple[Array, ...]]:
        trajectory, columns = trajectory_files.read_with(file, self.bodies, names_of(self.sensors))
        return trajectory, tuple(np.column_stack([columns[name] for name in names_of([sensor])]) for sensor in self.sensors)


def of_steps(path: Path) -> Path:
    """Return the path of the file with the first steps of a run, from that of its trajectory file."""
    return path.with_name(f"{path.stem} steps{path.suffix}")


def write(
    folder: Path, path: Path, trajectory: Trajectory, sensed: Sensed, sensors: Sequence[Sensor], bodies: Sequence[str]
) -> None:
    """Write the trajectory file of a run with readings, and that of its first steps.

    Parameters
    ----------
    folder, path, trajectory, bodies
        As those of `trajectory_files.write`.
    sensed, sensors
        The readings of the sensors, and the sensors.

    Raises
    ------
    NotWritten
        A file cannot be written.
    """
    for file, states, readings in (
        (path, trajectory, sensed.readings),
        (of_steps(path), sensed.window, sensed.stepwise),
    ):
        columns = dict(zip(names_of(sensors), (column for each in readings for column in each.T), strict=True))
        trajectory_files.write(folder, file, states, columns, bodies)


def is_readable(file: Path, bodies: Sequence[str], sensors: Sequence[Sensor]) -> bool:
    """Return whether the files of a run exist and are complete."""
    return all(trajectory_files.is_readable(each, bodies, names_of(sensors)) for each in (file, of_steps(file)))


def names_of(sensors: Sequence[Sensor]) -> list[str]:
    """Return the names of the columns of the readings of sensors."""
    return [
        f"{sensor.name}{OF_SENSOR}{suffix.removeprefix('.') or NUMBER}"
        for sensor in sensors
        for suffix in sensor.form.components
    ]
