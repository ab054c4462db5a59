"""Tolerances for differences that rounding alone can cause between two machines that run the same versions.

Processors and mathematical libraries round differently. In a run of n steps, every number is rounded at least n times with the
relative error u = 2^-53 (2^-24 in single precision). Random errors add up to sqrt(n) u, systematic ones to n u. The motion
amplifies them, for example by thousands in ten seconds of a flip. To measure the amplification, the run is repeated from
initial states that are nudged by sqrt(n) u, and the resulting change of a figure is its spread. The method works for contacts
and iterative solvers as well as for free flight.

The tolerance of a figure that is the difference of two numbers of size S is `MARGIN` (spread + n u S), plus the truth's error.
"""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

import numpy as np

from bodycheck.casefile.content import Case
from bodycheck.figures.columns import FIGURES, truth_bounds
from bodycheck.figures.scales import in_run, largest
from bodycheck.judging.discrepancy import compare
from bodycheck.reference.kinematics import multiply, normalise
from bodycheck.reference.mechanisms import exact, kinematics
from bodycheck.reference.mechanisms.coordinates import places
from bodycheck.reference.mechanisms.mechanism import AnyScene, BodyStart, Joint, JointedBody, Mechanism
from bodycheck.reference.requirements import touches
from bodycheck.reference.scene import Plane, State, Vector, vector_of
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truths import Truth
from bodycheck.results.outcome import Completed, Run

Change = Callable[[Vector], Vector]

#: Number of runs with nudged initial states.
NUDGES = 4

#: Factor for several roundings per step and the small number of nudged runs.
#:
#: With this factor, the differences between the engines' builds for x86-64 and aarch64 are at most half of the tolerance, over
#: all shipped cases.
MARGIN = 8.0


def nudged_mechanism(mechanism: Mechanism, trajectory: Trajectory, amount: float, random: np.random.Generator) -> Mechanism:
    """Return a mechanism with slightly changed initial states of its joints and free bodies.

    Parameters
    ----------
    mechanism, trajectory
        The mechanism, and a run of it.
    amount
        The size of the nudges, relative to the largest values in the run; for attitudes, in units of 0.5 rad.
    random
        The generator of random directions.
    """
    motion = kinematics.joints(mechanism, trajectory)
    most, fastest = (np.abs(values).max(axis=0, initial=0.0) for values in (motion.position, motion.velocity))
    joints = (
        _joint(joint, amount * most[held], amount * fastest[moving], amount / 2, random)
        for joint, (held, moving) in zip(mechanism.joints, places(mechanism), strict=True)
    )
    bodies = (_body(body, trajectory.body(index), amount, random) for index, body in enumerate(mechanism.bodies))
    return replace(mechanism, joints=tuple(joints), bodies=tuple(bodies))


def _joint(joint: Joint, apart: Array, rates: Array, turn: float, random: np.random.Generator) -> Joint:
    """Return a joint with nudged initial values. apart, rates: sizes of the nudges; turn: size for a quaternion (rad)."""
    start = np.array(joint.start) + random.choice([-1.0, 1.0], len(apart)) * apart
    if joint.type in ("spherical", "free"):
        start[-4:] = multiply(np.array(joint.start[-4:]), _turned(turn, random))
    velocity = np.array(joint.start_velocity) + random.choice([-1.0, 1.0], len(rates)) * rates
    return replace(joint, start=tuple(start.tolist()), start_velocity=tuple(velocity.tolist()))


def _body(body: JointedBody, states: Trajectory, amount: float, random: np.random.Generator) -> JointedBody:
    """Return a free body with a nudged initial state; return any other body unchanged."""
    if body.start is None:
        return body
    start = body.start

    def beside(given: Vector, size: float) -> Vector:
        direction = random.normal(size=3)
        return vector_of(np.array(given) + amount * size * direction / np.linalg.norm(direction))

    rates = vector_of(exact.rates(start.attitude, start.rotation))
    w, x, y, z = multiply(np.array(exact.nearest_turn(start.attitude)), _turned(amount / 2, random)).tolist()
    moved = BodyStart(
        beside(start.position, largest(states.position)),
        (w, x, y, z),
        beside(start.velocity, largest(states.velocity)),
        beside(rates, largest(states.angular_velocity)),
    )
    return replace(body, start=moved)


def _turned(angle: float, random: np.random.Generator) -> Array:
    """Return the quaternion of a turn by a small angle (rad) about a random axis."""
    axis = random.normal(size=3)
    return np.concatenate([[1.0], angle / 2 * axis / np.linalg.norm(axis)])


def nudged_contacts(scene: AnyScene, trajectory: Trajectory, amount: float, random: np.random.Generator) -> AnyScene:
    """Return a scene of bodies in contact with slightly moved initial positions, and slightly higher or lower velocities.

    Parameters
    ----------
    scene, trajectory
        The scene, and a run of it.
    amount
        The size of the nudges, relative to the largest values in the run.
    random
        The generator of random directions.
    """
    along = _direction(scene.plane, random) * amount * largest(trajectory.position)
    faster = 1.0 + amount * random.choice([-1.0, 1.0])

    def beside(position: Vector) -> Vector:
        return vector_of(np.array(position) + along)

    def scaled(velocity: Vector) -> Vector:
        return vector_of(faster * np.array(velocity))

    if isinstance(scene, Mechanism):
        return replace(scene, bodies=tuple(_changed_body(body, beside, scaled) for body in scene.bodies))
    start = scene.initial
    moved = replace(
        start,
        position=beside(start.position),
        velocity=scaled(start.velocity),
        angular_velocity=scaled(start.angular_velocity),
    )
    return replace(scene, initial=moved)


