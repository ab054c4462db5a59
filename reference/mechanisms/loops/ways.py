"""The motion of a mechanism with loops, in two ways that share numerical tools only.

The way is the mass matrix in joint coordinates with multipliers for the loops (`joint_space`), the witness Newton's and Euler's
equations of every body with constraint forces (`body_space`). Where a position is singular, the multipliers are those of minimum
norm, and the motion goes on as its analytic continuation: a step has no node there, and the series of a step does not end there.
"""

import numpy as np

from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.exact.pairs import WideArray
from bodycheck.reference.mechanisms.kinematics import joints
from bodycheck.reference.mechanisms.lagrangian.poses import WideMotion
from bodycheck.reference.mechanisms.loops import body_equations, body_space, joint_space
from bodycheck.reference.mechanisms.loops.collocation import integrate
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.trajectory import Array, Trajectory

#: The names of the ways in results.
NAME, WITNESS = "joint coordinates with multipliers", "Newton-Euler of every body"

#: Nodes of a step.
STAGES = 28

#: The tolerance of the witness: it is asked for disagreements above some 1e-13.
WITNESS_TOLERANCE = 1e-15


def follow(mechanism: Mechanism, times: Array) -> WideMotion:
    """The motion at ascending times (n,) >= 0, s.

    Loops that are open at the start by roundings are closed at the end of the first step.

    Raises `NotModelled` where the mechanism has dry friction, and `OutOfReach` where it cannot be followed.
    """
    tree, start = joint_space.tree(mechanism), joint_space.initial(mechanism)
    states = integrate(
        lambda values: joint_space.derivatives(tree, values),
        start,
        times,
        stages=STAGES,
        first=_first(joint_space.derivatives(tree, start[None])[0, tree.coordinates :], start[tree.coordinates :]),
        corrected=lambda state: joint_space.closed(tree, state),
    )
    held, moving = joint_space.of_joints(mechanism)
    found = joint_space.bodies(tree, states)
    return WideMotion(states[:, :held], states[:, tree.coordinates : tree.coordinates + moving], *found)


def witness(mechanism: Mechanism, times: Array) -> WideMotion:
    """The motion at ascending times (n,) >= 0, s; the joints are computed from the poses in double precision.

    Raises `NotModelled` where the mechanism has dry friction, and `OutOfReach` where it cannot be followed.
    """
    system, start = body_space.system(mechanism), body_space.initial(mechanism)
    moving = slice(7 * len(system.mass), 13 * len(system.mass))
    rates = body_equations.derivatives(system, start[None])[0, moving]
    states = integrate(
        lambda values: body_equations.derivatives(system, values),
        start,
        times,
        stages=STAGES,
        tolerance=WITNESS_TOLERANCE,
        first=_first(rates, start[moving]),
    )
    bodies = body_equations.unpacked(system, states)
    length = np.sqrt((bodies.quaternion * bodies.quaternion).sum(axis=-1, keepdims=True))
    parts = [
        np.swapaxes(part, 0, 1)
        for part in (bodies.position, bodies.quaternion / length, bodies.velocity, bodies.rates)
    ]
    found = joints(mechanism, Trajectory(times, *(part.astype(np.float64) for part in parts)))
    position, quaternion, velocity, angular_velocity = parts
    held, speed = found.position.astype(Wide), found.velocity.astype(Wide)
    return WideMotion(held, speed, position, quaternion, velocity, angular_velocity)


def _first(accelerations: WideArray, velocities: WideArray) -> float:
    """A size of the first step (s): a part of the time in which the motion changes."""
    rate = float(np.abs(velocities).max(initial=0) + np.sqrt(np.abs(accelerations).max(initial=0)))
    return 0.1 / rate if rate else 0.1
