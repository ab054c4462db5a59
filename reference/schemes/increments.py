"""Increments of a pose, and what they do to it on SO(3) x R^3 and on SE(3), for schemes that step.

A pose g is displaced to g exp(u) by an increment u, which has a linear and an angular part, as a velocity has. The angular one
is in the body frame. On SO(3) x R^3 the linear one is in the world frame and has nothing to do with the rotation; on SE(3) it
is in the body frame, and the centre moves on a screw. While g exp(u(t)) moves with the velocity v, u grows at the rate

    dexp^-1 v = v + ad_u v / 2 + c(a) ad_u ad_u v,     c(a) = (1 - (a/2) cot(a/2)) / a^2,

on SO(3), where ad_u v = u x v and a is the angle |u| (Iserles, Munthe-Kaas, Norsett and Zanna, Acta Numerica 9, 2000, appendix
B, but in the body frame, which turns the sign of the middle term). By the principle of transference it is the same on SE(3)
for dual vectors, angular + epsilon linear: what multiplies epsilon is the derivative along the linear part.

Vectors are plain tuples: schemes take one step after another, and for one vector the arrays of `kinematics` take 20 to 60
times as long.
"""

import math

from bodycheck.reference.scene import Quaternion, Vector

#: Linear and angular part of a velocity (m/s, rad/s), an acceleration or an increment (m, rad).
Pair = tuple[Vector, Vector]

#: Position (m, world) and unit quaternion (w, x, y, z; body to world).
Pose = tuple[Vector, Quaternion]

#: Below it the first term of a series in its square is exact to rounding.
SMALL_ANGLE = 1e-4


def cross(a: Vector, b: Vector) -> Vector:
    """The vector product a x b."""
    ax, ay, az = a
    bx, by, bz = b
    return ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx


def dot(a: Vector, b: Vector) -> float:
    """The scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def plus(a: Vector, h: float, b: Vector) -> Vector:
    """a + h b."""
    return a[0] + h * b[0], a[1] + h * b[1], a[2] + h * b[2]


def advanced(v: Pair, h: float, a: Pair) -> Pair:
    """v + h a, both parts."""
    return plus(v[0], h, a[0]), plus(v[1], h, a[1])


def times(h: float, v: Pair) -> Pair:
    """h v, both parts."""
    (x, y, z), (p, q, r) = v
    return (h * x, h * y, h * z), (h * p, h * q, h * r)


def rotate(q: Quaternion, v: Vector) -> Vector:
    """World components of a vector given in the body frame."""
    u = q[1:]
    t = cross(u, v)
    return plus(plus(v, 2 * q[0], t), 2.0, cross(u, t))


def unrotate(q: Quaternion, v: Vector) -> Vector:
    """Body components of a vector given in the world frame."""
    w, x, y, z = q
    return rotate((w, -x, -y, -z), v)


def turn(q: Quaternion, phi: Vector) -> Quaternion:
    """An attitude followed by a rotation vector (rad) in the body frame, of unit length to rounding."""
    w, i, j, k = q
    angle = math.sqrt(dot(phi, phi))
    c, s = math.cos(angle / 2), math.sin(angle / 2) / angle if angle > SMALL_ANGLE else 0.5
    x, y, z = s * phi[0], s * phi[1], s * phi[2]
    w, i, j, k = (
        c * w - i * x - j * y - k * z,
        c * i + w * x + j * z - k * y,
        c * j + w * y + k * x - i * z,
        c * k + w * z + i * y - j * x,
    )
    length = math.sqrt(w * w + i * i + j * j + k * k)
    return w / length, i / length, j / length, k / length


def displace_apart(pose: Pose, u: Pair) -> Pose:
    """g exp(u) on SO(3) x R^3."""
    return plus(pose[0], 1.0, u[0]), turn(pose[1], u[1])


def displace_screw(pose: Pose, u: Pair) -> Pose:
    """g exp(u) on SE(3).

    What cancels in the quotients here and in `screw_rate` multiplies products that are as small: only rounding is left.
    """
    position, attitude = pose
    rho, phi = u
    angle = math.sqrt(dot(phi, phi))
    once, twice = 1 / 2, 1 / 6
    if angle > SMALL_ANGLE:
        once, twice = (1 - math.cos(angle)) / angle**2, (angle - math.sin(angle)) / angle**3
    bent = cross(phi, rho)
    path = plus(plus(rho, once, bent), twice, cross(phi, bent))
    return plus(position, 1.0, rotate(attitude, path)), turn(attitude, phi)


def rate_apart(u: Pair, v: Pair) -> Pair:
    """dexp^-1 v on SO(3) x R^3."""
    (_, phi), (linear, omega) = u, v
    c, _ = _coefficients(phi)
    once = cross(phi, omega)
    return linear, plus(plus(omega, 1 / 2, once), c, cross(phi, once))


def rate_screw(u: Pair, v: Pair) -> Pair:
    """dexp^-1 v on SE(3)."""
    (rho, phi), (linear, omega) = u, v
    c, slope = _coefficients(phi)
    once, dual_once = cross(phi, omega), plus(cross(phi, linear), 1.0, cross(rho, omega))
    twice, dual_twice = cross(phi, once), plus(cross(phi, dual_once), 1.0, cross(rho, once))
    dual = plus(plus(plus(linear, 1 / 2, dual_once), c, dual_twice), slope * dot(phi, rho), twice)
    return dual, plus(plus(omega, 1 / 2, once), c, twice)


def _coefficients(phi: Vector) -> tuple[float, float]:
    """c(a) of the angle a = |phi| and c'(a) / a."""
    angle = math.sqrt(dot(phi, phi))
    if angle <= SMALL_ANGLE:
        return 1 / 12, 1 / 360
    sine, half = math.sin(angle / 2), angle / 2
    around = half * math.cos(half) / sine
    return (1 - around) / angle**2, (around + (half / sine) ** 2 - 2) / angle**4
