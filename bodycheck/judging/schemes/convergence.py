"""Observe the convergence of a method for vanishing time steps: its order, and the remaining error.

The limit of a method may differ from the truth, for example with soft contacts. Therefore the order is determined from the
differences between runs with successive time steps, in which the limit cancels. The error of the limit is the floor. It is
distinguished from rounding, which smaller steps do not reduce either. Lost attitudes, which differ by about a radian at any
time step, have neither order nor floor; both are then taken from the beginning of the same runs.
"""

import math
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from itertools import pairwise
from typing import Literal

import numpy as np

from bodycheck.adapters.contract import Strides
from bodycheck.figures import mechanisms
from bodycheck.figures.conservation import angular_momentum_size, energy_size
from bodycheck.figures.definition import observe
from bodycheck.reference.kinematics import geodesic_angle, normalise
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.mechanisms.observables import floats
from bodycheck.reference.observables import Observables
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truths import Truth, distance

#: The observed quantities with their units. Energy and angular momentum are relative, as in the results.
UNITS = {"attitude": "rad", "position": "m", "energy": "", "angular_momentum": ""}

#: The smallest number of common instants of all runs, without the start.
MIN_COMMON_INSTANTS = 4

#: Errors are in the asymptotic range if at least this many successive local orders differ by at most this fraction.
MIN_ORDERS, MAX_ORDER_SPREAD = 3, 0.1

#: Local orders outside this range are caused by rounding, or by a lost motion.
MIN_ORDER, MAX_ORDER = 0.25, 10.0

#: Absolute and relative tolerance of a root, and the largest number of steps: the defaults of `scipy.optimize.brentq`.
ROOT_TOLERANCE, ROOT_PRECISION, MOST_ROOT_STEPS = 2e-12, 4 * sys.float_info.epsilon, 100

#: Attitudes of two runs that differ by more than this (rad) are not in an asymptotic range, because angles end at a half turn.
LOST_RAD = 0.5

#: Limits for a floor that counts as rounding: the rounding of a figure per step in units of roundoff (a step has some ten
#: roundings), and the growth of rounding along the motion (thousands in ten seconds of a flip).
STEP_ROUNDINGS, LARGEST_GROWTH = 16.0, 1e4

#: Runs do not converge if the ratio of a change to the previous change reaches this; at first order it is a half.
STALLED = 0.7

#: An error is the error of the limit if its ratio to the remaining change by convergence exceeds this.
FLOOR_RATIO = 3.0


#: The cause of a floor.
Cause = Literal["", "limit", "rounding"]


@dataclass(frozen=True)
class Convergence:
    """The observed convergence of one quantity.

    Attributes
    ----------
    order, low, high
        The median, the minimum and the maximum of the local orders in the asymptotic range; None if there is no such range.
    floor
        The error below which no time step gets; None if the error was still decreasing.
    cause
        The cause of the floor: "limit" for runs that tend to another motion, and "rounding" for the engine's precision; empty
        if there is no floor, or its cause is unknown.
    horizon
        The time (s) from the start in which order and floor were observed; None for the whole runs.
    """

    order: float | None
    low: float | None
    high: float | None
    floor: float | None
    cause: Cause = ""
    horizon: float | None = None


def observe_convergence(
    runs: Sequence[tuple[float, Trajectory]], truth: Truth, errors: Mapping[str, Sequence[float]], roundoff: float
) -> dict[str, Convergence]:
    """Return the convergence of each quantity that is measured; empty if the runs have too few instants in common.

    Parameters
    ----------
    runs
        The time steps (s) and trajectories of n runs of one method, the largest time step first.
    truth
        The truth of the scene.
    errors
        The largest error of each run, for each quantity.
    roundoff
        The unit roundoff of the engine's arithmetic.
    """
    trajectories = common([trajectory for _, trajectory in runs])
    if len(runs) < 2 or len(trajectories[0]) <= MIN_COMMON_INSTANTS:
        return {}
    timesteps = [timestep for timestep, _ in runs]
    seen = [measured(truth, trajectory) for trajectory in trajectories]
    convergences = {
        quantity: converge(
            timesteps,
            errors[quantity],
            [apart(quantity, *pair) for pair in pairwise(seen)],
            STEP_ROUNDINGS * LARGEST_GROWTH * roundoff * float(trajectories[0].t[-1]),
        )
        for quantity in seen[0]
    }
    if convergences["attitude"].order is None and apart("attitude", *seen[-2:]) > LOST_RAD:
        convergences["attitude"] = _at_first(timesteps, trajectories, truth, roundoff)
    return convergences


