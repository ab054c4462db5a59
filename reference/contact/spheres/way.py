"""The motion of two free spheres that hit each other, at given instants: their states, attitudes, bounds and events.

All decisions, instants of events and states at events are computed with a hundred digits from the numbers of the file. The
states at given instants follow from the last event before, with a constant acceleration, in the widest type of NumPy.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.bounds import STATES
from bodycheck.reference.contact.motion import ContactMotion, Event
from bodycheck.reference.contact.problem import NONE
from bodycheck.reference.contact.round.turns import accelerated, chained
from bodycheck.reference.contact.spheres.ball import Ball, Moving, ball, begin, law_of, never_slips, size
from bodycheck.reference.contact.spheres.collision import slip
from bodycheck.reference.contact.spheres.course import Change, Course, Pair, Phase, course
from bodycheck.reference.errors import NotModelled
from bodycheck.reference.exact.numbers import MP, Real, Wide, wide
from bodycheck.reference.exact.rotations import minus
from bodycheck.reference.kinematics import conjugate, multiply, normalise, rotate
from bodycheck.reference.mechanisms import exact
from bodycheck.reference.mechanisms.mechanism import WORLD, Mechanism
from bodycheck.reference.scene import vector_of
from bodycheck.reference.trajectory import Array
from bodycheck.reference.witness import WideArray

#: The number of roundings of a state in a phase, relative to the size of its terms.
ROUNDINGS = 32 * float(np.finfo(Wide).eps)

#: The equations that are solved, and why they are exact.
MODEL = "closed form: flight, slip, roll and impacts of two spheres"
REASON = (
    "two free spheres that touch each other and a level plane at single points, under Coulomb's and Newton's laws of impact"
)


@dataclass(frozen=True, eq=False)
class States:
    """The states of a sphere at n instants.

    Attributes
    ----------
    position, velocity
        (n, 3) position (m) and velocity (m/s) of the centre, world frame.
    quaternion
        (n, 4) attitudes w, x, y, z.
    spin
        (n, 3) angular velocities along the axes of the body (rad/s).
    bounds
        (4, n) bounds of their errors, in the order of `bounds.STATES`.
    """

    position: WideArray
    velocity: WideArray
    quaternion: WideArray
    spin: WideArray
    bounds: WideArray


def motion(scene: Mechanism, times: Array) -> ContactMotion | None:
    """The motion of two spheres at ascending times (n,) >= 0 (s), or None for any other scene.

    Raises `NotModelled` for spheres that overlap at the start, for an inclined plane, and as `course` does.
    """
    if len(scene.bodies) != 2 or scene.pushes or (scene.plane is not None and scene.plane.incline):
        return None
    first, second = ball(scene, 0), ball(scene, 1)
    law = law_of(scene, 0, 1)
    if first is None or second is None or law is None:
        return None
    balls, starts = (first, second), (_start(first, scene, 0), _start(second, scene, 1))
    reach, apart = first.radius + second.radius, size(minus(starts[1].position, starts[0].position))
    if apart < reach * (1 - MP.mpf(NONE)):
        raise NotModelled("spheres that overlap at the start")
    speed = max(size(each.velocity) + one.radius * size(each.spin) for one, each in zip(balls, starts, strict=True))
    pair = Pair(balls, law, MP.mpf(scene.gravity), speed)
    whole = course(pair, starts, bool(apart <= reach), MP.mpf(float(times.max(initial=0.0))))
    turns = [_wide(exact.turn(body.start.attitude)) for body in scene.bodies if body.start is not None]
    states = [_states(*each, times) for each in zip(balls, whole.phases, turns, strict=True)]
    bounds = np.maximum(*(each.bounds for each in states)).astype(float)
    return ContactMotion(
        np.stack([each.position for each in states]),
        np.stack([each.velocity for each in states]),
        np.stack([each.quaternion for each in states]),
        np.stack([each.spin for each in states]),
        dict(zip(STATES, bounds, strict=True)),
        tuple(_event(change) for change in whole.changes if not _from_decimals(change, whole, balls[change.body])),
        MODEL,
        REASON,
        friction=_friction(whole, pair),
    )


def _start(one: Ball, scene: Mechanism, index: int) -> Moving:
    """Return a sphere at t = 0. Raises `NotModelled` for one that begins within the plane, or a rounding away from it."""
    moving = begin(scene.bodies[index])
    if one.plane is None:
        return moving
    height = moving.position[2] - one.radius
    if height < -NONE * one.radius:
        raise NotModelled("a body that begins within the plane")
    if 0 < abs(height) <= NONE * one.radius:
        raise NotModelled("a sphere above or below the plane by no more than the decimals of its height")
    borne = not height and not moving.velocity[2]
    return Moving(moving.time, moving.position, moving.velocity, moving.spin, borne, borne and not any(slip(one, moving)))


def _states(one: Ball, phases: list[Phase], attitude: WideArray, times: Array) -> States:
    """The states of a sphere at times (n,), s, from its phases and its attitude at the start.

    At the instant of an event they are those before it.
    """
    starts = [phase.start.time for phase in phases]
    index, lasting = _places(starts, times)
    spans = [_wide([later - earlier]) for earlier, later in itertools.pairwise(starts)]
    ended = list(zip(phases, spans, strict=False))
    before = chained(np.array([_turned(phase, span)[0] for phase, span in ended], Wide).reshape(-1, 4))
    angles = np.cumsum([Wide(0), *(_angle(phase, span)[0] for phase, span in ended)])
    position, velocity, spin = (np.zeros((len(times), 3), Wide) for _ in range(3))
    turn, bounds = np.zeros((len(times), 4), Wide), np.zeros((len(STATES), len(times)), Wide)
    for at in np.unique(index):
        here, phase = index == at, phases[at]
        t, start = lasting[here, None], phase.start
        far = _wide(start.position), t * _wide(start.velocity), t * t / 2 * _wide(phase.acceleration)
        fast = _wide(start.velocity), t * _wide(phase.acceleration)
        rapid = _wide(start.spin), t * _wide(phase.spin_rate)
        position[here], velocity[here], spin[here] = sum(far), sum(fast), sum(rapid)
        turn[here] = multiply(_turned(phase, t[:, 0]), before[at])
        turned = (at + 1) * (1 + angles[at] + _angle(phase, t[:, 0]))
        moved, sped, spun = (sum(np.abs(term).sum(axis=-1) for term in terms) for terms in (far, fast, rapid))
        bounds[:, here] = ROUNDINGS * np.array([turned, moved, sped, spun * (1 + turned)])
        doubt, radius = wide(start.doubt), wide(one.radius)
        further = t[:, 0] * doubt / radius
        bounds[:, here] += [further, t[:, 0] * doubt, 0 * further + doubt, (1 + spun * t[:, 0]) * doubt / radius]
    quaternion = normalise(multiply(turn, attitude))
    return States(position, velocity, quaternion, rotate(conjugate(quaternion), spin), bounds)


def _places(starts: Sequence[Real], times: Array) -> tuple[NDArray[np.intp], WideArray]:
    """The indices (n,) of the phases of ascending times (n,), s, and the times (n,) since the starts of these phases (s)."""
    index, lasting, at = np.zeros(len(times), np.intp), np.zeros(len(times), Wide), 0
    for row, time in enumerate(times.tolist()):
        while at + 1 < len(starts) and starts[at + 1] < time:
            at += 1
        index[row], lasting[row] = at, wide(MP.mpf(time) - starts[at])
    return index, lasting


def _turned(phase: Phase, lasting: WideArray) -> WideArray:
    """The rotations (n, 4) of a sphere within times (n,), s, from the start of a phase."""
    return accelerated(_wide(phase.start.spin), _wide(phase.spin_rate), lasting)


def _angle(phase: Phase, lasting: WideArray) -> WideArray:
    """A bound of the angle (rad) by which a sphere turns within times (n,), s, from the start of a phase."""
    fast, faster = (np.sqrt((each * each).sum()) for each in map(_wide, (phase.start.spin, phase.spin_rate)))
    return np.asarray(lasting * (fast + lasting / 2 * faster))


def _from_decimals(change: Change, whole: Course, one: Ball) -> bool:
    """Return whether an event ends a slip that a sphere has at the start only because of the decimals in the file."""
    start = whole.phases[change.body][0].start
    first = next(each for each in whole.changes if each.body == change.body)
    slipping, speed = size(slip(one, start)), size(start.velocity) + one.radius * size(start.spin)
    return change is first and start.borne and change.moving.rolls and slipping <= NONE * speed


def _event(change: Change) -> Event:
    after = change.moving
    return Event(
        change.kind,
        float(after.time),
        0.0,
        change.body,
        vector_of(after.position),
        vector_of(after.velocity),
        vector_of(after.spin),
        float(change.closing),
        change.other,
    )


def _friction(whole: Course, pair: Pair) -> float:
    """The smallest coefficient of friction with which nothing slips in an impact of a pair of which nothing slips."""
    laws = [(change, pair.balls[change.body].plane if change.other == WORLD else pair.law) for change in whole.changes]
    grips = [change.grip for change, law in laws if law is not None and never_slips(law)]
    return float(max(grips, default=MP.zero))


def _wide(values: Sequence[Real]) -> WideArray:
    return np.array([wide(value) for value in values], Wide)
