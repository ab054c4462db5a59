"""The motion of a gripped body, its fingers and their carriage at given instants: states, bounds and events.

All decisions, instants of events and motions are computed with a hundred digits from the numbers of the file; the states at
given instants are evaluated in the widest type of NumPy.
"""

import numpy as np

from bodycheck.reference.bodies import initial
from bodycheck.reference.bounds import STATES
from bodycheck.reference.contact.gripping.course import Change, Phase, course
from bodycheck.reference.contact.gripping.grip import Grip, grip_of
from bodycheck.reference.contact.gripping.waves import Wave
from bodycheck.reference.contact.motion import ContactMotion, Event
from bodycheck.reference.exact.numbers import MP, Vector3, Wide, wide
from bodycheck.reference.exact.rotations import plus, scaled
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.scene import vector_of
from bodycheck.reference.trajectory import Array
from bodycheck.reference.witness import WideArray

#: The number of roundings of a state in a phase, relative to the size of its terms.
ROUNDINGS = 32 * float(np.finfo(Wide).eps)

#: The equations that are solved, and why they are exact.
MODEL = "closed form: a body that two fingers hold, or that slips on them along a line"
REASON = "a free body between two fingers that press it with equal forces, under Coulomb's law"


def motion(scene: Mechanism, times: Array) -> ContactMotion:
    """The motion of a scene in which bodies on joints touch others, at ascending times (n,) >= 0 (s).

    Raises `NotModelled` as `grip_of` and `course` do.
    """
    grip = grip_of(scene)
    last = float(times.max(initial=0.0))
    whole = course(grip, MP.mpf(last))
    n, count = len(times), len(scene.bodies)
    moved, fast, sizes = _along(whole.phases, times)
    along, centres = _vectors([grip.along])[0], _vectors(grip.centres)
    carried = np.arange(count) != grip.body
    start = initial(scene)
    return ContactMotion(
        centres[:, None] + np.where(carried[:, None], moved[1], moved[0])[:, :, None] * along,
        np.where(carried[:, None], fast[1], fast[0])[:, :, None] * along,
        np.repeat(start.quaternion.astype(Wide), n, axis=1),
        np.zeros((count, n, 3), Wide),
        _bounds(grip, sizes, times),
        tuple(_event(grip, change) for change in whole.changes),
        MODEL,
        REASON,
    )


def _along(phases: list[Phase], times: Array) -> tuple[WideArray, WideArray, Array]:
    """The displacements (2, n), m, and speeds (2, n), m/s, along d of body and carriage, and sizes (2, n) of their terms."""
    moved, fast, sizes = np.zeros((2, len(times)), Wide), np.zeros((2, len(times)), Wide), np.zeros((2, len(times)))
    starts = [float(phase.start) for phase in phases]
    index = np.maximum(np.searchsorted(starts, times, side="left") - 1, 0)
    for number in np.unique(index):
        here, phase = index == number, phases[number]
        since = np.array([wide(MP.mpf(time) - phase.start) for time in times[here].tolist()], Wide)
        for row, wave in enumerate((phase.body, phase.carriage)):
            moved[row, here], far = _values(wave, since)
            fast[row, here], quick = _values(wave.rate(), since)
            sizes[:, here] = np.maximum(sizes[:, here], [far, quick])
    return moved, fast, sizes


def _values(wave: Wave, times: WideArray) -> tuple[WideArray, Array]:
    """The values (n,) of a function at times (n,), and the sums (n,) of the sizes of its terms, each with its roundings."""
    values, sizes = np.zeros_like(times), np.zeros_like(times)
    for order, power in enumerate(wave.powers):
        term = wide(power) * times**order
        values, sizes = values + term, sizes + np.abs(term)
    for a, w, p in wave.sines:
        amplitude, angle = wide(a), wide(w) * times + wide(MP.fmod(p, 2 * MP.pi))
        values, sizes = values + amplitude * np.sin(angle), sizes + np.abs(amplitude) * (1 + np.abs(angle))
    return values, sizes.astype(float)


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
    position = plus(grip.centres[grip.body], scaled(change.place, grip.along))
    error = ROUNDINGS * float(change.time) * (1 + 1e12 * float(grip.missed))
    velocity = vector_of(scaled(change.speed, grip.along))
    return Event(change.kind, float(change.time), error, grip.body, vector_of(position), velocity, (0.0, 0.0, 0.0))


def _vectors(vectors: list[Vector3] | tuple[Vector3, ...]) -> WideArray:
    return np.array([[wide(part) for part in each] for each in vectors], Wide)
