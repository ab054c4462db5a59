"""The mass and the centre of mass of a body of a mechanism, as rational numbers."""

from fractions import Fraction

from bodycheck.reference.mechanisms.mechanism import JointedBody
from bodycheck.reference.scene import Tensor


def centre_of(body: JointedBody) -> tuple[Fraction, Fraction, Fraction]:
    """Return the centre of mass of a body in its frame (m)."""
    if isinstance(body.inertia, Tensor):
        x, y, z = map(Fraction, body.center_of_mass)
        return x, y, z
    parts = body.inertia if isinstance(body.inertia, tuple) else (body.inertia,)
    whole = sum((Fraction(part.mass) for part in parts), Fraction(0))
    x, y, z = (sum((Fraction(part.mass) * Fraction(part.position[i]) for part in parts), Fraction(0)) / whole for i in range(3))
    return x, y, z


def mass_of(body: JointedBody) -> Fraction:
    """Return the mass of a body (kg)."""
    parts = body.inertia if isinstance(body.inertia, tuple) else (body.inertia,)
    return sum((Fraction(part.mass) for part in parts), Fraction(0))
