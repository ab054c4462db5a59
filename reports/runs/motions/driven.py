"""The targets and the stops of joints, as `templates/player/driven.js` shows them.

The body of a joint is shown once more at its target, as an outline, and lines from the joint show where it is at a stop. Their
places follow from the pose of the parent, so that they belong to the motion in which they are shown. A body that looks the same
at all angles of its joint has an arm, which shows its angle.
"""

from typing import Any

import numpy as np

from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.mechanisms.coordinates import places
from bodycheck.reference.mechanisms.exact import nearest_inertia, nearest_turn
from bodycheck.reference.mechanisms.mechanism import WORLD, AnyScene, Joint, Mechanism, breadth_first, shape_of
from bodycheck.reference.mechanisms.observables import tensor
from bodycheck.reference.scene import Vector
from bodycheck.reference.trajectory import Array, Trajectory, stacked
from bodycheck.reports.runs.motions.playback import Frame
from bodycheck.reports.runs.targets import target_of

#: The most points of a target.
MOST_POINTS = 400

#: Half the length of the lines at a stop of a prismatic joint, and the part of a body along which those of a revolute joint are
#: drawn; in extents, and as a share.
BAR, PART = 0.12, 0.8

#: The distance from the axis, relative to the size of a body, below which a point counts as on the axis.
ON_AXIS = 1e-6


def driven(scene: AnyScene, frame: Frame, end: float) -> list[dict[str, Any]]:
    """Return the joints that have a target or stops, each after those that carry it, as the player reads them.

    Lengths, and so the coordinates of prismatic joints, are in units of the extent. end: the last instant (s).
    """
    if not isinstance(scene, Mechanism):
        return []
    targets, entries = _targets(scene, end), []
    for body in breadth_first(scene):
        joint = scene.joint_of[body]
        if joint is None or joint.type not in ("revolute", "prismatic"):
            continue
        target, stops = targets.get(scene.joints.index(joint)), joint.stops
        if target is None and stops is None:
            continue
        unit = frame.extent if joint.type == "prismatic" else 1.0
        entry = _place(scene, joint, frame)
        if target is not None:
            entry["target"] = {"t": target[0].tolist(), "value": (target[1] / unit).tolist()}
        if stops is not None:
            entry["stops"] = [value / unit for value in (stops.lower, stops.upper) if value is not None]
            entry["lines"] = (np.array(_lines(scene, joint, frame)) / frame.extent).tolist()
        entries.append(entry)
    return entries


def places_at_targets(scene: AnyScene, exact: Trajectory) -> list[Array]:
    """Return the places (b, n, 3), m, of the bodies in a motion whose joints are at their targets; none without targets."""
    if not isinstance(scene, Mechanism):
        return []
    targets = _targets(scene, float(exact.t[-1]))
    if not targets:
        return []
    motion, slices = kinematics.joints(scene, exact), places(scene)
    for joint, target in targets.items():
        motion.position[:, slices[joint][0]] = np.interp(exact.t, *target)[:, None]
    free = [exact.body(index) for index, joint in enumerate(scene.joint_of) if joint is None]
    return [kinematics.bodies(scene, motion, stacked(exact.t, free) if free else None, exact.t).position]


def arm_of(scene: AnyScene, body: int, points: list[Vector]) -> Vector | None:
    """Return the end of the arm of a body without shape whose points are all on the axis of its revolute joint, else None.

    points: of its joints and loops, its own joint first, relative to its centre of mass (m), as the returned one is.
    """
    joint = scene.joint_of[body] if isinstance(scene, Mechanism) else None
    if (
        not isinstance(scene, Mechanism)
        or joint is None
        or joint.type != "revolute"
        or shape_of(scene.bodies[body]) is not None
    ):
        return None
    across = [_across(joint, np.subtract(point, points[0])) for point in [*points, (0.0, 0.0, 0.0)]]
    size = _size(scene, body)
    if max(float(np.linalg.norm(each)) for each in across) > ON_AXIS * size:
        return None
    x, y, z = (np.array(points[0]) + size * _perpendicular(joint)).tolist()
    return x, y, z


def _targets(mechanism: Mechanism, end: float) -> dict[int, tuple[Array, Array]]:
    """Return the targets that are drawn, by the index of the joint. end: the last instant (s)."""
    targets = {each.joint: target_of(each, end, MOST_POINTS) for each in mechanism.controllers}
    return {joint: target for joint, target in targets.items() if target is not None}


def _place(mechanism: Mechanism, joint: Joint, frame: Frame) -> dict[str, Any]:
    """Return where a joint is on its parent, and where the centre of mass of its child is on the joint."""
    world = joint.parent == WORLD
    origin = frame.middle if world else nearest_inertia(mechanism.bodies[joint.parent]).centre
    centre = np.array(nearest_inertia(mechanism.bodies[joint.child]).centre)
    return {
        "body": joint.child,
        "parent": joint.parent,
        "at": (np.subtract(joint.position, origin) / frame.extent).tolist(),
        "turn": nearest_turn(joint.attitude),
        "axis": _axis(joint).tolist(),
        "slides": joint.type == "prismatic",
        "centre": (centre / frame.extent).tolist(),
    }


def _lines(mechanism: Mechanism, joint: Joint, frame: Frame) -> list[list[Array]]:
    """Return the lines (m) that mark a stop, in the frame of the child: an arm of it, or a cross at right angles to a slide."""
    if joint.type == "prismatic":
        one = _perpendicular(joint)
        return [[-BAR * frame.extent * way, BAR * frame.extent * way] for way in (one, np.cross(_axis(joint), one))]
    centre = np.array(nearest_inertia(mechanism.bodies[joint.child]).centre)
    points = [centre, *(np.array(other.position) for other in mechanism.joints if other.parent == joint.child)]
    farthest = max((_across(joint, point) for point in points), key=lambda way: float(np.linalg.norm(way)))
    size = _size(mechanism, joint.child)
    if float(np.linalg.norm(farthest)) <= ON_AXIS * size:
        farthest = size * _perpendicular(joint)
    return [[np.zeros(3), PART * farthest]]


def _axis(joint: Joint) -> Array:
    return np.asarray(np.array(joint.axis) / np.linalg.norm(joint.axis))


def _across(joint: Joint, way: Array) -> Array:
    """Return the part of a vector that is at right angles to the axis of a joint."""
    axis = _axis(joint)
    return np.asarray(way - (way @ axis) * axis)


def _perpendicular(joint: Joint) -> Array:
    """Return a unit vector at right angles to the axis of a joint: the coordinate axis farthest from it, made perpendicular."""
    way = _across(joint, np.eye(3)[int(np.argmin(np.abs(_axis(joint))))])
    return np.asarray(way / np.linalg.norm(way))


def _size(mechanism: Mechanism, body: int) -> float:
    """Return the largest radius of gyration (m) of a body; 1 m for one without inertia."""
    mass = nearest_inertia(mechanism.bodies[body]).mass
    largest = float(np.linalg.eigvalsh(tensor(mechanism.bodies[body])).max())
    return float(np.sqrt(largest / mass)) if mass > 0 and largest > 0 else 1.0
