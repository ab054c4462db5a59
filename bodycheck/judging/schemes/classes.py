"""Classes of methods that are the same algorithm: their motions agree to the precision of their arithmetic.

Two methods with equal errors need not be the same: their motions are compared with each other, state by state, and not with the
truth. The effect of rounding is bounded by `scheme_rounding`, with the unit roundoff of the coarser of the two precisions.
"""

import math
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np

from bodycheck.judging.schemes.scheme_rounding import allowance, in_position
from bodycheck.judging.schemes.scheme_runs import sampled, steps
from bodycheck.reference.kinematics import geodesic_angle, normalise
from bodycheck.reference.scene import Scene
from bodycheck.reference.schemes.formulations import world_velocity
from bodycheck.reference.schemes.one_step import rosenbrock_euler, semi_implicit_euler
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truths import distance
from bodycheck.results.key import RunKey

#: Time from the start (s), and number of steps, in which motions are compared. Later, rounding hides too much.
EARLY_S, EARLY_STEPS = 2.0, 100

#: The largest effect of rounding on the attitude (rad) up to which motions are compared.
MOST_ROUNDING_RAD = 1e-2

#: Difference of two programs after a first turn by an angle (rad), in units of roundoff divided by the angle. It applies to an
#: angle that is computed from its cosine, as half a turn with an error of two units.
FIRST_TURN_ROUNDINGS = 4

#: A scene distinguishes methods if the difference between the motions of two schemes that differ only in the gyroscopic torque
#: exceeds the effect of rounding by this factor. In a spin about a principal axis these motions are the same.
TELLING = 10.0


@dataclass(frozen=True, eq=False)
class Motion:
    """A completed run of a method.

    Parameters
    ----------
    scene
        The scene.
    timestep
        The time step (s).
    method
        The method, as the key of a run over all cases and time steps.
    trajectory
        The states; the states of its `beginning` are sufficient.
    roundoff
        The unit roundoff of the engine's arithmetic, one of `scheme_rounding.ROUNDOFF`.
    exact
        The exact motion at the same instants, if motions that agree with it must not distinguish methods: with small time
        steps, all accurate schemes agree with it.
    """

    scene: Scene
    timestep: float
    method: RunKey
    trajectory: Trajectory
    roundoff: float
    exact: Trajectory | None = None

    @cached_property
    def early(self) -> Trajectory:
        """The states in the time in which motions are compared."""
        return beginning(self.trajectory, self.timestep)

    @cached_property
    def allowed(self) -> Array:
        """The attitude differences (n,), in rad, that rounding can cause at the early instants.

        They are the sum of the differences for semi-implicit Euler, whose errors in the rates grow at least as fast as in the
        exact motion, and for the first turn of an attitude that is stored as a rotation vector.
        """
        grown = allowance(semi_implicit_euler, self.scene, self.timestep, self.early, self.roundoff)
        first = math.hypot(*self.scene.initial.angular_velocity) * self.timestep
        return grown + (FIRST_TURN_ROUNDINGS * self.roundoff / first if first else 0.0)

    @cached_property
    def tells(self) -> bool:
        """True if the scene distinguishes methods.

        A free flight does if the gyroscopic torque matters, and a motion on a plane if the body slides and spins.
        """
        if self.exact is not None:
            solution = Motion(self.scene, self.timestep, self.method, self.exact, self.roundoff)
            if _apartness(self, solution)[1] <= TELLING:
                return False
        if self.scene.plane is not None:
            return any(self.scene.initial.velocity) and any(self.scene.initial.angular_velocity)
        ends = tuple(steps(self.early, self.timestep).tolist())
        one, other = (
            sampled(scheme, world_velocity, self.scene, self.timestep, ends)
            for scheme in (semi_implicit_euler, rosenbrock_euler)
        )
        apart = geodesic_angle(one[:, 3:7], other[:, 3:7]) > TELLING * self.allowed
        return bool((apart & (self.allowed <= MOST_ROUNDING_RAD)).any())


@dataclass(frozen=True)
class MethodClass:
    """Methods that are the same algorithm.

    Parameters
    ----------
    methods
        The keys of the methods over all cases and time steps, in the order in which they were given.
    distance
        The largest difference of two of their motions: of attitudes in rad, and of positions, velocities and angular velocities
        as a fraction of the largest so far. It is 0 for a single method.
    """

    methods: tuple[RunKey, ...]
    distance: float


@dataclass(frozen=True)
class _Difference:
    """The difference between the motions of two methods.

    Attributes
    ----------
    distance
        The largest difference, as in `MethodClass`.
    ratio
        The largest ratio of a difference to the possible effect of rounding.
    roundoff
        The coarser unit roundoff of the two methods.
    told
        Whether any scene distinguishes methods.
    """

    distance: float
    ratio: float
    roundoff: float
    told: bool

    @property
    def agrees(self) -> bool:
        return self.told and self.ratio <= 1

    def and_in(self, other: "_Difference") -> "_Difference":
        """Return the difference of the same two methods over further scenes."""
        return _Difference(
            max(self.distance, other.distance), max(self.ratio, other.ratio), self.roundoff, self.told or other.told
        )


def beginning(trajectory: Trajectory, timestep: float) -> Trajectory:
    """Return the states of a trajectory in the time in which motions with a time step (s) are compared."""
    return trajectory.part((trajectory.t <= EARLY_S) & (steps(trajectory, timestep) <= EARLY_STEPS))


