"""The growth of an error along the motion of a mechanism, from nudged motions in double precision.

A motion is followed again from a state that is nudged by a small part of the sizes of coordinates and velocities. Its distance
from the motion that is not nudged, divided by the nudge, is the growth of an error. When the distance becomes so large that it
is no longer proportional to the nudge, it is scaled back to the size of a nudge, and the motion continues from there (Benettin
et al., Meccanica 15, 1980), so that the growth can become arbitrarily large. Errors arise at all times, and a later error can
grow more than an error at the start; so motions are nudged at later instants too. One motion is nudged in its angles alone: it
gives the growth `of_start`, the error of angles per error of the initial angles.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from bodycheck.reference.bounds import EPS, STATES
from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.mechanisms.coordinates import places
from bodycheck.reference.mechanisms.mechanism import BodyStart, Mechanism
from bodycheck.reference.mechanisms.ways import Follow, Motion, apart, letters, reach, sizes
from bodycheck.reference.trajectory import Array, Trajectory

#: The size of a nudge, relative to the sizes of coordinates and velocities: large beside a rounding, and small beside `SMALL`.
NUDGE = 2.0**-30

#: Deviation, relative to the sizes, up to which deviations are taken to be proportional to the nudge.
SMALL = 1e-2

#: The range of the size of a deviation, in units of a nudge, within which it is not scaled.
UNSCALED = 2.0**10

#: The times of the nudges, as parts of the duration: the first motion is nudged in its angles alone, the others in all
#: coordinates and velocities.
STARTS = (0.0, 0.0, 1 / 3, 2 / 3)

#: The growth at which nothing is known of a motion any more, in any arithmetic.
LARGEST = 1e30

#: The number of instants after which the deviation of the first nudged motion is looked at.
AHEAD = 16

#: The largest number of pieces of a nudged motion, between which its deviation is scaled back.
MOST_PIECES = 40


#: The least number of roundings of an integration by Taylor's method, before they grow.
FEWEST_ROUNDINGS = 8.0

#: The factor by which the measured number of roundings may be too small: rounding in the two types differs, and growth is
#: measured in a few directions only. The largest that a proof has shown is 15.3, in `gyroscope-near-lock`; no other tree that
#: was measured needs more than 1 (`python benchmarks/loose_bounds.py --roundings --limit 5`).
CAUTION = 16.0

#: The factor of growth over which the number of roundings is measured together: a single difference may be small by chance.
#: By the same measurement, the factor 15.3 above is 25.2 if each instant is taken alone, 15.3 for 10, and 12.6 for 1000.
TOGETHER = 100.0

#: Number of roundings of a stored number that grows with time, such as the angle of a wheel, and of numbers computed from it.
STORED_ROUNDINGS = 16.0


@dataclass(frozen=True, eq=False)
class Growth:
    """The largest growth of a relative error of the state until each of m instants.

    Attributes
    ----------
    t
        (m,) instants (s), ascending.
    figures
        (m,) errors, in SI units, per unit of a relative error made at any earlier time, by the names of `bounds.STATES`; never
        decreasing. A relative error of 1 is one radian, one length of the mechanism, and the largest speeds and rates of the
        motion: see `scales`.
    of_any
        (m,) the largest of the relative errors per relative error.
    of_start
        (m,) the error of the angles per error of the angles at t = 0; never decreasing.
    """

    t: Array
    figures: dict[str, Array]
    of_any: Array
    of_start: Array

    def until(self, times: Array) -> "Growth":
        """The growth at other times (n,), s: at each time, the growth at the first instant that is not earlier."""
        places = np.minimum(np.searchsorted(self.t, times), len(self.t) - 1)
        figures = {name: values[places] for name, values in self.figures.items()}
        return Growth(times, figures, self.of_any[places], self.of_start[places])


def growth(mechanism: Mechanism, follow: Follow, base: Motion, t: Array) -> Growth:
    """The growth of an error along a motion.

    Parameters
    ----------
    mechanism
        The mechanism.
    follow
        The function that follows a mechanism in double precision. A nudged motion for which it raises `OutOfReach` does not
        count.
    base
        The motion at the instants t in double precision.
    t
        (m,) ascending instants (s), the first of which is 0.
    """
    units = scales(mechanism, base, float(t[-1]))
    figures = {name: np.full(len(t), units[name]) for name in STATES}
    of_start, ahead = np.ones(len(t)), AHEAD
    for first, nudged, turned_only in _nudges(mechanism, base, t, units):
        for rows, each in _deviations(mechanism, follow, base, t, first, units, nudged, ahead):
            ahead = rows.stop - rows.start
            for name in STATES:
                figures[name][rows] = np.maximum(figures[name][rows], each[name])
            if turned_only:
                of_start[rows] = np.maximum(of_start[rows], each["error"])
    return capped(t, figures, units, of_start)


def capped(t: Array, figures: dict[str, Array], units: dict[str, float], of_start: Array) -> Growth:
    """Return the growth from measurements (m,) at the instants t, which may decrease and become arbitrarily large."""
    largest = {name: np.minimum(np.maximum.accumulate(values), LARGEST * units[name]) for name, values in figures.items()}
    of_any = np.max([largest[name] / units[name] for name in STATES], axis=0)
    return Growth(t, largest, of_any, np.minimum(np.maximum.accumulate(of_start), LARGEST))


def _nudges(mechanism: Mechanism, base: Motion, t: Array, units: dict[str, float]) -> Iterator[tuple[int, Mechanism, bool]]:
    """Yield the index in t of each nudge, the mechanism that starts from the nudged state, and whether only angles are nudged.

    If joints have dry friction, the first nudge of all coordinates and velocities is made in both directions, since friction
    stops a joint that is nudged in one direction and may balance the force on a joint that is nudged in the other.
    """
    random, dry = np.random.default_rng(0), any(joint.friction for joint in mechanism.joints)
    held, moving = letters(mechanism)
    sizes_of_draws = (len(held), len(moving), (len(mechanism.bodies), 4), (len(mechanism.bodies), 3))
    for number, begin in enumerate(STARTS):
        first = int(np.searchsorted(t, begin * t[-1]))
        draws = [random.choice([-1.0, 1.0], size) for size in sizes_of_draws]
        for sign in (1.0, -1.0) if dry and number == 1 else (1.0,):
            directions = [sign * draw for draw in draws]
            yield first, _nudged(mechanism, base.part([first]), units, directions, turned_only=number == 0), number == 0


def scales(mechanism: Mechanism, motion: Motion, duration: float) -> dict[str, float]:
    """The sizes of the states of a motion, by the names of `bounds.STATES`.

    They are one radian, the length of the mechanism (m), and the largest speed (m/s) and rate (rad/s) of the motion. Rates that
    are smaller than a nudge beside the speeds, as in a free fall, may be zero but for rounding, and are no unit.
    """
    largest = {name: float(values.max(initial=0.0)) for name, values in sizes(mechanism, motion).items()}
    length, rate = reach(mechanism), largest["angular_velocity_error"]
    if rate <= NUDGE * largest["velocity_error"] / length:
        rate = 1 / (duration or 1.0)
    return {
        "error": 1.0,
        "position_error": length,
        "velocity_error": max(largest["velocity_error"], length * rate),
        "angular_velocity_error": rate,
    }


def _deviations(
    mechanism: Mechanism,
    follow: Follow,
    base: Motion,
    t: Array,
    first: int,
    units: dict[str, float],
    start: Mechanism,
    ahead: int,
) -> Iterator[tuple[slice, dict[str, Array]]]:
    """Yield the deviations per nudge of a motion that is nudged at the instant t[first], piece by piece.

    Each piece has the slice of its instants and the deviations there, by the names of `bounds.STATES`. start: the mechanism
    that starts from the nudged state at that instant. ahead: the number of instants that the first piece probably has.
    """
    grown = 1.0
    for _ in range(MOST_PIECES):
        if first + 1 >= len(t) or grown >= LARGEST:
            return
        try:
            end, differences, relative = _followed(mechanism, follow, base, t, first, units, start, ahead)
        except OutOfReach:  # such as a nudge that leaves undecided whether a joint sticks
            return
        # The loops of a nudged mechanism are closed before it is followed, which changes the size of the nudge.
        nudge = float(relative[0]) if mechanism.loops else NUDGE
        if not nudge:
            return
        at = len(relative) - 1
        yield slice(first, first + at + 1), {name: values * (grown / nudge) for name, values in differences.items()}
        if first + at + 1 >= len(t):
            return
        grown *= float(relative[at]) / nudge
        start = _between(mechanism, base.part([first + at]), end, NUDGE / float(relative[at]))
        first, ahead = first + at, at + 1


def _followed(
    mechanism: Mechanism,
    follow: Follow,
    base: Motion,
    t: Array,
    first: int,
    units: dict[str, float],
    start: Mechanism,
    ahead: int,
) -> tuple[Motion, dict[str, Array], Array]:
    """A nudged motion until its deviation is large, or to the end.

    Returns its state there, its deviations until there, and the largest of these relative to their units. ahead: the number of
    instants after which the deviation is looked at for the first time.
    """
    parts = _parts(first, ahead, len(t))
    differences: dict[str, list[Array]] = {name: [] for name in STATES}
    for rows, nudged in zip(parts, follow(start, [t[rows] - t[first] for rows in parts]), strict=True):
        here = apart(mechanism, nudged, base.part(rows))
        large = np.max([here[name] / units[name] for name in STATES], axis=0) > SMALL
        large[0] &= rows.start > first
        last = int(np.argmax(large)) if large.any() else len(large) - 1
        for name in STATES:
            differences[name].append(here[name][: last + 1])
        if large.any() or rows.stop == len(t):
            break
    joined = {name: np.concatenate(values) for name, values in differences.items()}
    return nudged.part([last]), joined, np.max([joined[name] / units[name] for name in STATES], axis=0)


def _parts(first: int, ahead: int, end: int) -> list[slice]:
    """The instants from `first` to `end` in parts: the first has `ahead` instants, the next a quarter, and then ever more."""
    parts, size = [slice(first, min(first + ahead, end))], ahead // 4 + 1
    while (begin := parts[-1].stop) < end:
        parts.append(slice(begin, min(begin + size, end)))
        size *= 2
    return parts


def _nudged(
    mechanism: Mechanism, state: Motion, units: dict[str, float], directions: list[Array], *, turned_only: bool
) -> Mechanism:
    """A mechanism that starts from a state at one instant, with a nudge of each coordinate and velocity.

    directions: the signs of the nudges of the coordinates and velocities of joints, and of the quaternions and angular
    velocities of bodies. turned_only: whether angles and attitudes alone are nudged.
    """
    held, moving = letters(mechanism)
    also = 0.0 if turned_only else 1.0
    of_coordinate = {"a": 1.0, "q": 1.0, "l": also * units["position_error"]}
    of_velocity = {"a": also * units["angular_velocity_error"], "l": also * units["velocity_error"]}
    q = NUDGE * np.array([of_coordinate[each] for each in held]) * directions[0]
    u = NUDGE * np.array([of_velocity[each] for each in moving]) * directions[1]
    turn, spin = NUDGE * directions[2], also * NUDGE * units["angular_velocity_error"] * directions[3]
    bodies = state.bodies
    return _started(
        mechanism,
        state.position[0] + q,
        state.velocity[0] + u,
        replace(bodies, quaternion=bodies.quaternion + turn[:, None], angular_velocity=bodies.angular_velocity + spin[:, None]),
    )


def _between(mechanism: Mechanism, base: Motion, other: Motion, part: float) -> Mechanism:
    """A mechanism whose start is interpolated between two states at one instant. part: 0 for `base`, 1 for `other`."""

    def mixed(one: Array, two: Array) -> Array:
        return np.asarray(one + part * (two - one))

    sign = np.where((base.bodies.quaternion * other.bodies.quaternion).sum(axis=-1, keepdims=True) < 0, -1.0, 1.0)
    bodies = replace(
        base.bodies,
        position=mixed(base.bodies.position, other.bodies.position),
        quaternion=mixed(base.bodies.quaternion, sign * other.bodies.quaternion),
        velocity=mixed(base.bodies.velocity, other.bodies.velocity),
        angular_velocity=mixed(base.bodies.angular_velocity, other.bodies.angular_velocity),
    )
    target = other.position[0].copy()
    for joint, (held, _) in zip(mechanism.joints, places(mechanism), strict=True):
        if joint.form.has_quaternion:
            components = slice(held.stop - 4, held.stop)
            if base.position[0, components] @ target[components] < 0:
                target[components] = -target[components]
    return _started(mechanism, mixed(base.position[0], target), mixed(base.velocity[0], other.velocity[0]), bodies)


def _started(mechanism: Mechanism, q: Array, u: Array, states: Trajectory) -> Mechanism:
    """A mechanism that starts from coordinates (c,) and velocities (u,) of its joints and states (b, 1, ...) of its bodies."""
    joints = tuple(
        replace(joint, start=tuple(q[held].tolist()), start_velocity=tuple(u[moving].tolist()))
        for joint, (held, moving) in zip(mechanism.joints, places(mechanism), strict=True)
    )

    def begun(index: int) -> BodyStart:
        x, v, w = (each[index, 0].tolist() for each in (states.position, states.velocity, states.angular_velocity))
        return BodyStart(tuple(x), tuple(states.quaternion[index, 0].tolist()), tuple(v), tuple(w))

    bodies = tuple(
        body if body.start is None else replace(body, start=begun(index)) for index, body in enumerate(mechanism.bodies)
    )
    return replace(mechanism, joints=joints, bodies=bodies)


def roundings(mechanism: Mechanism, base: Motion, wide: Motion, grown: Growth) -> float:
    """Return the number of roundings of an integration.

    It is the largest difference of the integration in doubles, `base`, from the wide one, `wide`, divided by one rounding of
    doubles times its growth, and at least `FEWEST_ROUNDINGS`.
    """
    off = apart(mechanism, base, wide)
    return max(FEWEST_ROUNDINGS, *(float(np.max(off[name] / grown.figures[name])) / EPS for name in STATES))


def of_roundings(mechanism: Mechanism, base: Motion, wide: Motion, grown: Growth, count: float) -> Growth:
    """Return the growth of roundings, of which `count` are made: the measured growth, less where it is of no rounding.

    The growth of an error in any direction may be much larger than that of roundings, which are relative to the states at
    their time and have their own directions. Where the growth is large, the number of roundings is that of the differences of
    `base` and `wide` since the growth was a hundredth, and at least `FEWEST_ROUNDINGS` that have grown a hundredfold. The
    arguments are those of `roundings`.
    """
    off = apart(mechanism, base, wide)
    numbers = np.max([off[name] / grown.figures[name] for name in STATES], axis=0) / EPS
    begins = np.searchsorted(grown.of_any, grown.of_any / TOGETHER)
    seen = np.array([numbers[begin : end + 1].max() for end, begin in enumerate(begins)])
    part = np.maximum(seen, FEWEST_ROUNDINGS * np.minimum(1.0, TOGETHER / grown.of_any)) / count
    figures = {name: so_far(values * part) for name, values in grown.figures.items()}
    return replace(grown, figures=figures, of_any=so_far(grown.of_any * part))


def rounding_errors(mechanism: Mechanism, motion: Motion, grown: Growth, count: float, eps: float) -> dict[str, Array]:
    """Bounds (n,) of the errors of an integration that makes `count` roundings of size eps, whose growth is `grown`."""
    largest = sizes(mechanism, motion)
    return {name: eps * (CAUTION * count * grown.figures[name] + STORED_ROUNDINGS * so_far(largest[name])) for name in STATES}


def so_far(values: Array) -> Array:
    """Return the largest of the values (n,) up to each of them."""
    return np.asarray(np.maximum.accumulate(values))
