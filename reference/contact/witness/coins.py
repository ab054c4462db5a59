"""The witness of a coin that rolls without slip on its rim: the balance of moments about the contact, in the world frame.

With r the arm from the contact to the centre of mass and w the angular velocity, the velocity of the centre is w x r. The
angular momentum about the contact, M = J w, changes by the moment of the weight, and because the contact moves along the plane:

    dM/dt = r x (m g) + m (dr/dt) x (w x r).

The force at the rim does not appear; it is computed only to find the slip. The units of length, time and mass are those of the
radius, of the time in which the coin falls or turns, and of the coin.
"""

import contextlib
from dataclasses import dataclass, replace

import numpy as np

from bodycheck.reference.bounds import EPS
from bodycheck.reference.contact.witness.faces import AXES, DECIMALS, half_lengths, in_world, wide_vector
from bodycheck.reference.contact.witness.faces import axis as axis_of
from bodycheck.reference.contact.witness.reading import FreeBody, bodies, surface
from bodycheck.reference.contact.witness.searching import Margin, first_negative
from bodycheck.reference.errors import NotModelled, OutOfReach
from bodycheck.reference.independent.arithmetic import (
    WIDE_EPS,
    Real,
    Vector,
    Wide,
    cross,
    dot,
    minus,
    norm,
    plus,
    scaled,
    wide,
)
from bodycheck.reference.independent.border import MP
from bodycheck.reference.independent.directions import quaternion_of
from bodycheck.reference.integration.collocation import steps
from bodycheck.reference.mechanisms.mechanism import AnyScene
from bodycheck.reference.scene import Cylinder
from bodycheck.reference.trajectory import Array
from bodycheck.reference.witness import Instant, WideArray, Witness, angle_between

#: Name of the way in results.
NAME = "balance of moments about the rim, Gauss-Legendre collocation"

#: The numbers of nodes of the steps of two integrations, the second of which measures the error of the first.
STAGES, FEWER_STAGES = 22, 18

#: The size of the first step, and the largest number of evaluations of the equations, each for all nodes of a step.
FIRST, MOST = 0.5, 40_000

#: The factor by which an error may exceed the difference of two integrations.
SAFETY = 4.0

#: The number of roundings of a state in the wide type.
ROUNDINGS = 16.0

#: The indices of the components of a state: the axes K and I of the coin, the angular momentum about the contact, and the place
#: of the centre of mass along the plane.
AXIS, FIRST_AXIS, MOMENTUM, PLACE = slice(0, 3), slice(3, 6), slice(6, 9), slice(9, 11)

#: The indices of the next and of the last of three components, in a circle.
_NEXT, _LAST = [1, 2, 0], [2, 0, 1]

#: The direction of the vertical.
UP = np.array([0, 0, 1], dtype=Wide)


@dataclass(frozen=True, eq=False)
class Coin:
    """A coin that touches a level plane with a point of its rim, in its units.

    Attributes
    ----------
    radius, half_length
        Its radius; and half its length, with the sign of the component of K along the vertical.
    across, along
        The moments of inertia about a diameter and about K.
    gravity
        The gravitational acceleration.
    start
        (11,) the state at t = 0.
    length, time
        The units (m, s).
    missed
        The differences of height (m) and velocity (m/s) in the file from those of rolling.
    node
        (3,) the level diameter about which a coin without other spin falls in a plane; None for any other coin.
    """

    radius: Wide
    half_length: Wide
    across: Wide
    along: Wide
    gravity: Wide
    start: WideArray
    length: Wide
    time: Wide
    missed: tuple[float, float]
    node: WideArray | None


@dataclass(frozen=True, eq=False)
class Motion:
    """A coin in n states: its arm, the rate of its arm, its angular velocity, and the velocity of its centre, each (n, 3)."""

    arm: WideArray
    arm_rate: WideArray
    spin: WideArray
    velocity: WideArray


@dataclass(frozen=True, eq=False)
class Rolled:
    """States (n, 11) of a coin, NaN after its end, with the events."""

    states: WideArray
    events: tuple[Instant, ...]


