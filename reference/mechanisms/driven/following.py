"""The motion of a driven joint from event to event, in arithmetic of many digits.

The motion is divided at the breaks of signals or at the instants of a sampled law, and there into steps of one mode. For each
instant that is wanted, the state at the start of its step is recorded. At an instant at which a joint meets a rigid stop, its
velocity is the one before the impact; a controller that acts at t = 0 has the velocity after an impact at t = 0.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

from bodycheck.reference.bounds import EPS
from bodycheck.reference.errors import OutOfReach, Stopped
from bodycheck.reference.exact.numbers import Real
from bodycheck.reference.mechanisms.driven import modes, rebounds, signals
from bodycheck.reference.mechanisms.driven.decisions import mode_of
from bodycheck.reference.mechanisms.driven.events import clear, first_end
from bodycheck.reference.mechanisms.driven.linear import Linear, State, advanced, flown, terms, value, zero
from bodycheck.reference.mechanisms.driven.modes import POSITION, VELOCITY, DrivenJoint, Mode, Phase
from bodycheck.reference.mechanisms.driven.sampled import reads_velocity, sampler

#: The largest numbers of instants of a sampled law, of steps, and of changes of the mode.
MOST_INSTANTS, MOST_STEPS, MOST_EVENTS = 1_000_000, 1_000_000, 10_000

#: The largest number of changes of the mode at one instant.
MOST_AT_ONCE = 50

#: The linear system of a phase, a state in it, and the time (s) since that state, of at most one step of the system.
Record = tuple[Linear, list[Real], Real]


@dataclass(eq=False)
class Course:
    """A motion that is being followed.

    Attributes
    ----------
    joint
        The joint.
    times
        The instants that are wanted (s), ascending.
    z, time
        The present state and its time (s).
    phase
        The present phase.
    soon
        A time (s) within which an event is expected, so that the next step need not be longer.
    records
        The records of the first of the instants.
    steps, events
        The numbers of steps with conditions, and of changes of the phase.
    """

    joint: DrivenJoint
    times: Sequence[float]
    z: list[Real]
    time: Real
    phase: Phase
    soon: Real
    records: list[Record] = field(default_factory=list)
    steps: int = 0
    events: int = 0


def follow(joint: DrivenJoint, times: Sequence[float]) -> list[Record]:
    """The records of a motion at ascending times (s) >= 0.

    Raises `OutOfReach` if the motion has too many instants, steps or events, or if an impact falls on an instant of a law that
    depends on the velocity.
    """
    mp = joint.mp
    z = modes.start_of(joint)
    if any(value(mp, modes.beyond(joint, side), z) > 0 for side in modes.rigid_sides(joint)):
        raise OutOfReach("a driven joint starts beyond one of its rigid stops")
    course = Course(joint, times, z, mp.zero, Phase(Mode(), Linear(mp, tuple({} for _ in z), None), []), mp.inf)
    _record(course, mp.zero)
    _impact(course)
    _settle(course)
    for duration, enter in _parts(joint, times[-1] if times else 0.0):
        end = course.time + duration
        course.z = enter(course.z)
        _follow_part(course, duration)
        course.time = end
    _record(course, course.time * zero(mp))
    return course.records


def _parts(joint: DrivenJoint, end: float) -> Iterator[tuple[Real, Callable[[list[Real]], list[Real]]]]:
    """Yield the durations (s) between breaks or instants of the controller, each with the function that changes the state."""
    mp, controller = joint.mp, joint.controller
    if controller is not None and controller.rate is not None:
        rate = mp.mpf(controller.rate)
        count = int(mp.ceil(mp.mpf(end) * rate))
        if count > MOST_INSTANTS:
            raise OutOfReach(f"the controller acts at {count} instants; at most {MOST_INSTANTS} are followed")
        act, held, period = sampler(mp, controller), joint.slots["held"], 1 / rate

        def enter(z: list[Real]) -> list[Real]:
            return [*z[:held], act(z[POSITION], z[VELOCITY]), *z[held + 1 :]]

        for _ in range(count):
            yield period, enter
        return
    given = [] if controller is None else [getattr(controller, name) for name in modes.SIGNALS]
    begins = sorted({0.0}.union(*(signals.breaks(signal) for signal in given)))
    begins = [time for time in begins if time < end]
    if not begins:
        return
    for begin, until in zip(begins, [*begins[1:], end], strict=True):
        yield mp.mpf(until) - mp.mpf(begin), lambda z, since=begin: modes.with_signals(joint, z, since)  # type: ignore[misc]


def _record(course: Course, duration: Real) -> None:
    """Record all instants until the end of a duration (s) of the present phase, from the start of their steps."""
    index, count, end = len(course.records), len(course.times), course.time + duration
    if index == count or course.times[index] > float(end) * (1 + 4 * EPS):
        return
    linear, z, since = course.phase.linear, course.z, course.time
    last = end * (1 + zero(linear.mp))
    certain = float(end) * (1 - 4 * EPS)
    while index < count and (course.times[index] < certain or course.times[index] <= last):
        linear, z, rest = _within_step(linear, z, course.times[index] - since)
        course.records.append((linear, z, rest))
        if z is not course.z:
            since = course.times[index] - rest
        index += 1


def _within_step(linear: Linear, z: list[Real], duration: Real) -> Record:
    """The record of the instant at a duration (s) after a state."""
    if linear.step is None or duration <= linear.step:
        return linear, z, duration
    steps = int(linear.mp.floor(duration / linear.step))
    return linear, advanced(linear, z, steps), duration - steps * linear.step


def _follow_part(course: Course, duration: Real) -> None:
    """Follow the motion for a duration (s) in which neither signals break nor the controller acts."""
    joint, left, fresh, at_once = course.joint, duration, True, 0
    mp = joint.mp
    while left:
        certain = clear(course.phase.scan, course.z)
        if fresh and not certain:
            left = _settled(course, duration, left)
            if not left:
                return
            certain = clear(course.phase.scan, course.z)
        phase, step, fresh = course.phase, course.phase.linear.step, False
        if step is None or not phase.conditions:
            _go(course, left)
            return
        course.steps += 1
        if course.steps > MOST_STEPS:
            raise OutOfReach(f"the motion of a driven joint takes more than {MOST_STEPS} steps")
        length = step if left > step * (1 - zero(mp)) else left
        length, course.soon = min(length, course.soon), mp.inf
        if certain:
            _go(course, length)
            left, at_once = max(left - length, mp.zero), 0
            continue
        series = terms(phase.linear, course.z, length)
        part = first_end(phase.linear, series, length, phase.conditions)
        passed = length if part is None else part * length
        _record(course, passed)
        course.z = _ended(joint, series, mp.one if part is None else part)
        course.time, left, fresh = course.time + passed, max(left - passed, mp.zero), part is not None
        at_once = at_once + 1 if part is not None and not part else 0
        if at_once > MOST_AT_ONCE:
            raise Stopped("the phases of a driven joint follow each other without an end", float(course.time))


def _go(course: Course, duration: Real) -> None:
    """Follow the present phase for a duration (s) without events."""
    _record(course, duration)
    linear = course.phase.linear
    course.z = advanced(linear, course.z, 1) if duration == linear.step else flown(linear, course.z, duration)
    course.time += duration


def _ended(joint: DrivenJoint, series: Sequence[State], part: Real) -> list[Real]:
    """The state at a part of a step, with a velocity that is zero and a coordinate that is at a stop within rounding."""
    mp = joint.mp
    powers = [part**n for n in range(len(series))]
    z = [mp.fdot(column, powers) for column in zip(*series, strict=True)]
    position, velocity = (mp.fsum([abs(term[column]) for term in series]) for column in (POSITION, VELOCITY))
    if abs(z[VELOCITY]) <= zero(mp) * velocity:
        z[VELOCITY] = mp.zero
    for side in modes.sides(joint):
        stop = modes.place_of(joint, side)
        if abs(z[POSITION] - stop) <= zero(mp) * (position + abs(stop)):
            z[POSITION] = stop
    return z


def _settle(course: Course) -> None:
    """Change the phase to the one that follows from the state."""
    mode = mode_of(course.joint, course.z)
    if mode != course.phase.mode:
        _count_event(course)
    course.phase = modes.phase_of(course.joint, mode)


def _count_event(course: Course) -> None:
    course.events += 1
    if course.events > MOST_EVENTS:
        raise Stopped(f"the motion of a driven joint has more than {MOST_EVENTS} events", float(course.time))


def _impact(course: Course) -> int:
    """Reverse the velocity of a joint that meets a rigid stop, and return the side of the stop; 0 if it meets none."""
    joint = course.joint
    for side in modes.rigid_sides(joint):
        if course.z[POSITION] == modes.place_of(joint, side) and side * course.z[VELOCITY] > 0:
            restitution = joint.mp.mpf(modes.stops_of(joint).restitution)
            course.z = [*course.z]
            course.z[VELOCITY] *= -restitution
            _count_event(course)
            return side
    return 0


def _settled(course: Course, duration: Real, left: Real) -> Real:
    """Change the state and the phase at an event, and return what is left (s) of the duration (s) of a part.

    Raises `OutOfReach` if an impact falls on an instant of a law that depends on the velocity.
    """
    joint = course.joint
    mp, controller = joint.mp, joint.controller
    side = _impact(course)
    if side and controller is not None and controller.rate is not None and reads_velocity(controller):
        near = mp.mpf(10) ** (-mp.dps // 2) * duration
        if min(left, duration - left) <= near:
            raise OutOfReach(
                f"at {float(course.time):.9g} s the joint meets a stop at an instant of its controller, within rounding: the "
                "velocity that the controller reads is not determined"
            )
    _settle(course)
    series = rebounds.rebounds_of(joint, course.z, side) if side else None
    if series is None:
        return left
    if rebounds.accumulate(joint, course.z, series, left):
        return _rebound(course, series, left)
    course.soon = 2 * series.arc
    return left


def _rebound(course: Course, series: rebounds.Rebounds, left: Real) -> Real:
    """Follow rebounds that accumulate to their end, and return what is left of a duration (s)."""
    joint, begun, z = course.joint, course.time, course.z
    mp = joint.mp
    moved = flown(course.phase.linear, z, series.duration)
    end = begun + series.duration
    for time in course.times[len(course.records) :]:
        elapsed = time - begun
        if elapsed >= series.duration:
            break
        since, q, v = rebounds.before(mp, series, elapsed)
        state = [q, v, *flown(course.phase.linear, z, since)[VELOCITY + 1 :]]
        phase = modes.phase_of(joint, mode_of(joint, state))
        course.records.append(_within_step(phase.linear, state, elapsed - since))
    course.z = [series.stop, mp.zero, *moved[VELOCITY + 1 :]]
    course.time = end
    _settle(course)
    return max(left - series.duration, mp.zero)
