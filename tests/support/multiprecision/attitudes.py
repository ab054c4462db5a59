"""Rotation matrices from quaternions and from Euler angles z-x-z, and angular velocities from the rates of these angles."""

from collections.abc import Sequence

from tests.support.multiprecision.arithmetic import MP, Matrix, Real, Vector, cross, dot, norm, vector


def from_quaternion(quaternion: Sequence[Real]) -> Matrix:
    """The rotation matrix of a quaternion w, x, y, z of any length but zero: R = 1 + 2 (w [v] + [v][v]) / |q|^2."""
    w, *v = (MP.mpf(part) for part in quaternion)
    hat = skew(vector(v))
    return MP.eye(3) + (w * hat + hat * hat) * (2 / (w * w + dot(v, v)))


def from_euler_zxz(angles: Sequence[Real]) -> Matrix:
    """The matrix Rz(phi) Rx(theta) Rz(psi) that takes components in the body to components in the world."""
    phi, theta, psi = (MP.mpf(angle) for angle in angles)
    return about(2, phi) * about(0, theta) * about(2, psi)


def about(axis: int, angle: Real) -> Matrix:
    """The rotation by an angle (rad) about the axis 0, 1 or 2."""
    turned = MP.eye(3)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    turned[i, i] = turned[j, j] = MP.cos(angle)
    turned[j, i] = MP.sin(angle)
    turned[i, j] = -turned[j, i]
    return turned


def turned(rotation_vector: Vector) -> Matrix:
    """The rotation by the length of a vector (rad) about its direction: Rodrigues' formula."""
    angle = norm(rotation_vector)
    if angle == 0:
        return MP.eye(3)
    hat = skew(rotation_vector / angle)
    return MP.eye(3) + hat * MP.sin(angle) + hat * hat * (2 * MP.sin(angle / 2) ** 2)


def skew(a: Vector) -> Matrix:
    """The matrix [a] with [a] b = a x b."""
    return MP.matrix([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


def rates_in_body(attitude: Matrix, psi: Real | None, rates: Sequence[Real]) -> Vector:
    """The angular velocity in the body frame from the rates of the Euler angles z-x-z [G 2.21].

    It is dphi about the vertical, dtheta about the line of nodes and dpsi about K, each along the axes of the body.

    Parameters
    ----------
    attitude
        Rotation matrix (3, 3), body to world.
    psi
        The angle psi (rad) from which the line of nodes follows, or None where the file states a quaternion. It then follows
        from the matrix; where the vertical is along K, psi is the whole angle and the line of nodes is the x axis of the world.
    rates
        dphi, dtheta, dpsi (rad/s).
    """
    dphi, dtheta, dpsi = (MP.mpf(rate) for rate in rates)
    vertical, k = attitude.T * vector([0, 0, 1]), vector([0, 0, 1])
    if psi is not None:
        nodes = vector([MP.cos(psi), -MP.sin(psi), 0])
    else:
        across = cross(vertical, k)
        nodes = across / norm(across) if norm(across) > 0 else attitude.T * vector([1, 0, 0])
    return vertical * dphi + nodes * dtheta + k * dpsi


def quaternion(attitude: Matrix) -> list[Real]:
    """A unit quaternion w, x, y, z of a rotation matrix, from its largest component, so that no digits cancel."""
    r = attitude
    trace = r[0, 0] + r[1, 1] + r[2, 2]
    squares = [1 + trace, *(1 + 2 * r[i, i] - trace for i in range(3))]
    largest = max(range(4), key=squares.__getitem__)
    if largest == 0:
        rows = [squares[0], r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]]
    else:
        i, j, k = largest - 1, largest % 3, (largest + 1) % 3
        rows = [r[k, j] - r[j, k], 0, 0, 0]
        rows[1 + i], rows[1 + j], rows[1 + k] = squares[largest], r[j, i] + r[i, j], r[k, i] + r[i, k]
    length = MP.sqrt(sum(part * part for part in rows))
    return [part / length for part in rows]
