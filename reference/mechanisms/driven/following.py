"""The motion of a driven joint from event to event, in arithmetic of many digits.

The motion is divided at the breaks of signals or at the instants of a sampled law, and there into steps of one mode. For each
instant that is wanted, the state at the start of its step is recorded.
"""

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from bodycheck.reference.errors import OutOfReach, Stopped
from bodycheck.reference.exact.numbers import Real
from bodycheck.reference.mechanisms.control import Controller
from bodycheck.reference.mechanisms.driven import modes, signals
from bodycheck.reference.mechanisms.driven.events import Scan, clear, first_end, scan_of
from bodycheck.reference.mechanisms.driven.linear import Linear, Row, State, advanced, flown, terms, zero
from bodycheck.reference.mechanisms.driven.modes import ONE, POSITION, VELOCITY, DrivenJoint, Mode

#: The largest numbers of instants of a sampled law, of steps, and of changes of the mode.
MOST_INSTANTS, MOST_STEPS, MOST_EVENTS = 1_000_000, 2_000_000, 20_000

#: The largest number of changes of the mode at one instant.
MOST_AT_ONCE = 50


@dataclass(frozen=True, eq=False)
class Phase:
    """A mode with its linear system and conditions."""

    mode: Mode
    linear: Linear
    conditions: list[Row]

    @cached_property
    def scan(self) -> Scan:
        """The conditions during one step."""
        return scan_of(self.linear, self.conditions)


@dataclass(eq=False)
class Course:
    """A motion that is being followed.

    Attributes
    ----------
    joint
        The joint.
    wanted
        The instants that are still to be recorded (s), ascending.
    z, time
        The state and its time (s).
    phase
        The present phase.
    records
        For each instant that is recorded, the linear system, the state at the start of its step, and the time since then (s).
    """

    joint: DrivenJoint
    wanted: deque[Real]
    z: list[Real]
    time: Real
    phase: Phase
    phases: dict[Mode, Phase] = field(default_factory=dict)
    records: list[tuple[Linear, list[Real], Real]] = field(default_factory=list)
    steps: int = 0
    events: int = 0


def follow(joint: DrivenJoint, times: Sequence[float]) -> list[tuple[Linear, list[Real], Real]]:
    """The records of a motion at ascending times (s) >= 0: see `Course`.

    At the instant of an impact, the state is the one before the impact.

    Raises `OutOfReach` if the motion has too many instants, steps or events.
    """
    mp = joint.mp
    z = modes.start_of(joint)
    first = Phase(Mode(), Linear(mp, tuple({} for _ in z), None), [])
    course = Course(joint, deque(mp.mpf(time) for time in times), z, mp.zero, first)
    _record(course, mp.zero)
    _settle(course)
    for duration, enter in _parts(joint, float(times[-1]) if len(times) else 0.0):
        begun = course.time
        course.z = enter(course.z)
        _follow_part(course, duration)
        course.time = begun + duration
    return course.records


def _parts(joint: DrivenJoint, end: float) -> Iterator[tuple[Real, Callable[[list[Real]], list[Real]]]]:
    """Yield the durations (s) between breaks or instants of the controller, each with the function that changes the state."""
    mp, controller = joint.mp, joint.controller
    if controller is not None and controller.rate is not None:
        rate = mp.mpf(controller.rate)
        count = int(mp.ceil(mp.mpf(end) * rate))
        if count > MOST_INSTANTS:
            raise OutOfReach(f"the controller acts at {count} instants; at most {MOST_INSTANTS} are followed")
        act = _sampled(joint, controller)
        for _ in range(count):
            yield 1 / rate, act
        return
    given = [] if controller is None else [getattr(controller, name) for name in modes.SIGNALS]
    breaks = sorted({time for signal in given for time in signals.breaks(signal) if time < end})
    for begin, until in zip([0.0, *breaks], [*breaks, end], strict=True):
        yield mp.mpf(until) - mp.mpf(begin), lambda z, begin=begin: modes.with_signals(joint, z, begin)


def _sampled(joint: DrivenJoint, controller: Controller) -> Callable[[list[Real]], list[Real]]:
    """The function that computes the law at each instant, and that changes the state to the effort that acts from there on."""
    mp, slot = joint.mp, joint.slots["held"]
    kp, kd, integral = mp.mpf(controller.kp), mp.mpf(controller.kd), mp.mpf(controller.ki) / mp.mpf(controller.rate)
    most = None if controller.effort_limit is None else mp.mpf(controller.effort_limit)
    values = [signals.at_instants(mp, getattr(controller, name), controller.rate or 1.0) for name in modes.SIGNALS]
    waiting = deque([mp.zero] * controller.delay)
    errors = mp.zero

    def act(z: list[Real]) -> list[Real]:
        nonlocal errors
        target, target_velocity, effort = (next(each) for each in values)
        error = target - z[POSITION]
        computed = effort
        if kp:
            computed += kp * error
        if kd:
            computed += kd * (target_velocity - z[VELOCITY])
        if integral:
            errors += error
            computed += integral * errors
        if most is not None:
            computed = _saturated(joint, computed, z[VELOCITY], most)
        waiting.append(computed)
        z = list(z)
        z[slot] = waiting.popleft()
        return z

    return act


