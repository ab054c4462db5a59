"""States of a robot model that follow from a seed alone, the same ones on every machine."""

import math
from collections.abc import Mapping
from random import Random

from bodycheck.reference.robots.model import RobotJoint, RobotModel
from bodycheck.reference.robots.state import VELOCITIES, RobotState

#: Up to where the position of a joint without limits is drawn (rad, m). Limits that are more than twice as far are none.
REACH = {"revolute": math.pi, "prismatic": 1.0}

#: How far from its limits the position of a joint is at least, as a part of what is between them.
MARGIN = 0.05

Numbers = tuple[float, ...]


def seeded_states(model: RobotModel, count: int, seed: int) -> tuple[RobotState, ...]:
    """States of a robot model.

    Positions are inside the limits of joints and never at their edge, and otherwise within a half turn or 1 m. Velocities,
    accelerations and efforts are between -1 and 1. What a joint mimics it has in positions, velocities and accelerations, be it
    inside its limits or not. Two joints that mimic each other are drawn as others are.

    Parameters
    ----------
    model
        The model, of which the names, types, limits and mimicry of the joints count, in the order of the file.
    count
        The number of states; the first ones do not depend on it.
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
    """The joint that moves by itself and that a joint follows, perhaps through others, with the multiplier and the offset.

    None where the joint follows none, one that there is not or that has not one position, or itself in the end.
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
    """The lowest and the highest position of a joint: its limits where they leave room, and some reach where there are none."""
    low = -math.inf if joint.lower is None else joint.lower
    high = math.inf if joint.upper is None else joint.upper
    if not low <= high or low == math.inf or high == -math.inf:
        return -reach, reach
    if low > 2 * reach:
        return low, min(high, low + 2 * reach)
    if high < -2 * reach:
        return max(low, high - 2 * reach), high
    # A single limit leaves as much room as there would be without it.
    left = low if low >= -2 * reach else min(-reach, high - reach)
    right = high if high <= 2 * reach else max(reach, low + reach)
    return left, right


def _quaternion(random: Random) -> tuple[float, float, float, float]:
    """A unit quaternion, evenly distributed; only roundings that are the same everywhere are made."""
    while True:
        w, x, y, z = (random.uniform(-1, 1) for _ in range(4))
        square = w * w + x * x + y * y + z * z
        if 0.01 < square <= 1:
            length = math.sqrt(square)
            return w / length, x / length, y / length, z / length