def _at_first(timesteps: Sequence[float], trajectories: Sequence[Trajectory], truth: Truth, roundoff: float) -> Convergence:
    """Return the convergence of lost attitudes, in the longest beginning of the runs that has an order.

    The beginning is halved until it has an order. All trajectories have the same instants.
    """
    count = len(trajectories[0])
    while (count := (count + 1) // 2) > MIN_COMMON_INSTANTS:
        parts = [trajectory.part(slice(0, count)) for trajectory in trajectories]
        exact = normalise(truth.at(parts[0].t).trajectory.quaternion)
        seen = [normalise(part.quaternion) for part in parts]
        errors = [float(geodesic_angle(attitudes, exact).max()) for attitudes in seen]
        changes = [float(geodesic_angle(coarse, fine).max()) for coarse, fine in pairwise(seen)]
        end = float(parts[0].t[-1])
        convergence = converge(timesteps, errors, changes, STEP_ROUNDINGS * LARGEST_GROWTH * roundoff * end)
        if convergence.order is not None:
            return replace(convergence, horizon=end)
    return Convergence(None, None, None, None)


def attitude_order(runs: Sequence[tuple[float, Trajectory]], truth: Truth) -> float:
    """Return the local order of the attitude from three runs of one method, with their time steps (s); NaN if there is none."""
    timesteps = [timestep for timestep, _ in runs]
    seen = [measured(truth, trajectory) for trajectory in common([trajectory for _, trajectory in runs])]
    (order,) = local_orders(timesteps, [apart("attitude", coarse, fine) for coarse, fine in pairwise(seen)])
    return order


def converge(
    timesteps: Sequence[float], errors: Sequence[float], changes: Sequence[float], rounded: float = 0.0
) -> Convergence:
    """Return the convergence of one quantity.

    Parameters
    ----------
    timesteps
        The n time steps (s), the largest first.
    errors
        The n errors.
    changes
        The n - 1 differences between runs with successive time steps.
    rounded
        The largest error that rounding can cause, multiplied by the time step (s).
    """
    window = asymptotic(local_orders(timesteps, changes))
    stays, cause = floor(timesteps, errors, changes, rounded)
    if not window:
        return Convergence(None, None, None, stays, cause)
    return Convergence(float(np.median(window)), min(window), max(window), stays, cause)


def local_orders(timesteps: Sequence[float], changes: Sequence[float]) -> list[float]:
    """Return the order p from each three successive time steps; NaN if they do not determine it.

    A deviation G h^p from the limit changes by |G| (h0^p - h1^p) and |G| (h1^p - h2^p); the ratio of the two gives p.
    """
    return [_local_order(*timesteps[index : index + 3], *changes[index : index + 2]) for index in range(len(timesteps) - 2)]


def _local_order(h0: float, h1: float, h2: float, first: float, second: float) -> float:
    def excess(p: float) -> float:
        return float((h0 / h1) ** p - 1 - first / second * (1 - (h2 / h1) ** p))

    if not (first > 0 and second > 0 and excess(MIN_ORDER) * excess(MAX_ORDER) < 0):
        return math.nan
    return root(excess, MIN_ORDER, MAX_ORDER)


def root(function: Callable[[float], float], first: float, second: float) -> float:
    """Return a root between two numbers at which the signs of a function differ, by Brent's method.

    Every operation is the same as in `scipy.optimize.brentq`, so that the root is the same number. SciPy's package takes longer
    to import than everything else that a judgement needs.

    R. P. Brent, Algorithms for Minimization Without Derivatives, chapter 4, Prentice-Hall 1973.
    """
    previous, present, opposite = first, second, 0.0
    at_previous, at_present, at_opposite = function(previous), function(present), 0.0
    last_step = step = 0.0
    if at_previous == 0:
        return previous
    for _ in range(MOST_ROOT_STEPS):
        if at_previous != 0 and at_present != 0 and (at_previous < 0) != (at_present < 0):
            opposite, at_opposite = previous, at_previous
            last_step = step = present - previous
        if abs(at_opposite) < abs(at_present):
            previous, present, opposite = present, opposite, present
            at_previous, at_present, at_opposite = at_present, at_opposite, at_present
        tolerance = (ROOT_TOLERANCE + ROOT_PRECISION * abs(present)) / 2
        half = (opposite - present) / 2
        if at_present == 0 or abs(half) < tolerance:
            return present
        last_step, step = _next_steps(
            (previous, present, opposite), (at_previous, at_present, at_opposite), (last_step, step), half, tolerance
        )
        previous, at_previous = present, at_present
        present += step if abs(step) > tolerance else math.copysign(tolerance, half)
        at_present = function(present)
    raise ArithmeticError(f"no root after {MOST_ROOT_STEPS} steps")


def _next_steps(
    points: tuple[float, float, float],
    values: tuple[float, float, float],
    steps: tuple[float, float],
    half: float,
    tolerance: float,
) -> tuple[float, float]:
    """Return the last and the next step of `root`: an interpolation if it is short enough, else a bisection.

    Parameters
    ----------
    points, values
        The previous, the present and the opposite point, and the values of the function there.
    steps
        The last two steps.
    half
        Half the distance to the opposite point.
    tolerance
        The smallest step.
    """
    (previous, present, opposite), (at_previous, at_present, at_opposite), (last_step, step) = points, values, steps
    if not (abs(last_step) > tolerance and abs(at_present) < abs(at_previous)):
        return half, half
    if previous == opposite:
        trial = -at_present * (present - previous) / (at_present - at_previous)
    else:
        slope = (at_previous - at_present) / (previous - present)
        slope_opposite = (at_opposite - at_present) / (opposite - present)
        trial = (
            -at_present
            * (at_opposite * slope_opposite - at_previous * slope)
            / (slope_opposite * slope * (at_opposite - at_previous))
        )
    return (step, trial) if 2 * abs(trial) < min(abs(last_step), 3 * abs(half) - tolerance) else (half, half)


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


def floor(
    timesteps: Sequence[float], errors: Sequence[float], changes: Sequence[float], rounded: float = 0.0
) -> tuple[float | None, Cause]:
    """Return the error that remains for vanishing time steps, None if the error was still decreasing, and its cause.

    If the remaining change by convergence, at first order or better, is far smaller than the last error, the last error
    remains, and its cause is the limit. If smaller time steps did not decrease the smallest error further, the smallest error
    remains. Its cause is rounding if rounding in as many steps can be as large, and the last change is not clearly smaller than
    the previous change, as it is for runs that tend to a limit. Parameters: see `converge`.
    """
    if not any(errors):
        return None, ""
    left = changes[-1] / (timesteps[-2] / timesteps[-1] - 1)
    if errors[-1] > FLOOR_RATIO * left:
        return errors[-1], "limit"
    smallest = int(np.argmin(errors))
    if smallest == len(errors) - 1:
        return None, ""
    shrinks = len(changes) > 1 and changes[-1] < STALLED * changes[-2]
    return errors[smallest], "rounding" if not shrinks and errors[smallest] <= rounded / timesteps[smallest] else ""


def common(trajectories: Sequence[Trajectory]) -> list[Trajectory]:
    """Return the trajectories at their common instants."""
    keys = [_keys(trajectory.t, max(float(t.t[-1]) for t in trajectories)) for trajectory in trajectories]
    shared = reduce(np.intersect1d, keys)
    places = [np.searchsorted(times, shared) for times in keys]
    return [trajectory.part(at) for trajectory, at in zip(trajectories, places, strict=True)]


def _keys(t: Array, longest: float) -> Strides:
    """Return instants as integers, because multiples of different time steps are equal only up to rounding."""
    return np.rint(t / longest * 2**40).astype(np.int64)


def measured(truth: Truth, trajectory: Trajectory) -> dict[str, Array]:
    """Return the values (..., n, k) of quantities of `UNITS` at the n instants of a trajectory.

    The angular momentum of a mechanism is included only if it is conserved, because it has no error otherwise.
    """
    scene = truth.scene
    reference, seen = observe(scene, truth.trajectory), observe(scene, trajectory)
    quantities = {
        "attitude": normalise(trajectory.quaternion),
        "position": trajectory.position,
        "energy": seen.total_energy[:, None] / energy_size(reference, truth.bounds.energy_error[0]),
    }
    if isinstance(scene, Mechanism):
        if floats(scene):
            momentum = mechanisms.angular_momentum_size(scene, truth, reference)
            quantities["angular_momentum"] = seen.angular_momentum / momentum
        return quantities
    assert isinstance(reference, Observables)
    size = angular_momentum_size(scene, reference, truth.bounds.angular_momentum_error[0])
    return quantities | {"angular_momentum": seen.angular_momentum / size}


def apart(quantity: str, one: dict[str, Array], other: dict[str, Array]) -> float:
    """Return the largest difference of a quantity over all instants."""
    difference = geodesic_angle if quantity == "attitude" else distance
    return float(difference(one[quantity], other[quantity]).max())
