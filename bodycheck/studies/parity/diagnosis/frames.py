"""Frames that an engine places differently from the file, found from the poses of the bodies at the states."""

from collections.abc import Iterator

import numpy as np

from bodycheck.reference.robots.model import RobotJoint, RobotModel
from bodycheck.reference.robots.rotations import matrices, quaternion, rotation_vector
from bodycheck.reference.trajectory import Array
from bodycheck.studies.parity.comparing import Comparison
from bodycheck.studies.parity.diagnosis.fault import Fault
from bodycheck.studies.parity.numbers import text
from bodycheck.studies.parity.quantities import Cause
from bodycheck.studies.parity.rotations import composed, gaps, inverse, relative
from bodycheck.studies.parity.rows import Compared
from bodycheck.studies.parity.stacks import values

#: The difference of poses, relative to the reach of the robot or in rad, below which the poses are the same.
SAME = 1e-7


def faults(comparison: Comparison) -> Iterator[Fault]:
    """Yield a fault for each joint whose frame or axis in the engine is not that of the file."""
    row = next((row for row in comparison.rows if row.quantity == "pose"), None)
    if row is None or row.status != "differs":
        return
    model = comparison.match.bodies
    for joint in model.joints:
        parent, child = model.links[joint.parent].name, model.links[joint.child].name
        if child in comparison.engine.poses and (parent in comparison.engine.poses or joint.parent == model.root):
            yield from _of_joint(comparison, joint, parent, child)
    yield from _of_welded(comparison)


def _of_joint(comparison: Comparison, joint: RobotJoint, parent: str, child: str) -> Iterator[Fault]:
    """Yield the fault of a joint between two bodies of the engine, if its frame or axis differs."""
    truth = relative(comparison.truth.poses[parent], comparison.truth.poses[child])
    engine = relative(comparison.engine.poses.get(parent, comparison.truth.poses[parent]), comparison.engine.poses[child])
    if _alike(comparison, engine, truth):
        return
    placed = np.concatenate([np.asarray(joint.position, np.float64), _quaternion(joint)])
    moved = composed(np.broadcast_to(inverse(placed), truth.shape), truth)  # the motion of the joint alone
    axis = _axis(comparison, joint, engine)
    if axis is not None:
        moved = _motion(comparison, joint, axis)
    frames = composed(engine, inverse(moved))
    if not _alike(comparison, frames, np.broadcast_to(frames[0], frames.shape)):
        return
    change: dict[str, object] = {}
    if axis is not None and not np.allclose(axis, np.asarray(joint.axis, np.float64), atol=SAME):
        change["axis"] = np.asarray(axis, np.longdouble)
    if not _alike(comparison, frames[:1], placed[None]):
        change["position"] = np.asarray(frames[0, :3], np.longdouble)
        change["rotation"] = matrices(np.asarray(frames[:1, 3:], np.longdouble))[0]
    if not change:
        return
    subject = _weld(comparison, joint, frames[0]) if "position" in change else joint.name
    row = _row(subject, frames[0], placed) if "position" in change else _axis_row(joint, change["axis"])
    yield Fault(row.cause, row.quantity or "pose", joint.name, joint=change, row=row)


def _of_welded(comparison: Comparison) -> Iterator[Fault]:
    """Yield the faults of links that are fixed to a body of the engine and whose poses the engine still reports."""
    model, kept = comparison.match.model, {link.name for link in comparison.match.bodies.links}
    for joint in model.joints:
        parent, child = model.links[joint.parent].name, model.links[joint.child].name
        if (
            joint.type != "fixed"
            or child in kept
            or child not in comparison.engine.poses
            or parent not in comparison.engine.poses
        ):
            continue
        truth = relative(comparison.truth.poses[parent], comparison.truth.poses[child])
        engine = relative(comparison.engine.poses[parent], comparison.engine.poses[child])
        if not _alike(comparison, engine, truth):
            yield Fault("frame", "pose", joint.name, row=_row(joint.name, engine[0], truth[0]))


