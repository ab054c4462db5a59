"""Textbook one-step schemes for one free rigid body.

A scheme displaces a pose by increments and changes a velocity by accelerations, so that it reads the same in both choices
of velocity (see `formulations`).
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.scene import Scene
from bodycheck.reference.schemes.formulations import Formulation
from bodycheck.reference.schemes.increments import Pair, Pose, add_scaled_pair, scale_pair
from bodycheck.reference.trajectory import Array

#: Largest relative change in the last iteration of the implicit midpoint at which its equations count as solved to rounding.
MIDPOINT_TOLERANCE = 1e-12

#: A scheme. It takes the equations of motion, the pose and the velocity at the start of a step, and the time step (s), and
#: returns the pose and the velocity at the end of the step.
Scheme = Callable[[Formulation, Pose, Pair, float], tuple[Pose, Pair]]


def explicit_euler(formulation: Formulation, pose: Pose, v: Pair, h: float) -> tuple[Pose, Pair]:
    """Explicit Euler, a `Scheme` of order 1: pose and velocity change at their rates at the start of the step."""
    return formulation.displace(pose, scale_pair(h, v)), add_scaled_pair(v, h, formulation.acceleration(pose, v))


def semi_implicit_euler(formulation: Formulation, pose: Pose, v: Pair, h: float) -> tuple[Pose, Pair]:
    """Semi-implicit Euler, a `Scheme` of order 1: the velocity changes first, then the pose with the new velocity."""
    v = add_scaled_pair(v, h, formulation.acceleration(pose, v))
    return formulation.displace(pose, scale_pair(h, v)), v


def rosenbrock_euler(formulation: Formulation, pose: Pose, v: Pair, h: float) -> tuple[Pose, Pair]:
    """Linearly implicit Euler, a `Scheme` of order 1: the pose changes with the new velocity.

    The change d of the velocity solves (1 - h J) d = h a. J is the part of the derivative of the acceleration a with respect
    to the velocity that comes from inertia: the gyroscopic torque and, on the body twist, the rotation of the frame. Drag is
    not part of it.
    """
    v = add_scaled_pair(v, h, formulation.relaxed_acceleration(pose, v, h))
    return formulation.displace(pose, scale_pair(h, v)), v


def implicit_midpoint(formulation: Formulation, pose: Pose, v: Pair, h: float) -> tuple[Pose, Pair]:
    """Implicit midpoint rule, a `Scheme` of order 2, solved to rounding.

    Velocity and acceleration are those at the middle of the step, half an increment away. The fixed-point iteration ends
    where the last change of neither the linear nor the angular part becomes smaller (Hairer, McLachlan and Razakarivony,
    BIT 48, 2008).

    Raises `ArithmeticError` where the iteration does not converge, which can happen where the body turns by a radian or more
    in a step.
    """
    middle, least, gains = v, (math.inf, math.inf), True
    while gains:
        a = formulation.acceleration(formulation.displace(pose, scale_pair(h / 2, middle)), middle)
        previous, middle = middle, add_scaled_pair(v, h / 2, a)
        linear, angular = _sizes(add_scaled_pair(middle, -1.0, previous))
        gains = linear < least[0] or angular < least[1]
        least = min(linear, least[0]), min(angular, least[1])
    if not all(change <= MIDPOINT_TOLERANCE * size for change, size in zip(least, _sizes(middle), strict=True)):
        raise ArithmeticError("the equations of the implicit midpoint rule are not solved")
    return formulation.displace(pose, scale_pair(h, middle)), add_scaled_pair(v, h, a)


def averaged_rk4(formulation: Formulation, pose: Pose, v: Pair, h: float) -> tuple[Pose, Pair]:
    """Classical Runge-Kutta with stage velocities averaged as if they shared one tangent space: a `Scheme` of order 2.

    The order is 2 in the attitude and, on the body twist, in the position; with the velocity in the world frame the
    translation is in a vector space and its order is 4.
    """
    a1 = formulation.acceleration(pose, v)
    v2 = add_scaled_pair(v, h / 2, a1)
    a2 = formulation.acceleration(formulation.displace(pose, scale_pair(h / 2, v)), v2)
    v3 = add_scaled_pair(v, h / 2, a2)
    a3 = formulation.acceleration(formulation.displace(pose, scale_pair(h / 2, v2)), v3)
    v4 = add_scaled_pair(v, h, a3)
    a4 = formulation.acceleration(formulation.displace(pose, scale_pair(h, v3)), v4)
    return formulation.displace(pose, scale_pair(h, _mean(v, v2, v3, v4))), add_scaled_pair(v, h, _mean(a1, a2, a3, a4))


def munthe_kaas_rk4(formulation: Formulation, pose: Pose, v: Pair, h: float) -> tuple[Pose, Pair]:
    """Runge-Kutta-Munthe-Kaas, a `Scheme` of order 4: classical Runge-Kutta for the increment (Munthe-Kaas, BIT 38, 1998).

    The inverse of dexp is exact, not truncated.
    """

    def slope(u: Pair, velocity: Pair) -> tuple[Pair, Pair]:
        return formulation.inverse_dexp(u, velocity), formulation.acceleration(formulation.displace(pose, u), velocity)

    u1, a1 = v, formulation.acceleration(pose, v)
    u2, a2 = slope(scale_pair(h / 2, u1), add_scaled_pair(v, h / 2, a1))
    u3, a3 = slope(scale_pair(h / 2, u2), add_scaled_pair(v, h / 2, a2))
    u4, a4 = slope(scale_pair(h, u3), add_scaled_pair(v, h, a3))
    return formulation.displace(pose, scale_pair(h, _mean(u1, u2, u3, u4))), add_scaled_pair(v, h, _mean(a1, a2, a3, a4))


#: The schemes by their textbook names, which results show.
SCHEMES: dict[str, Scheme] = {
    "explicit Euler": explicit_euler,
    "semi-implicit Euler": semi_implicit_euler,
    "linearly implicit Euler": rosenbrock_euler,
    "implicit midpoint": implicit_midpoint,
    "averaged Runge-Kutta 4": averaged_rk4,
    "Runge-Kutta-Munthe-Kaas 4": munthe_kaas_rk4,
}


def step_through(
    scheme: Scheme, formulation: Callable[[Scene], Formulation], scene: Scene, timestep: float, strides: NDArray[np.int64]
) -> Array:
    """States of a scheme at n samples, from the initial state of a scene.

    Parameters
    ----------
    scheme
        The scheme, one of `SCHEMES` or another.
    formulation
        The function that makes the equations of motion of a scene, one of `formulations.FORMULATIONS`.
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
    equations, initial = formulation(scene), scene.initial
    pose: Pose = initial.position, initial.quaternion
    v: Pair = equations.from_world(pose, initial.velocity), initial.angular_velocity
    rows = np.full((len(strides), 13), np.nan)
    try:
        for row, stride in zip(rows, strides.tolist(), strict=True):
            for _ in range(stride):
                pose, v = scheme(equations, pose, v, timestep)
            row[:] = *pose[0], *pose[1], *equations.to_world(pose, v[0]), *v[1]
    except (ArithmeticError, ValueError):  # ValueError: after an overflow, the sine of infinity
        pass
    return rows


def _mean(one: Pair, two: Pair, three: Pair, four: Pair) -> Pair:
    """The weighted mean of the four stages of the classical Runge-Kutta scheme."""
    return scale_pair(1 / 6, add_scaled_pair(add_scaled_pair(one, 2.0, add_scaled_pair(two, 1.0, three)), 1.0, four))


def _sizes(v: Pair) -> tuple[float, float]:
    """The largest absolute component of the linear and of the angular part."""
    return max(map(abs, v[0])), max(map(abs, v[1]))
