"""The states at the instants of readings and some steps before each, with what sensors should read there."""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bodycheck.adapters.driving import Controls
from bodycheck.reference.bodies import bodies, of_bodies
from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.mechanisms.coordinates import places
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.requirements import touches
from bodycheck.reference.sensors.efforts import acting_at
from bodycheck.reference.sensors.efforts import efforts as exerted
from bodycheck.reference.sensors.equations import equations, states_of
from bodycheck.reference.sensors.expected import accelerations, expected
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.sensors.truth import sensor_truth
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truth import at
from bodycheck.reference.truths import Truth

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


def of_window(
    scene: AnyScene, sensors: Sequence[Sensor], window: Trajectory, timestep: float
) -> tuple[Past, NDArray[np.bool_]]:
    """Return the past of readings after the steps of a window of states, and which of the states have one.

    The first states have no past that is long enough. timestep: that of the steps (s). Raises as `expected` does.
    """
    instants = np.arange(len(window))
    rows = instants[LAGS[-1] :] - np.array(LAGS)[:, None]
    driving = efforts(scene, window, timestep)
    linear, angular = accelerations(scene, window, driving)
    states, exactly = of_bodies(window), expected(scene, sensors, window, driving)
    return Past(scene, states, linear, angular, exactly, rows, timestep, _roundoff(states)), instants >= LAGS[-1]


def of_truth(truth: Truth, sensors: Sequence[Sensor], instants: Array, timestep: float) -> tuple[Past, NDArray[np.bool_]]:
    """Return the past of readings at instants (n,), s, with the states of the truth, and which of the instants have one.

    timestep: that of the steps before the readings (s); 0 if it is not known. Instants whose past begins before 0 are left out.
    Raises as `truth.truth` does.
    """
    lags = LAGS if timestep else LAGS[:1]
    chosen = instants >= lags[-1] * timestep * (1 - 1e-9)
    times = np.maximum(instants[chosen] - np.array(lags)[:, None] * timestep, 0.0)
    different, rows = np.unique(times, return_inverse=True)
    there = at(truth, different)
    nothing = np.full((len(bodies(truth.scene)), len(different), 3), np.nan)
    linear, angular = nothing, nothing
    if not touches(truth.scene):
        linear, angular = accelerations(truth.scene, there.trajectory, _efforts_of_truth(there))
    exactly = tuple(
        each.values if not each.reason else np.full((len(different), len(sensor.form.components)), np.nan)
        for sensor, each in zip(sensors, sensor_truth(there, sensors), strict=True)
    )
    states = of_bodies(there.trajectory)
    return Past(truth.scene, states, linear, angular, exactly, rows.reshape(times.shape), timestep, DOUBLE), chosen


def _efforts_of_truth(truth: Truth) -> Array | None:
    """Return the efforts (n, j) of the controllers of driven joints at the instants of a truth; None if no joint is driven."""
    if not isinstance(truth.scene, Mechanism) or not truth.scene.controllers:
        return None
    written = equations(truth.scene)
    states = states_of(written, of_bodies(truth.trajectory), truth.joints)
    return exerted(written, states, acting_at(truth)).astype(float)


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
    controls, acting = Controls(len(driven), controllers, [], staged=False), [np.zeros(len(driven))]
    for step, state in enumerate(zip(coordinates, velocities, strict=True)):
        acting.append(acting[-1])  # what acts until something else is computed
        controls.exert(step * Fraction(timestep), partial(_same, state), partial(acting.__setitem__, -1))
    return np.array(acting[1:])


def _same(state: tuple[Array, Array]) -> tuple[Array, Array]:
    return state


def _roundoff(states: Trajectory) -> float:
    """Return the unit roundoff of states: that of single precision if all of them are single-precision numbers."""
    parts: list[Any] = [states.position, states.quaternion, states.velocity, states.angular_velocity]
    with np.errstate(over="ignore"):
        single = all((values == values.astype(np.float32)).all() for values in parts)
    return SINGLE if single else DOUBLE
