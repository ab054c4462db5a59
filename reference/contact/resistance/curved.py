"""Legs whose accelerations change, integrated by collocation over a parameter q in which a velocity vanishes only at infinity.

The parameter has dt/dq = D in one cone. With separate limits, it has dt/dq = |u| |p|/(|u| + |p|) while the sphere slips and
rolls, |u| while friction keeps it from rolling, and |p| while it keeps it from slipping. The rates in q are then smooth.

In one cone on a level plane, the velocities are linear combinations of exponentials of q, however fast the slip decays.
"""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from bodycheck.reference.contact.resistance.laws import Pose, Resisted, velocity_and_spin
from bodycheck.reference.contact.resistance.straight import steady
from bodycheck.reference.errors import NotModelled, OutOfReach
from bodycheck.reference.exact.numbers import Wide, wide
from bodycheck.reference.integration.collocation import FINEST, Step, steps
from bodycheck.reference.kinematics import normalise
from bodycheck.reference.witness import WideArray

#: The number of nodes of a step, and the largest number of evaluations of the equations, which take some ten seconds.
STAGES, MOST = 24, 120_000

#: The size of the first step in units of the time in which friction changes the velocities.
FIRST = 0.1

#: The ratio of the rate of time to that at the start at which a velocity has vanished.
GONE = Wide(1e-19)

#: The number of steps of Newton's method for the parameter at an instant.
NEWTON_STEPS = 60

#: Indices of the parts of a state: slip, rolling velocity, pivoting velocity, position along the plane, rotation, time.
U, P, S, X, Q, T = slice(0, 2), slice(2, 4), 4, slice(5, 7), slice(7, 11), 11

#: How a sphere moves: in one cone, on a level plane or not, or with separate limits in slip and roll, or in one of these alone.
Mode = Literal["level", "one", "both", "slip", "roll"]


@dataclass(frozen=True, eq=False)
class Curved:
    """The states of a leg at instants (n,) before its end.

    Attributes
    ----------
    position, velocity, spin
        Positions (m), velocities (m/s) and angular velocities (rad/s), (n, 3), along the axes of the plane.
    turn
        Rotations (n, 4) since t = 0.
    end
        The sphere at its end.
    error
        The sum of the errors of its steps (m/s).
    slowing
        The rate (m/s^2) at which the velocity that has vanished has done so; infinite if none has.
    """

    position: WideArray
    velocity: WideArray
    spin: WideArray
    turn: WideArray
    end: Pose
    error: float
    slowing: float


@dataclass(frozen=True, eq=False)
class Decay:
    """Velocities that decay in one cone on a level plane: sums of exponentials of the parameter.

    Attributes
    ----------
    rates
        Rates (3,) of three exponentials.
    shares
        Slip, rolling velocity and pivoting velocity (3, 5) that belong to each.
    """

    rates: WideArray
    shares: WideArray

    def velocities(self, q: WideArray) -> WideArray:
        """Slip, rolling velocity and pivoting velocity (n, 5) at parameters (n,)."""
        return np.asarray(np.exp(-q[:, None] * self.rates) @ self.shares)


def _decay(velocities: WideArray, ratio: Wide, load: Wide, friction: Wide, rolling: Wide, pivoting: Wide) -> Decay:
    """The decay of velocities (5,): u' = b p - (1 + 1/k) a u, p' = a u/k - b p, s' = -c s, without differences of equals."""
    a, b, c = load * friction**2, load * rolling**2 / ratio, load * pivoting**2 / ratio
    whole = a * (1 + 1 / ratio) + b
    fast = (whole + np.sqrt(whole * whole - 4 * a * b)) / 2
    slow = a * b / fast
    slips = b / (a * (1 + 1 / ratio) - slow), (b - fast) * ratio / a
    u, p = velocities[U], velocities[P]
    fast_part = (u - slips[0] * p) / (slips[1] - slips[0])
    shares = np.zeros((3, 5), Wide)
    for row, (slip, part) in enumerate(zip(slips, (p - fast_part, fast_part), strict=True)):
        shares[row, U], shares[row, P] = slip * part, part
    shares[2, S] = velocities[S]
    return Decay(np.array([slow, fast, c]), shares)