def classes(motions: Iterable[Motion]) -> tuple[MethodClass, ...]:
    """Return the classes of methods, from their motions in scenes of one kind.

    Two methods agree if their motions agree in every scene and at every time step with which both were run, and one of these
    scenes distinguishes methods. The classes are the connected components of the methods that agree. A method in single
    precision can agree with two methods in double precision that do not agree with each other: methods of finer precision are
    therefore joined first, and never through a method of coarser precision. A method of coarser precision joins the largest
    class that it agrees with. A method that agrees with no other has a class of its own; a method that was run only in scenes
    that do not distinguish methods has none.

    Parameters
    ----------
    motions
        The completed runs. Runs of the same scene with the same time step have the same instants.
    """
    given = list(motions)
    pairs = _differences(given)
    agreeing = {pair: difference for pair, difference in pairs.items() if difference.agrees}
    components = _joined({motion.method: motion.roundoff for motion in given if motion.tells}, agreeing)
    return tuple(
        MethodClass(
            tuple(component), max((pairs[pair].distance for pair in combinations(component, 2) if pair in pairs), default=0.0)
        )
        for component in components
    )


def _differences(motions: Sequence[Motion]) -> dict[tuple[RunKey, RunKey], _Difference]:
    """Return the largest differences of all pairs of methods that were run together, in the order of the motions."""
    places = {method: index for index, method in enumerate(dict.fromkeys(motion.method for motion in motions))}
    differences: dict[tuple[RunKey, RunKey], _Difference] = {}
    for together in _together(motions):
        for one, other in combinations(sorted(together, key=lambda motion: places[motion.method]), 2):
            pair, new = (one.method, other.method), _difference(one, other)
            differences[pair] = differences.get(pair, new).and_in(new)
    return differences


def _together(motions: Sequence[Motion]) -> Iterator[list[Motion]]:
    """Yield the motions grouped by scene and time step."""
    groups: dict[tuple[Scene, float], list[Motion]] = defaultdict(list)
    for motion in motions:
        groups[motion.scene, motion.timestep].append(motion)
    yield from groups.values()


def _difference(one: Motion, other: Motion) -> _Difference:
    return _Difference(*_apartness(one, other), max(one.roundoff, other.roundoff), one.tells and other.tells)


@np.errstate(all="ignore")  # a damaged folder may contain invalid states, which differ from all others
def _apartness(one: Motion, other: Motion) -> tuple[float, float]:
    """Return the largest difference of two motions, and its largest ratio to the possible effect of rounding."""
    coarser = max(one.roundoff, other.roundoff)
    allowed = np.maximum(one.allowed * (coarser / one.roundoff), other.allowed * (coarser / other.roundoff))
    compared = allowed <= MOST_ROUNDING_RAD
    mine, theirs, limit = one.early.part(compared), other.early.part(compared), allowed[compared]
    largest, ratio = 0.0, 0.0
    for apart, size, most in (
        (geodesic_angle(normalise(mine.quaternion), normalise(theirs.quaternion)), np.ones(len(limit)), limit),
        _apart(mine.angular_velocity, theirs.angular_velocity, limit),
        _apart(mine.velocity, theirs.velocity, limit),
        _apart_in_place(one, mine, theirs, limit, coarser),
    ):
        largest = max(largest, _largest_quotient(apart, size))
        ratio = max(ratio, _largest_quotient(apart, most))
    return largest, ratio


def _apart(mine: Array, theirs: Array, limit: Array) -> tuple[Array, Array, Array]:
    """Return the differences (n,) of vectors (n, 3), the largest length so far (n,), and the effect of rounding (n,)."""
    size = np.maximum.accumulate(np.maximum(*(np.linalg.norm(vectors, axis=1) for vectors in (mine, theirs))))
    return distance(mine, theirs), size, limit * size


def _apart_in_place(
    one: Motion, mine: Trajectory, theirs: Trajectory, limit: Array, roundoff: float
) -> tuple[Array, Array, Array]:
    """Return the same as `_apart` for positions, whose rounding also grows with the distance travelled."""
    most = np.maximum(*(in_position(limit, trajectory, one.timestep, roundoff) for trajectory in (mine, theirs)))
    apart, size, _ = _apart(mine.position, theirs.position, limit)
    return apart, size, most


def _largest_quotient(values: Array, limits: Array) -> float:
    """Return the largest quotient of values (n,) and limits (n,); the quotient of a zero value is 0."""
    if not np.isfinite(values).all():
        return np.inf
    with np.errstate(divide="ignore"):
        quotients = np.divide(values, limits, out=np.zeros_like(values), where=values > 0)
    return float(quotients.max(initial=0.0))


def _joined(methods: Mapping[RunKey, float], agreeing: Mapping[tuple[RunKey, RunKey], _Difference]) -> list[list[RunKey]]:
    """Return the connected components of methods, and the methods in each, in the order in which the methods are given.

    Pairs of finer precision are joined first. A pair does not join two components that both contain methods of finer precision,
    because these were compared more precisely. If a method agrees with several components, it joins the largest.

    Parameters
    ----------
    methods
        The unit roundoff of each method.
    agreeing
        The differences of the pairs of methods that agree.
    """
    component = {method: [method] for method in methods}
    for roundoff in sorted({difference.roundoff for difference in agreeing.values()}):
        size = {method: len(members) for method, members in component.items()}
        pairs = [pair for pair, difference in agreeing.items() if difference.roundoff == roundoff]
        for one, other in sorted(pairs, key=lambda pair: (-max(size[pair[0]], size[pair[1]]), agreeing[pair].ratio)):
            mine, theirs = component[one], component[other]
            finer = all(min(methods[method] for method in members) < roundoff for members in (mine, theirs))
            if mine is not theirs and not finer:
                mine += theirs
                component |= dict.fromkeys(theirs, mine)
    order = list(methods)
    return [sorted(members, key=order.index) for members in {id(members): members for members in component.values()}.values()]
