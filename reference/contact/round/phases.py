"""The phases of a round body on a plane, one after another: flights between impacts, slips, rolling.

In a phase the acceleration and the rate of the angular velocity are constant, except in a slip across the fall line of an
inclined plane, which is described by a `Hodograph`.
"""

from dataclasses import dataclass, replace

import numpy as np

from bodycheck.reference.contact.motion import EventKind
from bodycheck.reference.contact.round.ball import Ball, Moment, after_impact, rolling_spin, slip
from bodycheck.reference.contact.round.hodograph import Hodograph, followed, hodograph, parameters
from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.witness import WideArray

#: The largest number of impacts; these take some seconds.
MAX_IMPACTS = 50_000

#: The ratio of the speed after an impact to the speed of the first impact below which the following impacts are summed as a
#: series.
LAST_IMPACT = Wide(2.0**-60)

#: The ratio of a speed to the speed at the start below which a body is at rest, because of the decimals in the file.
AT_REST = 1e-12

ZERO = Wide(0)


@dataclass(frozen=True, eq=False)
class Phase:
    """A phase, from its start on.

    Attributes
    ----------
    start
        The body at the start of the phase.
    acceleration, spin_rate
        Acceleration (3,), m/s^2, and rate of the angular velocity (3,), rad/s^2; with a hodograph, those at the start.
    airborne, slips
        Whether the body is in flight, and whether it slips on the plane.
    hodograph
        The hodograph of a slip whose direction changes; else None.
    """

    start: Moment
    acceleration: WideArray
    spin_rate: WideArray
    airborne: bool = False
    slips: bool = False
    hodograph: Hodograph | None = None


@dataclass(frozen=True, eq=False)
class Change:
    """An event.

    Attributes
    ----------
    kind, moment
        The kind of the event, and the body just after it.
    normal_speed
        Speed towards the plane just before an impact (m/s).
    jumps
        The sizes of the changes of the velocity (m/s) and of the angular velocity (rad/s) in an impact.
    grip
        The smallest coefficient of friction that ends the slip in an impact.
    """

    kind: EventKind
    moment: Moment
    normal_speed: Wide = ZERO
    jumps: tuple[Wide, Wide] = (ZERO, ZERO)
    grip: Wide = ZERO


@dataclass(frozen=True, eq=False)
class Course:
    """The phases of a motion and the events between them, in ascending order of time."""

    phases: tuple[Phase, ...]
    changes: tuple[Change, ...]


def states(ball: Ball, phase: Phase, lasting: WideArray) -> tuple[WideArray, WideArray, WideArray]:
    """Positions, velocities and angular velocities (n, 3) at times (n,) from the start of a phase."""
    begin, t = phase.start, lasting[:, None]
    if phase.hodograph is None:
        return (
            begin.position + t * (begin.velocity + t / 2 * phase.acceleration),
            begin.velocity + t * phase.acceleration,
            begin.spin + t * phase.spin_rate,
        )
    sliding, path = followed(phase.hodograph, parameters(phase.hodograph, lasting))
    return along_hodograph(ball, phase, lasting, sliding, path)


def along_hodograph(
    ball: Ball, phase: Phase, lasting: WideArray, sliding: WideArray, path: WideArray
) -> tuple[WideArray, WideArray, WideArray]:
    """The result of `states` for a phase with a hodograph, from the slip (n, 3), m/s, and its path (n, 3), m.

    It follows because friction changes velocity and slip in the ratio k/(1 + k).
    """
    begin, t, k = phase.start, lasting[:, None], ball.ratio
    first = slip(ball, begin.velocity, begin.spin)
    downhill = np.array([ball.downhill, ZERO, ZERO])
    part = k / (1 + k)
    velocity = begin.velocity + t * downhill / (1 + k) + part * (sliding - first)
    position = begin.position + t * (begin.velocity - part * first + t / 2 * downhill / (1 + k)) + part * path
    change = (t * downhill - (sliding - first)) / (ball.radius * (1 + k))
    return position, velocity, begin.spin + np.stack([-change[:, 1], change[:, 0], change[:, 2]], axis=1)


def at(ball: Ball, phase: Phase, lasting: Wide) -> Moment:
    """The body at a time (s) after the start of a phase."""
    position, velocity, spin = states(ball, phase, np.array([lasting]))
    return Moment(phase.start.time + lasting, position[0], velocity[0], spin[0])


def course(ball: Ball, start: Moment, airborne: bool, end: Wide) -> Course:
    """The phases and events until the time `end` (s). airborne: whether the body is in flight at the start.

    Raises `OutOfReach` for too many impacts.
    """
    phases: list[Phase] = []
    changes: list[Change] = []
    on_plane: Moment | None = start
    if airborne:
        on_plane = _bounced(ball, start, end, phases, changes)
    if on_plane is not None and on_plane.time <= end:
        scale = float(np.linalg.norm(start.velocity) + ball.radius * np.linalg.norm(start.spin))
        _on_plane(ball, on_plane, scale, phases, changes)
    begun = (phase for phase in phases if phase.start.time <= end)
    return Course(tuple(begun), tuple(change for change in changes if change.moment.time <= end))


