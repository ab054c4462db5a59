"""The creep of a body that fingers should hold."""

import numpy as np
from numpy.typing import NDArray

from bodycheck.figures.definition import Comparison
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.trajectory import Array, Trajectory

#: The part at the end of a time without slip over which the creep is measured, after the contacts have settled.
LAST_PART = 0.5


def creep(compared: Comparison) -> float | None:
    """Return the mean speed (m/s) at which a body moves across its fingers while they should hold it; None if never.

    The largest value counts over the times in which the exact body does not move across them. Each mean is over the second
    half of such a time.
    """
    mechanism = compared.mechanism
    assert mechanism is not None  # fingers are on joints
    exact, seen = (_across(mechanism, motion) for motion in (compared.truth.trajectory, compared.trajectory))
    allowed = 2 * compared.truth.bounds.velocity_error
    t, speeds = compared.trajectory.t, []
    for first, last in _spans(np.linalg.norm(exact[1], axis=-1) <= allowed):
        begin = int(np.searchsorted(t, t[last] - LAST_PART * (t[last] - t[first])))
        if t[begin] < t[last]:
            speeds.append(float(np.linalg.norm(seen[0][last] - seen[0][begin]) / (t[last] - t[begin])))
    return max(speeds, default=None)


def _across(mechanism: Mechanism, motion: Trajectory) -> tuple[Array, Array]:
    """The position (n, 3), m, and the velocity (n, 3), m/s, of the free body relative to the middle of its fingers.

    Their parts along the line through the fingers are left out.
    """
    touched = {index for pair in mechanism.contacts for index in pair.bodies}
    fingers = sorted(index for index in touched if mechanism.joint_of[index] is not None)
    (body,) = touched - set(fingers)
    line = motion.position[fingers[-1]] - motion.position[fingers[0]]
    line = line / np.linalg.norm(line, axis=-1, keepdims=True)
    relative = (states[body] - states[fingers].mean(axis=0) for states in (motion.position, motion.velocity))
    position, velocity = (each - (each * line).sum(axis=-1, keepdims=True) * line for each in relative)
    return position, velocity


def _spans(mask: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """The first and last indices of the stretches (n,) in which a mask is true."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]])))
    return [(int(first), int(after) - 1) for first, after in edges.reshape(-1, 2)]
