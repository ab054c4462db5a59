"""The truth of one block that lies flat on a level or inclined plane, is pushed or not, rests, slides, and begins to tip.

All pieces are closed forms; see `legs` and `oblique`. Whether the block rests, slides or tips is decided with a hundred digits.
After the onset of tipping no motion is known.
"""

import math

import numpy as np

from bodycheck.reference.bounds import EPS
from bodycheck.reference.contact.flat.face import face_of
from bodycheck.reference.contact.flat.legs import Leg, Turn, legs, loads
from bodycheck.reference.contact.flat.oblique import states
from bodycheck.reference.contact.motion import ContactMotion, Event, Interface, known_at
from bodycheck.reference.contact.problem import NONE, ContactBody, Problem
from bodycheck.reference.errors import NotModelled
from bodycheck.reference.exact.numbers import MP, Real, Vector2, Wide, real, wide
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.mechanisms.mechanism import WORLD
from bodycheck.reference.trajectory import Array
from bodycheck.reference.witness import WideArray

#: Bound of the errors of closed forms in the wide type, relative to the largest terms in them.
_ROUNDINGS = 256 * float(np.finfo(Wide).eps)

#: Half an ulp of a number in double precision, relative to it.
_HALF_ULP = EPS / 2


def motion(problem: Problem, times: Array) -> ContactMotion | None:
    """The motion of one block that lies flat; None for any other problem. Raises `NotModelled` if it turns or lifts off."""
    if len(problem.bodies) != 1:
        return None
    body = problem.bodies[0]
    face = face_of(body)
    x, y, z = map(float, body.velocity)
    if face is None or abs(z) > NONE * math.hypot(x, y):
        return None
    if body.spin.any():
        if not _spins_about_normal(body):
            return None
        raise NotModelled("a block that spins on an inclined plane, under a push, or beside other bodies")
    position, velocity = (_exact(vector) for vector in (body.position, body.velocity))
    path, turns = legs(problem, face, position, velocity)
    tip = next((float(turn.time) for turn in turns if turn.kind == "tip"), math.inf)
    where, speeds = _states(body, path, times)
    count, last = len(times), float(times[-1]) if len(times) else 0.0
    whole = ContactMotion(
        where[None],
        speeds[None],
        np.tile(body.quaternion, (count, 1))[None],
        np.zeros((1, count, 3), dtype=Wide),
        _errors(problem, path, times, abs(z)),
        tuple(_event(problem, path, turn, body) for turn in turns if turn.time <= last),
        _model(path, last),
        "a block that lies flat moves along the plane as a point does, as long as its face bears the load",
        _smallest_friction(problem, path, min(last, tip)),
        _interfaces(path, last, tip),
    )
    return known_at(whole, times <= tip)


def _spins_about_normal(body: ContactBody) -> bool:
    """Return whether a body that lies flat turns only about the normal. If not, it leaves the plane or presses into it."""
    spin = rotate(body.quaternion, body.spin)
    return bool(np.hypot(spin[0], spin[1]) <= NONE * abs(spin[2]))


def _exact(vector: WideArray) -> Vector2:
    return real(vector[0]), real(vector[1])


def _states(body: ContactBody, path: list[Leg], times: Array) -> tuple[WideArray, WideArray]:
    """Positions (n, 3), m, and velocities (n, 3), m/s, at times (n,), s, until the onset of tipping."""
    where, speeds = np.tile(body.position, (len(times), 1)), np.zeros((len(times), 3), dtype=Wide)
    speeds[:, :2] = body.velocity[:2]  # if the block tips from t = 0 on, there is no leg
    for leg in path:
        within = (times >= float(leg.start)) & (times <= float(leg.end))
        passed = np.clip(times[within].astype(Wide) - wide(leg.start), 0, None)
        if leg.end < MP.inf:
            passed = np.minimum(passed, wide(leg.end - leg.start))
        start, velocity, acceleration = (
            np.array([wide(part) for part in vector], dtype=Wide) for vector in (leg.position, leg.velocity, leg.acceleration)
        )
        if leg.oblique is None:
            way = passed[:, None] * (velocity + acceleration * passed[:, None] / 2)
            speed = velocity + acceleration * passed[:, None]
        else:
            way, speed = states(leg.oblique, passed)
        where[within, :2], speeds[within, :2] = start + way, speed
    return where, speeds