def _bounced(ball: Ball, start: Moment, end: Wide, phases: list[Phase], changes: list[Change]) -> Moment | None:
    """Append flights and impacts, and return the moment from which the body stays on the plane; None if it flies at the end."""
    none = np.zeros(3, Wide)
    gravity = np.array([ball.downhill, ZERO, -ball.onto])
    first, body = ZERO, start
    for _ in range(MAX_IMPACTS):
        flight = Phase(body, gravity, none, airborne=True)
        phases.append(flight)
        lasting, speed = _fall(ball, body)
        if not body.time + lasting <= end:
            return None
        first = first or speed
        hit = at(ball, flight, lasting)
        hit.position[2], hit.velocity[2] = ball.radius, -speed
        body = after_impact(ball, hit)
        changes.append(_impact(ball, hit, body))
        if not body.velocity[2] > first * LAST_IMPACT:
            return _settled(ball, body)
    raise OutOfReach(f"a body that bounces more than {MAX_IMPACTS} times")


def _impact(ball: Ball, before: Moment, after: Moment) -> Change:
    fall, sliding = -before.velocity[2], slip(ball, before.velocity, before.spin)
    velocity, spin = after.velocity - before.velocity, after.spin - before.spin
    jumps = np.sqrt(velocity @ velocity), np.sqrt(spin @ spin)
    grip = np.hypot(sliding[0], sliding[1]) * ball.ratio / ((1 + ball.ratio) * (1 + ball.restitution) * fall)
    return Change("impact", after, fall, jumps, grip)


def _fall(ball: Ball, body: Moment) -> tuple[Wide, Wide]:
    """Return how long a body flies (s), and its final speed towards the plane (m/s); infinity and 0 if it never lands."""
    height, rise = body.position[2] - ball.radius, body.velocity[2]
    speed = np.sqrt(rise * rise + 2 * ball.onto * height)
    if rise < 0:
        return 2 * height / (speed - rise), speed
    return ((rise + speed) / ball.onto, speed) if ball.onto > 0 else (Wide(np.inf), ZERO)


def _settled(ball: Ball, body: Moment) -> Moment:
    """A body after all remaining impacts, whose times are a geometric series; their impulses equal that of its weight."""
    speed = body.velocity[2]
    lasting = 2 * speed / (ball.onto * (1 - ball.restitution)) if speed > 0 else ZERO
    position, velocity = body.position + lasting * body.velocity, body.velocity.copy()
    position[2], velocity[2] = ball.radius, ZERO
    return Moment(body.time + lasting, position, velocity, body.spin)


def _on_plane(ball: Ball, body: Moment, scale: float, phases: list[Phase], changes: list[Change]) -> None:
    """Append the phases and events of a body that stays on the plane. scale: the size of speeds at the start (m/s)."""
    begins = bool(phases)  # without phases before, the first phase begins without an event
    while True:
        sliding = slip(ball, body.velocity, body.spin)
        if not np.any(sliding) and ball.grips:
            phases.append(_rolling(ball, body))
            if begins:
                changes.append(Change("rest" if _rests(ball, body, scale) else "roll", body))
            return
        if begins:
            changes.append(Change("slip", body))
        phase, lasting = _slipping(ball, body, sliding)
        phases.append(phase)
        if not np.isfinite(lasting):
            return
        ended = at(ball, phase, lasting)
        body, begins = replace(ended, spin=rolling_spin(ball, ended.velocity, ended.spin)), True


def _rests(ball: Ball, body: Moment, scale: float) -> bool:
    speed = float(np.linalg.norm(body.velocity) + ball.radius * abs(body.spin[2]))
    return not ball.downhill and speed <= AT_REST * scale


def _rolling(ball: Ball, body: Moment) -> Phase:
    downhill = ball.downhill / (1 + ball.ratio)
    return Phase(body, np.array([downhill, ZERO, ZERO]), np.array([ZERO, downhill / ball.radius, ZERO]))


def _slipping(ball: Ball, body: Moment, sliding: WideArray) -> tuple[Phase, Wide]:
    """The phase of slip that begins with a velocity (3,) of the point of contact, m/s, and its duration (s)."""
    downhill, braking, slowing = ball.downhill, ball.braking, ball.slowing
    size = np.hypot(sliding[0], sliding[1])
    direction = sliding / size if size else np.array([Wide(1), ZERO, ZERO])
    acceleration = np.array([downhill, ZERO, ZERO]) - braking * direction
    turning = braking / (ball.ratio * ball.radius)
    phase = Phase(body, acceleration, np.array([-turning * direction[1], turning * direction[0], ZERO]), slips=True)
    if not slowing:
        return phase, Wide(np.inf)
    if downhill and sliding[1]:
        turned = hodograph(downhill, slowing, sliding)
        return replace(phase, hodograph=turned), turned.duration
    against = slowing - downhill * direction[0]
    return phase, size / against if size and against > 0 else Wide(np.inf)
