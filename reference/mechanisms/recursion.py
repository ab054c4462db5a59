"""The motion of a mechanism without loops: the articulated-body recursion, integrated in a floating-point type.

If heyoka is installed, it integrates the equations by Taylor's method in any type; otherwise SciPy's DOP853 integrates them in
double precision.
"""

import functools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bodycheck.reference.errors import NotModelled, OutOfReach
from bodycheck.reference.exact.numbers import FloatType, WideArray
from bodycheck.reference.integration import dop853
from bodycheck.reference.kinematics import normalise
from bodycheck.reference.mechanisms import exact, poses
from bodycheck.reference.mechanisms.articulation import articulated
from bodycheck.reference.mechanisms.link_states import (
    Change,
    Course,
    Critical,
    Decision,
    LinkStates,
    derivatives,
    in_arithmetic,
    links_of,
    split,
    start,
)
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.mechanisms.tree import Tree, forest
from bodycheck.reference.trajectory import Array, Trajectory

#: The numbers of evenly spaced instants at which pivots of the mass matrix are computed, and of those around the smallest one.
INSTANTS, AROUND = 257, 17

#: The number of rounds in which a pivot is sought that is zero, and the pivots, relative to their largest values in the motion,
#: below which more are computed around them, below which they are zero, and below which they may have stopped an integration.
ROUNDS, NEAR, ZERO, SMALL = 10, 1e-2, 1e-12, 1e-6

#: A function that follows the links of a tree at times in any order.
Solver = Callable[[Tree, WideArray, FloatType], Course]


@dataclass(frozen=True, eq=False)
class JointStates:
    """The motion of a mechanism at n instants in a floating-point type that may be wider than double precision.

    Attributes
    ----------
    position, velocity
        (n, c) coordinates and (n, u) velocities of the joints, in the layout of `coordinates`. Angles are not reduced.
    bodies
        The states of all bodies, including free bodies: arrays (b, n, ...) of the same type.
    changes
        The changes in which joints with dry friction began and ceased to slip, up to the last instant.
    decisions
        The decisions which joints stick.
    criticals
        What errors may change altogether in trees with controllers and stops.
    """

    position: WideArray
    velocity: WideArray
    bodies: Trajectory
    changes: tuple[Change, ...] = ()
    decisions: tuple[Decision, ...] = ()
    criticals: tuple[Critical, ...] = ()


def follow(mechanism: Mechanism, times: Array, dtype: Any = np.longdouble, bits: int | None = None) -> JointStates:
    """The motion of a mechanism without loops.

    Parameters
    ----------
    mechanism
        The mechanism.
    times
        (n,) times >= 0 in any order (s).
    dtype, bits
        The floating-point type: `np.float64`, `np.longdouble`, heyoka's `real128`, or heyoka's `real` with a mantissa of `bits`
        bits.

    Raises
    ------
    NotModelled
        If the mechanism has loops.
    OutOfReach
        If the integration fails or takes too many steps, or rounding leaves undecided which joints with dry friction stick.
        Without heyoka, also if a joint has dry friction.
    """
    if mechanism.loops:
        raise NotModelled("the recursion follows trees, and this mechanism has loops")
    kind, instants = FloatType(dtype, bits), np.asarray(times, dtype=float)
    courses = [solver()(tree, instants, kind) for tree in forest(mechanism).trees]
    return _of_courses(mechanism, courses, instants, kind)


def coordinates(mechanism: Mechanism, times: Array, dtype: Any = np.longdouble, bits: int | None = None) -> WideArray:
    """The coordinates (n, c) of the joints of a mechanism without loops, and those (n, 7) of each free body after them.

    The coordinates of a free body are the position of its centre of mass (m) and the quaternion of its attitude. The arguments
    and errors are those of `follow`.
    """
    kind, whole = FloatType(dtype, bits), forest(mechanism)
    states = [solver()(tree, times, kind).links for tree in whole.trees]
    free = [index for index, joint in enumerate(mechanism.joint_of) if joint is None]
    frames = []
    if free or any(joint.type == "free" for joint in mechanism.joints):
        links = [poses.link_frames(tree, each, len(times), kind) for tree, each in zip(whole.trees, states, strict=True)]
        frames = poses.body_frames(whole, links, len(times), kind)
    columns = [poses.joints(mechanism, whole, states, frames, len(times), kind)[0]]
    for index in free:
        centre = poses.centred(mechanism.bodies[index], frames[index], kind)
        columns += [centre.origin, normalise(centre.turn)]
    return np.concatenate(columns, axis=1)


def _of_courses(mechanism: Mechanism, courses: Sequence[Course], instants: Array, kind: FloatType) -> JointStates:
    """The motion of a mechanism from the motions of its trees at instants (n,), s."""
    states = joined(mechanism, [course.links for course in courses], instants, kind)
    changes = sorted((change for course in courses for change in course.changes), key=lambda change: float(change.time))
    decisions = tuple(decision for course in courses for decision in course.decisions)
    criticals = tuple(critical for course in courses for critical in course.criticals)
    return replace(states, changes=tuple(changes), decisions=decisions, criticals=criticals)


