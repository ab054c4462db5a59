"""Decide whether a mechanism starts at rest and stays there, from the forces along its coordinates at the start."""

from collections.abc import Iterator

import numpy as np

from bodycheck.reference.exact.numbers import Wide, wide
from bodycheck.reference.mechanisms import exact, mimicry, start
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Mechanism, depth_first
from bodycheck.reference.mechanisms.start import WideArray

#: The largest force along a coordinate that counts as zero, relative to the sizes of its parts: a hundred roundings of doubles,
#: as the numbers of a case have them.
ROUNDED = 1e-14

#: The axes x, y and z.
AXES = np.eye(3, dtype=Wide)


def is_at_rest(mechanism: Mechanism) -> bool:
    """Return whether nothing moves: all velocities and all accelerations are zero at the start.

    Without velocities, the accelerations are zero if the force along each coordinate is zero or is not larger than its dry
    friction. Of loops, only the open chains are looked at: where these have no forces, the loops have none either.
    """
    if mechanism.pushes or any(any(frame.velocity) or any(frame.spin) for frame in start.frames(mechanism).values()):
        return False
    sums = np.zeros(
        (len(mechanism.joints), 3), Wide
    )  # of force, size and friction along the coordinates that move by themselves
    wrenches = _wrenches(mechanism)
    places = {joint.child: index for index, joint in enumerate(mechanism.joints)}
    for body, (force, torque, reach) in wrenches.items():
        if body not in places:
            if force.any():
                return False
            continue
        index = places[body]
        joint, turn, weight = mechanism.joints[index], start.frames(mechanism)[body].turn, np.abs(force).max()
        if not joint.form.has_axis:
            if any(abs(part) > ROUNDED * size for part, size in _several(joint, turn, force, torque, weight, weight * reach)):
                return False
            continue
        axis = turn @ np.array([wide(part) for part in exact.unit_axis(joint)])
        along, size = (force @ axis, weight) if joint.form.slides else (torque @ axis, weight * reach)
        spring = Wide(joint.stiffness) * (Wide(joint.rest) - Wide(joint.start[0]))
        rule = mimicry.rule(mechanism.joints, index)
        share = Wide(float(rule.multiplier))
        parts = [share * (along + spring + Wide(joint.effort)), abs(share) * (size + abs(spring) + abs(Wide(joint.effort)))]
        sums[rule.leader] += [*parts, abs(share) * Wide(joint.friction)]
    return bool((np.abs(sums[:, 0]) <= np.maximum(ROUNDED * sums[:, 1], sums[:, 2])).all())


def _wrenches(mechanism: Mechanism) -> dict[int, tuple[WideArray, WideArray, Wide]]:
    """Return the weight (N) of each body with all that hangs on it, its torque about the body's origin (N m), and a reach.

    Weight (3,) and torque (3,) are along the axes of the world. The reach (m) is the distance of the farthest centre of mass.
    """
    frames = start.frames(mechanism)
    carried: dict[int, list[tuple[Wide, WideArray]]] = {index: [] for index in (WORLD, *range(len(mechanism.bodies)))}
    wrenches = {}
    for index in reversed(list(depth_first(mechanism))):
        body, joint, frame = mechanism.bodies[index], mechanism.joint_of[index], frames[index]
        carried[index].append((start.mass(body), frame.point(start.centre(body))))
        carried[WORLD if joint is None else joint.parent] += carried[index]
        masses, centres = np.array([mass for mass, _ in carried[index]]), np.array([point for _, point in carried[index]])
        arms = centres - frame.origin
        force = np.array([0, 0, -Wide(mechanism.gravity) * masses.sum()])
        torque = np.cross(masses @ arms, [0, 0, -Wide(mechanism.gravity)])
        wrenches[index] = force, torque, Wide(np.abs(arms).max())
    return wrenches


def _several(
    joint: Joint, turn: WideArray, force: WideArray, torque: WideArray, weight: Wide, moment: Wide
) -> Iterator[tuple[Wide, Wide]]:
    """Yield the forces along the coordinates of a joint with several, each with the size that it is compared with.

    turn: the rotation matrix of the child. weight, moment: the sizes of force and torque. The plane of a planar joint is that
    of the child, and two turns count as a ball, so that the torque about every axis must be zero.
    """
    axes = dict(zip("xyz", turn.T, strict=True))
    for motion in joint.form.slides:
        yield force @ axes[motion.axis], weight
    for motion in joint.form.turns:
        for name in "z" if motion.axis == "z" else "xyz":
            yield torque @ axes[name], moment
