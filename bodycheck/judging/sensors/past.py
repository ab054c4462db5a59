"""The states at the instants of readings and some steps before each, with what sensors should read there."""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bodycheck.adapters.driving import Controls
from bodycheck.reference.bodies import of_bodies
from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.mechanisms.coordinates import places
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.sensors.expected import accelerations, expected
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array, Trajectory

#: The numbers of steps before each reading at which states are known. Values between them are interpolated by cubics.
LAGS = (0, 1, 2, 3)

#: The unit roundoffs of double and single precision.
DOUBLE, SINGLE = 2.0**-53, 2.0**-24


@dataclass(frozen=True, eq=False)
class Past:
    """States at N instants, from which those at n readings and at each lag before them are selected.

    Attributes
    ----------
    scene
        The scene.
    states
        The states (b, N, ...) of the bodies.
    linear, angular
        The accelerations (b, N, 3) of the centres of mass along the axes of the world (m/s^2), and the angular accelerations
        along the axes of the bodies (rad/s^2), by the equations of motion at the states.
    values
        For each sensor, what it should read at the states (N, k).
    rows
        The indices (lags, n) of the states at each lag before each reading.
    timestep
        The length (s) of a step; 0 if it is not known, and there is then one lag.
    roundoff
        The unit roundoff of the states.
    """

    scene: AnyScene
    states: Trajectory
    linear: Array
    angular: Array
    values: tuple[Array, ...]
    rows: NDArray[np.intp]
    timestep: float
    roundoff: float


def of_window(scene: AnyScene, sensors: Sequence[Sensor], window: Trajectory, timestep: float) -> Past | None:
    """Return the past of the readings after the steps of a window of states, except the first steps, whose past is too short.

    Returns None if the window has too few steps, or a state that is not finite.
    """
    states, count = of_bodies(window), len(window) - LAGS[-1]
    if count < 1 or not all(np.isfinite(values).all() for values in (states.position, states.velocity, states.quaternion)):
        return None
    rows = np.arange(count)[None] + LAGS[-1] - np.array(LAGS)[:, None]
    return past(scene, sensors, window, rows, timestep, efforts(scene, window, timestep))


def past(
    scene: AnyScene,
    sensors: Sequence[Sensor],
    states: Trajectory,
    rows: NDArray[np.intp],
    timestep: float,
    driving: Array | None,
) -> Past:
    """Return the past from states (N, ...) or (b, N, ...) and the efforts (N, j) of driven joints. For the others see `Past`."""
    linear, angular = accelerations(scene, states, driving)
    values = expected(scene, sensors, states, driving)
    bodies = of_bodies(states)
    return Past(scene, bodies, linear, angular, values, rows, timestep, _roundoff(bodies))


def efforts(scene: AnyScene, window: Trajectory, timestep: float) -> Array | None:
    """Return the efforts (n, j) of the controllers of driven joints after each step of a window of states, the start first.

    Controllers compute at the ends of steps, from the states there. Returns None if no joint is driven.
    """
    if not isinstance(scene, Mechanism) or not scene.driven:
        return None
    motion, driven = kinematics.joints(scene, window), scene.driven
    slices = [places(scene)[joint] for joint in driven]
    coordinates = np.stack([motion.position[:, each][:, 0] for each, _ in slices], axis=1)
    velocities = np.stack([motion.velocity[:, each][:, 0] for _, each in slices], axis=1)
    controllers = [(driven.index(each.joint), each) for each in scene.controllers]
    controls, exerted = Controls(len(driven), controllers, [], staged=False), [np.zeros(len(driven))]
    for step, state in enumerate(zip(coordinates, velocities, strict=True)):
        exerted.append(exerted[-1])  # what acts until something else is computed
        controls.exert(step * Fraction(timestep), partial(_same, state), partial(exerted.__setitem__, -1))
    return np.array(exerted[1:])


def _same(state: tuple[Array, Array]) -> tuple[Array, Array]:
    return state


def _roundoff(states: Trajectory) -> float:
    """Return the unit roundoff of states: that of single precision if all of them are single-precision numbers."""
    parts: list[Any] = [states.position, states.quaternion, states.velocity, states.angular_velocity]
    with np.errstate(over="ignore"):
        single = all((values == values.astype(np.float32)).all() for values in parts)
    return SINGLE if single else DOUBLE
