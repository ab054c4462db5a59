"""Attitudes of elements of MJCF, which are read exactly."""

from bodycheck.casefile.robots.numbers import numbers
from bodycheck.reference.exact.numbers import MP, Quaternion4, vector
from bodycheck.reference.exact.rotations import IDENTITY, unit
from bodycheck.robots.elements import Element, quoted, refuse
from bodycheck.robots.orientations import about_axis, euler, from_axes, from_z

#: The attributes of MJCF for an attitude.
ATTITUDES = ("quat", "axisangle", "euler", "xyaxes", "zaxis")


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
