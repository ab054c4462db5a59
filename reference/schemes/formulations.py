"""Equations of motion of one free rigid body with gravity and drag at its centre of mass, in two choices of velocity.

`world_velocity` uses the velocity of the centre of mass in the world frame and the angular velocity in the body frame, so
that poses move on SO(3) x R^3 and translation is independent of rotation. `body_twist` uses the components of the twist in
the body frame, so that poses move on SE(3) and the linear velocity changes as the body turns even where no force acts. The
rotation is the same in both; the numerical error of the position is not. `averaged` changes how the velocities of several
stages are combined. Formulations with coordinates of the attitude in place of the exponential map are in `coordinates`.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from bodycheck.reference.inertia import inertia_tensor
from bodycheck.reference.scene import Body, Scene, Vector
from bodycheck.reference.schemes.increments import (
    Increment,
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

#: Functions that return the angular acceleration (rad/s^2) at an angular velocity (rad/s), and over a step of a given length
#: (s).
Spin = Callable[[Vector], Vector]
SpinOver = Callable[[Vector, float], Vector]


@dataclass(frozen=True)
class Formulation:
    """The equations of motion of a body in one choice of velocity.

    Attributes
    ----------
    displace
        Maps a pose and an increment (m, rad) to the displaced pose.
    rate
        Maps a pose, an increment of it and the velocity of the displaced pose to the rate of change of the increment.
    acceleration
        Maps a pose and a velocity to the rate of change of the velocity (m/s^2, rad/s^2).
    relaxed_acceleration
        Maps a pose, a velocity and a time step h (s) to the solution x of (1 - h J) x = a, where a is the acceleration and J
        its derivative with respect to the velocity; see `one_step.rosenbrock_euler`.
    scaled_acceleration
        Maps a pose, a velocity and a time step h (s) to the mean acceleration of a step in which the angular momentum changes
        at its rate at the start, and is then scaled to its former length; see `one_step.momentum_euler`.
    from_state, to_state
        Map a pose and a velocity of states to the velocity of the formulation, and back. The velocity of states is the linear
        velocity (m/s) in the world frame and the angular velocity (rad/s) in the body frame.
    zero
        The increment of no displacement.
    """

    displace: Callable[[Pose, Increment], Pose]
    rate: Callable[[Pose, Increment, Pair], Increment]
    acceleration: Callable[[Pose, Pair], Pair]
    relaxed_acceleration: Callable[[Pose, Pair, float], Pair]
    scaled_acceleration: Callable[[Pose, Pair, float], Pair]
    from_state: Callable[[Pose, Pair], Pair]
    to_state: Callable[[Pose, Pair], Pair]
    zero: Increment = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


#: Makes the equations of motion of a scene.
Equations = Callable[[Scene], Formulation]


def world_velocity(scene: Scene) -> Formulation:
    """The formulation with the linear velocity in the world frame and the angular velocity in the body frame.

    The scene's plane, if any, is ignored.
    """
    spin, relaxed_spin, scaled_spin = gyroscopic(scene.body)
    force = force_of(scene)

    def acceleration(_pose: Pose, v: Pair) -> Pair:
        return force(v[0]), spin(v[1])

    def relaxed_acceleration(_pose: Pose, v: Pair, h: float) -> Pair:
        return force(v[0]), relaxed_spin(v[1], h)

    def scaled_acceleration(_pose: Pose, v: Pair, h: float) -> Pair:
        return force(v[0]), scaled_spin(v[1], h)

    return Formulation(
        displace_so3_r3,
        lambda _pose, u, v: inverse_dexp_so3_r3(u, v),
        acceleration,
        relaxed_acceleration,
        scaled_acceleration,
        unchanged,
        unchanged,
    )


def body_twist(scene: Scene) -> Formulation:
    """The formulation with both the linear and the angular velocity in the body frame.

    The scene's plane, if any, is ignored.
    """
    spin, relaxed_spin, scaled_spin = gyroscopic(scene.body)
    force = force_of(scene)

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
        lambda _pose, u, v: inverse_dexp_se3(u, v),
        acceleration,
        relaxed_acceleration,
        lambda pose, v, h: (linear(pose, v), scaled_spin(v[1], h)),
        lambda pose, v: (rotate_inverse(pose[1], v[0]), v[1]),
        lambda pose, v: (rotate(pose[1], v[0]), v[1]),
    )


def averaged(formulation: Equations) -> Equations:
    """The same equations, but velocities of different stages of a step are added as if they shared one tangent space.

    The rate of an increment is then the velocity itself, without the inverse of dexp.
    """

    def equations(scene: Scene) -> Formulation:
        return replace(formulation(scene), rate=lambda _pose, _u, v: v)

    return equations


def unchanged(_pose: Pose, v: Pair) -> Pair:
    """Return a velocity unchanged, for a formulation that uses the velocities of states."""
    return v


def gyroscopic(body: Body) -> tuple[Spin, SpinOver, SpinOver]:
    """Euler's equations of a body without torque, in its own frame.

    Returns three functions of the angular velocity w (rad/s). The first gives the angular acceleration a (rad/s^2). The others
    also take a time step h (s). The second gives the solution x of (1 - h J) x = a, where J is the Jacobian of a with respect
    to the angular velocity. The third gives the mean acceleration of a step in which the angular momentum L becomes
    |L| (L + h L x w) / |L + h L x w|.
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

    def scaled(omega: Vector, h: float) -> Vector:
        momentum = inertia(omega)
        turned = add_scaled(momentum, h, cross(momentum, omega))
        length = math.sqrt(dot(turned, turned))
        ratio = math.sqrt(dot(momentum, momentum)) / length if length else 0.0
        x, y, z = add_scaled((0.0, 0.0, 0.0), ratio, inverse(turned))
        return (x - omega[0]) / h, (y - omega[1]) / h, (z - omega[2]) / h

    return acceleration, relaxed, scaled


def force_of(scene: Scene) -> Callable[[Vector], Vector]:
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