def second(scene: AnyScene, times: Array) -> Witness | None:
    """The motion of a coin that rolls, at ascending times (n,) >= 0 (s), as far as it can be followed; None for another scene.

    Raises `OutOfReach` if it cannot be followed at all.
    """
    coin = _coin(scene)
    if coin is None:
        return None
    t, friction = times.astype(Wide) / coin.time, surface(scene).friction
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):  # steps that are too large are made smaller
        rolled, other = (_rolled(coin, friction, t, stages) for stages in (STAGES, FEWER_STAGES))
    poses, others = _poses(coin, rolled.states), _poses(coin, other.states)
    sizes = [1 + np.sqrt((values * values).sum(axis=-1)).astype(float) for values in poses]
    apart = [np.sqrt(((a - b) ** 2).sum(axis=-1)).astype(float) for a, b in zip(poses, others, strict=True)]
    apart[0] = angle_between(poses[0], others[0])
    error, spun, placed, moved = (
        SAFETY * np.fmax.accumulate(np.nan_to_num(each)) + ROUNDINGS * WIDE_EPS * np.nan_to_num(size)
        for each, size in zip(apart, sizes, strict=True)
    )
    late = [abs(one.time - another.time) for one, another in zip(rolled.events, other.events, strict=False)]
    events = tuple(replace(one, error=one.error + SAFETY * each) for one, each in zip(rolled.events, late, strict=False))
    quaternion, spin, position, velocity = poses
    return Witness(
        NAME,
        quaternion=quaternion[None],
        angular_velocity=(spin / coin.time)[None],
        position=(position * coin.length)[None],
        velocity=(velocity * (coin.length / coin.time))[None],
        error=error,
        angular_velocity_error=spun / float(coin.time),
        position_error=placed * float(coin.length) + coin.missed[0],
        velocity_error=moved * float(coin.length / coin.time) + coin.missed[1],
        events=events,
    )


def _coin(scene: AnyScene) -> Coin | None:
    """The coin of a scene; None if its only body does not roll on its rim on a level plane."""
    free = bodies(scene)
    if len(free) != 1 or scene.pushes or surface(scene).normal[0] or not scene.gravity:
        return None
    (body,) = free
    if not isinstance(body.shape, Cylinder) or not any(body.rates):
        return None
    axis = axis_of(body, 2)
    slope = MP.hypot(axis[0], axis[1])
    if min(slope, abs(axis[2])) <= DECIMALS:
        return None
    radius, half_length = half_lengths(body)[0], half_lengths(body)[2] * MP.sign(axis[2])
    uphill = (-axis[2] * axis[0] / slope, -axis[2] * axis[1] / slope, slope)
    arm = plus(scaled(axis, half_length), scaled(uphill, radius))
    spin = in_world(body, body.rates)
    rolling = cross(spin, arm)
    gap, missed = abs(body.position[2] - arm[2]), norm(minus(body.velocity, rolling))
    if gap > DECIMALS * norm(arm) or missed > 2 * DECIMALS * norm(spin) * norm(arm):
        return None
    if body.tensor[0][0] != body.tensor[1][1]:
        raise NotModelled("a coin whose moments about its diameters differ")
    return _scaled(body, MP.mpf(scene.gravity), (radius, half_length), arm, spin, (float(gap), float(missed)))