@dataclass(frozen=True, eq=False)
class Equations:
    """The equations of a sphere in the widest type, in units of a speed and of a time: see `laws`.

    `turning` is the angle (rad) by which it turns with the unit of speed in the unit of time, and `twist` the sign of s. The
    slip of a sphere that rolls in one cone is much smaller than its other velocities, and is in a unit that is smaller by the
    factor `stretch`, so that its force has as many digits as the others.
    """

    mode: Mode
    ratio: Wide
    downhill: Wide
    friction: Wide
    rolling: Wide
    pivoting: Wide
    load: Wide
    turning: Wide
    twist: Wide
    stretch: Wide
    decay: "Decay | None"

    def velocities(self, states: WideArray) -> WideArray:
        """Slip, rolling velocity and pivoting velocity (n, 5) in states (n, 12)."""
        if self.mode == "level":
            assert self.decay is not None  # it belongs to the mode
            return self.decay.velocities(states[:, 0])
        velocities = states[:, :5].copy()
        velocities[:, U] /= self.stretch
        return velocities

    def pace(self, states: WideArray) -> WideArray:
        """The rate of time (n,) in the parameter."""
        return self._forces(self.velocities(states))[0]

    def _forces(self, velocities: WideArray) -> tuple[WideArray, WideArray, WideArray, WideArray]:
        """The rate of time (n,), and F, R (n, 2) and T (n,) times this rate."""
        u, p, s, a = velocities[:, U], velocities[:, P], velocities[:, S], self.load
        slip, roll = _lengths(u), _lengths(p)
        if self.mode in ("level", "one"):
            pace = np.sqrt((self.friction * slip) ** 2 + (self.rolling * roll) ** 2 + (self.pivoting * s) ** 2)
            return pace, -a * self.friction**2 * u, -a * self.rolling**2 * p, -a * self.pivoting**2 * s
        if self.mode == "both" and not self.rolling:
            pace, force, moment = slip, -a * self.friction * u, np.zeros_like(p)
        elif self.mode == "both" and not self.friction:
            pace, force, moment = roll, np.zeros_like(u), -a * self.rolling * p
        elif self.mode == "both":
            sum_of_both = slip + roll
            pace = slip * roll / sum_of_both
            force = -a * self.friction * u * (roll / sum_of_both)[:, None]
            moment = -a * self.rolling * p * (slip / sum_of_both)[:, None]
        elif self.mode == "slip":
            pace, force = slip, -a * self.friction * u
            moment = force
        else:
            pace, moment = roll, -a * self.rolling * p
            drive = np.stack([pace * self.downhill, np.zeros_like(pace)], axis=1)
            force = (drive + moment) / (1 + self.ratio) - drive
        return pace, force, moment, -a * self.pivoting * self.twist * pace

    def rates(self, states: WideArray) -> WideArray:
        """The rates (n, 12) of states (n, 12) in the parameter."""
        velocities = self.velocities(states)
        pace, force, moment, twist = self._forces(velocities)
        changed = np.zeros_like(states)
        if self.mode == "level":
            changed[:, 0] = 1
        else:
            drive = np.stack([pace * self.downhill, np.zeros_like(pace)], axis=1)
            rolled = (moment - force) / self.ratio
            changed[:, P], changed[:, S] = rolled, twist / self.ratio
            changed[:, U] = 0 if self.mode == "roll" else self.stretch * (drive + force - rolled)
        changed[:, X] = pace[:, None] * (velocities[:, U] + velocities[:, P])
        a, b, c = (pace * self.turning / 2) * np.stack([-velocities[:, 3], velocities[:, 2], velocities[:, S]])
        w, x, y, z = states[:, Q].T
        turned = -(a * x + b * y + c * z), a * w + b * z - c * y, b * w + c * x - a * z, c * w + a * y - b * x
        changed[:, Q] = np.stack(turned, axis=1)
        changed[:, T] = pace
        return changed


def curved(body: Resisted, start: Pose, instants: WideArray, until: Wide) -> Curved:
    """Return a leg at ascending instants (n,), s, after its start, until a velocity vanishes or at most `until` (s).

    It also ends when the velocities keep their ratios. Raises `NotModelled` for a sphere that begins to slip while it turns
    across the fall line, and `OutOfReach` for too many steps.
    """
    speed, mode = _lengths(start.velocities[None])[0], _mode(body, start)
    equations, time = _equations(body, start, mode, speed)
    first = _state(equations, start, speed)[None]
    scale = equations.pace(first)[0]
    relative, last = (instants - start.time) / time, (until - start.time) / time
    rows = np.zeros((len(instants), 12), Wide)
    row, error, slowing = 0, 0.0, np.inf
    try:
        for step in steps(equations.rates, first[0], stages=STAGES, first=FIRST / float(scale), most=MOST, memory=1):
            error += max(step.error, FINEST) * float(step.size * np.abs(step.slopes).max())
            ended = step.last()
            inside = int(np.searchsorted(relative, min(ended[T], last), side="right"))
            rows[row:inside] = _at(equations, step, relative[row:inside])
            row, pose = inside, None
            pace = equations.pace(ended[None])[0]
            if ended[T] >= last:
                pose = _pose(equations, start, _at(equations, step, np.array([last]))[0], speed, time)
            elif pace <= GONE * scale:
                before = equations.pace(step.state[None])[0]
                left = pace * step.size / np.log(before / pace)
                pose = _vanished(equations, _pose(equations, start, ended, speed, time), left * time, pace * speed)
                slowing = float(pace * speed / (left * time))
            elif body.one and steady(body, after := _pose(equations, start, ended, speed, time)) is not None:
                pose = after
            if pose is not None:
                break
    except OutOfReach as reason:
        raise OutOfReach(f"a sphere with rolling or torsional friction: {reason}") from reason
    assert pose is not None  # `steps` is endless
    known = rows[:row]
    velocity, spin = velocity_and_spin(wide(body.radius), speed * equations.velocities(known))
    position = np.tile(start.position, (row, 1))
    position[:, :2] += speed * time * known[:, X]
    return Curved(position, velocity, spin, normalise(known[:, Q]), pose, error * float(speed), slowing)


