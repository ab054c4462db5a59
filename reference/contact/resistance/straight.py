"""Legs with constant accelerations: motions along a line with separate limits, or with velocities that keep their ratios.

Along a line with separate limits, the slip u, the rolling velocity p and the pivoting velocity s change at constant rates until
one of them vanishes. One that is zero stays zero where a force within its limit can hold it; if not, it takes the sign that its
rate then has. In one cone, velocities that keep their ratios have constant rates: so does a sphere that is released at rest.
"""

import itertools
from dataclasses import dataclass, replace

import numpy as np

from bodycheck.reference.contact.problem import NONE
from bodycheck.reference.contact.resistance.laws import Pose, Resisted, velocity_and_spin
from bodycheck.reference.contact.round.turns import accelerated
from bodycheck.reference.exact.numbers import MP, Real, Wide, real, wide
from bodycheck.reference.kinematics import multiply
from bodycheck.reference.witness import WideArray

#: The number of halvings of the interval in which the rates of a sphere that is released are searched.
HALVINGS = 400

#: The number of iterations for the ratio of slip to rolling velocity, and the largest relative difference from it.
RATIOS, NEAR = 30, MP.mpf("1e-13")

#: The direction of the fall line.
DOWNHILL = np.array([1, 0], Wide)


@dataclass(frozen=True, eq=False)
class Straight:
    """A leg with constant accelerations.

    Attributes
    ----------
    start
        The sphere at its start.
    rates
        The rates of slip, rolling velocity and pivoting velocity (5,), m/s^2.
    grip
        The friction that holds the slip at zero, over the load; 0 if it is not held.
    together
        Whether all velocities keep their ratios, so that all vanish if one does.
    error
        The size of the velocities that are left out at its start (m/s).
    """

    start: Pose
    rates: WideArray
    grip: float = 0.0
    together: bool = False
    error: float = 0.0

    def lasting(self) -> Wide:
        """The time (s) until a velocity that decreases is zero; infinite if none decreases."""
        times = [-v / a for v, a in zip(self.start.velocities, self.rates, strict=True) if v * a < 0]
        return min(times, default=Wide(np.inf))

    def states(self, radius: Wide, times: WideArray) -> tuple[WideArray, WideArray, WideArray, WideArray]:
        """Positions, velocities, angular velocities (n, 3) and rotations (n, 4) at times (n,), s, from its start."""
        velocity, spin = velocity_and_spin(radius, self.start.velocities + times[:, None] * self.rates)
        (first,), (turning,) = velocity_and_spin(radius, self.start.velocities[None])
        (_,), (faster,) = velocity_and_spin(radius, self.rates[None])
        position = self.start.position + times[:, None] * (first + velocity) / 2
        return position, velocity, spin, multiply(accelerated(turning, faster, times), self.start.turn)

    def ended(self, radius: Wide, lasting: Wide) -> Pose:
        """The sphere after a time (s). Velocities that vanish then are exactly zero."""
        velocities = self.start.velocities
        for index, rate in enumerate(self.rates):
            left = velocities[index] + lasting * rate
            near = self.together or not abs(left) > 4 * np.finfo(Wide).eps * abs(velocities[index])
            gone = near and velocities[index] * rate < 0
            velocities[index] = Wide(0) if gone else left
        position, _, _, turn = self.states(radius, np.array([lasting]))
        time = self.start.time + lasting
        return Pose(time, position[0], turn[0], velocities[:2], velocities[2:4], velocities[4])


def unbraked(body: Resisted, start: Pose) -> Straight:
    """The leg of a sphere with neither friction nor rolling friction, or without a load."""
    rates = np.zeros(5, Wide)
    rates[0], rates[4] = wide(body.downhill), _twist(body, start)
    return Straight(start, rates)


def _twist(body: Resisted, start: Pose) -> Wide:
    """The rate of the pivoting velocity with separate limits (m/s^2)."""
    return wide(MP.mpf(-_sign(start.pivoting) * body.pivoting * body.load / body.ratio))


def along_a_line(body: Resisted, start: Pose, direction: WideArray) -> Straight:
    """The leg of a sphere with separate limits whose slip and rolling velocity are along a unit vector (2,), as gravity is."""
    slip, rolling = Wide(start.slip @ direction), Wide(start.rolling @ direction)
    downhill = body.downhill * (1 if direction[0] > 0 else -1)
    slipping, rolled, force = _rates(body, _sign(slip), _sign(rolling), downhill)
    rates = np.array([*(wide(slipping) * direction), *(wide(rolled) * direction), _twist(body, start)])
    held = not slip and not slipping and body.load
    return Straight(start, rates, float(abs(force) / body.load) if held else 0.0)


def _sign(value: Wide) -> int:
    return int(np.sign(value))


