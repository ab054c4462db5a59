"""A sphere on a plane with rolling and torsional friction, and the forces and moments at its point of contact.

Vectors are along the axes of the plane: x downhill, z along the normal n. With the radius r, the velocity v and the angular
velocity w, the rolling velocity is p = r w x n, the slip is u = v - p, and the pivoting velocity is s = r w_n. A force m F on
the plane, a moment along it that is written as m r R, R = M x n/(m r), and a moment m r T about the normal give the rates

    v' = g + F,    p' = (R - F)/k,    s' = T/k,    u' = g + (1 + 1/k) F - R/k,    k = I/(m r^2)

With the load N = m a, each of them is against its velocity: F against u, R against p and T against s. In the product of their
limits |F| <= mu a, |R| <= mu_r a/r and |T| <= mu_t a/r. In one cone (F/mu)^2 + (r R/mu_r)^2 + (r T/mu_t)^2 <= a^2; while it
moves, F = -a mu^2 u/D, R = -a (mu_r/r)^2 p/D, T = -a (mu_t/r)^2 s/D, D^2 = mu^2 u^2 + (mu_r/r)^2 p^2 + (mu_t/r)^2 s^2.

All of this takes energy in every state, and the kinetic energy of the difference of two motions never grows.
"""

import math
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.contact.problem import ContactBody, Problem
from bodycheck.reference.errors import NotModelled
from bodycheck.reference.exact.numbers import MP, Real, Wide, real
from bodycheck.reference.mechanisms.mechanism import PairContact
from bodycheck.reference.scene import Plane
from bodycheck.reference.witness import WideArray


@dataclass(frozen=True, eq=False)
class Resisted:
    """A sphere and its plane, with a hundred digits.

    Attributes
    ----------
    mass, radius, ratio
        Mass (kg), radius r (m), and k = I/(m r^2).
    downhill, load
        The components of the gravitational acceleration along x and against the normal (m/s^2).
    friction, rolling, pivoting
        mu, which may be infinite, mu_r/r and mu_t/r.
    one
        Whether they have one limit.
    """

    mass: Real
    radius: Real
    ratio: Real
    downhill: Real
    load: Real
    friction: Real
    rolling: Real
    pivoting: Real
    one: bool

    @property
    def holds(self) -> bool:
        """Return whether friction holds the sphere at rest."""
        if not self.downhill:
            return True
        if self.one:
            return bool(self.downhill * MP.sqrt(1 / self.friction**2 + 1 / self.rolling**2) <= self.load)
        return bool(self.downhill <= min(self.friction, self.rolling) * self.load)


@dataclass(frozen=True, eq=False)
class Pose:
    """A sphere at a time (s).

    Attributes
    ----------
    time, position, turn
        The time (s), the position (3,), m, and the rotation (4,) since t = 0, along the axes of the plane.
    slip, rolling, pivoting
        The slip (2,), the rolling velocity (2,) and the pivoting velocity (m/s).
    """

    time: Wide
    position: WideArray
    turn: WideArray
    slip: WideArray
    rolling: WideArray
    pivoting: Wide

    @property
    def velocities(self) -> WideArray:
        """Slip, rolling velocity and pivoting velocity (5,), m/s."""
        return np.array([*self.slip, *self.rolling, self.pivoting])

    @property
    def still(self) -> bool:
        """Return whether nothing moves."""
        return not self.velocities.any()


def resisted(problem: Problem, body: ContactBody, radius: float, law: Plane | PairContact) -> Resisted:
    """The sphere of a problem. Raises `NotModelled` for one without inertia, and for one cone without one of its limits."""
    if not body.moments[0] > 0:
        raise NotModelled("a round body on a plane that has no moment of inertia")
    if law.cone == "one" and not (law.friction > 0 and law.rolling_friction > 0 and math.isfinite(law.friction)):
        raise NotModelled("one cone of friction without a coefficient of friction or of rolling friction")
    r, incline = MP.mpf(radius), MP.mpf(problem.plane.incline)
    gravity = np.sqrt(problem.gravity @ problem.gravity)
    return Resisted(
        real(body.mass),
        r,
        real(body.moments[0]) / (real(body.mass) * r**2),
        real(gravity) * MP.sin(incline),
        real(gravity) * MP.cos(incline),
        MP.mpf(law.friction),
        MP.mpf(law.rolling_friction) / r,
        MP.mpf(law.torsional_friction) / r,
        law.cone == "one",
    )


def velocity_and_spin(radius: Wide, velocities: WideArray) -> tuple[WideArray, WideArray]:
    """Velocities and angular velocities (n, 3) from slip, rolling velocity and pivoting velocity (n, 5), m/s."""
    u_x, u_y, p_x, p_y, s = velocities.T
    none = np.zeros_like(s)
    return np.stack([u_x + p_x, u_y + p_y, none], axis=1), np.stack([-p_y, p_x, s], axis=1) / radius