def _mode(body: Resisted, start: Pose) -> Mode:
    slips, rolls = bool(start.slip.any()), bool(start.rolling.any())
    if body.one:
        return "one" if body.downhill else "level"
    if slips and (rolls or not body.rolling):
        return "both"
    if slips and body.friction <= body.rolling:
        return "slip"
    if rolls and body.ratio * body.downhill + body.rolling * body.load <= (1 + body.ratio) * body.friction * body.load:
        return "roll"
    raise NotModelled("a sphere with rolling friction that begins to slip or to roll across the fall line of its plane")


def _equations(body: Resisted, start: Pose, mode: Mode, speed: Wide) -> tuple[Equations, Wide]:
    """The equations in units of a speed (m/s) and of a time, and this time (s), in which friction changes the speed."""
    strongest = body.load * max(body.rolling, body.pivoting, body.friction if np.isfinite(float(body.friction)) else 0)
    rate = wide(max(strongest, body.downhill))
    time = speed / rate
    numbers = (wide(each) for each in (body.ratio, body.downhill, body.friction, body.rolling, body.pivoting, body.load))
    ratio, downhill, friction, rolling, pivoting, load = numbers
    turning = speed * time / wide(body.radius)
    twist, stretch = np.sign(start.pivoting), max(Wide(1), (friction / rolling) ** 2) if mode == "one" else Wide(1)
    decay = _decay(start.velocities / speed, ratio, load / rate, friction, rolling, pivoting) if mode == "level" else None
    forces = downhill / rate, friction, rolling, pivoting, load / rate
    return Equations(mode, ratio, *forces, turning, twist, stretch, decay), time


def _state(equations: Equations, start: Pose, speed: Wide) -> WideArray:
    velocities = start.velocities / speed * (0 if equations.mode == "level" else 1)
    velocities[U] *= equations.stretch
    return np.concatenate([velocities, np.zeros(2, Wide), start.turn, np.zeros(1, Wide)])


def _pose(equations: Equations, start: Pose, state: WideArray, speed: Wide, time: Wide) -> Pose:
    """The sphere in a state of a leg, which is in its units."""
    position = start.position.copy()
    position[:2] += speed * time * state[X]
    velocities = speed * equations.velocities(state[None])[0]
    turn = normalise(state[None, Q])[0]
    return Pose(start.time + time * state[T], position, turn, velocities[U], velocities[P], velocities[S])


def _vanished(equations: Equations, pose: Pose, left: Wide, least: Wide) -> Pose:
    """The sphere when a velocity has vanished, from that just before. left: the time until then (s). least: see `GONE`, m/s."""
    none, later = np.zeros(2, Wide), replace(pose, time=pose.time + left)
    if equations.mode in ("level", "one"):
        return replace(later, slip=none, rolling=none, pivoting=Wide(0) if equations.pivoting else pose.pivoting)
    return replace(
        later,
        slip=none if np.hypot(*pose.slip) <= 4 * least else pose.slip,
        rolling=none if np.hypot(*pose.rolling) <= 4 * least else pose.rolling,
    )


def _at(equations: Equations, step: Step, times: WideArray) -> WideArray:
    """The states (n, 12) at times (n,) of a step, by Newton's method for the parameter."""
    if not len(times):
        return np.zeros((0, 12), Wide)
    low, high = np.full(len(times), step.start), np.full(len(times), step.end)
    q: WideArray = (low + high) / 2
    states = step.at(q)
    for _ in range(NEWTON_STEPS):
        missing = times - states[:, T]
        low, high = np.where(missing > 0, q, low), np.where(missing > 0, high, q)
        newton = q + missing / equations.pace(states)
        after: WideArray = np.where((newton >= low) & (newton <= high), newton, (low + high) / 2)
        settled = np.all(np.abs(after - q) <= 2 * np.finfo(Wide).eps * np.abs(step.end))
        q, states = after, step.at(after)
        if settled:
            break
    return states


def _lengths(vectors: WideArray) -> WideArray:
    return np.asarray(np.sqrt((vectors * vectors).sum(axis=1)))
