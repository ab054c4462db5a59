"""Prove how far a printed motion is from the exact one, from balls that contain the exact states."""

import time
from bisect import bisect_left
from fractions import Fraction

import numpy as np
from flint import arb

from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.mechanisms.coordinates import JointMotion
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.proof import bodies, drag, free_body, one_joint, tops
from bodycheck.reference.proof.balls import (
    Ball,
    Matrix,
    Triple,
    angle_between,
    ball,
    distance,
    lower,
    of_doubles,
    precision,
    triple,
    upper,
    vector_sum,
)
from bodycheck.reference.proof.contact.scenes import touching
from bodycheck.reference.proof.enclosure import CONSERVED, COORDINATES, QUANTITIES, Enclosure, Interval, NotEnclosed
from bodycheck.reference.proof.energies import Conserved, conserved
from bodycheck.reference.proof.motions import CLOSED_FORM, Motion, Shown, States
from bodycheck.reference.proof.trees import rest, validated
from bodycheck.reference.proof.trees.dynamics import joint_states, poses
from bodycheck.reference.proof.trees.polynomials import Candidate
from bodycheck.reference.proof.trees.tree import tree_of
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array, Trajectory

#: The precisions (bits) that are tried in turn, and the radius of balls that is small enough (rad, m and the like).
BITS, SMALL = (96, 128, 192, 256, 384, 512), 2.0**-60

#: The precisions that are tried for trees, and the largest number of their links: the candidate of more takes minutes.
BITS_OF_TREES, MOST_LINKS = (144, 208, 288), 8

#: The time (s) that is followed where a tree is asked for at t = 0 alone.
INSTANT = Fraction(1, 1024)

#: The time limit of a proof (s).
TIME_LIMIT_S = 60.0


def enclosed(
    scene: AnyScene,
    printed: Trajectory,
    joints: JointMotion | None = None,
    candidate: Candidate | None = None,
    limit: float = TIME_LIMIT_S,
) -> Enclosure:
    """Return the enclosure of the motion of a scene at the instants of a printed trajectory.

    Parameters
    ----------
    scene, printed, joints
        The scene, its printed states, and of a mechanism the printed coordinates of joints and their velocities.
    candidate
        A function that returns coordinates near to those of the motion of a tree. It may come from anywhere, as the proof does
        not believe it.
    limit
        The time (s) after which the motion of a tree is enclosed until an earlier instant.

    Raises
    ------
    NotEnclosed
        There is no proof of this motion.
    """
    begin, busy = time.perf_counter(), time.process_time()
    if isinstance(scene, Mechanism) and (not scene.joints or tops.on_ball_joint(scene)):
        joints = None  # the attitude of a body on a ball joint is its coordinate
    reason = NotEnclosed("balls that are too large")
    closed = not isinstance(scene, Mechanism) or not scene.joints or one_joint.has_closed_form(scene)
    tried = BITS if closed else BITS_OF_TREES
    best: Enclosure | None = None
    for bits in tried:
        if bits > tried[0] and time.perf_counter() > begin + limit:
            break
        with precision(bits):
            try:
                motion = _motion(scene, printed, joints, candidate, bits, begin + limit)
                compared = _compared(motion, printed, joints, conserved(scene))
                until = compared[3]
                events = _events(motion, float(printed.t[-1]) if until is None else until)
            except NotEnclosed as error:
                reason = error
                continue
        enclosure = Enclosure(motion.way, bits, *compared, time.process_time() - busy, events)
        if enclosure.until is None:
            return enclosure
        if best is None or best.until is None or enclosure.until > best.until:
            best = enclosure
    if best is None:
        raise reason
    return best


