"""The motion of a gripped body, its fingers and their carriage at given instants: states, bounds and events.

All decisions, instants of events and motions are computed with a hundred digits from the numbers of the file; the states at
given instants are evaluated in the widest type of NumPy.
"""

from dataclasses import replace

import numpy as np

from bodycheck.reference.bodies import initial
from bodycheck.reference.bounds import STATES
from bodycheck.reference.contact.gripping.course import Change, Phase, course
from bodycheck.reference.contact.gripping.grip import Grip, grip_of
from bodycheck.reference.contact.gripping.turning import ANGLE, Turning, W, centre_of, turned_by, turning
from bodycheck.reference.contact.gripping.waves import values
from bodycheck.reference.contact.motion import ContactMotion, Event, known_at
from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.exact.numbers import MP, Vector3, Wide, exactly, wide
from bodycheck.reference.exact.rotations import plus, scaled
from bodycheck.reference.kinematics import conjugate, multiply, normalise, rotate
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.scene import vector_of
from bodycheck.reference.trajectory import Array
from bodycheck.reference.witness import END, Instant, WideArray

#: The number of roundings of a state in a phase, relative to the size of its terms.
ROUNDINGS = 32 * float(np.finfo(Wide).eps)

#: The numbers of nodes of the steps of two integrations, and the factor by which errors may be larger than their difference.
STAGES, SAFETY = (20, 16), 50.0

#: The velocity of a body at rest.
REST = (0.0, 0.0, 0.0)

#: The equations that are solved, and why they are exact.
MODEL = "closed form: a body that two fingers hold, or that slips on them along a line"
INTEGRATED = "collocation: a body that turns between two fingers"
REASON = "a free body between two fingers that press it with equal forces, under Coulomb's law"


def motion(scene: Mechanism, times: Array) -> ContactMotion:
    """The motion of a scene in which bodies on joints touch others, at ascending times (n,) >= 0 (s).

    Raises `NotModelled` as `grip_of` and `course` do, and `OutOfReach` as `turning` does.
    """
    grip = grip_of(scene)
    last = float(times.max(initial=0.0))
    whole = course(grip, MP.mpf(last))
    n, count = len(times), len(scene.bodies)
    start = initial(scene)
    along, centres = _vectors([grip.along])[0], _vectors(grip.centres)
    moved, fast, sizes = _along(whole.phases, times)
    carried = np.arange(count) != grip.body
    position = centres[:, None] + np.where(carried[:, None], moved[1], moved[0])[:, :, None] * along
    velocity = np.where(carried[:, None], fast[1], fast[0])[:, :, None] * along
    quaternion, spin = np.repeat(start.quaternion.astype(Wide), n, axis=1), np.zeros((count, n, 3), Wide)
    errors, events = _bounds(grip, sizes, times), [_event(grip, change) for change in whole.changes]
    ends_at, late = whole.ends_at, 0.0
    if whole.turns_at is not None:
        later = slice(int(np.searchsorted(times, float(whole.turns_at), side="right")), None)
        turned, other = (turning(grip, whole.turns_at, times[later], MP.mpf(last), stages) for stages in STAGES)
        attitude, arrays = quaternion[grip.body, later], (position, velocity, quaternion, spin)
        for values_of_all, rows in zip(arrays, _states(grip, turned, attitude), strict=True):
            values_of_all[grip.body, later] = rows
        for name, rows in _added(grip, turned, other).items():
            errors[name][later] += rows
        events += _turned_events(grip, turned, other)
        if turned.ends_at is not None and other.ends_at is not None:
            ends_at, late = exactly(turned.ends_at), SAFETY * abs(float(turned.ends_at - other.ends_at))
    motion = ContactMotion(
        *(position, velocity, quaternion, spin, errors, tuple(events)),
        MODEL if whole.turns_at is None else INTEGRATED,
        REASON,
    )
    if ends_at is None:
        return motion
    until = float(ends_at)
    ended = Instant(END, until, late + _time_error(grip, until), grip.body)
    return replace(known_at(motion, times <= until), end=ended)


def _states(grip: Grip, turned: Turning, attitude: WideArray) -> tuple[WideArray, WideArray, WideArray, WideArray]:
    """The positions, velocities, attitudes and angular velocities (n, k) of a body that turns. attitude: (n, 4) before."""
    normal, along, across = _vectors([grip.normal, grip.along, grip.across])
    angle, w = turned.states[:, ANGLE], turned.states[:, W]
    centre = centre_of(grip)
    c = turned_by(centre, angle)
    position = _vectors([grip.centres[grip.body]])[0] + (c - centre) @ np.stack([along, across])
    velocity = w[:, None] * (c @ np.stack([across, -along]))
    turn = np.concatenate([np.cos(angle / 2)[:, None], np.sin(angle / 2)[:, None] * normal], axis=1)
    spin = rotate(conjugate(attitude), np.tile(normal, (len(angle), 1))) * w[:, None]
    return position, velocity, normalise(multiply(turn, attitude)), spin


