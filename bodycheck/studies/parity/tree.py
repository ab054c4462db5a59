"""Compare the tree of an engine with the tree of the file: parents, types of joints with limits and mimics, order, gravity."""

from collections.abc import Iterator

from bodycheck.adapters.robot_reading import ReadJoint, RobotReading
from bodycheck.reference.robots.model import Mimic, RobotJoint, RobotModel
from bodycheck.studies.parity.matching import Match
from bodycheck.studies.parity.numbers import none_if_unlimited, text, vector
from bodycheck.studies.parity.quantities import MODEL, Status
from bodycheck.studies.parity.rows import Compared

#: Types of joints that many engines do not read.
RARE = ("floating", "planar", "spherical")

#: Words of engines for types of URDF.
SYNONYMS = {"continuous": "revolute", "ball": "spherical", "free": "floating", "slide": "prismatic", "hinge": "revolute"}


def parents(match: Match, reading: RobotReading) -> Iterator[Compared]:
    """Yield a row with the parent of each body, also of a body that the engine does not report.

    The root and the world count as the same parent. Links without mass between several joints of one body, which an engine may
    not have, are skipped.
    """
    model = match.bodies
    root, names = model.links[model.root].name, {link.name for link in model.links}
    parent_of = {model.links[joint.child].name: model.links[joint.parent] for joint in model.joints}
    kept = {body.name for body in reading.bodies}
    for body in reading.bodies:
        if body.name in parent_of:
            name, expected = body.parent if body.parent in names else root, parent_of[body.name]
            while not expected.mass and expected.name not in (*kept, root):
                expected = parent_of[expected.name]
            status: Status = "agrees" if name == expected.name else "differs"
            yield Compared(status, "parent", body.name, body.parent or "", expected.name)
    for name, expected in parent_of.items():
        if name not in kept:
            yield Compared("not-modelled", "parent", name, "", expected.name)


def joint_types(match: Match, model: RobotModel, reading: RobotReading, tolerance: float) -> Iterator[Compared]:
    """Yield a row for each joint that moves: its type, its limits, and the joint that it mimics."""
    tried = {name for name, behaviour in reading.behaviours.items() if "limits" in behaviour.tried}
    for joint in model.joints:
        if joint.type == "fixed":
            continue
        expected = _words(joint.type, joint.lower, joint.upper, joint.mimic)
        joint_read = match.joints.get(joint.name)
        if joint_read is None:
            rare = joint.type in RARE
            yield Compared("not-modelled" if rare else "differs", "joint_type", joint.name, "fixed", expected)
            continue
        words = _words(SYNONYMS.get(joint_read.type, joint_read.type), joint_read.lower, joint_read.upper, joint_read.mimic)
        same = (
            same_type(joint, joint_read)
            and same_mimic(joint.mimic, joint_read.mimic)
            and same_limits(joint, joint_read, tolerance, joint_read.name in tried)
        )
        yield Compared("agrees" if same else "differs", "joint_type", joint.name, words, expected)
    for extra in match.extra:
        status: Status = "agrees" if extra.type in ("floating", "free") else "differs"
        yield Compared(status, "joint_type", extra.name, extra.type, "fixed")


def same_type(joint: RobotJoint, joint_read: ReadJoint) -> bool:
    """Return whether a joint has the same type on both sides, whatever the engine calls it."""
    return SYNONYMS.get(joint_read.type, joint_read.type) == joint.type


def same_mimic(expected: Mimic | None, engine: Mimic | None) -> bool:
    """Return whether a joint follows the same joint in the same way on both sides."""
    if expected is None or engine is None:
        return expected == engine
    numbers = [(expected.multiplier, engine.multiplier), (expected.offset, engine.offset)]
    return expected.joint == engine.joint and all(abs(a - b) <= 1e-9 * max(1.0, abs(a)) for a, b in numbers)


def same_limits(joint: RobotJoint, joint_read: ReadJoint, tolerance: float, tried: bool) -> bool:
    """Return whether a joint has the same limits on both sides; True if the engine reports no limits and none were tried."""
    if joint.type not in ("revolute", "prismatic") or (not tried and joint_read.lower is None and joint_read.upper is None):
        return True
    pairs = [(joint.lower, joint_read.lower), (joint.upper, joint_read.upper)]
    for expected, engine in ((none_if_unlimited(a), none_if_unlimited(b)) for a, b in pairs):
        if (expected is None) != (engine is None):
            return False
        if expected is not None and engine is not None and abs(expected - engine) > tolerance * max(1.0, abs(expected)):
            return False
    return True


def order(match: Match, model: RobotModel, reading: RobotReading) -> Iterator[Compared]:
    """Yield the row of the order of joints and the row of the number of velocities.

    A robot file does not define an order of joints, so that every order agrees. The row of the order is for users who pass
    vectors from one engine to another.
    """
    names = {id(joint): name for name, joint in match.joints.items()}
    moving = sorted((joint for joint in reading.joints if joint.count), key=lambda joint: joint.first)
    theirs = [names.get(id(joint), joint.name) for joint in moving]
    ours = [joint.name for joint in model.joints if joint.type != "fixed"]
    yield Compared("agrees", "order", MODEL, " ".join(theirs), " ".join(ours))
    whole = match.expansion.shape[0]
    expected = len(match.labels) + sum(joint.count for joint in match.extra)
    otherwise = sum(match.joints[name].count for name in match.otherwise)
    status: Status = "agrees" if reading.velocities == expected + otherwise and not match.otherwise else "differs"
    yield Compared(status, "joint_type", MODEL, f"{reading.velocities} velocities", f"{whole} velocities")


def gravity(model: RobotModel, reading: RobotReading, stated: bool, tolerance: float) -> Iterator[Compared]:
    """Yield the row of the engine's own default gravity, if it reports one. stated: whether the file states its gravity."""
    if reading.gravity is None:
        return
    if not stated:
        yield Compared("agrees", "gravity", MODEL, text(reading.gravity), "")
        return
    size = sum(component**2 for component in model.gravity) ** 0.5
    yield vector("gravity", MODEL, reading.gravity, model.gravity, size or 1.0, tolerance)


def _words(kind: str, lower: float | None, upper: float | None, mimic: Mimic | None) -> str:
    return " ".join([kind, *_limits_and_rule(lower, upper, mimic)])


def limits_and_rule(joint: ReadJoint) -> str:
    """Return the limits of a joint and the rule by which it follows another one, in words."""
    return " ".join(_limits_and_rule(joint.lower, joint.upper, joint.mimic)) or "no limits"


def _limits_and_rule(lower: float | None, upper: float | None, mimic: Mimic | None) -> Iterator[str]:
    limits = [none_if_unlimited(limit) for limit in (lower, upper)]
    if any(limit is not None for limit in limits):
        low, high = ("none" if limit is None else repr(limit) for limit in limits)
        yield f"from {low} to {high}"
    if mimic is not None:
        yield f"mimics {mimic.joint} times {mimic.multiplier!r} plus {mimic.offset!r}"
