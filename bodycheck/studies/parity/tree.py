"""Compare the tree of an engine with that of the file: parents, types of joints with limits and mimics, order, gravity."""

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


def parents(found: Match, reading: RobotReading) -> Iterator[Compared]:
    """Yield a row for each body that the engine keeps: what it hangs on.

    The root and the world are the same. Links without mass between several joints of one body, which an engine may not have,
    are passed over.
    """
    model = found.bodies
    root, names = model.links[model.root].name, {link.name for link in model.links}
    own = {model.links[joint.child].name: model.links[joint.parent] for joint in model.joints}
    kept = {body.name for body in reading.bodies}
    for body in reading.bodies:
        if body.name in own:
            told, expected = body.parent if body.parent in names else root, own[body.name]
            while not expected.mass and expected.name not in (*kept, root):
                expected = own[expected.name]
            status: Status = "agrees" if told == expected.name else "differs"
            yield Compared(status, "parent", body.name, body.parent or "", expected.name)


def joint_types(found: Match, model: RobotModel, tolerance: float) -> Iterator[Compared]:
    """Yield a row for each joint that moves: its type, limits, and what it mimics."""
    for joint in model.joints:
        if joint.type == "fixed":
            continue
        expected = _words(joint.type, joint.lower, joint.upper, joint.mimic)
        told = found.joints.get(joint.name)
        if told is None:
            rare = joint.type in RARE
            yield Compared("not-modelled" if rare else "differs", "joint_type", joint.name, "fixed", expected)
            continue
        words = _words(SYNONYMS.get(told.type, told.type), told.lower, told.upper, told.mimic)
        same = same_type(joint, told) and same_mimic(joint.mimic, told.mimic) and same_limits(joint, told, tolerance)
        yield Compared("agrees" if same else "differs", "joint_type", joint.name, words, expected)
    for extra in found.extra:
        status: Status = "agrees" if extra.type in ("floating", "free") else "differs"
        yield Compared(status, "joint_type", extra.name, extra.type, "fixed")


def same_type(joint: RobotJoint, told: ReadJoint) -> bool:
    """Return whether a joint has the same type on both sides, by whatever word of the engine."""
    return SYNONYMS.get(told.type, told.type) == joint.type


def same_mimic(expected: Mimic | None, told: Mimic | None) -> bool:
    """Return whether a joint follows the same joint in the same way on both sides."""
    if expected is None or told is None:
        return expected == told
    numbers = [(expected.multiplier, told.multiplier), (expected.offset, told.offset)]
    return expected.joint == told.joint and all(abs(a - b) <= 1e-9 * max(1.0, abs(a)) for a, b in numbers)


def same_limits(joint: RobotJoint, told: ReadJoint, tolerance: float) -> bool:
    """Return whether a joint has the same limits on both sides. An engine that tells none is not judged."""
    if joint.type not in ("revolute", "prismatic") or (told.lower is None and told.upper is None):
        return True
    pairs = [(joint.lower, told.lower), (joint.upper, told.upper)]
    for expected, own in ((none_if_unlimited(a), none_if_unlimited(b)) for a, b in pairs):
        if (expected is None) != (own is None):
            return False
        if expected is not None and own is not None and abs(expected - own) > tolerance * max(1.0, abs(expected)):
            return False
    return True


def order(found: Match, model: RobotModel, reading: RobotReading) -> Iterator[Compared]:
    """Yield the rows of the number of velocities, and of the order of joints.

    A file of a robot does not say in which order its joints come, so that every order agrees; it is told for users who pass
    vectors from one engine to another.
    """
    by_engine = {id(own): name for name, own in found.joints.items()}
    moving = sorted((joint for joint in reading.joints if joint.count), key=lambda joint: joint.first)
    theirs = [by_engine.get(id(joint), joint.name) for joint in moving]
    ours = [joint.name for joint in model.joints if joint.type != "fixed"]
    yield Compared("agrees", "order", MODEL, " ".join(theirs), " ".join(ours))
    whole = found.expansion.shape[0]
    expected = len(found.labels) + sum(joint.count for joint in found.extra)
    own = sum(found.joints[name].count for name in found.otherwise)
    status: Status = "agrees" if reading.velocities == expected + own and not found.otherwise else "differs"
    yield Compared(status, "joint_type", MODEL, f"{reading.velocities} velocities", f"{whole} velocities")


def gravity(model: RobotModel, reading: RobotReading, stated: bool, tolerance: float) -> Iterator[Compared]:
    """Yield the row of the gravity that the engine uses by itself. stated: whether the file says what it is."""
    if reading.gravity is None:
        return
    if not stated:
        yield Compared("agrees", "gravity", MODEL, text(reading.gravity), "")
        return
    size = sum(component**2 for component in model.gravity) ** 0.5
    yield vector("gravity", MODEL, reading.gravity, model.gravity, size or 1.0, tolerance)


def _words(kind: str, lower: float | None, upper: float | None, mimic: Mimic | None) -> str:
    parts = [kind]
    limits = [none_if_unlimited(limit) for limit in (lower, upper)]
    if any(limit is not None for limit in limits):
        low, high = ("none" if limit is None else repr(limit) for limit in limits)
        parts.append(f"from {low} to {high}")
    if mimic is not None:
        parts.append(f"mimics {mimic.joint} times {mimic.multiplier!r} plus {mimic.offset!r}")
    return " ".join(parts)