def _saturated(joint: DrivenJoint, effort: Real, velocity: Real, most: Real) -> Real:
    """The effort of a sampled law after saturation."""
    speed = joint.controller.no_load_speed if joint.controller is not None else None
    if speed is not None and velocity and (effort > 0) == (velocity > 0):
        most = most * max(joint.mp.zero, 1 - abs(velocity) / joint.mp.mpf(speed))
    return max(-most, min(most, effort))


def _phase(course: Course, mode: Mode) -> Phase:
    if mode not in course.phases:
        joint = course.joint
        course.phases[mode] = Phase(mode, modes.system(joint, mode), modes.conditions(joint, mode))
    return course.phases[mode]


def _record(course: Course, duration: Real) -> None:
    """Record all instants until the end of a duration (s) of the present phase, from the start of their steps."""
    linear, z, since = course.phase.linear, course.z, course.time
    mp = linear.mp
    end = course.time + duration
    end += zero(mp) * end
    while course.wanted and course.wanted[0] <= end:
        rest = max(course.wanted.popleft() - since, mp.zero)
        if linear.step is not None and rest > linear.step:
            count = int(mp.floor(rest / linear.step))
            z, since, rest = advanced(linear, z, count), since + count * linear.step, rest - count * linear.step
        course.records.append((linear, z, rest))


def _follow_part(course: Course, duration: Real) -> None:
    """Follow the motion for a duration (s) in which neither signals break nor the controller acts."""
    left, fresh, at_once = duration, True, 0
    joint = course.joint
    nearly = 1 - zero(joint.mp)
    while left:
        phase = course.phase
        step = phase.linear.step
        if fresh and phase.conditions and not clear(phase.scan, course.z):
            _settle(course)
            phase = course.phase
            step = phase.linear.step
        fresh = False
        if step is None or not phase.conditions:
            _go(course, left)
            return
        course.steps += 1
        if course.steps > MOST_STEPS:
            raise OutOfReach(f"the motion of a driven joint takes more than {MOST_STEPS} steps")
        length = step if left > step * nearly else left
        if clear(phase.scan, course.z):
            _go(course, length)
            left, at_once = max(left - length, joint.mp.zero), 0
            continue
        series = terms(phase.linear, course.z, length)
        part = first_end(phase.linear, series, length, phase.conditions)
        passed = length if part is None else part * length
        _record(course, passed)
        course.z = _ended(joint, series, joint.mp.one if part is None else part)
        course.time, left = course.time + passed, max(left - passed, joint.mp.zero)
        if part is not None:
            at_once = 0 if part else at_once + 1
            if at_once > MOST_AT_ONCE:
                raise OutOfReach("the phases of a driven joint follow each other without an end")
            fresh = True
        else:
            at_once = 0


def _go(course: Course, duration: Real) -> None:
    """Follow the present phase for a duration (s) without events."""
    _record(course, duration)
    linear = course.phase.linear
    course.z = advanced(linear, course.z, 1) if duration == linear.step else flown(linear, course.z, duration)
    course.time += duration


def _ended(joint: DrivenJoint, series: Sequence[State], part: Real) -> list[Real]:
    """The state at a part of a step, with a velocity that is zero and a coordinate that is at a stop within rounding."""
    mp, z = joint.mp, []
    powers = [mp.one]
    for _ in series[1:]:
        powers.append(powers[-1] * part)
    for column in zip(*series, strict=True):
        z.append(mp.fdot(zip(column, powers, strict=True)))
    size = mp.fsum([abs(term[VELOCITY]) for term in series])
    if abs(z[VELOCITY]) <= zero(mp) * size:
        z[VELOCITY] = mp.zero
    for side in modes.sides(joint):
        stop = modes.place_of(joint, side)
        size = mp.fsum([abs(term[POSITION]) for term in series]) + abs(stop)
        if abs(z[POSITION] - stop) <= zero(mp) * size:
            z[POSITION] = stop
    return z


def _settle(course: Course) -> None:
    """Change the velocity by an impact if there is one, and the phase."""
    joint = course.joint
    for side in modes.sides(joint) if joint.stops is not None and joint.stops.rigid else ():
        if course.z[POSITION] == modes.place_of(joint, side) and side * course.z[VELOCITY] > 0:
            course.z[VELOCITY] = -joint.mp.mpf(joint.stops.restitution) * course.z[VELOCITY]
    mode = modes.mode_of(joint, course.z)
    if mode != course.phase.mode:
        course.events += 1
        if course.events > MOST_EVENTS:
            raise OutOfReach(f"the motion of a driven joint has more than {MOST_EVENTS} events")
    course.phase = _phase(course, mode)
