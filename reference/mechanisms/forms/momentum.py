"""Exact properties of a chain that floats freely: the motion of its centre of mass, and its momenta.

Forces in joints act on both bodies in opposite directions, so that they do not change the momenta of a tree that nothing holds.
Its centre of mass moves on a parabola, and its angular momentum about the centre of mass is constant.
"""

from dataclasses import dataclass

import numpy as np

from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.exact.pairs import WideArray
from bodycheck.reference.mechanisms import start
from bodycheck.reference.mechanisms.mechanism import WORLD, Mechanism
from bodycheck.reference.trajectory import Array


@dataclass(frozen=True, eq=False)
class Floating:
    """A tree that floats freely.

    Attributes
    ----------
    bodies
        The indices of its bodies.
    mass
        Its mass (kg).
    centre, velocity
        (n, 3) position (m) and velocity (m/s) of its centre of mass in the world at the given instants.
    angular_momentum
        (3,) its angular momentum about the centre of mass in the world (kg m^2/s).
    """

    bodies: tuple[int, ...]
    mass: np.longdouble
    centre: WideArray
    velocity: WideArray
    angular_momentum: WideArray


def floating(mechanism: Mechanism, times: Array) -> tuple[Floating, ...]:
    """The trees of a mechanism that float freely, at times (n,), s.

    They begin with a free body or with a free joint on the world. Loops connect trees; a tree with a loop to the world does not
    float.
    """
    roots = _trees(mechanism)
    frames = start.frames(mechanism)
    trees = []
    for tree in sorted(set(roots.values()) - {WORLD}):
        bodies = tuple(body for body in range(len(mechanism.bodies)) if roots[body] == tree)
        trees.append(_tree(mechanism, frames, bodies, times))
    return tuple(trees)


def _trees(mechanism: Mechanism) -> dict[int, int]:
    """The first body of the tree of each body, or `WORLD` if the tree is connected to the world."""
    roots = {body: body for body in range(len(mechanism.bodies))} | {WORLD: WORLD}
    ties = [(joint.parent, joint.child) for joint in mechanism.joints if joint.type != "free" or joint.parent != WORLD]
    for one, other in (*ties, *(loop.bodies for loop in mechanism.loops)):
        first, second = sorted((roots[one], roots[other]))
        roots = {body: first if tree == second else tree for body, tree in roots.items()}
    return roots


def _tree(mechanism: Mechanism, frames: dict[int, start.Frame], bodies: tuple[int, ...], times: Array) -> Floating:
    """The floating tree of some bodies at times (n,), s, from the motion of the bodies at the start."""
    masses = [start.mass(mechanism.bodies[body]) for body in bodies]
    centres = [start.centre(mechanism.bodies[body]) for body in bodies]
    places = [frames[body].point(centre) for body, centre in zip(bodies, centres, strict=True)]
    speeds = [frames[body].speed(centre) for body, centre in zip(bodies, centres, strict=True)]
    total = np.sum(masses)
    centre, velocity = (
        np.sum([mass * part for mass, part in zip(masses, parts, strict=True)], axis=0) / total for parts in (places, speeds)
    )
    momentum = np.zeros(3, dtype=Wide)
    for body, mass, position, speed in zip(bodies, masses, places, speeds, strict=True):
        frame = frames[body]
        spin = frame.turn @ start.tensor(mechanism.bodies[body]) @ frame.turn.T @ frame.spin
        momentum = momentum + mass * np.cross(position - centre, speed - velocity) + spin
    t = times.astype(Wide)[:, None]
    down = np.array([0, 0, -1], dtype=Wide) * Wide(mechanism.gravity)
    return Floating(bodies, total, centre + t * (velocity + t * down / 2), velocity + t * down, momentum)
