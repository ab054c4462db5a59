"""Textbook one-step schemes on the exact equations of motion of one free rigid body, with gravity and drag at its centre.

A scheme moves a pose by increments and a velocity by accelerations (`increments`), and is the same for both ways to carry the
translation: with the velocity of the centre in the world frame, the rotation apart (SO(3) x R^3), or with the spatial twist,
whose components are in the body frame (SE(3)), where the linear velocity changes as the body turns even if nothing acts. The
rotation does not depend on that choice, the position does.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.inertia import inertia_tensor
from bodycheck.reference.scene import Body, Scene, Vector
from bodycheck.reference.schemes.increments import (
    Pair,
    Pose,
    advanced,
    cross,
    displace_apart,
    displace_screw,
    dot,
    plus,
    rate_apart,
    rate_screw,
    rotate,
    times,
    unrotate,
)
from bodycheck.reference.trajectory import Array

#: Relative change below which the implicit midpoint's iteration, where it gains no more, has been stopped by rounding.
SOLVED = 1e-12


@dataclass(frozen=True)
class Motion:
    """The equations of motion of a body in the velocities of one carrier.

    displace: a pose by an increment. rate: of an increment that leads to motion with some velocity (dexp^-1).
    acceleration: of a body in some pose with some velocity. relaxed_acceleration: the same and h more, see `rosenbrock_euler`.
    to_carrier, to_world: linear velocities between the world frame and the carrier's.
    """

    displace: Callable[[Pose, Pair], Pose]
    rate: Callable[[Pair, Pair], Pair]
    acceleration: Callable[[Pose, Pair], Pair]
    relaxed_acceleration: Callable[[Pose, Pair, float], Pair]
    to_carrier: Callable[[Pose, Vector], Vector]
    to_world: Callable[[Pose, Vector], Vector]


#: From pose and velocity to pose and velocity one time step (s) later.
Scheme = Callable[[Motion, Pose, Pair, float], tuple[Pose, Pair]]


def explicit_euler(motion: Motion, pose: Pose, v: Pair, h: float) -> tuple[Pose, Pair]:
    """Pose and velocity both with what they are at the beginning of the step. Order 1."""
    return motion.displace(pose, times(h, v)), advanced(v, h, motion.acceleration(pose, v))


def semi_implicit_euler(motion: Motion, pose: Pose, v: Pair, h: float) -> tuple[Pose, Pair]:
    """The velocity first, then the pose with the new velocity. Order 1."""
    v = advanced(v, h, motion.acceleration(pose, v))
    return motion.displace(pose, times(h, v)), v


def rosenbrock_euler(motion: Motion, pose: Pose, v: Pair, h: float) -> tuple[Pose, Pair]:
    """Linearly implicit: the change d of the velocity solves (1 - h J) d = h a, then the pose with the new velocity. Order 1.

    J is the derivative of the acceleration a by the velocity, as far as inertia makes it: gyroscopic torque, and on the twist
    the turning of the frame.
    """
    v = advanced(v, h, motion.relaxed_acceleration(pose, v, h))
    return motion.displace(pose, times(h, v)), v


def implicit_midpoint(motion: Motion, pose: Pose, v: Pair, h: float) -> tuple[Pose, Pair]:
    """Velocity and acceleration of the middle of the step, which is half an increment away; solved to rounding. Order 2.

    The iteration ends where neither part gains any more (Hairer, McLachlan and Razakarivony, BIT 48, 2008). Raises
    `ArithmeticError` where it does not converge, as it may not where the body turns by a radian or more in a step.
    """
    middle, least, gains = v, (math.inf, math.inf), True
    while gains:
        a = motion.acceleration(motion.displace(pose, times(h / 2, middle)), middle)
        previous, middle = middle, advanced(v, h / 2, a)
        linear, angular = _sizes(advanced(middle, -1.0, previous))
        gains = linear < least[0] or angular < least[1]
        least = min(linear, least[0]), min(angular, least[1])
    if not all(change <= SOLVED * size for change, size in zip(least, _sizes(middle), strict=True)):
        raise ArithmeticError("the implicit midpoint's equations are not solved")
    return motion.displace(pose, times(h, middle)), advanced(v, h, a)


def averaged_rk4(motion: Motion, pose: Pose, v: Pair, h: float) -> tuple[Pose, Pair]:
    """Classical Runge-Kutta whose stage velocities are added as if they shared one tangent space. Order 2 in attitude."""
    a1 = motion.acceleration(pose, v)
    v2 = advanced(v, h / 2, a1)
    a2 = motion.acceleration(motion.displace(pose, times(h / 2, v)), v2)
    v3 = advanced(v, h / 2, a2)
    a3 = motion.acceleration(motion.displace(pose, times(h / 2, v2)), v3)
    v4 = advanced(v, h, a3)
    a4 = motion.acceleration(motion.displace(pose, times(h, v3)), v4)
    return motion.displace(pose, times(h, _mean(v, v2, v3, v4))), advanced(v, h, _mean(a1, a2, a3, a4))


def munthe_kaas_rk4(motion: Motion, pose: Pose, v: Pair, h: float) -> tuple[Pose, Pair]:
    """Classical Runge-Kutta for the increment, with the exact inverse of dexp (Munthe-Kaas, BIT 38, 1998). Order 4."""

    def slope(u: Pair, velocity: Pair) -> tuple[Pair, Pair]:
        return motion.rate(u, velocity), motion.acceleration(motion.displace(pose, u), velocity)

    u1, a1 = v, motion.acceleration(pose, v)
    u2, a2 = slope(times(h / 2, u1), advanced(v, h / 2, a1))
    u3, a3 = slope(times(h / 2, u2), advanced(v, h / 2, a2))
    u4, a4 = slope(times(h, u3), advanced(v, h, a3))
    return motion.displace(pose, times(h, _mean(u1, u2, u3, u4))), advanced(v, h, _mean(a1, a2, a3, a4))


#: By their textbook names.
SCHEMES: dict[str, Scheme] = {
    "explicit Euler": explicit_euler,
    "semi-implicit Euler": semi_implicit_euler,
    "linearly implicit Euler": rosenbrock_euler,
    "implicit midpoint": implicit_midpoint,
    "averaged Runge-Kutta 4": averaged_rk4,
    "Runge-Kutta-Munthe-Kaas 4": munthe_kaas_rk4,
}


def rotation_apart(scene: Scene) -> Motion:
    """The motion of a scene's body in world-linear and body-angular velocities; a plane is not looked at."""
    spin, relaxed_spin = gyroscopic(scene.body)
    force = _force(scene)

    def acceleration(_pose: Pose, v: Pair) -> Pair:
        return force(v[0]), spin(v[1])

    def relaxed_acceleration(_pose: Pose, v: Pair, h: float) -> Pair:
        return force(v[0]), relaxed_spin(v[1], h)

    def unchanged(_pose: Pose, v: Vector) -> Vector:
        return v

    return Motion(displace_apart, rate_apart, acceleration, relaxed_acceleration, unchanged, unchanged)