def _scaled(
    body: FreeBody, gravity: Real, sizes: tuple[Real, Real], arm: Vector, spin: Vector, missed: tuple[float, float]
) -> Coin:
    """A coin in its units. sizes: its radius, and half its length with a sign (m). arm: from the contact to the centre (m)."""
    length = sizes[0]
    time = 1 / (MP.sqrt(gravity / length) + norm(spin))
    across, along = (body.tensor[axis][axis] / (body.mass * length**2) for axis in (0, 2))
    axis, unit, turning = axis_of(body, 2), scaled(arm, 1 / length), scaled(spin, time)
    level = cross(AXES[2], axis)
    node = scaled(level, 1 / norm(level))
    falls = norm(minus(turning, scaled(node, dot(turning, node)))) <= WIDE_EPS
    momentum = plus(
        scaled(turning, across + dot(unit, unit)),
        scaled(axis, (along - across) * dot(axis, turning)),
        scaled(unit, -dot(unit, turning)),
    )
    centre = [part / length for part in body.position[:2]]
    return Coin(
        wide(MP.one),
        wide(sizes[1] / length),
        wide(across),
        wide(along),
        wide(gravity * time**2 / length),
        wide_vector([*axis, *axis_of(body, 0), *momentum, *centre]),
        wide(length),
        wide(time),
        missed,
        wide_vector(node) if falls else None,
    )


def _moving(coin: Coin, states: WideArray) -> Motion:
    """The motion of a coin in states (n, 11)."""
    axis = states[:, AXIS]
    node = _node(coin, axis)
    arm = coin.half_length * axis + coin.radius * _crossed(axis, node)
    spin = _solved(_inertia(coin, axis, arm), states[:, MOMENTUM])
    turned = _crossed(spin, axis)
    uphill_rate = _crossed(turned, node)
    if coin.node is None:  # otherwise the diameter does not turn
        steep = np.sqrt(axis[:, :1] ** 2 + axis[:, 1:2] ** 2)
        uphill_rate = uphill_rate - axis[:, 2:] / steep * (turned * node).sum(axis=1)[:, None] * node
    return Motion(arm, coin.half_length * turned + coin.radius * uphill_rate, spin, _crossed(spin, arm))


def _node(coin: Coin, axis: WideArray) -> WideArray:
    """The level diameters (n, 3) of a coin whose axis has the directions (n, 3)."""
    if coin.node is not None:
        return np.broadcast_to(coin.node, axis.shape)
    level = np.stack([-axis[:, 1], axis[:, 0], np.zeros_like(axis[:, 0])], axis=1)
    return np.asarray(level / np.sqrt(axis[:, :1] ** 2 + axis[:, 1:2] ** 2))


def _inertia(coin: Coin, axis: WideArray, arm: WideArray) -> WideArray:
    """The inertia tensors (n, 3, 3) about the contact, world frame, per unit of mass."""
    round_about = coin.across + (arm * arm).sum(axis=1)
    diagonal = round_about[:, None, None] * np.eye(3, dtype=Wide)
    slender = (coin.along - coin.across) * (axis[:, :, None] * axis[:, None, :])
    return np.asarray(diagonal + slender - arm[:, :, None] * arm[:, None, :])


def _solved(rows: WideArray, right: WideArray) -> WideArray:
    """The solutions (n, 3) of linear equations with symmetric matrices (n, 3, 3) and right sides (n, 3), by Cramer's rule."""
    a, b, c = rows[:, 0], rows[:, 1], rows[:, 2]
    bc = _crossed(b, c)
    first, second, third = ((right * each).sum(axis=1) for each in (bc, _crossed(c, a), _crossed(a, b)))
    return np.asarray(np.stack([first, second, third], axis=1) / (a * bc).sum(axis=1)[:, None])


def _crossed(a: WideArray, b: WideArray) -> WideArray:
    """The vector products (n, 3) of vectors (n, 3), in a third of the time of np.cross."""
    products = a[:, _NEXT] * b[:, _LAST] - a[:, _LAST] * b[:, _NEXT]
    return np.asarray(products)


def _momentum_rate(coin: Coin, motion: Motion) -> WideArray:
    """The rate of change (n, 3) of the angular momentum about the contact."""
    weighing = coin.gravity * _crossed(motion.arm, np.broadcast_to(UP, motion.arm.shape))
    return np.asarray(_crossed(motion.arm_rate, motion.velocity) - weighing)


