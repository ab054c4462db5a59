"""Bounds of the error of a slide, from the errors that the witness estimates."""

import math
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.scene import Scene
from bodycheck.reference.sliding.balance import Deviation, deviation, direction_of_first_axis
from bodycheck.reference.sliding.coupled_motion import Motion
from bodycheck.reference.trajectory import Array, Trajectory

#: Relative error of about ten roundings in double precision: the roundings in a closed form, and in the storage of a result.
RELATIVE_ROUNDING = 16 * float(np.finfo(float).eps)

#: Relative error of a yaw that is read from the quaternion of a trajectory. It is at most two roundings.
STORED_ROUNDING = 4 * float(np.finfo(float).eps)

#: Ratio of the bound to the error that the witness estimates. The estimate is linear in the error and takes the derivatives of
#: friction at the middle of a panel; twice the estimate is a bound even if a moment of inertia is a quarter too small.
SAFETY = 2.0


#: Error of the speed, as a fraction of the speed, up to which the estimate is trusted to be linear in the error.
LINEAR = 0.1


@dataclass(frozen=True, eq=False)
class PlanarBounds:
    """Bounds (n,) of the errors of position (m), yaw (rad), velocity (m/s) and spin (rad/s) at n instants."""

    position: Array
    yaw: Array
    velocity: Array
    spin: Array


def error_bounds(scene: Scene, motion: Motion, trajectory: Trajectory) -> PlanarBounds:
    """The bounds of a motion and of the trajectory made from it: twice the error that the witness estimates, and rounding.

    The bounds of position and yaw are the largest over all panels so far, whatever the n instants are.

    After the stop the true body may move on until friction has braked a velocity as large as the error. Until then the velocity
    is bounded by this error, and later by zero. The remaining distance is bounded by this error times the duration.

    Parameters
    ----------
    scene
        The scene.
    motion
        The motion at n instants.
    trajectory
        The trajectory in space at the same instants.

    Returns
    -------
    PlanarBounds
        The bounds. The bounds of position and yaw never decrease.
    """
    times, rows, start = trajectory.t, motion.rows, motion.panels.rows[0]
    estimate = deviation(scene, motion.panels)
    k = estimate.gyration
    panel = np.searchsorted(motion.panels.times[1:], times, side="left")
    largest = SAFETY * largest_deviation(estimate)
    (x, y, turn), (vx, vy, spin) = np.maximum.accumulate(largest[:, :3])[panel].T, largest[panel, 3:].T
    speed = math.hypot(start[3], start[4], k * start[5])
    velocity, spin = np.hypot(vx, vy) + RELATIVE_ROUNDING * speed, spin + RELATIVE_ROUNDING * speed / k
    way, turned = np.hypot(*(rows[:, :2] - start[:2]).T), np.abs(rows[:, 2] - start[2])
    stored = STORED_ROUNDING * (1 + np.abs(start[2]) + turned)
    differing = np.abs(_wrapped(direction_of_first_axis(trajectory.quaternion) - rows[:, 2]))
    position, yaw = np.hypot(x, y), turn + np.maximum(differing, stored)
    # Once the error of the speed is comparable to the speed, it is only known that both motions slow down.
    left, first = _nearly_at_rest(motion, estimate)
    late, lasting = panel >= first, left / estimate.braking if left else 0.0
    velocity, spin = np.maximum(velocity, late * left), np.maximum(spin, late * left / k)
    # A distance beyond the range of doubles is infinite, but only in the late panels.
    position, yaw = position + np.where(late, left * lasting, 0.0), yaw + np.where(late, left / k * lasting, 0.0)
    elapsed = times
    if motion.stop is not None:
        stop = float(motion.stop[0])
        elapsed, rate = np.minimum(times, stop), np.hypot(velocity, k * spin)
        # Without friction nothing is braked, and only a body that has no speed at all rests.
        braked = rate / estimate.braking if estimate.braking else np.where(rate > 0, np.inf, 0.0)
        resting = times > stop + braked + RELATIVE_ROUNDING * stop
        velocity, spin = np.where(resting, 0.0, velocity), np.where(resting, 0.0, spin)
    position = position + RELATIVE_ROUNDING * (np.abs(start[:2]).sum() + way + speed * elapsed)
    yaw = yaw + RELATIVE_ROUNDING * (1 + turned + speed / k * elapsed)
    return PlanarBounds(np.maximum.accumulate(position), np.maximum.accumulate(yaw), velocity, spin)


def largest_deviation(estimate: Deviation) -> Array:
    """The largest absolute estimated errors (n + 1, 6) in each of n panels and after them."""
    ends = np.abs(estimate.ends)
    return np.concatenate([np.maximum(ends[:-1], ends[1:]) + estimate.within, ends[-1:]])


def _nearly_at_rest(motion: Motion, estimate: Deviation) -> tuple[float, int]:
    """A bound of the error of the speed |u| (m/s) from a certain panel on, and the index of this panel.

    The panel is the first one at whose beginning the estimated error exceeds `LINEAR` times the speed, or else the stop, which
    follows the last panel. From then on neither motion is faster than the sum of that speed and the error. If there is neither
    such a panel nor a stop, the bound is zero and the index is the number of instants at which panels begin or end.
    """
    metric = np.array([1.0, 1.0, estimate.gyration])
    speeds = np.linalg.norm(motion.panels.rows[:, 3:] * metric, axis=1)
    errors = SAFETY * np.hypot.reduce(estimate.ends[:, 3:] * metric, axis=1)  # squares of large errors would overflow
    late = np.flatnonzero(errors > LINEAR * speeds)
    if len(late):
        first = int(late[0])
    elif motion.stop is not None:
        first = len(speeds) - 1
    else:
        return 0.0, len(speeds)
    return float(2 * speeds[first] + errors[first : first + 2].max()), first


def _wrapped(angle: Array) -> Array:
    """Angles (rad) minus full turns, in [-pi, pi]."""
    return np.asarray(angle - 2 * np.pi * np.round(angle / (2 * np.pi)))