def body_twist(scene: Scene) -> Motion:
    """The motion of a scene's body in the components of its twist in the body frame; a plane is not looked at."""
    spin, relaxed_spin = gyroscopic(scene.body)
    force = _force(scene)

    def linear(pose: Pose, v: Pair) -> Vector:
        _, q = pose
        return plus(unrotate(q, force(rotate(q, v[0]))), -1.0, cross(v[1], v[0]))

    def acceleration(pose: Pose, v: Pair) -> Pair:
        return linear(pose, v), spin(v[1])

    def relaxed_acceleration(pose: Pose, v: Pair, h: float) -> Pair:
        change = relaxed_spin(v[1], h)
        # (1 + h Omega x) d = b with the b below: the inverse is that of Cayley's transform.
        _, (p, q, r) = w = times(h, v)
        b = plus(linear(pose, v), h, cross(v[0], change))
        d = plus(plus(b, -1.0, cross(w[1], b)), dot(w[1], b), w[1])
        along = 1 / (1 + p * p + q * q + r * r)
        return (along * d[0], along * d[1], along * d[2]), change

    return Motion(
        displace_screw,
        rate_screw,
        acceleration,
        relaxed_acceleration,
        lambda pose, v: unrotate(pose[1], v),
        lambda pose, v: rotate(pose[1], v),
    )


