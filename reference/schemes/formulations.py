"""Equations of motion of one free rigid body with gravity and drag at its centre of mass, in two choices of velocity.

`world_velocity` uses the velocity of the centre of mass in the world frame and the angular velocity in the body frame, so
that poses move on SO(3) x R^3 and translation is independent of rotation. `body_twist` uses the components of the twist in
the body frame, so that poses move on SE(3) and the linear velocity changes as the body turns even where no force acts. The
rotation is the same in both; the numerical error of the position is not.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.inertia import inertia_tensor
from bodycheck.reference.scene import Body, Scene, Vector
from bodycheck.reference.schemes.increments import (
    Pair,
    Pose,
    add_scaled,
    cross,
    displace_se3,
    displace_so3_r3,
    dot,
    inverse_dexp_se3,
    inverse_dexp_so3_r3,
    rotate,
    rotate_inverse,
    scale_pair,
)
from bodycheck.reference.trajectory import Array


@dataclass(frozen=True)
class Formulation:
    """The equations of motion of a body in one choice of velocity.

    Attributes
    ----------
    displace
        Maps a pose and an increment (m, rad) to the displaced pose.
    inverse_dexp
        Maps an increment and a velocity to the rate of change of the increment that leads to motion with that velocity.
    acceleration
        Maps a pose and a velocity to the rate of change of the velocity (m/s^2, rad/s^2).
    relaxed_acceleration
        Maps a pose, a velocity and a time step h (s) to the solution x of (1 - h J) x = a, where a is the acceleration and J
        its derivative with respect to the velocity; see `one_step.rosenbrock_euler`.
    from_world, to_world
        Convert a linear velocity (m/s) of a body in some pose from and to components in the world frame.
    """

    displace: Callable[[Pose, Pair], Pose]
    inverse_dexp: Callable[[Pair, Pair], Pair]
    acceleration: Callable[[Pose, Pair], Pair]
    relaxed_acceleration: Callable[[Pose, Pair, float], Pair]
    from_world: Callable[[Pose, Vector], Vector]
    to_world: Callable[[Pose, Vector], Vector]


def world_velocity(scene: Scene) -> Formulation:
    """The formulation with the linear velocity in the world frame and the angular velocity in the body frame.

    The scene's plane, if any, is ignored.
    """
    spin, relaxed_spin = gyroscopic(scene.body)
    force = _force(scene)

    def acceleration(_pose: Pose, v: Pair) -> Pair:
        return force(v[0]), spin(v[1])

    def relaxed_acceleration(_pose: Pose, v: Pair, h: float) -> Pair:
        return force(v[0]), relaxed_spin(v[1], h)

    def unchanged(_pose: Pose, v: Vector) -> Vector:
        return v

    return Formulation(displace_so3_r3, inverse_dexp_so3_r3, acceleration, relaxed_acceleration, unchanged, unchanged)


def body_twist(scene: Scene) -> Formulation:
    """The formulation with both the linear and the angular velocity in the body frame.

    The scene's plane, if any, is ignored.
    """
    spin, relaxed_spin = gyroscopic(scene.body)
    force = _force(scene)

    def linear(pose: Pose, v: Pair) -> Vector:
        _, q = pose
        return add_scaled(rotate_inverse(q, force(rotate(q, v[0]))), -1.0, cross(v[1], v[0]))

    def acceleration(pose: Pose, v: Pair) -> Pair:
        return linear(pose, v), spin(v[1])

    def relaxed_acceleration(pose: Pose, v: Pair, h: float) -> Pair:
        change = relaxed_spin(v[1], h)
        # (1 + h Omega x) d = b, with b below, is solved as in Cayley's transform.
        _, (p, q, r) = w = scale_pair(h, v)
        b = add_scaled(linear(pose, v), h, cross(v[0], change))
        d = add_scaled(add_scaled(b, -1.0, cross(w[1], b)), dot(w[1], b), w[1])
        along = 1 / (1 + p * p + q * q + r * r)
        return (along * d[0], along * d[1], along * d[2]), change

    return Formulation(
        displace_se3,
        inverse_dexp_se3,
        acceleration,
        relaxed_acceleration,
        lambda pose, v: rotate_inverse(pose[1], v),
        lambda pose, v: rotate(pose[1], v),
    )


#: The formulations by the words that follow a scheme's name in results.
FORMULATIONS: dict[str, Callable[[Scene], Formulation]] = {"": world_velocity, " on the body twist": body_twist}


def gyroscopic(body: Body) -> tuple[Callable[[Vector], Vector], Callable[[Vector, float], Vector]]:
    """Euler's equations of a body without torque, in its own frame.

    Returns two functions of the angular velocity (rad/s). The first gives the angular acceleration a (rad/s^2). The second
    also takes a time step h (s) and gives the solution x of (1 - h J) x = a, where J is the Jacobian of a with respect to the
    angular velocity.
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
            add_scaled(unit, -h, inverse(add_scaled(cross(momentum, unit), -1.0, cross(omega, column))))
            for unit, column in zip(units, columns, strict=True)
        )
        a, yz = inverse(cross(momentum, omega)), cross(y, z)
        # Cramer's rule for the matrix with the columns x, y, z.
        determinant = dot(x, yz)
        return dot(a, yz) / determinant, dot(a, cross(z, x)) / determinant, dot(a, cross(x, y)) / determinant

    return acceleration, relaxed


def _force(scene: Scene) -> Callable[[Vector], Vector]:
    """Acceleration (m/s^2) by gravity and quadratic drag as a function of the velocity (m/s), both in the world frame."""
    gravity, resistance = scene.gravity, scene.drag / scene.body.mass

    def force(v: Vector) -> Vector:
        slowing = -resistance * math.sqrt(dot(v, v))
        return slowing * v[0], slowing * v[1], slowing * v[2] - gravity

    return force


def _operator(matrix: Array) -> Callable[[Vector], Vector]:
    """The function that multiplies a vector by a matrix (3, 3)."""
    (a, b, c), (d, e, f), (g, h, i) = matrix.tolist()

    def product(v: Vector) -> Vector:
        x, y, z = v
        return a * x + b * y + c * z, d * x + e * y + f * z, g * x + h * y + i * z

    return product
