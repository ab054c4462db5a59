"""The motion of a mechanism with loops, in two ways that share numerical tools only.

The way uses the mass matrix in joint coordinates with multipliers for the loops (`joint_space`), the witness Newton's and
Euler's equations of every body with constraint forces (`body_space`). In a singular position the multipliers have minimum norm,
and the motion continues analytically: a step has no node at that instant, and its series converges across it.
"""

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from bodycheck.reference.bounds import STATES
from bodycheck.reference.errors import NotModelled
from bodycheck.reference.exact.pairs import WideArray
from bodycheck.reference.integration.collocation import integrate
from bodycheck.reference.mechanisms.coordinates import places
from bodycheck.reference.mechanisms.kinematics import joints
from bodycheck.reference.mechanisms.loops import body_equations, body_space, driven, joint_space
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.mechanisms.ways import Motion, Way
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.witness import DOUBLE_DIGITS
from bodycheck.reference.witnesses import EXTENDED_DIGITS

#: The names of the ways in results.
NAME, WITNESS = "joint coordinates with multipliers", "Newton-Euler of every body"

#: The name of the solver in results.
SOLVER = "Gauss-Legendre collocation"

#: The factor by which errors of the steps may grow.
CAUTION = 8.0

#: The number of nodes of a step.
STAGES = 28

#: The approximate time (s) that a way may take. The time of an evaluation of its equations was measured on one core.
MOST_SECONDS = 10.0

#: The tolerances of the way and of the witness, whose disagreements matter above some 1e-13.
TOLERANCE, WITNESS_TOLERANCE = 1e-17, 1e-15


def way(mechanism: Mechanism, times: Array) -> Way:
    """The motion at ascending times (n,) >= 0, s, in joint coordinates, with bounds of its errors.

    The bounds hold if errors do not grow by more than `CAUTION`; the comparison with the witness shows whether they do.

    Raises `NotModelled` if the mechanism has dry friction, and `OutOfReach` if the motion cannot be followed.
    """
    if any(joint.friction for joint in mechanism.joints):
        raise NotModelled("dry friction in a mechanism with loops", "dry friction")
    tree, start = joint_space.tree(mechanism), joint_space.initial(mechanism)
    how: dict[str, Any] = {
        "stages": STAGES,
        "tolerance": TOLERANCE,
        "most": int(MOST_SECONDS / (0.0006 * len(tree.elements))),
        "first": _first(joint_space.derivatives(tree, start[None])[0, tree.coordinates :], start[tree.coordinates :]),
    }
    if mechanism.controllers:
        solution = driven.integrated(mechanism, tree, start, times, **how)
    else:
        corrected = partial(joint_space.close_loops, tree)
        solution = integrate(partial(joint_space.derivatives, tree), start, times, corrected=corrected, **how)
    held, moving = joint_space.joint_sizes(mechanism)
    states: tuple[Any, ...] = joint_space.bodies(tree, solution.states)
    bodies = Trajectory(times, *states)
    motion = Motion(solution.states[:, :held], solution.states[:, tree.coordinates : tree.coordinates + moving], bodies)
    # Loops that are open at the start by rounding can be closed in several ways.
    gap, rate = (float(value[0]) for value in joint_space.gaps(tree, start[None]))
    errors = CAUTION * (solution.errors + gap + rate * (1 + times))
    return Way(f"{NAME}, {SOLVER}", motion, dict.fromkeys(STATES, errors), EXTENDED_DIGITS)


def witness(mechanism: Mechanism, times: Array) -> Way:
    """The motion at ascending times (n,) >= 0, s, in the coordinates of every body.

    The coordinates of the joints are computed from the poses in double precision.

    Raises `NotModelled` if the mechanism has dry friction, controllers, or a point mass that turns, and `OutOfReach` if the
    motion cannot be followed.
    """
    if mechanism.controllers:
        raise NotModelled("controllers in the coordinates of every body")
    system, start = body_space.system(mechanism), body_space.initial(mechanism)
    bodies = len(system.mass)
    moving = slice(7 * bodies, 13 * bodies)
    rates = body_equations.derivatives(system, start[None])[0, moving]
    solution = integrate(
        lambda values: body_equations.derivatives(system, values),
        start,
        times,
        stages=STAGES,
        most=int(MOST_SECONDS / (0.0007 * bodies**2)),
        tolerance=WITNESS_TOLERANCE,
        first=_first(rates, start[moving]),
    )
    end = body_equations.unpacked(system, solution.states)
    length = np.sqrt((end.quaternion * end.quaternion).sum(axis=-1, keepdims=True))
    states: tuple[Any, ...] = (end.position, end.quaternion / length, end.velocity, end.rates)
    parts: tuple[Any, ...] = tuple(np.swapaxes(part, 0, 1) for part in states)
    wide = Trajectory(times, *parts)
    narrow = (wide.position, wide.quaternion, wide.velocity, wide.angular_velocity)
    held = joints(mechanism, Trajectory(times, *(part.astype(np.float64) for part in narrow)))
    return Way(f"{WITNESS}, {SOLVER}", Motion(held.position, held.velocity, wide), {}, DOUBLE_DIGITS)


def closed_start(mechanism: Mechanism) -> Mechanism:
    """The mechanism, with initial values that close its loops, which must be almost closed. It has no free bodies."""
    tree = joint_space.tree(mechanism)
    state = joint_space.close_loops(tree, joint_space.initial(mechanism)).astype(float)
    joints = tuple(
        replace(joint, start=tuple(state[held].tolist()), start_velocity=tuple(state[tree.coordinates :][moving].tolist()))
        for joint, (held, moving) in zip(mechanism.joints, places(mechanism), strict=True)
    )
    return replace(mechanism, joints=joints)


def _first(accelerations: WideArray, velocities: WideArray) -> float:
    """The length of the first step (s): a part of the time in which the motion changes."""
    rate = float(np.abs(velocities).max(initial=0) + np.sqrt(np.abs(accelerations).max(initial=0)))
    return 0.1 / rate if rate else 0.1