def _direction(plane: Plane | None, random: np.random.Generator) -> Array:
    """Return a random unit vector along the plane, or in any direction if there is none."""
    if plane is None:
        anywhere = random.normal(size=3)
        return np.asarray(anywhere / np.linalg.norm(anywhere))
    angle, downhill = random.uniform(0.0, 2 * np.pi), np.array([np.cos(plane.incline), 0.0, -np.sin(plane.incline)])
    direction: Array = np.cos(angle) * downhill + np.sin(angle) * np.array([0.0, 1.0, 0.0])
    return direction


def _changed_body(body: JointedBody, beside: Change, scaled: Change) -> JointedBody:
    start = BodyStart() if body.start is None else body.start
    rates = vector_of(exact.rates(start.attitude, start.rotation))
    moved = replace(start, position=beside(start.position), velocity=scaled(start.velocity), rotation=scaled(rates))
    return replace(body, start=moved)


def nudged(case: Case, run: Run, seed: int) -> Case:
    """Return a case whose initial state is moved in random directions by the expected rounding error of a run.

    Each part of the state is moved relative to its largest absolute value in the run. On a plane the body stays flat. In a
    mechanism, each coordinate and velocity of a joint and each part of the state of a free body is moved. Bodies in contact are
    moved together, along the plane if there is one.

    Parameters
    ----------
    case
        The case.
    run
        A completed run of the case.
    seed
        The seed of the random directions.
    """
    assert isinstance(run.outcome, Completed)
    random = np.random.default_rng(seed)
    trajectory, scene = run.outcome.trajectory, case.scene
    amount = _unit_of_rounding(trajectory) * math.sqrt(run.outcome.steps)
    if touches(scene):
        return replace(case, scene=nudged_contacts(scene, trajectory, amount, random), expectations=())
    if isinstance(scene, Mechanism):
        return replace(case, scene=nudged_mechanism(scene, trajectory, amount, random), expectations=())
    initial = scene.initial
    within, about = (slice(0, 3), slice(0, 3)) if scene.plane is None else (slice(0, 2), slice(2, 3))

    def step(part: slice, size: float) -> Array:
        direction = np.zeros(3)
        direction[part] = random.normal(size=part.stop - part.start)
        return amount * size * direction / np.linalg.norm(direction)

    turn = multiply(np.concatenate([[1.0], step(about, 0.5)]), np.array(initial.quaternion))
    w, x, y, z = normalise(turn).tolist()
    state = State(
        vector_of(np.array(initial.position) + step(within, largest(trajectory.position))),
        (w, x, y, z),
        vector_of(np.array(initial.velocity) + step(within, largest(trajectory.velocity))),
        vector_of(np.array(initial.angular_velocity) + step(about, largest(trajectory.angular_velocity))),
    )
    return replace(case, scene=replace(scene, initial=state), expectations=())


def allowances(truth: Truth, run: Run, others: Sequence[Run]) -> dict[str, float]:
    """Return the tolerance of each figure of a completed run between machines, by its column.

    Parameters
    ----------
    truth
        The truth of the case.
    run
        The run.
    others
        The runs with nudged initial states. If one of them lacks a figure, the tolerance of the figure is infinite.
    """
    moved = [compare(truth, other).maxima() if isinstance(other.outcome, Completed) else {} for other in others]
    figures = compare(truth, run).maxima()
    allowed = {}
    for name, least in unamplified(truth, run, figures).items():
        spread = max((abs(other.get(name, math.inf) - figures[name]) for other in moved), default=math.inf)
        allowed[name] = MARGIN * spread + least
    return allowed


def unamplified(truth: Truth, run: Run, names: Iterable[str]) -> dict[str, float]:
    """Return the tolerances of a completed run's figures, by column, without amplification of rounding by the motion.

    Parameters
    ----------
    truth
        The truth of the case.
    run
        The run.
    names
        The columns of the figures.
    """
    assert isinstance(run.outcome, Completed)
    trajectory = run.outcome.trajectory
    all_one_way = run.outcome.steps * _unit_of_rounding(trajectory)
    bounds, scales = truth_bounds(truth), in_run(truth, trajectory)
    differences = {}
    for name in names:
        bound = float(np.fmax.reduce(bounds[name])) if name in bounds else 0.0
        differences[name] = MARGIN * all_one_way * FIGURES[name].scale(scales) + bound
    return differences


def _unit_of_rounding(trajectory: Trajectory) -> float:
    """Return the unit roundoff of the precision in which the engine seems to keep its states."""
    parts = (trajectory.position, trajectory.quaternion, trajectory.velocity, trajectory.angular_velocity)
    states = np.concatenate(parts, axis=-1)
    with np.errstate(over="ignore"):
        single = np.array_equal(states.astype(np.float32), states)
    return 2.0**-24 if single else 2.0**-53
