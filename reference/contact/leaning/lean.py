"""The fall of a brick that leans on an edge, or a standing cylinder on its rim, while the contact does not move.

With theta the angle of the centre of mass from the vertical above the contact, at the distance l, k the radius of gyration
about the axis of the fall, and beta = l^2 / (k^2 + l^2), a body that is released at theta0 > 0 falls as a pendulum:

    theta'' = (beta g / l) sin theta,    theta'^2 = 2 (beta g / l) (cos theta0 - cos theta).

The acceleration of the centre of mass gives the forces of the plane, T along the plane and N along its normal:

    T = beta m g sin theta (3 cos theta - 2 cos theta0),    N = m g (1 - beta (1 + 2 cos theta cos theta0 - 3 cos^2 theta)).

For a thin rod released from nearly upright, these are 3 m g sin theta (3 cos theta - 2) / 4 and m g (3 cos theta - 1)^2 / 4.
"""

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np

from bodycheck.reference.contact.flat.face import exact_quaternion
from bodycheck.reference.contact.problem import NONE, ContactBody, Problem
from bodycheck.reference.exact.numbers import MP, Real, Vector2, real
from bodycheck.reference.exact.rotations import matrix
from bodycheck.reference.scene import Brick, Cylinder

#: Size of an imaginary part up to which it differs from zero only by rounding.
_ROUNDED = MP.mpf(10) ** -30


@dataclass(frozen=True)
class Lean:
    """A body that leans, and falls in the vertical plane of its lean.

    Attributes
    ----------
    towards
        The unit vector along the plane from the contact towards the foot of the centre of mass.
    angle, landing
        theta0 > 0, and theta when the next face lies on the plane (rad).
    length
        l (m).
    share
        beta.
    square
        beta g / l (1/s^2).
    apart
        The distance of the body from the plane, divided by l, plus the tilt of its edge (rad); both are taken to be zero.
    """

    towards: Vector2
    angle: Real
    landing: Real
    length: Real
    share: Real
    square: Real
    apart: float

    def speed(self, cosine: Real) -> Real:
        """theta' (rad/s) for a value of cos theta."""
        return MP.sqrt(2 * self.square * (MP.cos(self.angle) - cosine))

    def time(self, cosine: Real) -> Real:
        """The time (s) at which cos theta reaches a value, by the elliptic integral of the first kind."""
        modulus = MP.cos(self.angle / 2) ** 2
        rest = (MP.cos(self.angle) - cosine) / (2 * modulus)
        sine = MP.sqrt(rest / (1 - (1 + cosine) / 2))
        return MP.ellipf(MP.asin(min(sine, MP.mpf(1))), modulus) / MP.sqrt(self.square)

    def forces(self, cosine: Real) -> tuple[Real, Real]:
        """|T| and N for a value of cos theta, in units of the weight."""
        first = MP.cos(self.angle)
        along = self.share * MP.sqrt(1 - cosine**2) * abs(3 * cosine - 2 * first)
        return along, 1 - self.share * (1 + 2 * cosine * first - 3 * cosine**2)


def lean(problem: Problem) -> Lean | None:
    """Return the lean of the only body of a problem on a level plane; None if it does not lean, or is balanced."""
    body = problem.bodies[0]
    columns = tuple(zip(*matrix(exact_quaternion(body.quaternion)), strict=True))
    axes = _axes(body, columns)
    if axes is None or problem.plane.incline or not problem.gravity[2]:
        return None
    up, halves, moment, tilted = axes
    standing = columns[up] if columns[up][2] > 0 else tuple(-part for part in columns[up])
    across = MP.hypot(standing[0], standing[1])
    if min(across, standing[2]) <= NONE:
        return None
    width, height = halves
    angle = MP.atan2(across, standing[2]) - MP.atan2(width, height)
    length = MP.hypot(width, height)
    gap = abs(real(body.position[2]) - length * MP.cos(angle))
    if gap > NONE * length or abs(angle) <= NONE:
        return None
    side = 1 if angle > 0 else -1
    share = length**2 / (moment / real(body.mass) + length**2)
    return Lean(
        (side * standing[0] / across, side * standing[1] / across),
        abs(angle),
        MP.atan2(height, width) if angle > 0 else MP.atan2(width, height),
        length,
        share,
        -share * real(problem.gravity[2]) / length,
        float(gap / length) + tilted,
    )


