"""Textbook one-step schemes for one free rigid body.

A scheme displaces a pose by increments and changes a velocity by accelerations, so that its code is the same for both choices
of velocity (see `formulations`).
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.scene import Scene, Vector
from bodycheck.reference.schemes.formulations import Equations, Formulation
from bodycheck.reference.schemes.increments import (
    Pair,
    Pose,
    add_scaled,
    add_scaled_pair,
    dot,
    scale_increment,
    scale_pair,
)
from bodycheck.reference.trajectory import Array

#: Largest relative change in the last iteration of an implicit scheme at which its equations count as solved to rounding.
SOLVED = 1e-12

#: Relative change of the velocity at which the iteration of velocity Verlet ends, which is the default of Simbody.
VERLET_TOLERANCE = 1e-4

#: A scheme. It takes the equations of motion, the pose and the velocity at the start of a step, and the time step (s), and
#: returns the pose and the velocity at the end of the step.
Scheme = Callable[[Formulation, Pose, Pair, float], tuple[Pose, Pair]]


def explicit_euler(formulation: Formulation, pose: Pose, v: Pair, h: float) -> tuple[Pose, Pair]:
    """Explicit Euler, a `Scheme` of order 1: pose and velocity change at their rates at the start of the step."""
    return _moved(formulation, pose, v, h), add_scaled_pair(v, h, formulation.acceleration(pose, v))


def semi_implicit_euler(formulation: Formulation, pose: Pose, v: Pair, h: float) -> tuple[Pose, Pair]:
    """Semi-implicit Euler, a `Scheme` of order 1: the velocity changes first, then the pose with the new velocity.

    With a quaternion q as coordinates the attitude changes to q + h q (0, w) / 2, normalised: a turn of 2 atan(h |w| / 2).
    """
    v = add_scaled_pair(v, h, formulation.acceleration(pose, v))
    return _moved(formulation, pose, v, h), v


def rosenbrock_euler(formulation: Formulation, pose: Pose, v: Pair, h: float) -> tuple[Pose, Pair]:
    """Linearly implicit Euler, a `Scheme` of order 1: the pose changes with the new velocity.

    The change d of the velocity solves (1 - h J) d = h a. J is the part of the derivative of the acceleration a with respect
    to the velocity that comes from inertia: the gyroscopic torque and, on the body twist, the rotation of the frame. Drag is
    not part of it.
    """
    v = add_scaled_pair(v, h, formulation.relaxed_acceleration(pose, v, h))
    return _moved(formulation, pose, v, h), v


def momentum_euler(formulation: Formulation, pose: Pose, v: Pair, h: float) -> tuple[Pose, Pair]:
    """Semi-implicit Euler of the angular momentum, a `Scheme` of order 1: its length is restored in each step.

    The momentum L in the body frame becomes |L| (L + h L x w) / |L + h L x w|, and the pose changes with the new velocity.
    """
    v = add_scaled_pair(v, h, formulation.scaled_acceleration(pose, v, h))
    return _moved(formulation, pose, v, h), v


def torque_free_euler(formulation: Formulation, pose: Pose, v: Pair, h: float) -> tuple[Pose, Pair]:
    """Semi-implicit Euler without the gyroscopic torque: the angular velocity stays constant.

    It does not converge to the motion of a body that tumbles.
    """
    v = add_scaled_pair(v, h, (formulation.acceleration(pose, v)[0], (0.0, 0.0, 0.0)))
    return _moved(formulation, pose, v, h), v


def of_turn(scheme: Scheme) -> Scheme:
    """The scheme with its final angular velocity replaced by the turn of the step divided by the time step.

    With a quaternion as coordinates the turn by w is 2 atan(h |w| / 2), so that w loses the fraction (h |w|)^2 / 12 a step.
    """

    def step(formulation: Formulation, pose: Pose, v: Pair, h: float) -> tuple[Pose, Pair]:
        pose, (linear, angular) = scheme(formulation, pose, v, h)
        half = h * math.sqrt(dot(angular, angular)) / 2
        return pose, (linear, _scaled(math.atan(half) / half if half else 1.0, angular))

    return step


def of_sine(scheme: Scheme) -> Scheme:
    """The scheme with its final angular velocity replaced by twice the sine of half the turn, divided by the time step.

    With a quaternion as coordinates the turn by w is 2 atan(h |w| / 2), and w is divided by the root of 1 + (h |w| / 2)^2.
    """

    def step(formulation: Formulation, pose: Pose, v: Pair, h: float) -> tuple[Pose, Pair]:
        pose, (linear, angular) = scheme(formulation, pose, v, h)
        return pose, (linear, _scaled(1 / math.sqrt(1 + h * h * dot(angular, angular) / 4), angular))

    return step


def substeps(count: int, scheme: Scheme) -> Scheme:
    """The scheme that takes `count` steps of another scheme in each step."""

    def step(formulation: Formulation, pose: Pose, v: Pair, h: float) -> tuple[Pose, Pair]:
        for _ in range(count):
            pose, v = scheme(formulation, pose, v, h / count)
        return pose, v

    return step


def velocity_verlet(formulation: Formulation, pose: Pose, v: Pair, h: float) -> tuple[Pose, Pair]:
    """Velocity Verlet with coordinates that are linear in their rates, a `Scheme` of order 2 (Swope and others, 1982).

    The coordinates change by h q' + h^2 q'' / 2. The velocity changes by h (a + a') / 2; the acceleration a' at the end depends
    on the new velocity, which is found by iteration from a step of explicit Euler, until it changes by less than the fraction
    `VERLET_TOLERANCE`, in at most ten iterations.
    """
    a = formulation.acceleration(pose, v)
    first, second = formulation.rate(pose, formulation.zero, v), formulation.rate(pose, formulation.zero, a)
    beyond = formulation.rate(pose, first, v)
    bent = tuple(change + then - now for change, then, now in zip(second[1], beyond[1], first[1], strict=True))
    moved = add_scaled(add_scaled((0.0, 0.0, 0.0), h, first[0]), h * h / 2, a[0])
    turned = tuple(h * x + h * h / 2 * y for x, y in zip(first[1], bent, strict=True))
    pose = formulation.displace(pose, (moved, turned))
    end, change = add_scaled_pair(v, h, a), math.inf
    for count in range(10):
        before, last = end, change
        end = add_scaled_pair(v, h / 2, add_scaled_pair(a, 1.0, formulation.acceleration(pose, end)))
        change = _norm(add_scaled_pair(end, -1.0, before)) / (_norm(before) or 1.0)
        if change <= VERLET_TOLERANCE or (count > 1 and change > last):
            break
    return pose, end


def implicit_midpoint(formulation: Formulation, pose: Pose, v: Pair, h: float) -> tuple[Pose, Pair]:
    """Implicit midpoint rule, a `Scheme` of order 2, solved to rounding.

    Velocity and acceleration are those at the middle of the step, half an increment away. The fixed-point iteration ends when
    the changes of both the linear and the angular part no longer become smaller (Hairer, McLachlan and Razakarivony, BIT 48,
    2008).

    Raises `ArithmeticError` if the iteration does not converge, which can happen if the body turns by a radian or more in a
    step.
    """
    middle, least, gains = v, (math.inf, math.inf), True
    while gains:
        a = formulation.acceleration(formulation.displace(pose, scale_pair(h / 2, middle)), middle)
        previous, middle = middle, add_scaled_pair(v, h / 2, a)
        linear, angular = _sizes(add_scaled_pair(middle, -1.0, previous))
        gains = linear < least[0] or angular < least[1]
        least = min(linear, least[0]), min(angular, least[1])
    if not all(change <= SOLVED * size for change, size in zip(least, _sizes(middle), strict=True)):
        raise ArithmeticError("the iteration of the implicit midpoint rule does not converge")
    return formulation.displace(pose, scale_pair(h, middle)), add_scaled_pair(v, h, a)


def step_through(scheme: Scheme, formulation: Equations, scene: Scene, timestep: float, strides: NDArray[np.int64]) -> Array:
    """States of a scheme at n samples, from the initial state of a scene.

    Parameters
    ----------
    scheme
        The scheme.
    formulation
        The function that makes the equations of motion of a scene, such as `formulations.world_velocity`.
    scene
        The scene. Its plane, if any, is ignored.
    timestep
        Time step (s).
    strides
        (n,) numbers of steps >= 0 from each sample to the next; the first counts from the initial state.

    Returns
    -------
    Array
        (n, 13) position (world, m), quaternion (w, x, y, z, body to world), velocity (world, m/s) and angular velocity (body,
        rad/s). Rows are NaN from the first sample that the scheme does not reach because its equations have no solution or a
        number overflows.
    """
    initial = scene.initial
    start = (initial.position, initial.quaternion), (initial.velocity, initial.angular_velocity)
    return step_from(scheme, formulation(scene), start, timestep, strides)


def step_from(
    scheme: Scheme, equations: Formulation, start: tuple[Pose, Pair], timestep: float, strides: NDArray[np.int64]
) -> Array:
    """States of a scheme at n samples, as from `step_through`, for equations of motion and a state to start from.

    start: position (m) and quaternion, velocity (world, m/s) and angular velocity (body, rad/s).
    """
    pose, velocities = start
    v = equations.from_state(pose, velocities)
    rows = np.full((len(strides), 13), np.nan)
    try:
        for row, stride in zip(rows, strides.tolist(), strict=True):
            for _ in range(stride):
                pose, v = scheme(equations, pose, v, timestep)
            linear, angular = equations.to_state(pose, v)
            row[:] = *pose[0], *pose[1], *linear, *angular
    except (ArithmeticError, ValueError):  # ValueError: after an overflow, the sine of infinity
        pass
    return rows


def _sizes(v: Pair) -> tuple[float, float]:
    """The largest absolute component of the linear part and of the angular part of a pair."""
    return max(map(abs, v[0])), max(map(abs, v[1]))


def _moved(formulation: Formulation, pose: Pose, v: Pair, h: float) -> Pose:
    """The pose after a step, in which it changes at the rate that belongs to a velocity at the start."""
    return formulation.displace(pose, scale_increment(h, formulation.rate(pose, formulation.zero, v)))


def _scaled(factor: float, v: Vector) -> Vector:
    return factor * v[0], factor * v[1], factor * v[2]


def _norm(v: Pair) -> float:
    return math.sqrt(dot(v[0], v[0]) + dot(v[1], v[1]))
