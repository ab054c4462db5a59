"""How a method converges as its time step vanishes: the order that is observed, and the error that stays.

A method tends to some limit, which need not be the truth: a soft contact's is not. Its order is therefore read off the
differences between runs with successive time steps, in which the limit cancels, and what the limit is off by is its floor.
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

#: The quantities that are observed, with their units. Energy and angular momentum are relative, as in the results.
UNITS = {"attitude": "rad", "position": "m", "energy": "", "angular_momentum": ""}

#: Instants that all runs must have in common, the start aside.
FEWEST_INSTANTS = 4

#: Errors are in the asymptotic range where so many successive local orders, or more, differ by at most this part of them.
FEWEST_ORDERS, ALIKE = 3, 0.1

#: Local orders beyond these are those of rounding, or of a motion that was lost.
LOWEST, HIGHEST = 0.25, 10.0


#: An error so many times larger than what is left of its convergence is that of the limit.
STANDING = 3.0


@dataclass(frozen=True)
class Convergence:
    """order: the median of the local orders in the asymptotic range, low and high their extremes; None where there is none.

    floor: the error that the method does not get below however small its step; None where it was still falling.
    """

    order: float | None
    low: float | None
    high: float | None
    floor: float | None


def observe_convergence(
    runs: Sequence[tuple[float, Trajectory]], truth: Truth, errors: Mapping[str, Sequence[float]]
) -> dict[str, Convergence]:
    """The convergence of each of `UNITS`; none where the runs have too few instants in common.

    runs: n time steps (s), the largest first, and trajectories of one method. truth: of their scene. errors: the n largest
    ones of each quantity, over all samples of each run.
    """
    trajectories = common([trajectory for _, trajectory in runs])
    if len(runs) < 2 or len(trajectories[0]) <= FEWEST_INSTANTS:
        return {}
    timesteps = [timestep for timestep, _ in runs]
    seen = [measured(truth, trajectory) for trajectory in trajectories]
    return {
        quantity: converge(timesteps, errors[quantity], [apart(quantity, *pair) for pair in pairwise(seen)])
        for quantity in UNITS
    }


def attitude_order(runs: Sequence[tuple[float, Trajectory]], truth: Truth) -> float:
    """The local order in attitude from three runs of one method, as above; nan where they tell none."""
    timesteps = [timestep for timestep, _ in runs]
    seen = [measured(truth, trajectory) for trajectory in common([trajectory for _, trajectory in runs])]
    (order,) = local_orders(timesteps, [apart("attitude", coarse, fine) for coarse, fine in pairwise(seen)])
    return order


def converge(timesteps: Sequence[float], errors: Sequence[float], changes: Sequence[float]) -> Convergence:
    """The convergence of n errors with their time steps, the largest first, and of the n - 1 changes between them."""
    window = asymptotic(local_orders(timesteps, changes))
    stays = floor(timesteps, errors, changes)
    return (
        Convergence(float(np.median(window)), min(window), max(window), stays)
        if window
        else Convergence(None, None, None, stays)
    )


def local_orders(timesteps: Sequence[float], changes: Sequence[float]) -> list[float]:
    """The order p from each three successive steps, nan where they tell none.

    An error G h^p above any limit changes by |G| (h0^p - h1^p) and |G| (h1^p - h2^p); their ratio gives p.
    """
    return [_local_order(*timesteps[place : place + 3], *changes[place : place + 2]) for place in range(len(timesteps) - 2)]


def _local_order(h0: float, h1: float, h2: float, first: float, second: float) -> float:
    def excess(p: float) -> float:
        return float((h0 / h1) ** p - 1 - first / second * (1 - (h2 / h1) ** p))

    if not (first > 0 and second > 0 and excess(LOWEST) * excess(HIGHEST) < 0):
        return math.nan
    return float(brentq(excess, LOWEST, HIGHEST))


def asymptotic(orders: Sequence[float]) -> list[float]:
    """The longest run of successive local orders that agree, of several the one with the finest steps; empty if none does."""
    best: list[float] = []
    for start in range(len(orders)):
        for stop in range(start + FEWEST_ORDERS, len(orders) + 1):
            window = list(orders[start:stop])
            alike = all(map(math.isfinite, window)) and max(window) - min(window) <= ALIKE * max(window)
            if alike and len(window) >= len(best):
                best = window
    return best


def floor(timesteps: Sequence[float], errors: Sequence[float], changes: Sequence[float]) -> float | None:
    """The error that stays, from n errors and the n - 1 changes between them.

    It is the last error where what is left of its convergence, at first order or better, is far smaller. It is the smallest
    error where finer steps than that one's have not made it smaller: rounding.
    """
    if not any(errors):
        return None
    left = changes[-1] / (timesteps[-2] / timesteps[-1] - 1)
    if errors[-1] > STANDING * left:
        return errors[-1]
    smallest = int(np.argmin(errors))
    return errors[smallest] if smallest < len(errors) - 1 else None


def common(trajectories: Sequence[Trajectory]) -> list[Trajectory]:
    """The trajectories at the instants that all of them have."""
    keys = [_keys(trajectory.t, max(float(t.t[-1]) for t in trajectories)) for trajectory in trajectories]
    shared = reduce(np.intersect1d, keys)
    places = [np.searchsorted(own, shared) for own in keys]
    return [trajectory.part(at) for trajectory, at in zip(trajectories, places, strict=True)]


def _keys(t: Array, longest: float) -> Strides:
    """Instants as whole numbers: multiples of different time steps meet to rounding only."""
    return np.rint(t / longest * 2**40).astype(np.int64)


def measured(truth: Truth, trajectory: Trajectory) -> dict[str, Array]:
    """The values (n, k) of each of `UNITS`."""
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
    """The largest difference of a quantity at any instant."""
    difference = geodesic_angle if quantity == "attitude" else distance
    return float(difference(one[quantity], other[quantity]).max())