def _derivatives(coin: Coin, states: WideArray) -> WideArray:
    """The derivatives (n, 11) of states (n, 11)."""
    motion = _moving(coin, states)
    turned = (_crossed(motion.spin, states[:, part]) for part in (AXIS, FIRST_AXIS))
    return np.concatenate([*turned, _momentum_rate(coin, motion), motion.velocity[:, :2]], axis=1)


def _margins(coin: Coin, friction: Real) -> dict[str, Margin]:
    """The conditions under which a coin rolls on: friction holds the force at its rim, and it touches with one point alone."""

    def held(states: WideArray) -> WideArray:
        motion, axis = _moving(coin, states), states[:, AXIS]
        turned = _crossed(motion.spin, axis)
        across, along = (motion.spin * motion.arm).sum(axis=1), (motion.spin * axis).sum(axis=1)
        # The rate of change of J, times w.
        inertia_rate = (
            2 * (motion.arm * motion.arm_rate).sum(axis=1)[:, None] * motion.spin
            + (coin.along - coin.across) * (along[:, None] * turned + (motion.spin * turned).sum(axis=1)[:, None] * axis)
            - across[:, None] * motion.arm_rate
            - (motion.spin * motion.arm_rate).sum(axis=1)[:, None] * motion.arm
        )
        turning = _solved(_inertia(coin, axis, motion.arm), _momentum_rate(coin, motion) - inertia_rate)
        force = _crossed(turning, motion.arm) + _crossed(motion.spin, motion.arm_rate) + coin.gravity * UP
        if MP.isinf(friction):
            return np.asarray(force[:, 2])
        return np.asarray(wide(friction) * force[:, 2] - np.hypot(force[:, 0], force[:, 1]))

    def above(states: WideArray) -> WideArray:
        """Return the margins (n,) up to lying on its side and, if the coin can get there, on its face."""
        upwards = np.asarray(np.sign(coin.half_length) * states[:, 2])
        if coin.node is None:
            return upwards
        return np.asarray(np.minimum(upwards, coin.node[1] * states[:, 0] - coin.node[0] * states[:, 1]))

    return {"slip": held, "impact": above}


def _rolled(coin: Coin, friction: Real, t: WideArray, stages: int) -> Rolled:
    """Follow a coin at times t (n,), in its units, as far as steps with a number of nodes can."""
    states, margins = np.full((len(t), len(coin.start)), np.nan, dtype=Wide), _margins(coin, friction)
    states[t == 0] = coin.start
    row = int((t == 0).sum())
    solved = steps(lambda each: _derivatives(coin, each), coin.start, stages=stages, first=FIRST, most=MOST, memory=1)
    with contextlib.suppress(OutOfReach):  # near lying flat or upright, no step can be solved
        for step in solved:
            ends = {kind: instant for kind, margin in margins.items() if (instant := first_negative(step, margin)) is not None}
            kind = min(ends, key=lambda each: ends[each], default=None)
            until = step.end if kind is None else ends[kind]
            last = int(np.searchsorted(t, until, side="right"))
            states[row:last], row = step.at(t[row:last]), last
            if kind is not None and until <= t[-1]:
                time = float(until * coin.time)
                return Rolled(states, (Instant(kind, time, 2 * EPS * time),))
            if row == len(t):
                break
    return Rolled(states, ())


def _poses(coin: Coin, states: WideArray) -> tuple[WideArray, WideArray, WideArray, WideArray]:
    """Attitudes (n, 4), angular velocities along the body's axes, places and velocities (n, 3), in the units of the coin."""
    motion = _moving(coin, states)
    axis, first = states[:, AXIS], states[:, FIRST_AXIS]
    cosines = np.stack([first, _crossed(axis, first), axis], axis=2)
    known = ~np.isnan(states[:, 0])
    attitude = np.full((len(states), 4), np.nan, dtype=Wide)
    attitude[known] = quaternion_of(cosines[known])
    spin = np.einsum("nij,ni->nj", cosines, motion.spin)
    position = np.concatenate([states[:, PLACE], motion.arm[:, 2:]], axis=1)
    return attitude, spin, position, motion.velocity