def _added(grip: Grip, turned: Turning, other: Turning) -> dict[str, Array]:
    """The bounds (n,) of the errors of the states of a body that turns, by the names of `bounds.STATES`.

    They are the largest differences so far from the integration with other steps.
    """
    apart = np.maximum.accumulate(np.abs(turned.states - other.states), axis=0).astype(float)
    sizes = np.maximum.accumulate(np.abs(turned.states), axis=0).astype(float)
    errors = SAFETY * apart + ROUNDINGS * (1 + sizes)
    angle, w, arm = errors[:, ANGLE], errors[:, W], float(np.hypot(*centre_of(grip)))
    return dict(zip(STATES, (angle, arm * angle, arm * (w + sizes[:, W] * angle), w), strict=True))


def _turned_events(grip: Grip, turned: Turning, other: Turning) -> list[Event]:
    """The events of a body that turns. Their errors are the differences from the integration with other steps."""
    if [event.kind for event in turned.events] != [event.kind for event in other.events]:
        raise OutOfReach("a body between fingers that comes to rest and turns on almost at once")
    plane, start, centre = _vectors([grip.along, grip.across]), _vectors([grip.centres[grip.body]])[0], centre_of(grip)
    events = []
    for event, again in zip(turned.events, other.events, strict=True):
        position = vector_of(start + (turned_by(centre, np.array([event.angle]))[0] - centre) @ plane)
        error = SAFETY * abs(float(event.time - again.time)) + _time_error(grip, float(event.time))
        events.append(Event(event.kind, float(event.time), error, grip.body, position, REST, REST))
    return [event for event in events if event.time > 0]


def _along(phases: list[Phase], times: Array) -> tuple[WideArray, WideArray, Array]:
    """The displacements (2, n), m, and speeds (2, n), m/s, along d of body and carriage, and sizes (2, n) of their terms."""
    moved, fast, sizes = np.zeros((2, len(times)), Wide), np.zeros((2, len(times)), Wide), np.zeros((2, len(times)))
    starts = [float(phase.start) for phase in phases]
    index = np.maximum(np.searchsorted(starts, times, side="left") - 1, 0)
    for number in np.unique(index):
        here, phase = index == number, phases[number]
        since = np.array([wide(MP.mpf(time) - phase.start) for time in times[here].tolist()], Wide)
        for row, wave in enumerate((phase.body, phase.carriage)):
            moved[row, here], far = values(wave, since)
            fast[row, here], quick = values(wave.rate(), since)
            sizes[:, here] = np.maximum(sizes[:, here], [far, quick])
    return moved, fast, sizes


def _bounds(grip: Grip, sizes: Array, times: Array) -> dict[str, Array]:
    """The bounds (n,) of the errors of the states, by the names of `bounds.STATES`.

    The decimals by which the file misses directions and contacts change accelerations by this part of all forces. sizes: those
    of the terms of positions and velocities (2, n).
    """
    last = MP.mpf(float(times.max(initial=0.0)))
    press, effort = (max(float(wave.from_time(start).size(last)) for start, wave in each) for each in (grip.press, grip.effort))
    pulled = effort / float(grip.borne) if grip.carriage is not None else 0.0
    strength = abs(float(grip.gravity)) + 4 * press * (1 + float(grip.friction)) / float(grip.mass) + pulled
    missed = float(grip.missed)
    slower = missed * (strength * times + abs(float(grip.speed)) + abs(float(grip.carried)))
    turning = abs(float(grip.arm[1])) * strength * float(grip.mass / grip.moment) if grip.centred else 0.0
    reach = float(grip.length) + max(float(abs(part)) for centre in grip.centres for part in centre)
    turned = ROUNDINGS + missed + turning * times * times
    shift = ROUNDINGS * (sizes[0] + reach) + missed * reach + slower * times
    return dict(zip(STATES, (turned, shift, ROUNDINGS * sizes[1] + slower, 2 * turning * times), strict=True))


def _event(grip: Grip, change: Change) -> Event:
    position = plus(grip.centres[grip.body], scaled(change.position, grip.along))
    error = _time_error(grip, float(change.time))
    velocity = vector_of(scaled(change.speed, grip.along))
    return Event(change.kind, float(change.time), error, grip.body, vector_of(position), velocity, (0.0, 0.0, 0.0))


def _time_error(grip: Grip, time: float) -> float:
    """The bound (s) of the error of a time (s) by rounding, and by the decimals with which the file misses directions."""
    return ROUNDINGS * time * (1 + 1e12 * float(grip.missed))


def _vectors(vectors: list[Vector3] | tuple[Vector3, ...]) -> WideArray:
    return np.array([[wide(part) for part in each] for each in vectors], Wide)