def _motion(
    scene: AnyScene, printed: Trajectory, joints: JointMotion | None, candidate: Candidate | None, bits: int, deadline: float
) -> Motion:
    """The motion of a scene in balls."""
    if scene.plane is not None or (isinstance(scene, Mechanism) and scene.contacts):
        return touching(scene)
    if isinstance(scene, Mechanism):
        if tops.on_ball_joint(scene):
            of_top = tops.states(scene)
            return Motion("Taylor series with Cauchy's bound", lambda t: Shown([], [], [of_top(t)]))
        if not one_joint.has_closed_form(scene):
            return _tree(scene, printed, joints, candidate, bits, deadline)
        of_joint = one_joint.states(scene)

        def at(t: Fraction) -> Shown:
            (q, v), *states = of_joint(t)
            return Shown([q], [v], [tuple(states)])  # type: ignore[list-item]

        return Motion(CLOSED_FORM, at)
    if scene.pushes:
        raise NotEnclosed("pushes")
    return Motion(CLOSED_FORM, _flight(scene))


def _tree(
    mechanism: Mechanism,
    printed: Trajectory,
    joints: JointMotion | None,
    candidate: Candidate | None,
    bits: int,
    deadline: float,
) -> Motion:
    """The motion of a tree, by a polynomial near to a candidate for it."""
    count = joints.position.shape[1] if joints else 0
    if any(joint.friction for joint in mechanism.joints):
        return _held(mechanism, count)
    tree = tree_of(mechanism)
    if len(tree.links) > MOST_LINKS:
        raise NotEnclosed(f"a tree of more than {MOST_LINKS} links")
    if candidate is None:
        raise NotEnclosed("a tree, whose candidate needs heyoka, which is not installed")
    end = Fraction(float(printed.t[-1])) or INSTANT

    def ordered(times: Array, digits: int) -> list[list[Ball]]:
        try:
            rows = candidate(times, digits)
        except OutOfReach:
            raise NotEnclosed("a tree that is followed in too many steps") from None
        return [[row[column] for column in tree.columns] for row in rows]

    steps = validated.steps(tree, end, ordered, bits, deadline)
    if not steps:
        raise NotEnclosed("a tree whose errors grow at once")
    ends = [step.end for step in steps]

    def at(t: Fraction) -> Shown:
        q, v = steps[bisect_left(ends, t)].at(t)
        return Shown(*joint_states(tree, q, v, count), poses(tree, q, v))

    way = f"validated polynomials of degree {steps[0].part.motion[0].degree()}, {len(steps)} steps"
    return Motion(way, at, None if ends[-1] >= end else ends[-1])


def _held(mechanism: Mechanism, count: int) -> Motion:
    """The rest of a tree that dry friction holds; its method names the joints that need all of it. count: of coordinates."""
    tree, q, at_limit = rest.held(mechanism)
    still = [arb(0)] * tree.size
    shown = Shown(*joint_states(tree, q, still, count), poses(tree, q, still))
    limit = f", which is just enough at {' and '.join(at_limit)}" if at_limit else ""
    return Motion(f"rest that dry friction holds{limit}", lambda t: shown)


def _flight(scene: Scene) -> States:
    rotation = free_body.rotation(bodies.rotor(scene))
    begin, (u, v, w), gravity = triple(scene.initial.position), triple(scene.initial.velocity), ball(scene.gravity)

    def falling(t: Fraction) -> tuple[Triple, Triple]:
        time = ball(t)
        return (u * time, v * time, w * time - gravity * time * time / 2), (u, v, w - gravity * time)

    ratio = Fraction(scene.drag) / Fraction(scene.body.mass)
    speeds = tuple(map(Fraction, scene.initial.velocity))
    flying = drag.flight(speeds, ratio, Fraction(scene.gravity)) if scene.drag else falling

    def at(t: Fraction) -> Shown:
        attitude, rates = rotation(t)
        way, velocity = flying(t)
        return Shown([], [], [(vector_sum(begin, way), attitude, velocity, rates)])

    return at


