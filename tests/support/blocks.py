"""Scenes of one block on a plane, and the motion of a block by an integration that knows forces alone."""

import math
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from bodycheck.reference.inertia import principal_moments
from bodycheck.reference.scene import Body, Brick, Plane, Push, Quaternion, Scene, State, Vector
from bodycheck.reference.trajectory import Array

#: Half-lengths (m) and mass (kg) of the block, and gravity (m/s^2).
HALVES = 0.3, 0.2, 0.1
MASS = 2.0
GRAVITY = 9.81

#: The speed (m/s) from which on a stop is straight.
SLOW = 1e-9


def in_world(incline: float, vector: Vector) -> Vector:
    """A vector along the axes of a plane, along those of the world."""
    x, y, z = vector
    c, s = math.cos(incline), math.sin(incline)
    return c * x + s * z, y, c * z - s * x


def block_on(
    plane: Plane, velocity: Vector = (0.0, 0.0, 0.0), *pushes: Push, yaw: float = 0.0, gravity: float = GRAVITY
) -> Scene:
    """A brick that lies on a plane at the origin. velocity, and the forces of the pushes: along the axes of the plane."""
    half, turn = plane.incline / 2, yaw / 2
    attitude: Quaternion = (
        math.cos(half) * math.cos(turn),
        math.sin(half) * math.sin(turn),
        math.sin(half) * math.cos(turn),
        math.cos(half) * math.sin(turn),
    )
    start = State(in_world(plane.incline, (0.0, 0.0, HALVES[2])), attitude, in_world(plane.incline, velocity))
    acting = tuple(Push(in_world(plane.incline, push.force), push.point, push.start, push.end) for push in pushes)
    return Scene(Body(MASS, principal_moments(Brick(HALVES), MASS), Brick(HALVES)), start, gravity, plane, pushes=acting)


def integrated(plane: Plane, velocity: Vector, pushes: tuple[Push, ...], times: Array, gravity: float = GRAVITY) -> Array:
    """Places and velocities (n, 4) along the plane by DOP853, piece by piece between pushes and stops.

    The forces of the pushes are along the axes of the plane.
    """
    states = np.full((len(times), 4), np.nan)
    state, last = np.array([0.0, 0.0, *velocity[:2]]), float(times[-1])
    instants = (0.0, last, *(at for push in pushes for at in (push.start, push.end) if at < last))
    for begin, end in pairwise(sorted(set(instants))):
        force = sum((np.array(push.force) for push in pushes if push.start <= begin < push.end), np.zeros(3))
        drive = np.array([gravity * math.sin(plane.incline), 0.0]) + force[:2] / MASS
        brake = plane.friction * (gravity * math.cos(plane.incline) - force[2] / MASS)
        now = begin
        while now < end:
            way, stop = _moved(state, drive, brake, now, end)
            inside = (times >= now) & (times <= stop)
            states[inside] = way(times[inside]).T
            state, now = way(stop), stop
            if stop < end:  # the rest of a stop, along which the deceleration is constant
                speed = float(np.hypot(*state[2:]))
                passed = speed / -float((drive - brake * state[2:] / speed) @ state[2:] / speed)
                state, now = np.array([*(state[:2] + state[2:] * passed / 2), 0.0, 0.0]), now + passed
    return states


def _moved(state: Array, drive: Array, brake: float, begin: float, end: float) -> tuple[Callable[[Any], Array], float]:
    """The motion from one instant to another or until the block is slower than `SLOW`, and when it ends."""
    if not state[2:].any():
        if np.hypot(*drive) <= brake:
            held = state.copy()
            return lambda t: np.multiply.outer(held, np.ones_like(t)), end
        state = state + np.concatenate([np.zeros(2), 1e-30 * drive])

    def rates(_: float, y: Array) -> Array:
        return np.concatenate([y[2:], drive - brake * y[2:] / np.hypot(y[2], y[3])])

    def stopped(_: float, y: Array) -> float:
        return float(np.hypot(y[2], y[3])) - SLOW

    setattr(stopped, "terminal", True)  # noqa: B010  (so SciPy wants it)
    setattr(stopped, "direction", -1)  # noqa: B010
    way = solve_ivp(
        rates, (begin, end), state, "DOP853", rtol=3e-14, atol=1e-16, max_step=0.02, events=stopped, dense_output=True
    )
    return way.sol, float(way.t[-1])
