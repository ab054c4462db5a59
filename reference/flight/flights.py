"""Motions of many bodies in free flight in closed form, with the bounds of `closed_form`.

The members are `scenes.Scenes`. The constants of their rotations are computed with pairs of numbers of the wide type, and
everything after that by the code for a single scene, with a leading axis. Members whose constants would lose digits (extremely
near the separatrix, extremely nearly symmetric) are computed one by one as single scenes. The motion of a member is the same,
to the last bit, whatever the other members are.
"""

import itertools
from collections.abc import Generator, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.bounds import NAMES, Bounds
from bodycheck.reference.exact import inertia, pairs
from bodycheck.reference.exact.numbers import Wide, vector
from bodycheck.reference.exact.rotations import IDENTITY
from bodycheck.reference.exact.start import Start
from bodycheck.reference.flight import symmetric_top
from bodycheck.reference.flight.closed_form import (
    ASYMMETRIC,
    AT_REST,
    PRINCIPAL,
    SYMMETRIC,
    Form,
    Numbers,
    bounds,
    parabolas,
    smallest_form,
)
from bodycheck.reference.flight.constants import Branch, branches, constants_of_many
from bodycheck.reference.flight.torque_free import polhodes, steady_spins, tumbling
from bodycheck.reference.flight.turning import Turning, placed
from bodycheck.reference.scene import Brick, Cylinder, Ellipsoid, Sphere
from bodycheck.reference.scenes import Scenes, sizes_of
from bodycheck.reference.trajectory import Array, Trajectory

#: Number of states that are computed at once: so few that the arrays of a step stay in the cache of the processor.
STATES_AT_ONCE = 2**14