def _compared(
    motion: Motion, printed: Trajectory, joints: JointMotion | None, kept: Conserved
) -> tuple[float, dict[str, Array], dict[str, Array], float | None, str]:
    """The largest radius of a ball, bounds of the distances of the printed states from above and below, and their last instant.

    The last instant is None if all balls are small; otherwise there is the reason why it is the last one.
    """
    count = len(printed.t)
    farthest, nearest = ({name: np.full(count, np.nan) for name in (*QUANTITIES, *CONSERVED)} for _ in range(2))
    if joints is not None:
        shapes = zip(COORDINATES, (joints.position.shape, joints.velocity.shape), strict=True)
        for name, shape in shapes:
            farthest[name], nearest[name] = np.full(shape, np.nan), np.full(shape, np.nan)
    largest, until, reason = 0.0, None, ""
    for row, instant in enumerate(printed.t.tolist()):
        if np.isnan(printed.position[..., row, :]).any():  # mechanics determines no motion there
            continue
        try:
            shown = _small(motion, Fraction(instant))
        except NotEnclosed as ended:
            if row <= 1:  # an initial state alone is no motion
                raise
            until, reason = float(printed.t[row - 1]), str(ended)
            break
        largest = max(largest, shown.radius)
        for name, values in _distances(shown, _printed(printed, joints, row), kept).items():
            high, low = list(map(upper, values)), list(map(lower, values))
            farthest[name][row], nearest[name][row] = (high, low) if name in COORDINATES else (max(high), max(low))
    return largest, farthest, nearest, until, reason


def _small(motion: Motion, instant: Fraction) -> Shown:
    """The states at an instant (s). Raises `NotEnclosed` if their balls are too large, or if the motion ends before."""
    if motion.until is not None and instant > motion.until:
        raise NotEnclosed("a tree whose errors grow too much, or that needs too long")
    shown = motion.states(instant)
    if not shown.radius <= SMALL:
        raise NotEnclosed("balls that are too large")
    return shown


def _events(motion: Motion, until: float) -> tuple[Interval, ...] | None:
    """The events of a motion until an instant (s); None if it has none by its kind."""
    if motion.changes is None:
        return None
    changes = motion.changes(Fraction(until))
    return tuple(Interval(change.kind, change.body, lower(change.time), upper(change.time)) for change in changes)


def _printed(printed: Trajectory, joints: JointMotion | None, row: int) -> Shown:
    """The printed states at an instant, which is given by its row, as exact numbers."""
    several = [printed] if printed.position.ndim == 2 else [printed.body(index) for index in range(len(printed.position))]
    bodies: list[tuple[Triple, Matrix, Triple, Triple]] = []
    for body in several:
        position, velocity, rates = map(_exact, (body.position[row], body.velocity[row], body.angular_velocity[row]))
        bodies.append((position, of_doubles(body.quaternion[row].tolist()), velocity, rates))
    if joints is None:
        return Shown([], [], bodies)
    return Shown(list(map(arb, joints.position[row].tolist())), list(map(arb, joints.velocity[row].tolist())), bodies)


def _exact(values: Array) -> Triple:
    """Three doubles as balls, which are exact."""
    x, y, z = map(arb, values.tolist())
    return x, y, z


def _distances(shown: Shown, printed: Shown, kept: Conserved) -> dict[str, list[Ball]]:
    """The distances of printed states from the exact ones, of each body and coordinate, and of all bodies together."""
    distances: dict[str, list[Ball]] = {name: [] for name in QUANTITIES}
    for (position, attitude, velocity, rates), other in zip(shown.bodies, printed.bodies, strict=True):
        distances["error"].append(angle_between(attitude, other[1]))
        distances["position_error"].append(distance(position, other[0]))
        distances["velocity_error"].append(distance(velocity, other[2]))
        distances["angular_velocity_error"].append(distance(rates, other[3]))
    (energy, momentum), (of_printed, other_momentum) = kept(shown), kept(printed)
    distances |= {"energy_error": [abs(energy - of_printed)], "angular_momentum_error": [distance(momentum, other_momentum)]}
    if printed.position:
        pairs = ((shown.position, printed.position), (shown.velocity, printed.velocity))
        for name, (one, other_values) in zip(COORDINATES, pairs, strict=True):
            distances[name] = [abs(a - b) for a, b in zip(one, other_values, strict=True)]
    return distances
