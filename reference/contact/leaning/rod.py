"""The truth of a body that leans on an edge or on its rim, and is released from rest: a rod that falls.

While friction holds the contact, the body is a compound pendulum, in closed form; see `lean`. After the onset of slipping, the
loss of contact or the impact of the next face, no motion is known.
"""

import math
from typing import Literal

import numpy as np

from bodycheck.reference.bounds import EPS
from bodycheck.reference.contact.leaning.lean import Lean, jams, lean, onset, smallest_friction
from bodycheck.reference.contact.motion import ContactMotion, Event, known_at
from bodycheck.reference.contact.problem import NONE, ContactBody, Problem
from bodycheck.reference.errors import NotModelled
from bodycheck.reference.exact.numbers import MP, Real, Wide, wide
from bodycheck.reference.kinematics import about, conjugate, multiply, rotate
from bodycheck.reference.mechanisms.forms.pendulum import Pendulum, follow
from bodycheck.reference.trajectory import Array
from bodycheck.reference.witness import WideArray

#: Relative error of angles and lengths after a few roundings in the wide type.
_ROUNDINGS = 16 * float(np.finfo(Wide).eps)

#: The part of the fall, before the instant at which the plane would have to pull, that is left out of the friction that holds
#: the contact: it would be infinite.
_BEFORE_LIFT = 1e-6


def motion(problem: Problem, times: Array) -> ContactMotion | None:
    """The motion of a body that leans on a level plane at ascending times (n,) >= 0 (s); None for any other problem.

    Raises `NotModelled` if its contact slides at the start such that no force of the plane is possible: see `jams`.
    """
    if len(problem.bodies) != 1 or problem.pushes or problem.bodies[0].spin.any():
        return None
    (body,) = problem.bodies
    falling, friction = lean(problem), problem.pair(0)[0]
    if falling is None:
        return None
    if body.velocity.any():
        _refuse_jam(falling, friction, body)
        return None
    kind, cosine = onset(falling, friction)
    last = falling.time(cosine)
    reached = np.minimum(times, float(last))
    swing = Pendulum(falling.square, MP.pi, falling.angle, MP.mpf(0))
    form = follow(swing, reached)
    theta, rate = form.position[:, 0], form.velocity[:, 0]
    position, velocity, quaternion, spin = _states(falling, body, theta, rate)
    events = (_event(falling, body, kind, cosine, last),) if len(times) and last <= times[-1] else ()
    slips = kind == "slip" and not math.isinf(friction) and len(times) and last <= times[-1]
    before_lift = float(cosine + _BEFORE_LIFT * (MP.cos(falling.angle) - cosine)) if kind == "slip" else -1.0
    least = smallest_friction(falling, max(float(np.cos(theta[-1])), before_lift)) if len(times) and not slips else 0.0
    whole = ContactMotion(
        position[None],
        velocity[None],
        quaternion[None],
        spin[None],
        _errors(falling, form.error, form.velocity_error, reached),
        events,
        "closed form: fall about an edge",
        "a body that leans is a pendulum about its contact with the plane, as long as friction holds it",
        least,
    )
    return known_at(whole, times <= float(last))


def _refuse_jam(falling: Lean, friction: float, body: ContactBody) -> None:
    x, y, z = map(float, body.velocity)
    a, b = map(float, falling.towards)
    speed = float(np.hypot(x, y))
    if abs(z) <= NONE * speed and abs(a * y - b * x) <= NONE * speed and jams(falling, friction, a * x + b * y):
        raise NotModelled("a body that leans and slides where mechanics with rigid bodies gives no motion (Painlevé)")


def _states(falling: Lean, body: ContactBody, theta: WideArray, rate: WideArray) -> tuple[WideArray, ...]:
    """Positions and velocities (n, 3), quaternions (n, 4) and spins (n, 3) at angles (n,), rad, and their rates (n,), rad/s."""
    a, b = (wide(part) for part in falling.towards)
    length, begin = wide(falling.length), wide(falling.angle)
    ahead, up, axis = (np.array(each, dtype=Wide) for each in ((a, b, 0), (0, 0, 1), (-b, a, 0)))
    sine, cosine = np.sin(theta)[:, None], np.cos(theta)[:, None]
    turned = theta - begin
    moved = length * ((sine - np.sin(begin)) * ahead + (cosine - np.cos(begin)) * up)
    quaternion = multiply(about(axis, turned), np.tile(body.quaternion, (len(theta), 1)))
    spin = rotate(conjugate(body.quaternion), axis)
    return body.position + moved, length * rate[:, None] * (cosine * ahead - sine * up), quaternion, rate[:, None] * spin


def _errors(falling: Lean, angle: Array, rate: Array, times: Array) -> dict[str, Array]:
    """The bounds of errors of states at times (n,), s, from the errors of the pendulum and of its start.

    angle, rate: (n,) bounds of the pendulum's angle (rad) and its rate (rad/s). An error of the start grows at most as
    cosh(sqrt(square) t), since sin theta changes by less than theta does.
    """
    root, length = float(MP.sqrt(falling.square)), float(falling.length)
    begun = (_ROUNDINGS + falling.apart) * np.cosh(root * times)
    off, off_rate = angle + begun, rate + root * begun
    fastest = 2 * root
    return {
        "error": off,
        "position_error": length * (off + _ROUNDINGS),
        "velocity_error": length * (off_rate + fastest * off),
        "angular_velocity_error": off_rate + fastest * _ROUNDINGS,
    }


def _event(falling: Lean, body: ContactBody, kind: Literal["slip", "impact"], cosine: Real, time: Real) -> Event:
    rate, theta = falling.speed(cosine), MP.acos(cosine)
    states = _states(falling, body, np.array([wide(theta)]), np.array([wide(rate)]))
    (x, y, z), (u, v, w), (p, q, r) = (states[part][0].astype(float).tolist() for part in (0, 1, 3))
    begun = (_ROUNDINGS + falling.apart) * float(MP.cosh(MP.sqrt(falling.square) * time))
    error = 2 * EPS * float(time) + (4 * begun / float(rate) if rate else 0.0)
    if kind == "slip":
        return Event("slip", float(time), error, 0, (x, y, z), (u, v, w), (p, q, r))
    unknown = np.nan, np.nan, np.nan
    return Event("impact", float(time), error, 0, (x, y, z), unknown, unknown)