#: Members with a moment or a rate, other than zero, above this number or below its inverse, in SI units, are computed as single
#: scenes, since a product of several such numbers could overflow or underflow.
MODERATE = 2.0 ** min(np.finfo(Wide).maxexp // 12, 1000)

#: The pairs of axes.
_AXIS_PAIRS = ((0, 1), (0, 2), (1, 2))

#: Indices (k,) of members, or a mask (m,).
Places = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Flights:
    """The motions of m bodies in free flight.

    Attributes
    ----------
    trajectory
        The motions: arrays (m, n, ...) at the instants t (n,).
    bounds
        The bounds of their errors, as arrays (m, n).
    forms
        (m,) the names of the closed forms of the rotations.
    """

    trajectory: Trajectory
    bounds: Bounds
    forms: NDArray[np.str_]


def flights(scenes: Scenes, times: Array) -> Flights:
    """The motions of many bodies in free flight at any times (n,), s, in any order."""
    m, n = len(scenes), len(times)
    turning = Turning(np.empty((m, n, 4)), np.empty((m, n, 3)), np.empty((m, 3)), np.empty(m), np.empty(m))
    forms = np.empty(m, dtype=f"U{max(len(form.name) for form in (AT_REST, PRINCIPAL, SYMMETRIC, ASYMMETRIC))}")
    for form, places, part in _rotations(scenes, times):
        forms[places] = form.name
        for name, values in vars(part).items():
            getattr(turning, name)[places] = values
    motion = Trajectory(times, np.empty((m, n, 3)), turning.attitude, np.empty((m, n, 3)), turning.angular_velocity)
    limits = Bounds(*(np.empty((m, n)) for _ in NAMES))
    for places in _cut(np.arange(m), times):
        rows = slice(places[0], places[-1] + 1)
        _translate(scenes.part(rows), rows, turning, motion, limits)
    return Flights(motion, limits, forms)


def _translate(scenes: Scenes, rows: slice, turning: Turning, motion: Trajectory, limits: Bounds) -> None:
    """Set the translation, and the bounds of all errors, in the rows of some of the scenes."""
    translation = parabolas(scenes.position, scenes.velocity, scenes.gravity, motion.t)
    motion.position[rows], motion.velocity[rows] = translation
    numbers = Numbers(scenes.mass, scenes.gravity, scenes.moments, scenes.angular_velocity, scenes.position, scenes.velocity)
    flights = Trajectory(motion.t, translation[0], motion.quaternion[rows], translation[1], motion.angular_velocity[rows])
    turned = Turning(*(value[rows] for value in vars(turning).values()))
    errors = bounds(numbers, turned, flights, turned=False)
    for name in NAMES:
        getattr(limits, name)[rows] = getattr(errors, name)


def _rotations(scenes: Scenes, times: Array) -> Iterator[tuple[Form, Places, Turning]]:
    """Yield the rotations of all members in parts: the form, the indices of the members, and their rotations."""
    equal, certain = _equal_moments(scenes)
    moving = scenes.angular_velocity != 0
    rest = ~moving.any(axis=1)
    certain &= ~rest & _moderate(scenes.moments) & _moderate(np.where(moving, scenes.angular_velocity, 1.0))
    about_one = np.all([equal[:, k] | ~(moving[:, i] & moving[:, j]) for k, (i, j) in enumerate(_AXIS_PAIRS)], axis=0)
    count = equal.sum(axis=1)

    alone = [np.flatnonzero(~rest & ~certain)]
    for places in _cut(np.flatnonzero(rest), times):
        yield AT_REST, places, _at_rest(scenes.quaternion[places], times)
    for places in _cut(np.flatnonzero(certain & about_one), times):
        turning = steady_spins(scenes.angular_velocity[places], np.concatenate(([0.0], times)))
        yield PRINCIPAL, places, placed(turning, scenes.quaternion[places])
    for k, axis in enumerate((2, 1, 0)):
        for places in _cut(np.flatnonzero(certain & ~about_one & (count == 1) & equal[:, k]), times):
            steady = symmetric_top.steady_precessions(axis, scenes.exact_moments[places], scenes.angular_velocity[places])
            yield SYMMETRIC, places, symmetric_top.precessing(steady, scenes.quaternion[places], times)
    asymmetric = np.flatnonzero(certain & ~about_one & (count == 0))
    if len(asymmetric):
        alone.append((yield from _elliptic(scenes, asymmetric, times)))
    for index in np.concatenate(alone).tolist():
        begin = _start(scenes, index)
        form = smallest_form(begin.moments, begin.rates)
        turning = form.rotation(begin, times)
        yield form, np.array([index]), Turning(*(np.asarray(value)[None] for value in vars(turning).values()))


def _elliptic(scenes: Scenes, places: Places, times: Array) -> Generator[tuple[Form, Places, Turning], None, Places]:
    """Yield the rotations of bodies whose moments all differ, in parts; return the indices of the bodies left over."""
    invariants, accurate = constants_of_many(scenes.exact_moments[places], scenes.angular_velocity[places])
    p, f, hyperbolic = branches(invariants)
    t = np.concatenate(([0.0], times))
    for chosen in itertools.starmap(Branch, itertools.product((0, 2), (0, 2), (False, True))):
        same = accurate & (p == chosen.p) & (f == chosen.f) & (hyperbolic == chosen.hyperbolic)
        for part in _cut(np.flatnonzero(same), times):
            motion = polhodes(invariants.part(part), chosen)
            yield ASYMMETRIC, places[part], placed(tumbling(motion, t), scenes.quaternion[places[part]])
    return places[~accurate]


def _at_rest(quaternion: Array, times: Array) -> Turning:
    """The attitudes (m, 4) at t = 0, repeated for all times."""
    m, n = len(quaternion), len(times)
    attitude = np.broadcast_to(quaternion[:, None], (m, n, 4))
    return Turning(attitude, np.zeros((m, n, 3)), np.zeros((m, 3)), np.zeros(m), np.zeros(m))


def _cut(places: Places, times: Array) -> list[Places]:
    """Split indices of members into parts with about `STATES_AT_ONCE` states each."""
    size = max(1, STATES_AT_ONCE // (len(times) + 1))
    return [places[first : first + size] for first in range(0, len(places), size)]


def _moderate(values: Array) -> NDArray[np.bool_]:
    """Return whether all numbers of each row (m, 3) have a moderate size."""
    return np.asarray(((np.abs(values) <= MODERATE) & (np.abs(values) >= 1 / MODERATE)).all(axis=1))


def _equal_moments(scenes: Scenes) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return which of the pairs of moments are equal (m, 3), and whether this is certain for all three (m,).

    Moments that follow from the sizes of a shape may differ by less than a pair of numbers can resolve.
    """
    exact = scenes.exact_moments
    equal = np.stack([pairs.compare(exact[:, i], exact[:, j]) == 0 for i, j in _AXIS_PAIRS], axis=1)
    if not scenes.homogeneous:
        return equal, np.ones(len(scenes), dtype=bool)
    shape = scenes.like.body.shape
    match shape:
        case Brick() | Ellipsoid():
            sizes = np.tile(sizes_of(shape), (len(scenes), 1)) if scenes.sizes is None else scenes.sizes
            by_shape = np.stack([sizes[:, i] == sizes[:, j] for i, j in _AXIS_PAIRS], axis=1)
        case Cylinder():
            by_shape = np.broadcast_to([True, False, False], equal.shape)
        case Sphere():
            by_shape = np.ones_like(equal)
        case None:
            by_shape = np.zeros_like(equal)
    return equal, np.asarray((equal == by_shape).all(axis=1))


def _start(scenes: Scenes, index: int) -> Start:
    """The start of a member, in exact arithmetic except for its attitude, of which only the doubles matter here."""
    scene = scenes.scene(index)
    shape = scene.body.shape
    w, x, y, z = scene.initial.quaternion
    attitude = (*vector((w, x, y)), vector((x, y, z))[2])
    moments = inertia.moments(shape, scene.body.mass) if shape and scenes.homogeneous else vector(scene.body.moments)
    return Start(moments, IDENTITY, attitude, vector(scene.initial.angular_velocity))
