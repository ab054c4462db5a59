"""Vectors, poses and increments of poses as plain tuples, with the exponential maps of SO(3) x R^3 and of SE(3).

A pose g is displaced to g exp(u) by an increment u, which has a linear and an angular part, as a velocity has. The angular
part is in the body frame. On SO(3) x R^3 the linear part is in the world frame and independent of the rotation; on SE(3) it
is in the body frame, and the centre of mass moves along a screw. While g exp(u(t)) moves with the velocity v, u changes at
the rate

    dexp^-1 v = v + ad_u v / 2 + c(a) ad_u ad_u v,     c(a) = (1 - (a/2) cot(a/2)) / a^2,

on SO(3), where ad_u v = u x v and a is the angle |u| (Iserles, Munthe-Kaas, Norsett and Zanna, Acta Numerica 9, 2000, appendix
B; here in the body frame, which changes the sign of the middle term). By the principle of transference the same holds on
SE(3) for dual vectors, angular + epsilon linear: the coefficient of epsilon is the derivative along the linear part.

Tuples are used because a scheme steps one state at a time: for single vectors the array functions of `kinematics` take 20 to
60 times as long.
"""

import math

from bodycheck.reference.scene import Quaternion, Vector

#: Linear and angular part of a velocity (m/s, rad/s), of an acceleration (m/s^2, rad/s^2) or of an increment (m, rad).
Pair = tuple[Vector, Vector]

#: Linear part (m) and change of the attitude: a rotation vector (rad), or a change of the coordinates of the attitude.
Increment = tuple[Vector, tuple[float, ...]]

#: Position (m, world) and unit quaternion (w, x, y, z; body to world).
Pose = tuple[Vector, Quaternion]

#: Angle up to which the first term of a power series in its square is exact to rounding.
SMALL_ANGLE_RAD = 1e-4


def cross(a: Vector, b: Vector) -> Vector:
    """The vector product a x b."""
    ax, ay, az = a
    bx, by, bz = b
    return ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx


def dot(a: Vector, b: Vector) -> float:
    """The scalar product of a and b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def add_scaled(a: Vector, h: float, b: Vector) -> Vector:
    """The vector a + h b."""
    return a[0] + h * b[0], a[1] + h * b[1], a[2] + h * b[2]


def add_scaled_pair(v: Pair, h: float, a: Pair) -> Pair:
    """The pair v + h a, both parts."""
    return add_scaled(v[0], h, a[0]), add_scaled(v[1], h, a[1])


def scale_increment(h: float, u: Increment) -> Increment:
    """The increment h u, both parts."""
    (x, y, z), angular = u
    return (h * x, h * y, h * z), tuple(h * a for a in angular)


def scale_pair(h: float, v: Pair) -> Pair:
    """The pair h v, both parts."""
    (x, y, z), (p, q, r) = v
    return (h * x, h * y, h * z), (h * p, h * q, h * r)


def rotate(q: Quaternion, v: Vector) -> Vector:
    """World components of a vector given in the body frame, for a unit quaternion q (body to world)."""
    u = q[1:]
    t = cross(u, v)
    return add_scaled(add_scaled(v, 2 * q[0], t), 2.0, cross(u, t))


def rotate_inverse(q: Quaternion, v: Vector) -> Vector:
    """Body components of a vector given in the world frame, for a unit quaternion q (body to world)."""
    w, x, y, z = q
    return rotate((w, -x, -y, -z), v)


def product(p: Quaternion, q: Quaternion, factor: float = 1.0) -> Quaternion:
    """The product of two quaternions of any norm, times a factor."""
    a, b, c, d = p
    w, x, y, z = q
    return (
        factor * (a * w - b * x - c * y - d * z),
        factor * (a * x + b * w + c * z - d * y),
        factor * (a * y - b * z + c * w + d * x),
        factor * (a * z + b * y - c * x + d * w),
    )


def turn(q: Quaternion, phi: Vector) -> Quaternion:
    """The attitude q followed by a rotation vector phi (rad) in the body frame, normalised to unit length."""
    w, i, j, k = q
    angle = math.sqrt(dot(phi, phi))
    c, s = math.cos(angle / 2), math.sin(angle / 2) / angle if angle > SMALL_ANGLE_RAD else 0.5
    x, y, z = s * phi[0], s * phi[1], s * phi[2]
    w, i, j, k = (
        c * w - i * x - j * y - k * z,
        c * i + w * x + j * z - k * y,
        c * j + w * y + k * x - i * z,
        c * k + w * z + i * y - j * x,
    )
    length = math.sqrt(w * w + i * i + j * j + k * k)
    return w / length, i / length, j / length, k / length


def displace_so3_r3(pose: Pose, u: Increment) -> Pose:
    """The pose g exp(u) on SO(3) x R^3, for an increment u with its linear part in the world frame."""
    x, y, z = u[1]
    return add_scaled(pose[0], 1.0, u[0]), turn(pose[1], (x, y, z))


def displace_se3(pose: Pose, u: Increment) -> Pose:
    """The pose g exp(u) on SE(3), for an increment u with both parts in the body frame.

    The quotients here and in `inverse_dexp_se3` lose digits at small angles, but they multiply products that are equally small,
    so that the result has only rounding errors.
    """
    position, attitude = pose
    rho, (x, y, z) = u
    phi = x, y, z
    angle = math.sqrt(dot(phi, phi))
    once, twice = 1 / 2, 1 / 6
    if angle > SMALL_ANGLE_RAD:
        once, twice = (1 - math.cos(angle)) / angle**2, (angle - math.sin(angle)) / angle**3
    bent = cross(phi, rho)
    path = add_scaled(add_scaled(rho, once, bent), twice, cross(phi, bent))
    return add_scaled(position, 1.0, rotate(attitude, path)), turn(attitude, phi)


def inverse_dexp_so3_r3(u: Increment, v: Pair) -> Pair:
    """The rate dexp^-1 v of an increment u on SO(3) x R^3, for a velocity v."""
    (_, (x, y, z)), (linear, omega) = u, v
    phi = x, y, z
    c, _ = _coefficients(phi)
    once = cross(phi, omega)
    return linear, add_scaled(add_scaled(omega, 1 / 2, once), c, cross(phi, once))


def inverse_dexp_se3(u: Increment, v: Pair) -> Pair:
    """The rate dexp^-1 v of an increment u on SE(3), for a velocity v."""
    (rho, (x, y, z)), (linear, omega) = u, v
    phi = x, y, z
    c, slope = _coefficients(phi)
    once, dual_once = cross(phi, omega), add_scaled(cross(phi, linear), 1.0, cross(rho, omega))
    twice, dual_twice = cross(phi, once), add_scaled(cross(phi, dual_once), 1.0, cross(rho, once))
    dual = add_scaled(add_scaled(add_scaled(linear, 1 / 2, dual_once), c, dual_twice), slope * dot(phi, rho), twice)
    return dual, add_scaled(add_scaled(omega, 1 / 2, once), c, twice)


def _coefficients(phi: Vector) -> tuple[float, float]:
    """The coefficient c(a) of dexp^-1 at the angle a = |phi|, and c'(a) / a."""
    angle = math.sqrt(dot(phi, phi))
    if angle <= SMALL_ANGLE_RAD:
        return 1 / 12, 1 / 360
    sine, half = math.sin(angle / 2), angle / 2
    around = half * math.cos(half) / sine
    return (1 - around) / angle**2, (around + (half / sine) ** 2 - 2) / angle**4
