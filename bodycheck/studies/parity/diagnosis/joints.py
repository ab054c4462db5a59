"""The causes of differences in the numbers and types of joints that an engine reports."""

import math
from collections.abc import Iterator

import numpy as np

from bodycheck.adapters.robot_reading import ReadJoint
from bodycheck.reference.robots.model import Mimic, RobotJoint
from bodycheck.studies.parity.comparing import Comparison
from bodycheck.studies.parity.diagnosis.fault import Fault
from bodycheck.studies.parity.diagnosis.inertias import same
from bodycheck.studies.parity.numbers import none_if_unlimited
from bodycheck.studies.parity.quantities import Cause, Quantity
from bodycheck.studies.parity.rows import Compared
from bodycheck.studies.parity.tree import same_mimic, same_type

#: The ratios of two numbers if radians were taken for degrees, or the reverse.
DEGREES = (180 / math.pi, math.pi / 180)

#: The cause for each number of a joint that an engine ignores. A joint without its spring is another joint.
IGNORED: dict[Quantity, Cause] = {
    "damping": "damping-ignored",
    "friction": "friction-ignored",
    "stiffness": "representation",
}


def faults(comparison: Comparison) -> Iterator[Fault]:
    """Yield a fault for each number and each type of a joint that differs from the file."""
    model = comparison.asked.model
    joints = {joint.name: joint for joint in model.joints}
    for row in comparison.rows:
        joint, joint_read = joints.get(row.subject), comparison.match.joints.get(row.subject)
        if row.status != "differs" or joint is None:
            continue
        if row.quantity == "joint_type":
            yield Fault(_type_cause(joint, joint_read), "joint_type", joint.name)
        elif joint_read is not None and (fault := _number(row, joint, joint_read)) is not None:
            yield fault


def _number(row: Compared, joint: RobotJoint, joint_read: ReadJoint) -> Fault | None:
    match row.quantity:
        case "armature":
            return Fault("armature", "armature", joint.name, joint={"armature": joint_read.armature})
        case "damping" | "friction" | "stiffness" as quantity:
            value, expected = float(getattr(joint_read, quantity)), float(getattr(joint, quantity))
            return Fault(number_cause(quantity, value, expected), quantity, joint.name, joint={quantity: value})
        case "axis":
            assert joint_read.axis is not None  # an engine without an axis has no row
            axis = np.array(joint_read.axis)
            return Fault(_axis_cause(axis, joint), "axis", joint.name, joint={"axis": np.asarray(axis, np.longdouble)})
        case "effort_limit":
            unlimited = not joint.effort_limit and none_if_unlimited(joint_read.effort_limit) is None
            return Fault("representation" if unlimited else "unexplained", "effort_limit", joint.name)
    return None


def number_cause(quantity: Quantity, engine: float, truth: float) -> Cause:
    """Return why the damping, friction or stiffness of a joint differs."""
    if not engine and truth:
        return IGNORED.get(quantity, "unexplained")
    if truth and any(math.isclose(engine / truth, factor, rel_tol=1e-6) for factor in DEGREES):
        return "representation"
    return "unexplained"


def _axis_cause(engine: np.ndarray, joint: RobotJoint) -> Cause:
    truth = np.asarray(joint.axis, np.float64)
    return "representation" if same(engine, -truth, 1.0) else "frame"


def _type_cause(joint: RobotJoint, joint_read: ReadJoint | None) -> Cause:
    if joint_read is None or not same_type(joint, joint_read):
        return "representation"
    if not same_mimic(joint.mimic, joint_read.mimic):
        if joint_read.mimic is None:
            return "mimic-ignored"
        return "mimic-inverted" if joint.mimic and _is_inverse(joint.mimic, joint_read.mimic) else "unexplained"
    pairs = ((joint.lower, joint_read.lower), (joint.upper, joint_read.upper))
    if all(limit is None or limit == expected for expected, limit in pairs):
        return "limits-ignored"
    return "representation"


def _is_inverse(file: Mimic, engine: Mimic) -> bool:
    """Return whether the leader of a joint follows the joint by the rule by which the joint should follow its leader.

    The engine's rule is measured, with errors of some percent.
    """
    if not file.multiplier or file.joint != engine.joint:
        return False
    inverse = (1 / file.multiplier, -file.offset / file.multiplier)
    return bool(np.allclose((engine.multiplier, engine.offset), inverse, rtol=0.05, atol=0.05 * abs(inverse[0])))
