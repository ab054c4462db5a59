"""The states that simulations return: their instants, and their form as trajectories."""

import numpy as np

from bodycheck.adapters.contract import Method, Strides
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.results.outcome import AdapterFault


def steps_to(times: Array, method: Method) -> Strides:
    """Return the numbers of steps (n,) of fixed size to times (n,), in s, which are multiples of the time step."""
    return np.rint(times / method.timestep).astype(np.int64)


def of_scene(states: Array, scene: AnyScene) -> Array:
    """Return the rows (n, 13) of one body, or (b, n, 13) of a mechanism, from the states (1, n, bodies, 13) of one scene."""
    return states[0].swapaxes(0, 1) if isinstance(scene, Mechanism) else states[0, :, 0]


def rows_of(states: object, scenes: int, count: int) -> Array:
    """Return the rows (scenes, count, 13) of states of single bodies, as `states_of` does."""
    return states_of(states, scenes, count, 1)[:, :, 0]


def states_of(states: object, scenes: int, count: int, bodies: int) -> Array:
    """Return the states (scenes, count, bodies, 13) in an engine's own type of array as an array of NumPy.

    Raises `AdapterFault` if the states are not of this number of scenes, instants and bodies.
    """
    if isinstance(states, np.ma.MaskedArray):
        raise AdapterFault("its states are a masked array")
    array = np.asarray(states)
    if array.dtype.kind not in "fiu":
        raise AdapterFault(f"its states are of the type {array.dtype}, not real numbers")
    if array.shape != (scenes, count, bodies, 13):
        raise AdapterFault(f"its states have the shape {array.shape}, not {(scenes, count, bodies, 13)}")
    return array.astype(np.float64)


def trajectory_of(times: Array, rows: Array) -> Trajectory:
    """Return the trajectory of states (..., k, 13) at times (n,), in s, of which the first k are used."""
    return Trajectory(times[: rows.shape[-2]], rows[..., :3], rows[..., 3:7], rows[..., 7:10], rows[..., 10:])