def _axis(comparison: Comparison, joint: RobotJoint, engine: Array) -> Array | None:
    """Return the axis about or along which a joint moves in the engine; None if the poses do not determine it."""
    if joint.type not in ("revolute", "prismatic"):
        return None
    positions = values(comparison.motion.states, [(joint.name, 0)], lambda state: state.positions)[:, 0]
    steps = positions[1:] - positions[0]
    if not len(steps):
        return None
    chosen = int(np.argmax(np.where(np.abs(steps) < 3.0, np.abs(steps), 0.0)))
    step = steps[chosen]
    between = relative(engine[0], engine[chosen + 1])
    axis = (between[:3] if joint.type == "prismatic" else rotation_vector(between[None, 3:])[0]) / step
    length = float(np.linalg.norm(axis))
    return axis / length if abs(length - 1) < 1e-6 else None


def _motion(comparison: Comparison, joint: RobotJoint, axis: Array) -> Array:
    """Return the poses (s, 7) of the child of a joint in the joint's frame if the joint has the given axis (3,)."""
    positions = values(comparison.motion.states, [(joint.name, 0)], lambda state: state.positions)[:, 0]
    poses = np.zeros((len(positions), 7))
    if joint.type == "prismatic":
        poses[:, :3], poses[:, 3] = positions[:, None] * axis, 1.0
    else:
        poses[:, 3], poses[:, 4:] = np.cos(positions / 2), np.sin(positions / 2)[:, None] * axis
    return poses


def _weld(comparison: Comparison, joint: RobotJoint, engine: Array) -> str:
    """Return the name of the joint whose frame causes the difference: a weld on the path to `joint`, or `joint` itself."""
    model = comparison.match.model
    path = _path(model, comparison.match.bodies, joint)
    for lost in path:
        for keeps_place, keeps_turn in ((True, False), (False, True), (False, False)):
            composed_pose = np.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
            for weld in path:
                pose = np.concatenate([np.asarray(weld.position, np.float64), _quaternion(weld)])
                if weld is lost:
                    position = pose[:3] if keeps_place else np.zeros(3)
                    pose = np.concatenate([position, pose[3:] if keeps_turn else [1.0, 0.0, 0.0, 0.0]])
                composed_pose = composed(composed_pose, pose)
            if _alike(comparison, composed_pose[None], engine[None]):
                return lost.name
    return joint.name


def _path(model: RobotModel, bodies: RobotModel, joint: RobotJoint) -> list[RobotJoint]:
    """Return the joints of the file from a body of the engine to the child of a joint, this joint last."""
    parent = bodies.links[joint.parent].name
    by_child = {first.child: first for first in model.joints}
    first = next(weld for weld in model.joints if weld.name == joint.name)
    path = [first]
    while model.links[path[0].parent].name != parent and path[0].parent in by_child:
        path.insert(0, by_child[path[0].parent])
    return path


def _quaternion(joint: RobotJoint) -> Array:
    return np.asarray(quaternion(joint.rotation), np.float64)


def _alike(comparison: Comparison, one: Array, other: Array) -> bool:
    """Return whether poses (s, 7) are the same, up to what rounding in the precision of the engine leaves."""
    least = max(SAME, comparison.tolerance)
    shift, turn = gaps(one, other)
    return bool(np.all(shift / comparison.sizes.length < least) and np.all(turn < least))


def _row(subject: str, engine: Array, truth: Array) -> Compared:
    difference = float(np.max(np.abs(engine - truth)))
    return Compared("differs", "pose", subject, text(engine), text(truth), difference, difference, "frame")


def _axis_row(joint: RobotJoint, engine: object) -> Compared:
    numbers, truth = np.asarray(engine, np.float64), np.asarray(joint.axis, np.float64)
    difference = float(np.max(np.abs(numbers - truth)))
    cause: Cause = "representation" if np.allclose(numbers, -truth, atol=SAME) else "frame"
    return Compared("differs", "axis", joint.name, text(numbers), text(truth), difference, difference, cause)