def _rates(body: Resisted, slip: int, rolling: int, downhill: Real) -> tuple[Real, Real, Real]:
    """The rates of the slip and of the rolling velocity, and the force F, from the signs of both velocities (m/s^2)."""
    most, k = body.friction * body.load if body.load else MP.mpf(0), body.ratio
    resisting = body.rolling * body.load
    signs = (slip,) if slip else (0, 1, -1), (rolling,) if rolling else (0, 1, -1)
    for sign, turn in itertools.product(*signs):
        if sign and MP.isinf(most):
            continue
        if not turn:
            force = -most * sign if sign else -downhill
            rolled, slipping, moment = MP.mpf(0), (downhill + force) * abs(sign), force
        elif not sign:
            moment = -resisting * turn
            rolled, slipping = (downhill + moment) / (1 + k), MP.mpf(0)
            force = rolled - downhill
        else:
            force, moment = -most * sign, -resisting * turn
            rolled, slipping = (moment - force) / k, downhill + force + (force - moment) / k
        holds = (sign or abs(force) <= most) and (turn or abs(moment) <= resisting)
        leaves = (slip or not sign or slipping * sign > 0) and (rolling or not turn or rolled * turn > 0)
        if holds and leaves:
            return slipping, rolled, force
    raise AssertionError("Coulomb's laws have a solution")


def released(body: Resisted, start: Pose) -> Straight:
    """The leg of a sphere that is released at rest on an incline on which one cone does not hold it.

    For a size D of the rates, the equations are linear; D grows with the rates, so that one of them has rates of this size.
    """
    low, high = MP.mpf(0), 2 * (body.friction + body.rolling) * body.downhill
    for _ in range(HALVINGS):
        size = (low + high) / 2
        slip, rolling = _linear(body, size)
        larger = MP.sqrt((body.friction * slip) ** 2 + (body.rolling * rolling) ** 2) > size
        low, high = (size, high) if larger else (low, size)
    slip, rolling = map(wide, _linear(body, (low + high) / 2))
    return Straight(start, np.array([slip, Wide(0), rolling, Wide(0), Wide(0)]))


def steady(body: Resisted, start: Pose) -> Straight | None:
    """Return the leg of a sphere in one cone whose velocities keep their ratios; None if they do not.

    A slip close to the one that keeps its ratio to the rolling velocity is left out: it vanishes, and moves nothing by more.
    """
    pivots = bool(start.pivoting and body.pivoting)
    if not (start.slip.any() or start.rolling.any() or (pivots and body.downhill)):
        return released(body, start) if not body.holds else Straight(start, np.array([*np.zeros(4, Wide), _twist(body, start)]))
    speed = np.hypot(*start.rolling)
    direction = DOWNHILL if body.downhill else start.rolling / (speed or Wide(1))
    aside = [vector[0] * direction[1] - vector[1] * direction[0] for vector in (start.slip, start.rolling)]
    if pivots or not speed or np.abs(aside).max() > NONE * np.hypot(*start.slip):
        return None
    rolling = real(start.rolling @ direction)
    ratio = real(start.slip @ direction) / rolling
    exact, growth = _kept(body, ratio, MP.sign(rolling), body.downhill * _sign(direction[0]))
    if abs(exact - ratio) > NEAR * abs(ratio):
        return None
    kept = np.array([*(wide(exact * rolling) * direction), *(wide(rolling) * direction), start.pivoting])
    rates = np.array([*(wide(exact * growth) * direction), *(wide(growth) * direction), Wide(0)])
    left = float(np.abs(start.velocities - kept).sum())
    return Straight(replace(start, slip=kept[:2], rolling=kept[2:4]), rates, together=True, error=left)


def _kept(body: Resisted, ratio: Real, sign: Real, downhill: Real) -> tuple[Real, Real]:
    """The ratio of slip to rolling velocity that stays, near another one, and the rate of the rolling velocity (m/s^2)."""
    k = body.ratio
    for _ in range(RATIOS):
        size = MP.sqrt((body.friction * ratio) ** 2 + body.rolling**2)
        resisting = sign * body.load * body.rolling**2 / size
        braking = sign * body.load * body.friction**2 / size
        # slip' = ratio rolling', with friction -braking ratio and moment -resisting
        growth = (braking * ratio - resisting) / k
        ratio = (downhill + resisting / k - ratio * growth) / (braking * (1 + 1 / k))
    return ratio, growth


def _linear(body: Resisted, size: Real) -> tuple[Real, Real]:
    """The rates of slip and rolling velocity (m/s^2) with friction that is linear in them, over a size D (m/s^2)."""
    k = body.ratio
    braking, resisting = body.load * body.friction**2 / size, body.load * body.rolling**2 / size
    # rolling (k + resisting) = braking slip;  slip (1 + braking) + rolling = downhill
    share = braking / (k + resisting)
    slip = body.downhill / (1 + braking + share)
    return slip, share * slip
