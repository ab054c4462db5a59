"""Little engines of one free body without gravity: schemes written out with NumPy's matrices, in double or single precision.

They share no code with the schemes of the reference, so that one can be told by the other.
"""

from collections.abc import Callable

import numpy as np
from scipy.spatial.transform import Rotation

from bodycheck.reference.trajectory import Array

#: Takes a quaternion (4,), w x y z, the angular velocity (3,) in the world frame, the moments of inertia (3,) and a time step.
Step = Callable[[Array, Array, Array, np.floating], tuple[Array, Array]]


def hamilton(p: Array, q: Array) -> Array:
    """The product of two quaternions."""
    return np.concatenate([[p[0] * q[0] - p[1:] @ q[1:]], p[0] * q[1:] + q[0] * p[1:] + np.cross(p[1:], q[1:])]).astype(p.dtype)


def matrix(q: Array) -> Array:
    """The rotation matrix of a quaternion of any norm."""
    w, x, y, z = q / np.sqrt(q @ q)
    one = q.dtype.type(1)
    rows = [
        [one - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), one - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), one - 2 * (x * x + y * y)],
    ]
    return np.array(rows, dtype=q.dtype)


def rates(y: Array, moments: Array) -> Array:
    """The rates (7,) of a quaternion and the angular velocity in the world frame."""
    q, w = y[:4], y[4:]
    turn = matrix(q)
    inertia = turn @ np.diag(moments) @ turn.T
    vector = np.concatenate([np.zeros(1, dtype=y.dtype), w])
    return np.concatenate([hamilton(vector, q) / 2, np.linalg.solve(inertia, -np.cross(w, inertia @ w))]).astype(y.dtype)


def runge_kutta(stages: list[list[float]], weights: list[float]) -> Step:
    """An explicit scheme of quaternion and angular velocity, which is normalised after the step."""

    def step(q: Array, w: Array, moments: Array, h: np.floating) -> tuple[Array, Array]:
        start, slopes = np.concatenate([q, w]), []
        for row in stages:
            at = start + h * sum((start.dtype.type(a) * k for a, k in zip(row, slopes, strict=True)), np.zeros_like(start))
            slopes.append(rates(at, moments))
        end = start + h * sum((start.dtype.type(b) * k for b, k in zip(weights, slopes, strict=True)), np.zeros_like(start))
        return end[:4] / np.sqrt(end[:4] @ end[:4]), end[4:]

    return step


def implicit_euler(q: Array, w: Array, moments: Array, h: np.floating) -> tuple[Array, Array]:
    start = np.concatenate([q, w])
    end = start
    for _ in range(60):  # each iteration gains a factor of some h |w|
        end = start + h * rates(end, moments)
    return end[:4] / np.sqrt(end[:4] @ end[:4]), end[4:]


def linear_turn(q: Array, w: Array, h: np.floating) -> Array:
    """The attitude after a linear update of the quaternion, normalised."""
    moved = q + h / 2 * hamilton(np.concatenate([np.zeros(1, dtype=q.dtype), w]), q)
    return moved / np.sqrt(moved @ moved)


def gyroscopic(q: Array, w: Array, moments: Array, h: np.floating) -> Array:
    """The angular velocity in the world frame after an explicit step of Euler's equations."""
    return (w + h * rates(np.concatenate([q, w]), moments)[4:]).astype(q.dtype)


def linear_euler(q: Array, w: Array, moments: Array, h: np.floating) -> tuple[Array, Array]:
    w = gyroscopic(q, w, moments, h)
    return linear_turn(q, w, h), w


def momentum_euler(q: Array, w: Array, moments: Array, h: np.floating) -> tuple[Array, Array]:
    """Angular momentum of constant length in the body frame, and a rotation by the exponential map."""
    turn = matrix(q)
    body = turn.T @ w
    momentum = moments * body
    after = momentum + h * np.cross(momentum, body)
    body = after * np.sqrt(momentum @ momentum) / np.sqrt(after @ after) / moments
    x, y, z, s = (Rotation.from_quat(q, scalar_first=True) * Rotation.from_rotvec(h * body)).as_quat()
    q = np.array([s, x, y, z], dtype=q.dtype)
    return q, (matrix(q) @ body).astype(q.dtype)


def pose_difference(q: Array, w: Array, moments: Array, h: np.floating) -> tuple[Array, Array]:
    """The angular velocity is that of the turn that the linear update of the quaternion made."""
    after = linear_turn(q, gyroscopic(q, w, moments, h), h)
    difference = hamilton(after, q * np.array([1, -1, -1, -1], dtype=q.dtype))
    sine = np.sqrt(difference[1:] @ difference[1:])
    return after, (difference[1:] / sine * 2 * np.arctan2(sine, difference[0]) / h).astype(q.dtype)


def half_steps(step: Step, count: int) -> Step:
    def divided(q: Array, w: Array, moments: Array, h: np.floating) -> tuple[Array, Array]:
        for _ in range(count):
            q, w = step(q, w, moments, h / h.dtype.type(count))
        return q, w

    return divided


def fly(step: Step, moments: Array, spin: Array, timestep: float, strides: Array, precision: type[np.floating]) -> Array:
    """Rows (n, 7) of quaternions and angular velocities in the body frame after strides, from an unturned body that spins."""
    q, w = np.array([1, 0, 0, 0], dtype=precision), np.array(spin, dtype=precision)
    inertia, h, rows = np.array(moments, dtype=precision), precision(timestep), []
    for stride in strides:
        for _ in range(stride):
            q, w = step(q, w, inertia, h)
        rows.append(np.concatenate([q, matrix(q).T @ w]))
    return np.array(rows, dtype=np.float64)
