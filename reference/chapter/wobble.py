"""How far a spin about an axis bears a wobble: the separatrix of torque-free motion, and the cone of a symmetric body.

A spin about the axis of the least or of the largest moment stays a spin about that axis as long as the angular momentum,
as the body sees it, goes round that axis: L^2 - 2 T I_middle keeps the sign that it has without a wobble.
"""

import math

from bodycheck.reference.scene import Vector


def cone_angle(moments: Vector, spin: float, wobble: float) -> float:
    """Angle (rad) between K and the angular momentum for a spin about K and a wobble about I (rad/s).

    For a body that is symmetric about K it is kept for ever; K swings by twice this angle from where it was.
    """
    a, _, c = moments
    return math.atan2(a * abs(wobble), c * abs(spin))


def largest_wobble(moments: Vector, spin: float) -> float:
    """The rate (rad/s) about one of the other axes at which a spin about K (rad/s) is lost; infinite where none is enough.

    It is the axis of the extreme moment at the other end: of the largest where K has the least. A wobble about the axis of the
    middle moment alone never suffices. Raises `ValueError` where K has the middle moment, for such a spin is lost at once.
    """
    a, b, c = moments
    if min(a, b) < c < max(a, b):
        raise ValueError(f"K has the middle moment of {moments}: its spin is unstable without any wobble")
    middle, far = (min(a, b), max(a, b)) if c <= min(a, b) else (max(a, b), min(a, b))
    apart = far * abs(far - middle)
    return abs(spin) * math.sqrt(c * abs(middle - c) / apart) if apart > 0 else math.inf
