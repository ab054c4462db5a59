"""Bounds of the errors of the motion of a round body, from roundings and from instants close to an impact.

Errors of the velocity do not grow: friction below its limit ends the slip, and friction at its limit brings two different slips
nearer to each other. So the roundings of the phases add up.
"""

import numpy as np

from bodycheck.reference.bounds import EPS
from bodycheck.reference.contact.round.ball import Ball
from bodycheck.reference.contact.round.phases import Course
from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.trajectory import Array
from bodycheck.reference.witness import WideArray

#: The number of roundings of a state in a phase, relative to the size of its terms.
ROUNDINGS = 64.0

#: The distance from the steepest slope on which the body rolls, in roundings of doubles, within which the bounds cover both
#: slipping and rolling.
EDGE = 4.0


def errors(
    ball: Ball,
    course: Course,
    position_error: Wide,
    velocity_error: Wide,
    times: WideArray,
    phase_index: WideArray,
    velocity: WideArray,
    spin: WideArray,
) -> dict[str, Array]:
    """The bounds (n,) of the errors of the states at times (n,), s, by the names of `bounds.STATES`.

    position_error, velocity_error: errors of the start (m, m/s). phase_index: (n,) indices of the phases of the instants.
    velocity, spin: (n, 3) at the instants.
    """
    begins = [phase.start for phase in course.phases]
    speeds = np.maximum.accumulate([_speed(ball, begin.velocity, begin.spin) for begin in begins])
    speed = np.maximum(speeds[phase_index], np.array([_speed(ball, v, w) for v, w in zip(velocity, spin, strict=True)]))
    unit = ROUNDINGS * np.finfo(Wide).eps * (phase_index + 1)
    late = _late(ball, course, phase_index)
    size = np.sqrt(begins[0].position @ begins[0].position)
    slope = _edge(ball) * times
    fast = unit * speed + velocity_error + (ball.onto + ball.downhill) * late + slope
    drift = unit * speed * times + speed * late + times * (velocity_error + slope)
    far = unit * (size + ball.radius) + position_error + drift
    rolling = (1 + 1 / ball.ratio) / ball.radius
    jumps = _jumps(ball, course, times)
    return {
        "error": (unit + rolling * drift).astype(float),
        "position_error": far.astype(float),
        "velocity_error": (fast + jumps[0]).astype(float),
        "angular_velocity_error": (rolling * fast + jumps[1]).astype(float),
    }


def event_errors(ball: Ball, course: Course) -> WideArray:
    """The bounds (m,) of the errors of the times of the events of a motion (s)."""
    if not course.changes:
        return np.zeros(0, Wide)
    times = np.array([change.moment.time for change in course.changes])
    speed = np.max([_speed(ball, phase.start.velocity, phase.start.spin) for phase in course.phases])
    least = ball.slowing - ball.downhill if ball.slowing > ball.downhill else ball.slowing
    stops = np.array([change.kind != "impact" for change in course.changes])
    ends = stops * (speed / least if least else Wide(0))
    count = np.arange(len(times)) + 1
    unit = ROUNDINGS * np.finfo(Wide).eps * count
    return np.asarray(np.where(times > 0, unit * (times + ends) + _late(ball, course, count), 0))


def _speed(ball: Ball, velocity: WideArray, spin: WideArray) -> Wide:
    return Wide(np.sqrt(velocity @ velocity) + ball.radius * np.sqrt(spin @ spin))


def _late(ball: Ball, course: Course, count: WideArray) -> WideArray:
    """The bounds (n,) of the errors of the times of the last of `count` (n,) impacts (s), from the roundings of the height.

    If the first impact is late by dt, its speed is wrong by g dt, and the flight after k impacts lasts 2 e^k dt longer.
    """
    first = next((change for change in course.changes if change.kind == "impact"), None)
    if first is None:
        return np.zeros(len(count), Wide)
    height = course.phases[0].start.position[2]
    late = ROUNDINGS * np.finfo(Wide).eps * (height / first.normal_speed + first.moment.time) * (first.moment.time > 0)
    e, flights = ball.restitution, np.maximum(count - 1, 0)
    longer = 2 * (flights if e == 1 else e * (1 - e**flights) / (1 - e))
    return np.asarray(late * (count > 0) * (1 + longer))


def _edge(ball: Ball) -> Wide:
    """The difference of the accelerations of slip and roll close to the steepest slope on which the body rolls (m/s^2)."""
    near = abs(ball.downhill - ball.slowing) <= EDGE * EPS * ball.downhill
    return Wide(EDGE * EPS * ball.downhill * near)


def _jumps(ball: Ball, course: Course, times: WideArray) -> tuple[WideArray, WideArray]:
    """Return the errors of velocities (n,), m/s, and angular velocities (n,), rad/s, at instants too close to an impact.

    At these instants the error of the time of the impact leaves open whether they are before or after it; else they are zero.
    """
    changes = course.changes
    if not changes:
        return np.zeros_like(times), np.zeros_like(times)
    instants, margins = np.array([change.moment.time for change in changes]), event_errors(ball, course)
    jumps = np.array([change.jumps for change in changes])
    found_jumps = np.zeros((2, len(times)), Wide)
    after = np.searchsorted(instants, times)
    for beside in (after - 1, after):
        one = np.clip(beside, 0, len(changes) - 1)
        near = np.abs(times - instants[one]) < margins[one]
        found_jumps += np.where(near, jumps[one].T, 0)
    return found_jumps[0], found_jumps[1]
