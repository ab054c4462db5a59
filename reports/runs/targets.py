"""The targets of controllers as few points between which pictures and charts draw straight lines."""

import math

import numpy as np

from bodycheck.adapters.control_laws import value_of
from bodycheck.reference.mechanisms.control import Controller, Samples, Signal, Sine
from bodycheck.reference.trajectory import Array
from bodycheck.reports.series import corners

#: The points of a period of a sine, whose lines deviate from it by at most 0.5 % of its amplitude.
POINTS_OF_PERIOD = 32

#: The most points of a sine; a target with more periods than this allows is a grey area to the eye, and is not drawn.
MOST_POINTS = 3200


def target_of(controller: Controller, end: float, most: int) -> tuple[Array, Array] | None:
    """Return instants (n,), s, and values (n,), rad or m, of the target of a controller.

    At a jump two instants are one double apart. None if the controller follows no target, since kp and ki are zero, or if the
    target has too many periods.

    Parameters
    ----------
    controller
        The controller.
    end
        The last instant (s).
    most
        The most points.
    """
    if not (controller.kp or controller.ki):
        return None
    t = _instants(controller.target, end)
    if t is None:
        return None
    values = np.array([value_of(controller.target, time) for time in t.tolist()])
    kept = corners(t, values[:, None], most)
    return t[kept], values[kept]


def _instants(signal: Signal, end: float) -> Array | None:
    """Return the instants (s) at which a signal is read; None if it has too many periods."""
    if isinstance(signal, Sine):
        points = POINTS_OF_PERIOD * abs(signal.angular_frequency) * end / (2 * math.pi)
        return np.linspace(0.0, end, math.ceil(points) + 2) if points < MOST_POINTS else None
    within = np.array([time for time in signal.times if 0 < time < end]) if isinstance(signal, Samples) else np.empty(0)
    return np.unique(np.concatenate([[0.0], np.nextafter(within, 0), within, [end]]))
