"""The instants at which joints pass limits of their coordinates, or of linear forms of these, in a motion without the limits.

A limit is passed where the coordinate is beyond it by more than the bound of its own error: a coordinate that only touches a
limit does not pass it. The motion is followed at evenly spaced instants. Between two instants the coordinate is a cubic with
the coordinates and velocities at both, whose error is measured at the instants in between; where the cubic comes so near to the
limit that it might pass, the motion is followed at more instants. The instant is at last enclosed by two others, at which the
coordinate lies within and beyond the limit by more than the bound of its error.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.bounds import EPS
from bodycheck.reference.errors import NotModelled, within_range
from bodycheck.reference.exact.numbers import FloatType, WideArray
from bodycheck.reference.mechanisms import mimicry, recursion
from bodycheck.reference.mechanisms.coordinates import places
from bodycheck.reference.mechanisms.followed import arithmetic, followed, growth_instants
from bodycheck.reference.mechanisms.forms.choice import form_of
from bodycheck.reference.mechanisms.loops import ways as loops
from bodycheck.reference.mechanisms.mechanism import Joint, Mechanism
from bodycheck.reference.mechanisms.tree import forest
from bodycheck.reference.mechanisms.ways import Motion, sizes
from bodycheck.reference.trajectory import Array

#: The numbers of evenly spaced instants: at least, at most, and for each radian that the fastest body turns.
FEWEST, MOST, PER_RADIAN = 513, 16385, 8

#: The number of parts into which an interval is divided in which a limit might be passed, the number of rounds of division, and
#: the largest number of such intervals for each limit.
PARTS, ROUNDS, MOST_INTERVALS = 16, 6, 64

#: The number of pairs of instants, each pair twice as far apart as the one before, among which is one that encloses the root.
DOUBLINGS = 24


class Range(Protocol):
    """The limits of a linear form of the coordinates of joints with one coordinate, as of one of them alone.

    name: of the joint, or of the tendon whose length the form is. terms: the joints by their names, each with its coefficient.
    lower, upper: the limits (rad or m); None where there is none.
    """

    @property
    def name(self) -> str: ...

    @property
    def terms(self) -> Sequence[tuple[str, float]]: ...

    @property
    def lower(self) -> float | None: ...

    @property
    def upper(self) -> float | None: ...


@dataclass(frozen=True)
class JointLimits:
    """The stops of one joint as a `Range`."""

    name: str
    terms: tuple[tuple[str, float], ...]
    lower: float | None
    upper: float | None

    @classmethod
    def of(cls, joint: Joint) -> "JointLimits":
        """Return the stops of a joint, which has stops."""
        assert joint.stops is not None
        return cls(joint.name, ((joint.name, 1.0),), joint.stops.lower, joint.stops.upper)


@dataclass(frozen=True)
class Passing:
    """The first instant at which a joint, or a linear form of the coordinates of joints, passes one of its limits.

    Attributes
    ----------
    name
        The name of the joint, or of the form.
    side, limit
        The limit (rad or m), and which of the two it is.
    time, error
        The instant (s), 0 for a joint that is beyond the limit at the start, and the bound of its error (s).
    """

    name: str
    side: Literal["lower", "upper"]
    limit: float
    time: float
    error: float


#: A function from ascending instants (n,), s, to the coordinates and velocities (n, k) of joints in the wide type.
_Follow = Callable[[Array], tuple[WideArray, WideArray]]


@dataclass(frozen=True)
class _Limit:
    """One limit of one linear form of coordinates.

    terms: the indices of joints, each with its coefficient. sign: 1 for an upper limit, -1 for a lower one. start, velocity:
    the exact excess of the form over the limit at t = 0, and its derivative.
    """

    name: str
    terms: tuple[tuple[int, float], ...]
    sign: int
    value: float
    start: Fraction
    velocity: Fraction

    @property
    def passed_at_start(self) -> bool:
        return self.start > 0 or (self.start == 0 and self.velocity > 0)

    def passing(self, time: float, error: float) -> Passing:
        return Passing(self.name, "upper" if self.sign > 0 else "lower", self.value, time, error)


@dataclass(frozen=True, eq=False)
class _Samples:
    """The coordinates and velocities (n, k) of joints at ascending instants t (n,), s.

    columns: the column of each joint, by its index. error: bounds (n, k) of the errors of the coordinates.
    """

    columns: dict[int, int]
    t: Array
    position: WideArray
    velocity: WideArray
    error: Array

    def excess(self, limit: _Limit) -> tuple[Array, Array, Array]:
        """The excess (n,) of a form over a limit, its derivative, and the bound of its error, which is 0 at t = 0."""
        columns = [self.columns[joint] for joint, _ in limit.terms]
        factors = np.array([factor for _, factor in limit.terms], dtype=self.position.dtype)
        over = (self.position[:, columns] @ factors - self.position.dtype.type(limit.value)).astype(float) * limit.sign
        error = self.error[:, columns] @ np.abs(factors.astype(float))
        over[0], error[0] = float(limit.start), 0.0
        return over, (self.velocity[:, columns] @ factors).astype(float) * limit.sign, error

    def with_others(self, others: "_Samples") -> "_Samples":
        """These samples and others at other instants, in order of time."""
        order = np.argsort(np.concatenate([self.t, others.t]), kind="stable")

        def merged(one: WideArray, other: WideArray) -> WideArray:
            return np.concatenate([one, other])[order]

        return _Samples(
            self.columns,
            merged(self.t, others.t),
            merged(self.position, others.position),
            merged(self.velocity, others.velocity),
            merged(self.error, others.error),
        )


def passed(mechanism: Mechanism, ranges: Sequence[Range], duration: float) -> tuple[Passing, ...]:
    """Return for each limit that is passed within a duration (s) the first instant, in order of time.

    A joint that begins beyond a limit, or on it and moves outwards, passes it at 0 s.

    Raises
    ------
    ValueError
        If a range is that of a joint that the mechanism does not have, or that has not one coordinate.
    NotModelled, OutOfReach
        As `mechanism_truth`; also `NotModelled` for a mechanism with a plane or pushes.
    """
    if mechanism.plane is not None or mechanism.pushes:
        raise NotModelled("limits of joints beside contacts and pushes")
    limits = tuple(_limits(mechanism, ranges))
    at_start = [limit.passing(0.0, 0.0) for limit in limits if limit.passed_at_start]
    waiting = [limit for limit in limits if not limit.passed_at_start]
    if not waiting or not duration:
        return tuple(at_start)
    with within_range("the motion"):
        later = list(_passings(mechanism, waiting, duration))
    return tuple(sorted([*at_start, *later], key=lambda each: each.time))


def reached(mechanism: Mechanism, ranges: Sequence[Range], duration: float) -> frozenset[str]:
    """Return the names of ranges of which a limit may be reached within a duration (s).

    The coordinates surely stay within all other ranges, by more than the bounds of their errors. A coordinate that begins at a
    limit reaches it. Raises as `passed` does.
    """
    limits = tuple(_limits(mechanism, ranges))
    reaching = {limit.name for limit in limits if limit.start >= 0}
    waiting = [limit for limit in limits if limit.name not in reaching]
    if not waiting or not duration:
        return frozenset(reaching)
    with within_range("the motion"):
        sample, samples = _begun(mechanism, waiting, duration)
        for _ in range(ROUNDS):
            open_ones = {limit: _open(samples, limit) for limit in waiting if not _reaches(samples, limit)}
            wanted = np.unique(np.concatenate([_divided(samples.t, each) for each in open_ones.values()] or [np.empty(0)]))
            if not len(wanted := np.setdiff1d(wanted, samples.t)):
                break
            samples = samples.with_others(sample(wanted))
        return frozenset({*reaching, *(each.name for each in waiting if _reaches(samples, each) or _open(samples, each).any())})


def _reaches(samples: _Samples, limit: _Limit) -> bool:
    """Return whether a coordinate is so near to a limit at an instant that it may be beyond it."""
    over, _, error = samples.excess(limit)
    return bool((over[1:] >= -error[1:]).any())


def _open(samples: _Samples, limit: _Limit) -> NDArray[np.bool_]:
    """Return in which intervals (n - 1,) a coordinate might reach a limit."""
    largest, uncertain = _largest(samples, limit)
    return np.asarray(largest + uncertain >= -samples.excess(limit)[2][1:])


def _limits(mechanism: Mechanism, ranges: Sequence[Range]) -> Iterator[_Limit]:
    indices = {joint.name: index for index, joint in enumerate(mechanism.joints)}
    for each in ranges:
        terms = tuple((indices.get(joint, -1), factor) for joint, factor in each.terms)
        if any(index < 0 or mechanism.joints[index].type not in ("revolute", "prismatic") for index, _ in terms):
            raise ValueError(f"{each.name} is no revolute or prismatic joint of the mechanism")
        starts = [mimicry.start(mechanism.joints, index) for index, _ in terms]
        begin, velocity = (
            sum((Fraction(factor) * pair[part] for (_, factor), pair in zip(terms, starts, strict=True)), Fraction(0))
            for part in (0, 1)
        )
        for sign, value in ((-1, each.lower), (1, each.upper)):
            if value is not None and math.isfinite(value):
                yield _Limit(each.name, terms, sign, value, sign * (begin - Fraction(value)), sign * velocity)


def _passings(mechanism: Mechanism, limits: Sequence[_Limit], duration: float) -> Iterator[Passing]:
    sample, samples = _begun(mechanism, limits, duration)
    for find in (*[_within] * ROUNDS, _around):
        wanted = np.unique(np.concatenate([find(samples, limit) for limit in limits]))
        if len(wanted := np.setdiff1d(wanted, samples.t)):
            samples = samples.with_others(sample(wanted))
    for limit in limits:
        over, _, error = samples.excess(limit)
        if (after := _first_beyond(over, error)) is not None:
            before = np.flatnonzero(over[:after] <= -error[:after])[-1]
            start, end = float(samples.t[before]), float(samples.t[after])
            yield limit.passing((start + end) / 2, (end - start) / 2 + EPS * end)


def _begun(mechanism: Mechanism, limits: Sequence[_Limit], duration: float) -> tuple[Callable[[Array], _Samples], _Samples]:
    """Return a function that samples the coordinates of limits at ascending instants, and samples at evenly spaced instants."""
    coarse = growth_instants(np.array([duration]))
    way = followed(mechanism, coarse).way
    joints = tuple(dict.fromkeys(joint for limit in limits for joint, _ in limit.terms))
    sample = _sampler(mechanism, joints, coarse, way.errors, duration)
    return sample, sample(_evenly(mechanism, way.motion, duration))


def _first_beyond(over: Array, error: Array) -> int | None:
    """The index of the first instant at which a coordinate is beyond a limit by more than the bound of its error."""
    beyond = np.flatnonzero(over > error)
    return int(beyond[0]) if len(beyond) else None


def _within(samples: _Samples, limit: _Limit) -> Array:
    """The instants that divide the intervals in which a coordinate might pass a limit for the first time."""
    over, _, error = samples.excess(limit)
    after = _first_beyond(over, error)
    largest, uncertain = _largest(samples, limit)
    chosen = largest + uncertain > error[1:]
    if after is not None:
        chosen[after - 1] = uncertain[after - 1] > error[after]
        chosen[after:] = False
    return _divided(samples.t, chosen)


def _largest(samples: _Samples, limit: _Limit) -> tuple[Array, Array]:
    """The largest excesses (n - 1,) of cubics over a limit between neighbouring instants, and the errors of these."""
    over, slope, _ = samples.excess(limit)
    thirds = np.diff(samples.t) / 3
    # A cubic lies below the largest of the four coefficients of Bernstein's polynomials.
    largest = np.max([over[:-1], over[:-1] + slope[:-1] * thirds, over[1:] - slope[1:] * thirds, over[1:]], axis=0)
    return largest, _uncertainty(samples.t, over, slope)


def _divided(t: Array, chosen: NDArray[np.bool_]) -> Array:
    """The instants that divide the chosen intervals (n - 1,) between the instants t (n,)."""
    steps = np.diff(t)
    intervals = np.flatnonzero(chosen & (steps > PARTS * EPS * t[1:]))[:MOST_INTERVALS]
    parts = np.arange(1, PARTS) / PARTS
    return np.asarray((t[intervals, None] + steps[intervals, None] * parts).ravel())


def _uncertainty(t: Array, over: Array, slope: Array) -> Array:
    """The largest errors (n - 1,) of cubics between neighbouring instants t (n,).

    The cubic between the instants before and after an instant is compared with the coordinate there. Its error is largest in
    the middle, and larger than the errors of the cubics in both halves.
    """
    width = t[2:] - t[:-2]
    s = (t[1:-1] - t[:-2]) / width
    cubic = _cubic(over[:-2], over[2:], slope[:-2] * width, slope[2:] * width, s)
    largest = np.abs(over[1:-1] - cubic) / (16 * np.square(s * (1 - s)))
    return np.asarray(np.maximum(np.append(largest, 0.0), np.insert(largest, 0, 0.0)))


def _cubic(start: Array, end: Array, first: Array, last: Array, s: Array | float) -> Array:
    """The cubic with given values and derivatives at 0 and 1, at s."""
    rise = end - start
    return np.asarray(start + s * (first + s * (3 * rise - 2 * first - last + s * (first + last - 2 * rise))))


def _around(samples: _Samples, limit: _Limit) -> Array:
    """Instants that enclose the first root of the excess of a coordinate over a limit, ever farther away from it."""
    over, slope, error = samples.excess(limit)
    after = _first_beyond(over, error)
    if after is None:
        return np.empty(0)
    begin, width = samples.t[after - 1], samples.t[after] - samples.t[after - 1]
    ends = over[after - 1], over[after], slope[after - 1] * width, slope[after] * width
    low, high = 0.0, 1.0
    while low < (middle := (low + high) / 2) < high:
        low, high = (low, middle) if _cubic(*ends, middle) > 0 else (middle, high)
    root = begin + low * width
    nearest = error[after] / max(abs(slope[after]), error[after] / width) + EPS * root
    apart = nearest * 2.0 ** np.arange(DOUBLINGS)
    times = np.concatenate([root - apart, root + apart])
    return np.asarray(times[(times > 0) & (times < samples.t[-1])])


def _evenly(mechanism: Mechanism, motion: Motion, duration: float) -> Array:
    """Evenly spaced instants (n,), s, of which there are enough for the turning of the fastest body."""
    turned = duration * float(sizes(mechanism, motion)["angular_velocity_error"].max())
    return np.linspace(0.0, duration, int(min(max(PER_RADIAN * turned, FEWEST), MOST)))


def _sampler(
    mechanism: Mechanism, joints: tuple[int, ...], coarse: Array, errors: dict[str, Array], end: float
) -> Callable[[Array], _Samples]:
    """A function from ascending instants (n,), s, to the coordinates of joints.

    errors: (m,) bounds of the errors of the motion at ascending instants `coarse` (m,), s, by the names of `bounds.STATES`.
    end: the time (s) at which the motion ends.
    """
    names = ["error" if mechanism.joints[index].type == "revolute" else "position_error" for index in joints]
    bounds = np.stack([errors[name] for name in names], axis=1)
    columns = {index: column for column, index in enumerate(joints)}
    follow = _follower(mechanism, joints, end)

    def sample(times: Array) -> _Samples:
        rows = np.minimum(np.searchsorted(coarse, times), len(coarse) - 1)
        return _Samples(columns, times, *follow(times), bounds[rows])

    return sample


def _follower(mechanism: Mechanism, joints: Sequence[int], end: float) -> _Follow:
    form = form_of(mechanism)
    if form is None and not mechanism.loops:
        return _by_recursion(mechanism, joints, end)
    held, moving = ([slices[part].start for slices in map(places(mechanism).__getitem__, joints)] for part in (0, 1))

    def follow(times: Array) -> tuple[WideArray, WideArray]:
        motion = loops.way(mechanism, times).motion if form is None else form.follow(times)
        return motion.position[:, held], motion.velocity[:, moving]

    return follow


def _by_recursion(mechanism: Mechanism, joints: Sequence[int], end: float) -> _Follow:
    kind, solve = FloatType(arithmetic()[0]), recursion.solver()
    trees = [tree for tree in forest(mechanism).trees if any(link.joint in joints for link in tree.links)]

    def follow(times: Array) -> tuple[WideArray, WideArray]:
        pairs: dict[int, tuple[WideArray, WideArray]] = {}
        to_end = np.append(times, end)  # a motion is kept from its start to its end
        for tree in trees:
            for link, state in zip(tree.links, solve(tree, to_end, kind).links, strict=True):
                pairs[link.joint] = state.coordinates[:-1, 0], state.rates[:-1, 0]
        position, velocity = (np.stack([pairs[index][part] for index in joints], axis=1) for part in (0, 1))
        return position, velocity

    return follow
