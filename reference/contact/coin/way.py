"""The motion of a coin that rolls without slip, with bounds of errors from a second solution by other equations."""

import math
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.bounds import EPS
from bodycheck.reference.contact.coin import angles, bodily, steady
from bodycheck.reference.contact.coin.ends import FIRST, MOST, End, Followed, followed, slacks
from bodycheck.reference.contact.coin.start import Coin, coin
from bodycheck.reference.contact.motion import ContactMotion, Event
from bodycheck.reference.contact.problem import Problem
from bodycheck.reference.errors import NotModelled
from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.integration.collocation import integrate
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.scene import vector_of
from bodycheck.reference.trajectory import Array
from bodycheck.reference.witness import WideArray, angle_between

#: The names of the solutions.
APPELL = "Appell's equations in Euler angles, Gauss-Legendre collocation"
NEWTON = "Newton's and Euler's equations with a quaternion, Gauss-Legendre collocation"
STEADY = "closed form: steady circle"

REASON = "the coin is rigid and rolls without slip on the circle of its rim"

#: The number of nodes of a step of the second solution. It differs from the first solution's, so that its steps differ too.
_STAGES = 20

#: The factor by which the error of a solution may exceed the disagreement of two solutions.
_SAFETY = 2.0

#: The number of roundings of the start, relative to the size of a state, which both solutions have in common.
_ROUNDINGS = 16.0

#: The largest difference, in units of the coin, of a steady motion in closed form from the motion of the scene, whose numbers
#: are rounded. If it is larger, the motion of the scene is only close to the steady motion.
_STEADY = 1e-12

#: Positions (n, 3), velocities (n, 3), attitudes (n, 4) and angular velocities (n, 3).
_Poses = tuple[WideArray, WideArray, WideArray, WideArray]

#: The smallest rate of a slack at an end (see `ends.End`) in the error of its instant; below it the end is grazing.
_GRAZING = 1e-9


@dataclass(frozen=True, eq=False)
class _Vouched:
    """A motion at instants (k,) with its witness, in units of the coin.

    Attributes
    ----------
    poses
        The motion.
    apart
        The largest differences so far (k,) from the positions, velocities, attitudes and angular velocities of the witness.
    model, witness
        The names of the two solutions.
    slack_error
        The difference of the slack that ends the motion (see `ends.slacks`) in the two solutions shortly before the end.
    """

    poses: _Poses
    apart: tuple[Array, ...]
    model: str
    witness: str
    slack_error: float = 0.0


def rolling_coin(problem: Problem, times: Array) -> ContactMotion | None:
    """The motion of a cylinder that rolls without slip with a point of its rim on a level plane.

    It ends when the friction does not hold, or when the coin meets the plane with its face or its side. Returns None for any
    other problem. Raises `NotModelled` for a coin that slips at its start, and `OutOfReach` for a coin that comes too close to
    lying flat.
    """
    wheel = coin(problem)
    if wheel is None:
        return None
    friction, _ = problem.pair(0)
    _check_start(wheel, friction)
    t = times / float(wheel.time)
    # Steps that are too large may overflow, and are then made smaller.
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        motion = followed(wheel, friction, t)
        count = int((~np.isnan(motion.states[:, 0])).sum())
        vouched = _vouched(wheel, motion, t[:count])
    position, velocity, quaternion, spin = (_spread(values, len(t)) for values in _in_units(wheel, vouched.poses))
    end = motion.end
    return ContactMotion(
        position[None],
        velocity[None],
        quaternion[None],
        spin[None],
        {name: _spread(values, len(t)) for name, values in _bounds(wheel, vouched).items()},
        () if end is None else (_event(wheel, end, vouched.slack_error),),
        vouched.model,
        REASON,
        friction=motion.friction if end is None or end.kind == "impact" or math.isinf(friction) else 0.0,
        witness=vouched.witness,
    )


def _check_start(coin: Coin, friction: float) -> None:
    """Raise `NotModelled` if the friction does not hold a coin at its start."""
    _, held = slacks(coin, friction)[0]
    if held(angles.initial(coin)[None])[0] >= 0:
        return
    tangential, normal = (float(force[0]) for force in angles.forces(coin, angles.initial(coin)[None]))
    needs = f"it needs the friction {tangential / normal:.6g}" if normal > 0 else "its rim is lifted from the plane"
    raise NotModelled(f"a coin that slips at its start: {needs}")


