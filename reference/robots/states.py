"""Pseudo-random states of a robot model, which depend on a seed alone and are the same on every machine."""

import math
from collections.abc import Mapping
from random import Random

from bodycheck.reference.robots.model import RobotJoint, RobotModel
from bodycheck.reference.robots.state import VELOCITIES, RobotState

#: The largest distance from 0 at which the position of a joint without limits is drawn (rad, m). A limit on its own side of 0
#: that is more than twice as far does not count.
REACH = {"revolute": math.pi, "prismatic": 1.0}

#: The least distance of a drawn position from the ends of its range, as a fraction of the range.
MARGIN = 0.05

Numbers = tuple[float, ...]


def seeded_states(model: RobotModel, count: int, seed: int) -> tuple[RobotState, ...]:
    """Return pseudo-random states of a robot model.

    Positions are inside the limits of a joint, never at a limit; without limits they are within a half turn or 1 m of 0.
    Velocities, accelerations and efforts are between -1 and 1. A joint that mimics another joint has the positions, velocities
    and accelerations that follow from that joint, inside its own limits or not. Joints that mimic each other in a circle are
    drawn like independent joints.

    Parameters
    ----------
    model
        The model. Only the names, types, limits and mimic rules of its joints, in the order of the file, affect the states.
    count
        The number of states. A larger number adds states at the end and leaves the others unchanged.
    seed
        The seed.
    """
    random = Random(seed)
    return tuple(_state(model, random) for _ in range(count))


def _state(model: RobotModel, random: Random) -> RobotState:
    moving = [joint for joint in model.joints if VELOCITIES[joint.type]]
    positions, velocities, accelerations, efforts = (dict[str, Numbers]() for _ in range(4))
    for joint in moving:
        positions[joint.name] = _position(joint, random)
        for part in (velocities, accelerations, efforts):
            part[joint.name] = tuple(random.uniform(-1, 1) for _ in range(VELOCITIES[joint.type]))
    by_name = {joint.name: joint for joint in moving}
    followed = {name: rule for name in by_name if (rule := _followed(by_name, name)) is not None}
    for name, (leader, multiplier, offset) in followed.items():
        positions[name] = (multiplier * positions[leader][0] + offset,)
        for part in (velocities, accelerations):
            part[name] = (multiplier * part[leader][0],)
    return RobotState(positions, velocities, accelerations, efforts)


def _followed(joints: Mapping[str, RobotJoint], name: str) -> tuple[str, float, float] | None:
    """The independent joint that a joint follows, perhaps through other joints, with the total multiplier and offset.

    Returns None where the joint follows no joint, a joint that does not exist or is neither revolute nor prismatic, or, in a
    circle, itself.
    """
    multiplier, offset, passed = 1.0, 0.0, {name}
    if joints[name].type not in REACH:
        return None
    while (mimic := joints[name].mimic) is not None and mimic.joint in joints and joints[mimic.joint].type in REACH:
        name = mimic.joint
        if name in passed:
            return None
        multiplier, offset = multiplier * mimic.multiplier, multiplier * mimic.offset + offset
        passed.add(name)
    return (name, multiplier, offset) if len(passed) > 1 else None


def _position(joint: RobotJoint, random: Random) -> Numbers:
    match joint.type:
        case "revolute" | "prismatic":
            low, high = _range(joint, REACH[joint.type])
            part = random.uniform(MARGIN, 1 - MARGIN)
            return (low + (high - low) * part,)
        case "planar":
            return (random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-math.pi, math.pi))
        case "spherical":
            return _quaternion(random)
        case "floating":
            return (*(random.uniform(-1, 1) for _ in range(3)), *_quaternion(random))
        case "fixed":
            return ()


def _range(joint: RobotJoint, reach: float) -> tuple[float, float]:
    """The range in which the position of a joint is drawn: its limits, or a distance `reach` from 0 where they do not count."""
    low = -math.inf if joint.lower is None else joint.lower
    high = math.inf if joint.upper is None else joint.upper
    if not low <= high or low == math.inf or high == -math.inf:
        return -reach, reach
    if low > 2 * reach:
        return low, min(high, low + 2 * reach)
    if high < -2 * reach:
        return max(low, high - 2 * reach), high
    # A range with a single limit is at least as wide as a range without limits.
    left = low if low >= -2 * reach else min(-reach, high - reach)
    right = high if high <= 2 * reach else max(reach, low + reach)
    return left, right


def _quaternion(random: Random) -> tuple[float, float, float, float]:
    """A uniformly distributed unit quaternion, computed only with operations that round in the same way on every machine."""
    while True:
        w, x, y, z = (random.uniform(-1, 1) for _ in range(4))
        square = w * w + x * x + y * y + z * z
        if 0.01 < square <= 1:
            length = math.sqrt(square)
            return w / length, x / length, y / length, z / length
