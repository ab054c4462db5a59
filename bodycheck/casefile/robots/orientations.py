"""Attitudes as URDF and MJCF give them, as exact unit quaternions (w, x, y, z) from the frame that is given to its parent's."""

from collections.abc import Sequence

from bodycheck.casefile.robots.elements import Element, numbers, quoted, refuse
from bodycheck.reference.exact.numbers import MP, Quaternion4, Real, Vector3, vector
from bodycheck.reference.exact.rotations import IDENTITY, multiply, unit

#: The attributes of MJCF for an attitude.
ATTITUDES = ("quat", "axisangle", "euler", "xyaxes", "zaxis")

#: The half turn about x, which is a shortest rotation from z to -z.
HALF_TURN: Quaternion4 = (MP.mpf(0), MP.mpf(1), MP.mpf(0), MP.mpf(0))


def about_axis(axis: Vector3, angle: Real) -> Quaternion4:
    """Return the rotation by an angle (rad) about an axis of any length."""
    x, y, z = axis
    cosine, sine = MP.cos_sin(angle / 2)
    length = MP.sqrt(x * x + y * y + z * z)
    return cosine, sine * x / length, sine * y / length, sine * z / length


def euler(angles: Sequence[Real], sequence: str) -> Quaternion4:
    """Return successive rotations about the axes of a sequence: lower case turns with the body, upper case is fixed."""
    turn = IDENTITY
    for angle, letter in zip(angles, sequence, strict=True):
        axis = vector([float(letter.lower() == name) for name in "xyz"])
        step = about_axis(axis, angle)
        turn = multiply(turn, step) if letter.islower() else multiply(step, turn)
    return turn


def urdf(origin: Element | None) -> Quaternion4:
    """Return the attitude of an <origin> of URDF: roll, pitch and yaw about the fixed axes x, y and z (rad)."""
    if origin is not None and "quat_xyzw" in origin.attributes:
        refuse(origin, "quat_xyzw", "is not read here; allowed: rpy")
    angles = (0.0, 0.0, 0.0) if origin is None else numbers(origin, "rpy", (3,), (0.0, 0.0, 0.0))
    return euler(vector(angles), "XYZ")


def mjcf(element: Element, degrees: bool, sequence: str) -> Quaternion4:
    """Return the attitude of an element of MJCF.

    Parameters
    ----------
    element
        The element, with at most one of `ATTITUDES`.
    degrees
        Whether angles are in degrees and not in rad.
    sequence
        The sequence of Euler angles, such as "xyz".
    """
    given = [name for name in ATTITUDES if name in element.attributes]
    if len(given) > 1:
        refuse(element, given[1], f"{given[0]} is given too; allowed: one of {', '.join(ATTITUDES)}")
    if not given:
        return IDENTITY
    values = [
        MP.mpf(value) for value in numbers(element, given[0], ({"quat": 4, "axisangle": 4, "xyaxes": 6}.get(given[0], 3),))
    ]
    factor = MP.pi / 180 if degrees else MP.mpf(1)
    try:
        match given[0]:
            case "quat":
                w, x, y, z = values
                return unit((w, x, y, z))
            case "axisangle":
                return about_axis(vector(values[:3]), values[3] * factor)
            case "euler":
                return euler([value * factor for value in values], sequence)
            case "xyaxes":
                return from_axes(vector(values[:3]), vector(values[3:]))
            case _:
                return from_z(vector(values))
    except ZeroDivisionError:
        refuse(element, given[0], f"read {quoted(element.attributes[given[0]])}; allowed: vectors that are not 0 or parallel")


def from_z(z: Vector3) -> Quaternion4:
    """Return the shortest rotation that turns the axis z into the direction of a vector."""
    length = MP.sqrt(sum(part * part for part in z))
    x, y, z_part = (part / length for part in z)
    if not (x or y):
        return IDENTITY if z_part > 0 else HALF_TURN
    return about_axis((-y, x, MP.mpf(0)), MP.atan2(MP.hypot(x, y), z_part))


def from_axes(x: Vector3, y: Vector3) -> Quaternion4:
    """Return the attitude with an axis x, and an axis y from which its part along x is taken away."""
    x = _normed(x)
    along = sum(a * b for a, b in zip(x, y, strict=True))
    a, b, c = (own - along * part for own, part in zip(y, x, strict=True))
    y = _normed((a, b, c))
    first = from_z((x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]))
    # What is left is a rotation about the third axis, after which the first axis is x.
    w, i, j, k = first
    back = multiply(multiply((w, -i, -j, -k), (MP.mpf(0), *x)), first)
    return multiply(first, about_axis(vector((0, 0, 1)), MP.atan2(back[2], back[1])))


def _normed(v: Vector3) -> Vector3:
    length = MP.sqrt(sum(part * part for part in v))
    x, y, z = (part / length for part in v)
    return x, y, z
