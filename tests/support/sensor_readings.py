"""Readings of sensors in an engine beside what they should read at the engine's own states."""

from dataclasses import dataclass

import numpy as np

from bodycheck.adapters import offers
from bodycheck.adapters.contract import Method, Sensing
from bodycheck.casefile.case import load
from bodycheck.reference.bodies import bodies
from bodycheck.reference.sensors.expected import expected
from bodycheck.reference.trajectory import Array
from bodycheck.running.states import of_scene, states_of, trajectory_of


@dataclass(frozen=True, eq=False)
class Readings:
    """The readings of the sensors that an engine reads, at the start and after each of some steps.

    Attributes
    ----------
    given
        The readings (n, k) by the names of the sensors.
    expected
        What each sensor should read (n, k) at the states of the engine.
    quaternion
        The attitude (n, 4) of the first body.
    """

    given: dict[str, Array]
    expected: dict[str, Array]
    quaternion: Array


def readings(adapter: Sensing, case: str, spelling: str, timestep: float, steps: int) -> Readings:
    """Return the readings of a shipped case whose joints are not driven."""
    shipped, method = load(case), Method.parse(spelling, timestep)
    scene = shipped.scene
    sensors = [sensor for sensor in shipped.sensors if adapter.lacking(scene, sensor, method) is None]
    sensing = offers.prepare_sensing(adapter, scene, sensors, method)
    states, given = [], []
    for step in range(steps + 1):
        states.append(states_of(sensing.simulation.advance(np.array([min(step, 1)])), 1, 1, len(bodies(scene))))
        given.append(sensing.read())
    trajectory = trajectory_of(np.arange(steps + 1) * timestep, of_scene(np.concatenate(states, axis=1), scene))
    exactly = expected(scene, sensors, trajectory)
    names = [sensor.name for sensor in sensors]
    quaternion = trajectory.quaternion if trajectory.quaternion.ndim == 2 else trajectory.quaternion[0]
    return Readings(
        dict(zip(names, map(np.array, zip(*given, strict=True)), strict=True)),
        dict(zip(names, exactly, strict=True)),
        quaternion,
    )