def joined(mechanism: Mechanism, states: list[list[LinkStates]], instants: Array, kind: FloatType) -> JointStates:
    """The motion of joints and bodies from the states of the links of trees at instants (n,), s."""
    whole, count = forest(mechanism), len(instants)
    links = [poses.link_frames(tree, tree_states, count, kind) for tree, tree_states in zip(whole.trees, states, strict=True)]
    frames = poses.body_frames(whole, links, count, kind)
    position, velocity = poses.joints(mechanism, whole, states, frames, count, kind)
    return JointStates(position, velocity, poses.bodies(mechanism, frames, instants, kind))


def require_regular(mechanism: Mechanism, duration: float, zero: float = ZERO) -> None:
    """Raise `OutOfReach` if the mass matrix of a mechanism without loops becomes singular within a duration (s).

    It can become singular only if a body has no mass, or no moment of inertia about some axis. Its pivots are computed in
    double precision, at evenly spaced instants, and at more and more of them around the smallest one.

    zero: the pivots, relative to their largest values in the motion, that count as zero.
    """
    if not any(exact.has_zero_moment(body) for body in mechanism.bodies):
        return
    for tree in forest(mechanism).trees:
        times, largest = np.linspace(0.0, duration, INSTANTS), np.zeros((1, 1))
        for _ in range(ROUNDS):
            pivots = _pivots(tree, times)
            largest = np.maximum(largest, pivots.max(axis=1, keepdims=True))
            relative = pivots / largest
            row, column = divmod(int(np.argmin(relative)), len(times))
            if not relative[row, column] > zero:
                raise OutOfReach(_undetermined(mechanism, tree, row, float(times[column])))
            if relative[row, column] > NEAR or not duration:
                break
            times = np.linspace(times[max(column - 1, 0)], times[min(column + 1, len(times) - 1)], AROUND)


def _pivots(tree: Tree, times: Array) -> Array:
    """The pivots (k, n) of the mass matrix of a tree at times (n,), s, in double precision."""
    form, links = in_arithmetic(tree, float), solver()(tree, times, FloatType(np.float64)).links
    moving = [
        replace(link, coordinates=list(state.coordinates.T), rates=list(state.rates.T))
        for link, state in zip(links_of(form, start(tree)), links, strict=True)
    ]
    with np.errstate(all="ignore"):
        pivots = articulated.accelerations(moving, form.gravity, np).pivots
    return np.stack([np.broadcast_to(np.asarray(each, float), times.shape) for row in pivots for each in row])


def _undetermined(mechanism: Mechanism, tree: Tree, row: int, time: float) -> str:
    """The sentence on a pivot that is zero. row: its index among the pivots of a tree."""
    links = [link for link in tree.links if link.follows is None for _ in articulated.FREEDOMS[link.kind]]
    joint = links[row].joint
    name = f"the joint {mechanism.joints[joint].name}" if joint >= 0 else "a free body"
    return (
        f"the mass matrix becomes singular at t = {time:.6g} s: what {name} moves has no inertia against it there while the "
        "joints behind it are loose"
    )


@functools.cache
def solver() -> Solver:
    """Return the solver of trees: Taylor's method where heyoka is installed, otherwise DOP853."""
    try:
        from bodycheck.reference.mechanisms import tree_equations
        from bodycheck.reference.mechanisms.friction import stick_slip
        from bodycheck.reference.mechanisms.hybrid import following
    except ImportError:
        return followed_by_dop853

    def followed_by_taylor(tree: Tree, times: WideArray, kind: FloatType) -> Course:
        if any(link.controller or link.stops for link in tree.links):
            return following.followed(tree, times, kind)
        dry = any(link.friction for link in tree.links)
        return stick_slip.followed(tree, times, kind) if dry else tree_equations.followed(tree, times, kind)

    return followed_by_taylor


def followed_by_dop853(tree: Tree, times: WideArray, kind: FloatType) -> Course:
    """The motion of the links of a tree at times (n,) >= 0, s, in any order, by SciPy's DOP853 in double precision.

    Raises
    ------
    OutOfReach
        If the integration fails or takes too many steps, or a joint has dry friction, a controller or stops.
    """
    if any(link.friction for link in tree.links):
        raise OutOfReach("joints with dry friction are followed by heyoka, which is not installed")
    if any(link.controller or link.stops for link in tree.links):
        raise OutOfReach("joints with controllers or stops are followed by heyoka, which is not installed")
    doubles = in_arithmetic(tree, float)

    def rates(_: float, state: Array) -> Array:
        return np.array(derivatives(doubles, state.tolist(), math).state, dtype=float)

    begin = np.array([float(value) for value in start(tree)])
    instants, rows = np.unique(times, return_inverse=True)
    # States in SI units are of the order of 1 or larger; a smaller scale would make steps needlessly short.
    states = dop853.solve(rates, begin, instants, np.maximum(np.abs(begin), 1.0))
    return Course(split(tree, states[rows].astype(kind.dtype), times, kind))