def _axes(body: ContactBody, columns: tuple[tuple[Real, ...], ...]) -> tuple[int, tuple[Real, Real], Real, float] | None:
    """The geometry of a body that may lean; None for a shape or a position that this module does not treat.

    Returns the index of an axis of the body in the plane of the fall, the half-lengths across and along it (m), the moment of
    inertia about the edge or diameter (kg m^2), and the tilt of the edge (rad).
    """
    match body.shape:
        case Brick(semi_axes):
            level = [axis for axis in range(3) if abs(columns[axis][2]) <= NONE]
            if len(level) != 1:
                return None
            (edge,) = level
            across, up = (axis for axis in range(3) if axis != edge)
            halves = MP.mpf(semi_axes[across]), MP.mpf(semi_axes[up])
            return up, halves, real(body.moments[edge]), float(abs(columns[edge][2]))
        case Cylinder(radius, half_length) if body.moments[0] == body.moments[1]:
            return 2, (MP.mpf(radius), MP.mpf(half_length)), real(body.moments[0]), 0.0
        case _:
            return None


def onset(falling: Lean, friction: float) -> tuple[Literal["slip", "impact"], Real]:
    """Return the kind of the end of a fall, and cos theta there.

    "slip": friction no longer holds, or the normal force vanishes. "impact": the next face lands.
    """
    first, last = MP.cos(falling.angle), MP.cos(falling.landing)

    def slack(cosine: Real) -> Real:
        along, normal = falling.forces(cosine)
        return normal if math.isinf(friction) else MP.mpf(friction) * normal - along

    roots = MP.polyroots(_border(falling.share, first, friction), maxsteps=500, extraprec=400)
    inside = [MP.re(root) for root in roots if abs(MP.im(root)) < _ROUNDED and last < MP.re(root) < first]
    marks = [first, *sorted(inside, reverse=True), last]
    for high, low in pairwise(marks):
        if slack((high + low) / 2) < 0:
            return "slip", high
    return "impact", last


def _border(share: Real, first: Real, friction: float) -> list[Real]:
    """The coefficients, highest power first, of a polynomial in cos theta that is zero where |T| = mu N.

    If the friction is infinite, it is zero where N = 0. share: beta. first: cos theta0.
    """
    normal = [3 * share, -2 * share * first, 1 - share]
    if math.isinf(friction):
        return normal
    a, b, c = normal
    squared = [a * a, 2 * a * b, b * b + 2 * a * c, 2 * b * c, c * c]
    along = [MP.mpf(-9), 12 * first, 9 - 4 * first**2, -12 * first, 4 * first**2]
    return [share**2 * one - MP.mpf(friction) ** 2 * other for one, other in zip(along, squared, strict=True)]


def smallest_friction(falling: Lean, cosine: float) -> float:
    """The largest |T| / N from the start until cos theta reaches a value."""
    share, first = float(falling.share), float(MP.cos(falling.angle))
    normal = np.polynomial.Polynomial([1 - share, -2 * share * first, 3 * share])
    along = np.polynomial.Polynomial([1, 0, -1]) * np.polynomial.Polynomial([-2 * first, 3]) ** 2
    extremes = (along.deriv() * normal - 2 * along * normal.deriv()).roots().tolist()
    real_parts = [complex(root).real for root in extremes if abs(complex(root).imag) < 1e-6]
    inside = [root for root in real_parts if cosine < root < first]
    forces = [falling.forces(MP.mpf(at)) for at in (first, *inside, cosine)]
    return max(float(tangential / pressing) for tangential, pressing in forces)


def jams(falling: Lean, friction: float, sliding: float) -> bool:
    """Return whether no force of the plane is possible while the contact slides: Painleve's paradox.

    sliding: the velocity of the contact along `towards` (m/s). If it is negative, a normal force N with its friction
    accelerates the contact along the normal by N / m times 1 + (l / k)^2 sin theta (sin theta - mu cos theta). If this factor
    is negative, weight and every such force pull the contact into the plane.
    """
    if sliding >= 0 or math.isinf(friction):
        return False
    ratio = falling.share / (1 - falling.share)
    sine, cosine = MP.sin(falling.angle), MP.cos(falling.angle)
    return bool(1 + ratio * sine * (sine - MP.mpf(friction) * cosine) < 0)