def _errors(problem: Problem, path: list[Leg], times: Array, rising: float) -> dict[str, Array]:
    """The bounds of errors of states at times (n,), s.

    Two motions from the same start under drives that differ by d differ by at most d t^2 / 2, since friction brings them
    together.

    rising: the velocity along the normal that was taken to be zero (m/s).
    """
    body = problem.bodies[0]
    size, speed = float(np.linalg.norm(body.position)), float(np.linalg.norm(body.velocity))
    drive = max((_accelerations(problem, leg) for leg in path), default=0.0)
    doubt = np.zeros(len(times))
    for leg in path:
        doubt = np.maximum(doubt, np.where(times >= float(leg.start), _doubt(problem, leg), 0.0))
    return {
        "error": np.full(len(times), _ROUNDINGS),
        "position_error": _ROUNDINGS * (size + (speed + drive * times) * times) + doubt * np.square(times) / 2,
        "velocity_error": _ROUNDINGS * (speed + drive * times) + doubt * times + rising,
        "angular_velocity_error": np.zeros(len(times)),
    }


def _accelerations(problem: Problem, leg: Leg) -> float:
    """A bound of the acceleration (m/s^2) by drive and friction along a leg."""
    if leg.rests:
        return 0.0
    return float((MP.hypot(*leg.load.drive) + problem.pair(0)[0] * leg.load.press) / real(problem.bodies[0].mass))


def _doubt(problem: Problem, leg: Leg) -> float:
    """Return the uncertainty of the drive along a leg (m/s^2), from rounded pushes and from decisions at the limit of friction.

    If half an ulp of the numbers of the scene decides whether a block rests or slips, the bound covers both motions.
    """
    friction, mass = problem.pair(0)[0], real(problem.bodies[0].mass)
    slope, drive, press = problem.plane.incline, MP.hypot(*leg.load.drive), leg.load.press
    rough = 0.0 if math.isinf(friction) else friction
    rounded = _HALF_ULP * (1 + rough) * float(leg.load.pushed / mass) if slope else 0.0
    if math.isinf(friction) or any(leg.velocity):
        return rounded
    hold = friction * press
    edge = _HALF_ULP * float((slope * (press + friction * drive) + hold + (1 + rough) * leg.load.pushed) / mass)
    return rounded + edge if abs(drive - hold) <= edge * mass else rounded


def _event(problem: Problem, path: list[Leg], turn: Turn, body: ContactBody) -> Event:
    (x, y), (u, v) = (map(float, vector) for vector in (turn.position, turn.velocity))
    error = 2 * EPS * float(turn.time)
    before = next((leg for leg in path if leg.end == turn.time and not leg.rests), None)
    if before is not None and turn.kind != "tip":
        error += float(_doubt(problem, before) * turn.time / _braking(problem, before))
    return Event(turn.kind, float(turn.time), error, 0, (x, y, float(body.position[2])), (u, v, 0.0), (0.0, 0.0, 0.0))


def _braking(problem: Problem, leg: Leg) -> Real:
    """The deceleration (m/s^2) at the end of a leg that ends in a stop."""
    if leg.oblique is None:
        return MP.hypot(*leg.acceleration)
    return (problem.pair(0)[0] * leg.load.press - MP.hypot(*leg.load.drive)) / real(problem.bodies[0].mass)


def _model(path: list[Leg], last: float) -> str:
    within = [leg for leg in path if leg.start <= last]
    if any(leg.oblique is not None for leg in within):
        return "closed form: oblique slide of a block"
    return "closed form: " + ("rest of a block" if all(leg.rests for leg in within) else "straight slide of a block")


def _smallest_friction(problem: Problem, path: list[Leg], last: float) -> float:
    """The smallest coefficient of friction that holds a block that rests until `last` (s); 0 if it moves.

    The load under which it begins to tip counts too.
    """
    if not all(leg.rests for leg in path if leg.start <= last):
        return 0.0
    return max(float(MP.hypot(*load.drive) / load.press) for load in loads(problem) if load.start <= last)


def _interfaces(path: list[Leg], last: float, tip: float) -> tuple[Interface, ...]:
    """The interface of a block and the plane, if it rests until `last` (s) with the same normal force; else empty."""
    within = [leg for leg in path if leg.start <= last]
    pressed = {float(leg.load.press) for leg in within}
    if tip <= last or not all(leg.rests for leg in within) or len(pressed) != 1:
        return ()
    return (Interface((WORLD, 0), pressed.pop()),)
