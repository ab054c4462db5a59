"""Equations of motion in coordinates of the attitude: the four components of a quaternion, or three angles.

Schemes add increments to these coordinates as to any vector, instead of turning the body by the exponential map. A quaternion
therefore does not keep its norm within a step. It is normalised after each step. Its rate is linear in the quaternion, so that
a scheme that never normalises the quaternion turns the body in the same way.
"""

import math
from collections.abc import Callable

from bodycheck.reference.scene import Quaternion, Scene, Vector
from bodycheck.reference.schemes.formulations import Formulation, force_of, gyroscopic, unchanged, world_velocity
from bodycheck.reference.schemes.increments import Increment, Pair, Pose, add_scaled, product, rotate, rotate_inverse

#: The functions `displace` and `rate` of a `Formulation`.
Displace = Callable[[Pose, Increment], Pose]
Rate = Callable[[Pose, Increment, Pair], Increment]

#: The increment of no displacement, for both kinds of coordinates.
STILL_QUATERNION: Increment = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0))
STILL_ANGLES: Increment = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


def quaternion_and_body_rates(scene: Scene) -> Formulation:
    """The formulation with the quaternion q and the angular velocity w in the body frame: dq/dt = q (0, w) / 2.

    The linear velocity is in the world frame. The scene's plane, if any, is ignored.
    """

    def rate(pose: Pose, u: Increment, v: Pair) -> Increment:
        return v[0], product(_moved(pose[1], u), (0.0, *v[1]), 0.5)

    motion = world_velocity(scene)
    return Formulation(
        displace_quaternion,
        rate,
        motion.acceleration,
        motion.relaxed_acceleration,
        motion.scaled_acceleration,
        unchanged,
        unchanged,
        STILL_QUATERNION,
    )


def quaternion_and_world_rates(scene: Scene) -> Formulation:
    """The formulation with the quaternion q and the angular velocity w in the world frame: dq/dt = (0, w) q / 2.

    The angular acceleration is that of Euler's equations with the tensor of inertia of the attitude, R I R^T. The linear
    velocity is in the world frame. The scene's plane, if any, is ignored.
    """

    def rate(pose: Pose, u: Increment, v: Pair) -> Increment:
        return v[0], product((0.0, *v[1]), _moved(pose[1], u), 0.5)

    return _with_world_rates(scene, displace_quaternion, rate, STILL_QUATERNION)


def angles_and_world_rates(scene: Scene) -> Formulation:
    """The formulation with turns about x, then y, then z of the body, and the angular velocity in the world frame.

    The rates of the angles a, b, c at the angular velocity (p, q, r) in the body frame are

        a' = (p cos c - q sin c) / cos b,    b' = p sin c + q cos c,    c' = r - a' sin b.

    They are infinite in gimbal lock, where b is a right angle. The linear velocity is in the world frame. The scene's plane, if
    any, is ignored.
    """

    def rate(pose: Pose, u: Increment, v: Pair) -> Increment:
        _, b, c = added(angles(pose[1]), u[1])
        p, q, r = rotate_inverse(displace_angles(pose, u)[1], v[1])
        first = (p * math.cos(c) - q * math.sin(c)) / math.cos(b)
        return v[0], (first, p * math.sin(c) + q * math.cos(c), r - first * math.sin(b))

    return _with_world_rates(scene, displace_angles, rate, STILL_ANGLES)


def _with_world_rates(scene: Scene, displace: Displace, rate: Rate, zero: Increment) -> Formulation:
    """A formulation with the angular velocity in the world frame, from its functions `displace` and `rate`."""
    spin, relaxed_spin, scaled_spin = gyroscopic(scene.body)
    force = force_of(scene)

    def acceleration(pose: Pose, v: Pair) -> Pair:
        return force(v[0]), rotate(pose[1], spin(rotate_inverse(pose[1], v[1])))

    def relaxed_acceleration(pose: Pose, v: Pair, h: float) -> Pair:
        return force(v[0]), rotate(pose[1], relaxed_spin(rotate_inverse(pose[1], v[1]), h))

    def scaled_acceleration(pose: Pose, v: Pair, h: float) -> Pair:
        return force(v[0]), rotate(pose[1], scaled_spin(rotate_inverse(pose[1], v[1]), h))

    return Formulation(
        displace,
        rate,
        acceleration,
        relaxed_acceleration,
        scaled_acceleration,
        lambda pose, v: (v[0], rotate(pose[1], v[1])),
        lambda pose, v: (v[0], rotate_inverse(pose[1], v[1])),
        zero,
    )


def displace_quaternion(pose: Pose, u: Increment) -> Pose:
    """The pose after an increment of its position (m, world) and of the components of its quaternion, normalised."""
    w, x, y, z = _moved(pose[1], u)
    norm = math.sqrt(w * w + x * x + y * y + z * z)
    return add_scaled(pose[0], 1.0, u[0]), (w / norm, x / norm, y / norm, z / norm)


def displace_angles(pose: Pose, u: Increment) -> Pose:
    """The pose after an increment of its position (m, world) and of its angles (rad)."""
    a, b, c = added(angles(pose[1]), u[1])
    about_x = (math.cos(a / 2), math.sin(a / 2), 0.0, 0.0)
    about_y = (math.cos(b / 2), 0.0, math.sin(b / 2), 0.0)
    about_z = (math.cos(c / 2), 0.0, 0.0, math.sin(c / 2))
    return add_scaled(pose[0], 1.0, u[0]), product(product(about_x, about_y), about_z)


def angles(attitude: Quaternion) -> Vector:
    """The turns (rad) about x, then y, then z of the body that make an attitude."""
    w, x, y, z = attitude
    return (
        math.atan2(2 * (w * x - y * z), 1 - 2 * (x * x + y * y)),
        math.asin(min(1.0, max(-1.0, 2 * (w * y + x * z)))),
        math.atan2(2 * (w * z - x * y), 1 - 2 * (y * y + z * z)),
    )


def added(one: tuple[float, ...], other: tuple[float, ...]) -> tuple[float, ...]:
    """The sum of two vectors with the same number of components."""
    return tuple(a + b for a, b in zip(one, other, strict=True))


def _moved(attitude: Quaternion, u: Increment) -> Quaternion:
    (a, b, c, d), (w, x, y, z) = attitude, u[1]
    return a + w, b + x, c + y, d + z