#: The ways to carry the translation, by what they add to a scheme's name.
CARRIERS: dict[str, Callable[[Scene], Motion]] = {"": rotation_apart, " on the body twist": body_twist}


def gyroscopic(body: Body) -> tuple[Callable[[Vector], Vector], Callable[[Vector, float], Vector]]:
    """Euler's equations in the frame of a body: the angular acceleration a (rad/s^2), and the relaxed one.

    The latter solves (1 - h J) x = a for a time step h (s), with the Jacobian J of a by the angular velocity.
    """
    tensor = inertia_tensor(body)
    inertia, inverse = _operator(tensor), _operator(np.asarray(np.linalg.inv(tensor), dtype=np.float64))
    columns: list[Vector] = [(x, y, z) for x, y, z in tensor.T.tolist()]
    units: list[Vector] = [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)]

    def acceleration(omega: Vector) -> Vector:
        return inverse(cross(inertia(omega), omega))

    def relaxed(omega: Vector, h: float) -> Vector:
        momentum = inertia(omega)
        x, y, z = (
            plus(unit, -h, inverse(plus(cross(momentum, unit), -1.0, cross(omega, column))))
            for unit, column in zip(units, columns, strict=True)
        )
        a, yz = inverse(cross(momentum, omega)), cross(y, z)
        determinant = dot(x, yz)
        return dot(a, yz) / determinant, dot(a, cross(z, x)) / determinant, dot(a, cross(x, y)) / determinant

    return acceleration, relaxed


def step_through(
    scheme: Scheme, carrier: Callable[[Scene], Motion], scene: Scene, timestep: float, strides: NDArray[np.int64]
) -> Array:
    """States (n, 13) after each of n strides of a scheme from the initial state of a scene, whose plane is not looked at.

    timestep: s. strides: (n,) numbers of steps >= 0 from each sample to the next, the first from the start.
    Columns: position (world, m), quaternion (w x y z, body to world), velocity (world, m/s), angular velocity (body, rad/s).
    They are not numbers from where the scheme cannot go on.
    """
    motion, initial = carrier(scene), scene.initial
    pose: Pose = initial.position, initial.quaternion
    v: Pair = motion.to_carrier(pose, initial.velocity), initial.angular_velocity
    rows = np.full((len(strides), 13), np.nan)
    try:
        for row, stride in zip(rows, strides.tolist(), strict=True):
            for _ in range(stride):
                pose, v = scheme(motion, pose, v, timestep)
            row[:] = *pose[0], *pose[1], *motion.to_world(pose, v[0]), *v[1]
    except (ArithmeticError, ValueError):  # no solution, or an overflow, after which there is no sine of infinity
        pass
    return rows


def _force(scene: Scene) -> Callable[[Vector], Vector]:
    """Gravity and quadratic drag on the unit of mass (m/s^2) at a velocity, in the world frame."""
    gravity, resistance = scene.gravity, scene.drag / scene.body.mass

    def force(v: Vector) -> Vector:
        slowing = -resistance * math.sqrt(dot(v, v))
        return slowing * v[0], slowing * v[1], slowing * v[2] - gravity

    return force


def _operator(matrix: Array) -> Callable[[Vector], Vector]:
    """The product of a matrix (3, 3) and a vector."""
    (a, b, c), (d, e, f), (g, h, i) = matrix.tolist()

    def product(v: Vector) -> Vector:
        x, y, z = v
        return a * x + b * y + c * z, d * x + e * y + f * z, g * x + h * y + i * z

    return product


def _mean(one: Pair, two: Pair, three: Pair, four: Pair) -> Pair:
    """The average of the stages of the classical Runge-Kutta scheme."""
    return times(1 / 6, advanced(advanced(one, 2.0, advanced(two, 1.0, three)), 1.0, four))


def _sizes(v: Pair) -> tuple[float, float]:
    """The largest component of each part."""
    return max(map(abs, v[0])), max(map(abs, v[1]))
