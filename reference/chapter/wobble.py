"""The wobble that a stable spin tolerates: the separatrix of torque-free motion, and the cone of a symmetric body.

A wobble is an angular velocity about an axis other than the axis of the spin. A spin about the axis of the smallest or of the
largest moment remains a spin about that axis as long as the angular momentum, in the body frame, encircles that axis, that is,
as long as L^2 - 2 T I_middle has the same sign as without the wobble.
"""

import math

from bodycheck.reference.scene import Vector


def cone_angle(moments: Vector, spin: float, wobble: float) -> float:
    """Angle between the body axis K and the angular momentum, for a spin about K and a wobble about I.

    For a body that is symmetric about K the angle is constant, and K moves on a cone: it deviates by up to twice the angle from
    its initial direction.

    Parameters
    ----------
    moments
        Principal moments A, B, C (kg m^2).
    spin, wobble
        Angular velocity about K and about I (rad/s).

    Returns
    -------
    float
        The angle (rad).
    """
    a, _, c = moments
    return math.atan2(a * abs(wobble), c * abs(spin))


def largest_wobble(moments: Vector, spin: float) -> float:
    """The wobble (rad/s) at which a spin (rad/s) about K is lost; infinite where no wobble is enough.

    Beyond it the angular momentum, in the body frame, no longer encircles K. The wobble is about the axis of the opposite
    extreme moment: the axis of the largest moment if K has the smallest, and vice versa. A wobble about the axis of the middle
    moment alone is never enough. moments: principal moments A, B, C (kg m^2).

    Raises `ValueError` if K has the middle moment, since such a spin is unstable.
    """
    a, b, c = moments
    if min(a, b) < c < max(a, b):
        raise ValueError(f"K has the middle moment of {moments}: a spin about it is unstable without any wobble")
    middle, far = (min(a, b), max(a, b)) if c <= min(a, b) else (max(a, b), min(a, b))
    apart = far * abs(far - middle)
    return abs(spin) * math.sqrt(c * abs(middle - c) / apart) if apart > 0 else math.inf
