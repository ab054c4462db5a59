"""Observe the convergence of a method as the time step vanishes: its order, and the error that remains.

The limit of a method may differ from the truth, for example with soft contacts. Therefore the order is determined from the
differences between runs with successive time steps, in which the limit cancels. The error of the limit is the floor.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from itertools import pairwise

import numpy as np
from scipy.optimize import brentq

from bodycheck.adapters.contract import Strides
from bodycheck.figures.conservation import angular_momentum_size, energy_size
from bodycheck.reference.kinematics import geodesic_angle, normalise
from bodycheck.reference.observables import observe
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truth import Truth, distance

#: The observed quantities with their units. Energy and angular momentum are relative, as in the results.
UNITS = {"attitude": "rad", "position": "m", "energy": "", "angular_momentum": ""}

#: Smallest number of instants, without the start, that all runs must have in common.
MIN_COMMON_INSTANTS = 4

#: Errors are in the asymptotic range if at least this many successive local orders differ by at most this fraction.
MIN_ORDERS, MAX_ORDER_SPREAD = 3, 0.1

#: Local orders outside this range are caused by rounding, or by a motion that was lost.
MIN_ORDER, MAX_ORDER = 0.25, 10.0

#: Ratio of an error to the remaining change by convergence, above which it is the error of the limit.
FLOOR_RATIO = 3.0


@dataclass(frozen=True)
class Convergence:
    """The observed convergence of one quantity.

    Attributes
    ----------
    order, low, high
        The median, the minimum and the maximum of the local orders in the asymptotic range; None if there is no such range.
    floor
        The error below which no time step gets; None if the error was still decreasing.
    """

    order: float | None
    low: float | None
    high: float | None
    floor: float | None


def observe_convergence(
    runs: Sequence[tuple[float, Trajectory]], truth: Truth, errors: Mapping[str, Sequence[float]]
) -> dict[str, Convergence]:
    """Return the convergence of each quantity of `UNITS`; empty if the runs have too few instants in common.

    Parameters
    ----------
    runs
        The time steps (s) and trajectories of n runs of one method, the largest time step first.
    truth
        The truth of the scene.
    errors
        The largest error of each run, for each quantity.
    """
    trajectories = common([trajectory for _, trajectory in runs])
    if len(runs) < 2 or len(trajectories[0]) <= MIN_COMMON_INSTANTS:
        return {}
    timesteps = [timestep for timestep, _ in runs]
    seen = [measured(truth, trajectory) for trajectory in trajectories]
    return {
        quantity: converge(timesteps, errors[quantity], [apart(quantity, *pair) for pair in pairwise(seen)])
        for quantity in UNITS
    }


def attitude_order(runs: Sequence[tuple[float, Trajectory]], truth: Truth) -> float:
    """Return the local order of the attitude from three runs of one method, with their time steps (s); NaN if there is none."""
    timesteps = [timestep for timestep, _ in runs]
    seen = [measured(truth, trajectory) for trajectory in common([trajectory for _, trajectory in runs])]
    (order,) = local_orders(timesteps, [apart("attitude", coarse, fine) for coarse, fine in pairwise(seen)])
    return order


def converge(timesteps: Sequence[float], errors: Sequence[float], changes: Sequence[float]) -> Convergence:
    """Return the convergence of one quantity.

    Parameters
    ----------
    timesteps
        The n time steps (s), the largest first.
    errors
        The n errors.
    changes
        The n - 1 differences between runs with successive time steps.
    """
    window = asymptotic(local_orders(timesteps, changes))
    stays = floor(timesteps, errors, changes)
    return (
        Convergence(float(np.median(window)), min(window), max(window), stays)
        if window
        else Convergence(None, None, None, stays)
    )


def local_orders(timesteps: Sequence[float], changes: Sequence[float]) -> list[float]:
    """Return the order p from each three successive time steps; NaN if they determine none.

    A deviation G h^p from the limit changes by |G| (h0^p - h1^p) and |G| (h1^p - h2^p); the ratio of the two gives p.
    """
    return [_local_order(*timesteps[place : place + 3], *changes[place : place + 2]) for place in range(len(timesteps) - 2)]


def _local_order(h0: float, h1: float, h2: float, first: float, second: float) -> float:
    def excess(p: float) -> float:
        return float((h0 / h1) ** p - 1 - first / second * (1 - (h2 / h1) ** p))

    if not (first > 0 and second > 0 and excess(MIN_ORDER) * excess(MAX_ORDER) < 0):
        return math.nan
    return float(brentq(excess, MIN_ORDER, MAX_ORDER))


def asymptotic(orders: Sequence[float]) -> list[float]:
    """Return the longest sequence of successive local orders that agree; of several, the one with the smallest steps."""
    best: list[float] = []
    for start in range(len(orders)):
        for stop in range(start + MIN_ORDERS, len(orders) + 1):
            window = list(orders[start:stop])
            alike = all(map(math.isfinite, window)) and max(window) - min(window) <= MAX_ORDER_SPREAD * max(window)
            if alike and len(window) >= len(best):
                best = window
    return best


def floor(timesteps: Sequence[float], errors: Sequence[float], changes: Sequence[float]) -> float | None:
    """Return the error that remains for vanishing time steps; None if the error was still decreasing.

    It is the last error if the remaining change by convergence, at first order or better, is far smaller. It is the smallest
    error if smaller time steps did not decrease it further, because of rounding. Parameters are those of `converge`.
    """
    if not any(errors):
        return None
    left = changes[-1] / (timesteps[-2] / timesteps[-1] - 1)
    if errors[-1] > FLOOR_RATIO * left:
        return errors[-1]
    smallest = int(np.argmin(errors))
    return errors[smallest] if smallest < len(errors) - 1 else None


def common(trajectories: Sequence[Trajectory]) -> list[Trajectory]:
    """Return the trajectories at the instants that all of them have."""
    keys = [_keys(trajectory.t, max(float(t.t[-1]) for t in trajectories)) for trajectory in trajectories]
    shared = reduce(np.intersect1d, keys)
    places = [np.searchsorted(own, shared) for own in keys]
    return [trajectory.part(at) for trajectory, at in zip(trajectories, places, strict=True)]


def _keys(t: Array, longest: float) -> Strides:
    """Return instants as integers, because multiples of different time steps are equal only up to rounding."""
    return np.rint(t / longest * 2**40).astype(np.int64)


def measured(truth: Truth, trajectory: Trajectory) -> dict[str, Array]:
    """Return the values (n, k) of each quantity of `UNITS` at the n instants of a trajectory."""
    reference = observe(truth.scene, truth.trajectory)
    energy, momentum = energy_size(reference), angular_momentum_size(truth.scene, reference)
    seen = observe(truth.scene, trajectory)
    return {
        "attitude": normalise(trajectory.quaternion),
        "position": trajectory.position,
        "energy": seen.total_energy[:, None] / energy,
        "angular_momentum": seen.angular_momentum / momentum,
    }


def apart(quantity: str, one: dict[str, Array], other: dict[str, Array]) -> float:
    """Return the largest difference of a quantity over all instants."""
    difference = geodesic_angle if quantity == "attitude" else distance
    return float(difference(one[quantity], other[quantity]).max())