def _vouched(coin: Coin, motion: Followed, t: Array) -> _Vouched:
    """A motion with its witness. t: the instants (k,) before its end, in units of the coin."""
    poses = angles.poses(coin, motion.states[: len(t)])
    if motion.end is None and steady.is_steady(coin):
        closed = angles.poses(coin, steady.states(coin, t))
        apart = _apart(closed, poses)
        if all((each <= _STEADY).all() for each in apart):
            return _Vouched(closed, apart, STEADY, APPELL)
    end = motion.end
    early = len(t) if end is None else int(np.searchsorted(t, float(end.before)))
    grid = t if end is None else np.insert(t, early, float(end.before))
    other = integrate(
        bodily.equations(coin), bodily.initial(coin), grid, stages=_STAGES, first=FIRST, most=MOST, memory=1
    ).states
    if end is None:
        return _Vouched(poses, _apart(poses, bodily.poses(coin, other)), APPELL, NEWTON)
    apart = _apart(poses, bodily.poses(coin, np.delete(other, early, axis=0)))
    return _Vouched(poses, apart, APPELL, NEWTON, _slack_error(coin, end, other[early : early + 1]))


def _apart(one: _Poses, other: _Poses) -> tuple[Array, ...]:
    """The largest distances (k,) so far between positions, velocities, attitudes and angular velocities of two motions."""
    distances = [np.sqrt(((a - b) ** 2).sum(axis=1)).astype(float) for a, b in zip(one, other, strict=True)]
    distances[2] = angle_between(one[2], other[2])
    return tuple(np.maximum.accumulate(distance) for distance in distances)


def _slack_error(coin: Coin, end: End, other: WideArray) -> float:
    """The difference of two solutions shortly before an end.

    For an impact it is the angle (rad) between the attitudes, and for a slip the sum of the differences of both forces, in
    units of the coin's weight. other: the state (1, 10) of the second solution there.
    """
    one = end.state_before[None]
    if end.kind == "impact":
        return float(angle_between(angles.poses(coin, one)[2], bodily.poses(coin, other)[2])[0])
    forces = zip(angles.forces(coin, one), bodily.forces(coin, other), strict=True)
    return sum(abs(float((a - b)[0])) for a, b in forces)


def _bounds(coin: Coin, vouched: _Vouched) -> dict[str, Array]:
    """The bounds (k,) of the errors of a motion, in SI units, increased if they do not explain the drift of the energy."""
    rounding = _ROUNDINGS * float(np.finfo(Wide).eps)
    sizes = [1.0 + np.sqrt((pose * pose).sum(axis=1)).astype(float) for pose in vouched.poses]
    bounds = [_SAFETY * each + rounding * size for each, size in zip(vouched.apart, sizes, strict=True)]
    grown = _drift(coin, vouched.poses, bounds)
    position, velocity, error, spin = (grown * each for each in bounds)
    length, time = float(coin.length), float(coin.time)
    return {
        "error": error,
        "position_error": position * length + coin.missed_position,
        "velocity_error": velocity * (length / time) + coin.missed_velocity,
        "angular_velocity_error": spin / time,
    }


def _drift(coin: Coin, poses: _Poses, errors: list[Array]) -> Array:
    """The largest ratio so far (k,) of the drift of the energy to the drift that errors (k,) allow; at least 1."""
    position, velocity, _, spin = poses
    momentum = spin * np.array([coin.across, coin.across, coin.along])
    energy = ((velocity * velocity).sum(axis=1) + (momentum * spin).sum(axis=1)) / 2 + coin.gravity * position[:, 2]
    lengths = [np.sqrt((each * each).sum(axis=1)).astype(float) for each in (velocity, momentum)]
    allowed = lengths[0] * errors[1] + lengths[1] * errors[3] + float(coin.gravity) * errors[0]
    drift = np.abs(energy - energy[0]).astype(float)
    return np.maximum(1.0, np.maximum.accumulate(drift / allowed))


def _event(coin: Coin, end: End, slack_error: float) -> Event:
    """The event with which the coin no longer rolls. No law gives its velocity after its face or its side has hit the plane."""
    position, velocity, quaternion, spin = _in_units(coin, angles.poses(coin, end.state[None]))
    time = float(end.time * coin.time)
    late = (_SAFETY * slack_error + _ROUNDINGS * float(np.finfo(Wide).eps)) / max(abs(end.rate), _GRAZING)
    after = velocity[0], rotate(quaternion, spin)[0]
    fast, turning = map(vector_of, after if end.kind == "slip" else np.full((2, 3), np.nan))
    error = late * float(coin.time) + EPS * time
    return Event(end.kind, time, error, 0, vector_of(position[0]), fast, turning)


def _in_units(coin: Coin, poses: _Poses) -> _Poses:
    """Convert poses of a coin, in its units, to poses of the body of the scene, in SI units."""
    position, velocity, quaternion, spin = poses
    return position * coin.length, velocity * (coin.length / coin.time), *coin.as_given(quaternion, spin)


def _spread(values: WideArray, count: int) -> WideArray:
    """Extend values (k, ...) at the instants before the end to values (count, ...) at all instants, with NaN after the end."""
    spread = np.full((count, *values.shape[1:]), np.nan, dtype=values.dtype)
    spread[: len(values)] = values
    return spread
