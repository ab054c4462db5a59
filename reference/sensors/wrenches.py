"""The force and moment that the parent of a joint exerts on the child, from the momenta of all bodies beyond the joint.

Newton's and Euler's equations of the bodies beyond the joint give

    force = sum of m (a - g) - forces of loops,
    moment = sum of (c - o) x m (a - g) + I w' + w x I w - moments of the forces of loops,

about the origin o of the child's frame. Armatures are not in these sums: what turns a rotor does not pass through the joint.
"""

import functools

import numpy as np

from bodycheck.reference.errors import NotModelled
from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.exact.pairs import WideArray
from bodycheck.reference.kinematics import cross
from bodycheck.reference.mechanisms.loops import joint_space
from bodycheck.reference.mechanisms.loops.vectors import apply
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.sensors.equations import Equations, Solution
from bodycheck.reference.sensors.kinetics import Kinetics, norm

#: The ratio of a singular value of the loops' rows to the largest one below which a multiplier is not unique, and the component
#: of a direction of such multipliers above which a loop takes part in it.
SINGULAR, PART = 1e-9, 1e-6


def wrench(written: Equations, solved: Solution, moving: Kinetics, child: int) -> WideArray:
    """The force and moment (s, 6) on a child from its parent, about and along the child's frame.

    Raises `NotModelled` if they are not unique because of loops.
    """
    linkage = written.linkage
    beyond = subtree(written.mechanism, child)
    axes = moving.axes[child]
    origin = moving.position[child] - apply(axes, linkage.centre[child])
    force, moment = np.zeros_like(origin), np.zeros_like(origin)
    pushes, twists = _loads(written, moving)
    for body in beyond:
        force += pushes[body]
        moment += cross(moving.position[body] - origin, pushes[body]) + twists[body]
    for index in crossing(written.mechanism, beyond):
        one, other = linkage.points[index]
        inside = written.mechanism.loops[index].bodies[0] in beyond
        element, point = one if inside else other
        pull = solved.pulls[:, index] if inside else -solved.pulls[:, index]
        position, _, _ = joint_space.point_motion(solved.motion, element, point)
        force -= pull
        moment -= cross(position - origin, pull)
    back = np.swapaxes(axes, 1, 2)
    return np.hstack([apply(back, force), apply(back, moment)])


def terms_of_wrench(written: Equations, moving: Kinetics, child: int) -> WideArray:
    """The sizes (s, 6) of the terms that `wrench` adds up, without those of loops."""
    origin = moving.position[child] - apply(moving.axes[child], written.linkage.centre[child])
    force, moment = np.zeros((len(origin), 1), dtype=Wide), np.zeros((len(origin), 1), dtype=Wide)
    _, twists = _loads(written, moving)
    for body in subtree(written.mechanism, child):
        weight = written.linkage.mass[body] * (norm(moving.acceleration[body]) + Wide(written.linkage.gravity))
        force += weight
        moment += norm(moving.position[body] - origin) * weight + norm(twists[body])
    return np.hstack([np.tile(force, 3), np.tile(moment, 3)])


@functools.lru_cache(maxsize=1)
def _loads(written: Equations, moving: Kinetics) -> tuple[list[WideArray], list[WideArray]]:
    """The force m (a - g) and the moment I w' + w x I w (s, 3) that the motion of each body requires, world.

    They are kept for the sensors of all joints, which read them one after another.
    """
    up = np.array([0, 0, written.linkage.gravity], dtype=Wide)
    pushes, twists = [], []
    for body, mass in enumerate(written.linkage.mass):
        axes, spin = moving.axes[body], moving.spin[body]
        tensor = axes @ written.linkage.tensor[body] @ np.swapaxes(axes, 1, 2)
        pushes.append(mass * (moving.acceleration[body] + up))
        twists.append(apply(tensor, moving.turning[body]) + cross(spin, apply(tensor, spin)))
    return pushes, twists


def subtree(mechanism: Mechanism, child: int) -> set[int]:
    """The indices of a body and of all bodies that hang on it."""
    beyond, waiting = {child}, [child]
    while waiting:
        parent = waiting.pop()
        further = [joint.child for joint in mechanism.joints if joint.parent == parent]
        beyond.update(further)
        waiting += further
    return beyond


def crossing(mechanism: Mechanism, beyond: set[int]) -> list[int]:
    """The indices of loops that join a body beyond a joint with one that is not."""
    return [index for index, loop in enumerate(mechanism.loops) if (loop.bodies[0] in beyond) != (loop.bodies[1] in beyond)]


def require_unique(written: Equations, solved: Solution, child: int) -> None:
    """Raise `NotModelled` if loops leave the wrench on a child undetermined at some of the instants."""
    crossed = crossing(written.mechanism, subtree(written.mechanism, child))
    if not crossed:
        return
    for rows in solved.closures.astype(float):
        left, values, _ = np.linalg.svd(rows)
        full = np.zeros(len(rows))
        full[: len(values)] = values
        free = left[:, full <= SINGULAR * full.max(initial=0.0)]
        if any((np.abs(free[3 * index : 3 * index + 3]) > PART).any() for index in crossed):
            raise NotModelled("a wrench in a loop")
