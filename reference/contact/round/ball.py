"""A round body on a plane: a sphere, or a cylinder on its side, and the laws of Coulomb and Huygens at the point of contact.

Vectors are along the axes of the plane: x downhill, z along the normal. With the radius r, the velocity v and the angular
velocity w, the point of contact slips with u = v + w x (-r n), that is (v_x - r w_y, v_y + r w_x). A force F along the plane at
this point gives v the rate F/m and u the rate (1 + 1/k) F/m, where k = I/(m r^2).
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from bodycheck.reference.contact.problem import ContactBody, Problem
from bodycheck.reference.errors import NotModelled
from bodycheck.reference.exact.numbers import MP, Wide, real
from bodycheck.reference.witness import WideArray

#: The number of roundings in the velocity of the point of contact.
SLIP_ROUNDINGS = 16.0


@dataclass(frozen=True, eq=False)
class Ball:
    """A round body and its plane.

    Attributes
    ----------
    mass, radius
        Mass (kg) and radius r (m).
    ratio
        k = I/(m r^2), with the moment of inertia I about the axes along the plane about which the body turns.
    friction, restitution
        Coulomb's coefficient mu, which may be infinite, and the coefficient of restitution e.
    downhill, onto
        The components of the gravitational acceleration along x and against the normal (m/s^2).
    grips
        Whether a body that rolls continues to roll, that is, tan(incline) <= mu (1 + k)/k.
    """

    mass: Wide
    radius: Wide
    ratio: Wide
    friction: Wide
    restitution: Wide
    downhill: Wide
    onto: Wide
    grips: bool

    @property
    def braking(self) -> Wide:
        """Acceleration (m/s^2) by friction against a slip; 0 for infinite friction, for which it is not used."""
        return Wide(0) if np.isinf(self.friction) else self.friction * self.onto

    @property
    def slowing(self) -> Wide:
        """The rate at which friction reduces the slip: (1 + 1/k) times `braking` (m/s^2)."""
        return self.braking * (1 + 1 / self.ratio)


@dataclass(frozen=True, eq=False)
class Moment:
    """A round body at a time (s): position (3,), velocity (3,) and angular velocity (3,) along the axes of the plane."""

    time: Wide
    position: WideArray
    velocity: WideArray
    spin: WideArray


def ball(problem: Problem, body: ContactBody, radius: float, moment: Wide) -> Ball:
    """The round body of a problem. moment: the moment of inertia about the axes about which it rolls (kg m^2).

    Raises `NotModelled` for a body without inertia.
    """
    if not moment > 0:
        raise NotModelled("a round body on a plane that has no moment of inertia")
    friction, restitution = problem.pair(0)
    exact = real(moment) / (real(body.mass) * MP.mpf(radius) ** 2)
    incline = MP.mpf(problem.plane.incline)
    grips = (
        math.isinf(friction)
        or not problem.gravity.any()
        or MP.sin(incline) * exact <= MP.mpf(friction) * (1 + exact) * MP.cos(incline)
    )
    return Ball(
        body.mass,
        Wide(radius),
        moment / (body.mass * Wide(radius) ** 2),
        Wide(friction),
        Wide(restitution),
        problem.gravity[0],
        -problem.gravity[2],
        bool(grips),
    )


def slip(ball: Ball, velocity: WideArray, spin: WideArray) -> WideArray:
    """The velocity (3,) of the point of contact along the plane (m/s); zero if it differs from zero only by rounding."""
    r = ball.radius
    velocity_of_point = np.array([velocity[0] - r * spin[1], velocity[1] + r * spin[0], Wide(0)])
    terms = np.hypot(velocity[0], velocity[1]) + r * np.hypot(spin[0], spin[1])
    return np.asarray(
        velocity_of_point * (np.hypot(velocity_of_point[0], velocity_of_point[1]) > SLIP_ROUNDINGS * np.finfo(Wide).eps * terms)
    )


def rolling_spin(ball: Ball, velocity: WideArray, spin: WideArray) -> WideArray:
    """The angular velocity (3,) of a body that rolls with a velocity (3,). spin: (3,), whose normal component it keeps."""
    return np.array([-velocity[1] / ball.radius, velocity[0] / ball.radius, spin[2]])


def after_impact(ball: Ball, before: Moment) -> Moment:
    """A body just after it has hit the plane, by impulse and momentum.

    The impulse along the plane ends the slip if Coulomb's law allows it; otherwise it is mu times the impulse along the normal,
    against the slip.
    """
    fall = -before.velocity[2]
    back = ball.restitution * fall
    sliding = slip(ball, before.velocity, before.spin)
    velocity = before.velocity + gripping(ball, sliding, (1 + ball.restitution) * fall)
    velocity[2] = back
    spin = before.spin.copy()
    if stops(ball, sliding, (1 + ball.restitution) * fall):
        spin = rolling_spin(ball, velocity, spin)
    else:
        change = (velocity - before.velocity) / (ball.ratio * ball.radius)
        spin[0] += change[1]
        spin[1] -= change[0]
    return replace(before, velocity=velocity, spin=spin)


def stops(ball: Ball, sliding: WideArray, normal: Wide) -> bool:
    """Return whether friction during an impulse along the normal, `normal`, ends a slip (3,). normal: over the mass (m/s)."""
    if np.isinf(ball.friction):
        return True
    size = np.hypot(sliding[0], sliding[1])
    return bool(size * ball.ratio <= ball.friction * normal * (1 + ball.ratio))


def gripping(ball: Ball, sliding: WideArray, normal: Wide) -> WideArray:
    """The change (3,) of the velocity (m/s) by friction on a slip (3,). normal: impulse along the normal over the mass, m/s."""
    if stops(ball, sliding, normal):
        return np.asarray(sliding * (-ball.ratio / (1 + ball.ratio)))
    return np.asarray(sliding * (-ball.friction * normal / np.hypot(sliding[0], sliding[1])))
