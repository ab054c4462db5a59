"""Vectors and rotations in exact arithmetic: quaternions, and z-x-z Euler angles [G 2.14, 2.21a]."""

from bodycheck.reference.exact.numbers import MP, Quaternion4, Real, Vector3
from bodycheck.reference.scene import AlongPlane, Attitude, EulerAngles, EulerRates

#: The origin of a frame, and a vector of zeros.
ORIGIN: Vector3 = (MP.mpf(0), MP.mpf(0), MP.mpf(0))

#: The identity quaternion: no rotation.
IDENTITY: Quaternion4 = (MP.mpf(1), MP.mpf(0), MP.mpf(0), MP.mpf(0))


def plus(a: Vector3, b: Vector3) -> Vector3:
    """The sum of two vectors."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def minus(a: Vector3, b: Vector3) -> Vector3:
    """The difference of two vectors."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def scaled(factor: Real, a: Vector3) -> Vector3:
    """A vector times a number."""
    return factor * a[0], factor * a[1], factor * a[2]


def dot(a: Vector3, b: Vector3) -> Real:
    """The scalar product of two vectors."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector3, b: Vector3) -> Vector3:
    """The vector product of two vectors."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def multiply(p: Quaternion4, q: Quaternion4) -> Quaternion4:
    """The Hamilton product p q: the rotation q followed, in the world frame, by the rotation p."""
    pw, px, py, pz = p
    qw, qx, qy, qz = q
    return (
        pw * qw - px * qx - py * qy - pz * qz,
        pw * qx + px * qw + py * qz - pz * qy,
        pw * qy - px * qz + py * qw + pz * qx,
        pw * qz + px * qy - py * qx + pz * qw,
    )


def conjugate(q: Quaternion4) -> Quaternion4:
    """The conjugate of a unit quaternion: the inverse rotation."""
    w, x, y, z = q
    return w, -x, -y, -z


def unit(q: Quaternion4) -> Quaternion4:
    """A quaternion scaled to unit length; it is returned unchanged if its length is 1 already."""
    w, x, y, z = q
    square = w * w + x * x + y * y + z * z
    if square == 1:
        return q
    length = MP.sqrt(square)
    return w / length, x / length, y / length, z / length


def matrix(q: Quaternion4) -> tuple[Vector3, Vector3, Vector3]:
    """The rows of the rotation matrix of a quaternion of any length: a quotient of polynomials, without a square root."""
    w, x, y, z = q
    xx, yy, zz, ww = x * x, y * y, z * z, w * w
    scale = 1 / (ww + xx + yy + zz)
    xy, xz, yz, wx, wy, wz = x * y, x * z, y * z, w * x, w * y, w * z
    twice = 2 * scale
    return (
        ((ww + xx - yy - zz) * scale, (xy - wz) * twice, (xz + wy) * twice),
        ((xy + wz) * twice, (ww - xx + yy - zz) * scale, (yz - wx) * twice),
        ((xz - wy) * twice, (yz + wx) * twice, (ww - xx - yy + zz) * scale),
    )


def turned(rows: tuple[Vector3, Vector3, Vector3], v: Vector3) -> Vector3:
    """The product of a matrix, given by its rows, and a vector."""
    x, y, z = v
    first, second, third = rows
    return (
        first[0] * x + first[1] * y + first[2] * z,
        second[0] * x + second[1] * y + second[2] * z,
        third[0] * x + third[1] * y + third[2] * z,
    )


def attitude(orientation: Attitude) -> Quaternion4:
    """The unit quaternion (w, x, y, z) of an attitude [G 2.14]."""
    if isinstance(orientation, AlongPlane):
        cosine, sine = MP.cos_sin(MP.mpf(orientation.incline) / 2)
        return cosine, MP.mpf(0), sine, MP.mpf(0)
    if not isinstance(orientation, EulerAngles):
        w, x, y, z = orientation
        return unit((MP.mpf(w), MP.mpf(x), MP.mpf(y), MP.mpf(z)))
    phi, theta, psi = MP.mpf(orientation.phi), MP.mpf(orientation.theta), MP.mpf(orientation.psi)
    if not (phi or theta or psi):
        return IDENTITY
    c, s = MP.cos_sin(theta / 2)
    cos_sum, sin_sum = MP.cos_sin((phi + psi) / 2)
    cos_difference, sin_difference = MP.cos_sin((phi - psi) / 2)
    return c * cos_sum, s * cos_difference, s * sin_difference, c * sin_sum


def body_rates(orientation: Attitude, rates: EulerRates) -> Vector3:
    """The angular velocity in the frame of the body (rad/s) from the rates of the Euler angles of its attitude [G 2.21a]."""
    theta, psi = _angles(orientation)
    (cos_theta, sin_theta), (cos_psi, sin_psi) = MP.cos_sin(theta), MP.cos_sin(psi)
    dphi, dtheta, dpsi = MP.mpf(rates.dphi), MP.mpf(rates.dtheta), MP.mpf(rates.dpsi)
    return (
        dphi * sin_theta * sin_psi + dtheta * cos_psi,
        dphi * sin_theta * cos_psi - dtheta * sin_psi,
        dphi * cos_theta + dpsi,
    )


def _angles(orientation: Attitude) -> tuple[Real, Real]:
    """theta and psi (rad) of an attitude; where only their sum or difference with phi is determined, phi is 0 [G p. 45]."""
    if isinstance(orientation, EulerAngles):
        return MP.mpf(orientation.theta), MP.mpf(orientation.psi)
    w, x, y, z = attitude(orientation)
    theta = 2 * MP.atan2(MP.hypot(x, y), MP.hypot(w, z))
    if not (x or y):
        return theta, 2 * MP.atan2(z, w)
    if not (w or z):
        return theta, -2 * MP.atan2(y, x)
    return theta, MP.atan2(z, w) - MP.atan2(y, x)
