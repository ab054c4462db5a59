"""The motion of a round body on a plane at given instants: its start, its states and attitudes, and its events."""

from dataclasses import dataclass

import numpy as np

from bodycheck.reference.contact.motion import ContactMotion, Event, Interface
from bodycheck.reference.contact.problem import NONE, ContactBody
from bodycheck.reference.contact.round.ball import Ball, Moment, rolling_spin, slip
from bodycheck.reference.contact.round.bounds import errors, event_errors
from bodycheck.reference.contact.round.phases import Course, course, states
from bodycheck.reference.contact.round.turns import turned, turns_between
from bodycheck.reference.errors import NotModelled
from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.kinematics import conjugate, dot, multiply, normalise, rotate
from bodycheck.reference.mechanisms.mechanism import WORLD
from bodycheck.reference.scene import vector_of
from bodycheck.reference.trajectory import Array
from bodycheck.reference.witness import WideArray


@dataclass(frozen=True, eq=False)
class Begin:
    """The start of a round body.

    Attributes
    ----------
    moment
        The body at t = 0.
    airborne
        Whether it is in flight, or hits the plane at t = 0.
    position_error, velocity_error
        The sizes of the parts of the position (m) and of the velocity (m/s) that were taken to be zero.
    """

    moment: Moment
    airborne: bool
    position_error: Wide
    velocity_error: Wide


def begin(ball: Ball, position: WideArray, velocity: WideArray, spin: WideArray) -> Begin:
    """Return the start of a body from its position, velocity and angular velocity (3,) along the axes of the plane.

    Raises `NotModelled` for a body that begins within the plane, or that slips on a plane on which nothing slips.
    """
    height, speed = position[2] - ball.radius, np.sqrt(dot(velocity, velocity))
    if height < -NONE * ball.radius:
        raise NotModelled("a body that begins within the plane")
    placed, moving, turning = position.copy(), velocity.copy(), spin.copy()
    touching = height <= NONE * ball.radius
    if touching:
        placed[2] = ball.radius
    airborne = not touching or bool(abs(velocity[2]) > NONE * speed)
    if not airborne:
        moving[2] = Wide(0)
        sliding = slip(ball, moving, turning)
        size, scale = np.hypot(sliding[0], sliding[1]), speed + ball.radius * np.sqrt(dot(spin, spin))
        if 0 < size <= NONE * scale and ball.friction > 0:
            moving = moving - sliding * (ball.ratio / (1 + ball.ratio))
            turning = rolling_spin(ball, moving, turning)
        elif size and np.isinf(ball.friction):
            raise NotModelled("a body that slips at the start on a plane on which nothing slips")
    moved_by = np.abs(velocity - moving).sum() + ball.radius * np.abs(turning - spin).sum()
    return Begin(Moment(Wide(0), placed, moving, turning), airborne, abs(height) * touching, moved_by)


def moved(ball: Ball, body: ContactBody, begun: Begin, times: Array, model: str, reason: str) -> ContactMotion:
    """The motion at ascending times (n,) >= 0 (s). Raises `OutOfReach` for too many impacts."""
    wide_times = times.astype(Wide)
    whole = course(ball, begun.moment, begun.airborne, wide_times.max(initial=Wide(0)))
    starts = np.array([phase.start.time for phase in whole.phases])
    # At the instant of an impact the state is the state before it, so that the state at t = 0 is that of the file.
    phase_index = np.maximum(np.searchsorted(starts, wide_times, side="left") - 1, 0)
    position, velocity, spin = (np.zeros((len(times), 3), Wide) for _ in range(3))
    turn = np.zeros((len(times), 4), Wide)
    before = turns_between(ball, whole, starts)
    for index in np.unique(phase_index):
        here, phase = phase_index == index, whole.phases[index]
        lasting = wide_times[here] - starts[index]
        position[here], velocity[here], spin[here] = states(ball, phase, lasting)
        turn[here] = multiply(turned(ball, phase, lasting), before[index])
    quaternion = normalise(multiply(turn, body.quaternion))
    return ContactMotion(
        position[None],
        velocity[None],
        quaternion[None],
        rotate(conjugate(quaternion), spin)[None],
        errors(ball, whole, begun.position_error, begun.velocity_error, wide_times, phase_index, velocity, spin),
        _events(ball, whole),
        model,
        reason,
        _friction(ball, whole),
        _interfaces(ball, whole),
    )


def _events(ball: Ball, course: Course) -> tuple[Event, ...]:
    return tuple(
        Event(
            change.kind,
            float(change.moment.time),
            float(error),
            0,
            vector_of(change.moment.position),
            vector_of(change.moment.velocity),
            vector_of(change.moment.spin),
            float(change.normal_speed),
        )
        for change, error in zip(course.changes, event_errors(ball, course), strict=True)
    )


def _friction(ball: Ball, course: Course) -> float:
    """The smallest coefficient of friction with which nothing slips; 0 if something slips."""
    rolls = any(not phase.airborne for phase in course.phases)
    needed = ball.downhill / ball.onto * ball.ratio / (1 + ball.ratio) if rolls and ball.onto else Wide(0)
    needed = max([needed, *(change.grip for change in course.changes)])
    if any(phase.slips for phase in course.phases) or needed > ball.friction:
        return 0.0
    return float(needed)


def _interfaces(ball: Ball, course: Course) -> tuple[Interface, ...]:
    """The interface of the body and the plane if the body rests from the start on; else empty."""
    first = course.phases[0]
    rests = not (first.airborne or first.start.velocity.any() or first.start.spin.any() or first.acceleration.any())
    return (Interface((WORLD, 0), float(ball.mass * ball.onto)),) if rests else ()
