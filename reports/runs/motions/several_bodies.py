"""The animation of bodies on joints, and of bodies that touch, as `templates/player/mechanism.js` shows them.

A body with a shape is drawn as the shape. A body without a shape is drawn as capsules, whose middle lines are its sticks: from
its own joint to the joints and loops that it carries, or to its centre of mass if it carries none or is bent. It has an arm
from its joint if they do not show its angle, and is a point if it has none of these. While mechanics only gives inequalities,
the bodies of the truth are not drawn.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bodycheck.reference.bodies import AnyBody, bodies, initial, of_bodies
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.mechanisms.exact import nearest_inertia, nearest_turn
from bodycheck.reference.mechanisms.mechanism import WORLD, AnyScene, JointedBody, Mechanism
from bodycheck.reference.mechanisms.observables import floats
from bodycheck.reference.scene import Plane, Solid, Vector
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reports.quantities import number
from bodycheck.reports.runs.motions import tracks
from bodycheck.reports.runs.motions.cast import Cast, Shown, name_of
from bodycheck.reports.runs.motions.driven import arm_of, driven, places_at_targets
from bodycheck.reports.runs.motions.playback import (
    PLACE_TOLERANCE,
    TOO_FAST,
    Frame,
    Stage,
    course_of,
    solid_of,
    turning_of,
)

#: The number of pieces into which a path is divided between two samples; it is a cubic curve with the velocities of both.
FINER = 4

#: The least extent (m) of pictures, for bodies without a size, such as a point at rest.
SMALLEST = 1e-3

#: The distance of the centre of mass from the line between two joints, relative to their distance, above which a body is bent.
BENT = 0.3

#: The number of lines of the grid on either side of the middle, and half the width of the grid in extents.
GRID, WIDE = 6, 1.5


@dataclass(frozen=True, eq=False)
class _View:
    """The view of the pictures: the path (n, 3), m, that they follow at instants (n,), s, and their frame."""

    scene: AnyScene
    t: Array
    path: Array
    frame: Frame

    def parts(self, trajectory: Trajectory) -> list[dict[str, Any]] | None:
        """Return the motions of all bodies as the player reads them; None if one cannot be stored.

        At instants where the motion of a truth is not known, the bodies are at rest.
        """
        whole, parts = _filled(of_bodies(trajectory), self.scene), []
        for index in range(len(whole.position)):
            motion = whole.body(index)
            if (turning := turning_of(motion, math.inf)) is None:
                return None
            t, path = finer_path(motion.t, motion.position, motion.velocity)
            shift = np.column_stack([np.interp(t, self.t, axis) for axis in self.path.T]) + np.array(self.frame.middle)
            parts.append(turning | course_of(t, (path - shift) / self.frame.extent, PLACE_TOLERANCE))
        return parts

    def run(self, run: Shown) -> dict[str, Any] | None:
        """Return the motion of a run as the player reads it, or None if it cannot be drawn.

        The motion is empty if the run moves as the truth does.
        """
        attitude, position = (run.maxima.get(f"{name}_error", math.nan) for name in ("attitude", "position"))
        near = attitude <= tracks.TOLERANCE and position <= PLACE_TOLERANCE * self.frame.extent
        if near and np.isfinite(run.truth.position).all():
            return {}
        parts = self.parts(run.trajectory)
        return None if parts is None else {"parts": parts}


def stage_of(scene: AnyScene, shown: Cast) -> Stage | str:
    """Return the pictures of bodies on joints or of bodies that touch, or the reason why there are none."""
    view = _on_plane(scene, shown) if scene.plane is not None else _in_space(scene, shown)
    if (parts := view.parts(shown.exact)) is None:
        return f"a body turns by {TOO_FAST}"
    return Stage(
        described(scene, view.frame, float(shown.exact.t[-1])),
        {"parts": parts},
        view.run,
        view.frame.extent,
        _alt(shown.runs),
        f"methods of which a body turns by {TOO_FAST}",
        frame=view.frame,
    )


def described(scene: AnyScene, frame: Frame, end: float) -> dict[str, Any]:
    """Return the data of the bodies, the fixed points, the grid and the view for the player. end: the last instant (s)."""
    on_plane = {} if scene.plane is None else {"ground": _ground(scene.plane, frame), "known": frame.known}
    return {
        "bodies": [_drawn(scene, index, body, frame) for index, body in enumerate(bodies(scene))],
        "driven": driven(scene, frame, end),
        "fixed": _fixed(scene, frame),
        "follows": _follows(scene),
        "azimuth": frame.azimuth,
        **on_plane,
        "extent": frame.extent,
        "within": tracks.TOLERANCE,
    }


def _in_space(scene: AnyScene, shown: Cast) -> _View:
    """Return the view of bodies on joints.

    The pictures contain the bodies of the truth, and the same at the targets of their joints. If nothing holds or pushes the
    bodies, the pictures follow the centre of mass of the truth. They look at right angles to the widest horizontal extent of
    the motion, arms included.
    """
    exact = of_bodies(shown.exact)
    centre = _centre(scene, exact) if _follows(scene) else np.zeros((len(exact), 3))
    seen, *wanted = (positions - centre for positions in (exact.position, *places_at_targets(scene, exact)))
    ends = [(index, end) for index in range(len(exact.position)) for end in _arm(scene, index)]
    arms = [seen[index] + rotate(exact.quaternion[index], np.array(end)) for index, end in ends]
    flat = np.concatenate([*seen, *arms])[:, :2]
    _, axes = np.linalg.eigh(np.cov(flat.T) if len(flat) > 1 else np.eye(2))
    x, y = axes[:, 1]
    return _View(scene, exact.t, centre, _frame(scene, [seen, *wanted], math.atan2(y, x) - math.pi / 2))


def _on_plane(scene: AnyScene, shown: Cast) -> _View:
    """Return the view of bodies on a plane, which is fixed.

    It contains the truth as far as it is known, and the runs if the truth is not known at all instants.
    """
    exact = of_bodies(shown.exact)
    count = _known(exact)
    seen = [exact.position[:, :count], initial(scene).position]
    if count < len(exact):
        seen += [of_bodies(run.trajectory).position for run in shown.runs]
    end = float(exact.t[count - 1]) if count else -1.0
    frame = _frame(scene, [positions for positions in seen if positions.size], -math.pi / 2, end)
    return _View(scene, exact.t, np.zeros((len(exact), 3)), frame)


def _frame(scene: AnyScene, seen: Sequence[Array], azimuth: float, known: float | None = None) -> Frame:
    """Return the frame of pictures that contain the bodies at all positions. seen: arrays of positions (b, n, 3), m."""
    ends = [[*_points(scene, index), *_arm(scene, index)] for index in range(len(bodies(scene)))]
    radii = np.array([_radius(*each) for each in zip(bodies(scene), ends, strict=True)])[:, None, None]
    low = np.min([(positions - radii).min(axis=(0, 1)) for positions in seen], axis=0)
    high = np.max([(positions + radii).max(axis=(0, 1)) for positions in seen], axis=0)
    x, y, z = ((low + high) / 2).tolist()
    return Frame((x, y, z), max(float((high - low).max()) / 2, SMALLEST), azimuth, known)


def _follows(scene: AnyScene) -> bool:
    return isinstance(scene, Mechanism) and floats(scene)


def _centre(scene: AnyScene, exact: Trajectory) -> Array:
    """Return the path (n, 3), m, of the centre of mass of all bodies."""
    mass = np.array([body.mass for body in bodies(scene)])[:, None, None]
    return np.asarray((mass * exact.position).sum(axis=0) / mass.sum())


def _known(trajectory: Trajectory) -> int:
    """Return the number of instants, from the first on, for which mechanics determines the motion."""
    known = np.asarray(np.isfinite(trajectory.position).all(axis=(0, 2)))
    return len(known) if known.all() else int(np.argmin(known))


def _drawn(scene: AnyScene, index: int, body: AnyBody, frame: Frame) -> dict[str, Any]:
    """Return a body as the player reads it, with lengths in units of the extent."""
    points = [[component / frame.extent for component in point] for point in _points(scene, index)]
    parts: dict[str, Any] = {"joints": points, "sticks": []}
    if body.shape is not None:
        kind, semi_axes = solid_of(body.shape)
        lengths = [axis / frame.extent for axis in semi_axes]
        return parts | {"solid": {"kind": kind, "semi_axes": lengths, "turned": _turned(body)}}
    sticks = [[[component / frame.extent for component in end] for end in stick] for stick in sticks_of(scene, index)]
    return parts | ({"sticks": sticks} if sticks else {"joints": [[0.0, 0.0, 0.0]]})


def _turned(body: AnyBody) -> tuple[float, ...]:
    """Return the quaternion (w, x, y, z) that turns components along the axes of a body's shape into components in the body."""
    inertia = body.given.inertia if isinstance(body.given, JointedBody) else None
    return nearest_turn(inertia.attitude) if isinstance(inertia, Solid) else (1.0, 0.0, 0.0, 0.0)


def _fixed(scene: AnyScene, frame: Frame) -> list[list[float]]:
    """Return the points of joints and loops that are fixed in the world, in units of the extent."""
    if not isinstance(scene, Mechanism) or floats(scene):
        return []
    joints = [joint.position for joint in scene.joints if joint.parent == WORLD]
    loops = [point for loop in scene.loops for body, point in zip(loop.bodies, loop.points, strict=True) if body == WORLD]
    return [((np.array(point) - frame.middle) / frame.extent).tolist() for point in (*joints, *loops)]


def _radius(body: AnyBody, ends: Sequence[Vector]) -> float:
    """Return the distance (m) of the farthest point of a body from its centre of mass. ends: of its sticks, from there (m)."""
    reaches = [math.hypot(*point) for point in ends]
    if body.shape is not None:
        reaches.append(math.hypot(*solid_of(body.shape)[1]))
    return max(reaches, default=0.0)


def _points(scene: AnyScene, index: int) -> list[Vector]:
    """Return the points (m) of a body's own joint, and of the joints and loops that it carries.

    They are relative to the centre of mass of the body, along its axes.
    """
    if not isinstance(scene, Mechanism):
        return []
    points = [(0.0, 0.0, 0.0)] if scene.joint_of[index] is not None else []
    points += [joint.position for joint in scene.joints if joint.parent == index]
    for loop in scene.loops:
        points += [point for body, point in zip(loop.bodies, loop.points, strict=True) if body == index]
    a, b, c = nearest_inertia(scene.bodies[index]).centre
    return [(x - a, y - b, z - c) for x, y, z in points]


def sticks_of(scene: AnyScene, index: int) -> list[tuple[Vector, Vector]]:
    """Return the ends (m) of the sticks of a body without a shape, from its centre of mass along its axes."""
    points, middle = _points(scene, index), (0.0, 0.0, 0.0)
    carried = points[1:] if isinstance(scene, Mechanism) and scene.joint_of[index] is not None else []
    links = [(points[0], point) for point in carried if point != points[0]]
    if not links or any(_is_bent(*link) for link in links):
        links = [(point, middle) for point in points if any(point)]
    return [*links, *((points[0], end) for end in _arm(scene, index))]


def _is_bent(start: Vector, end: Vector) -> bool:
    """Return whether the centre of mass is far from the line between two joints, which then does not look like the body."""
    along = np.subtract(end, start)
    return float(np.linalg.norm(np.cross(start, along))) > BENT * float(along @ along)


def _arm(scene: AnyScene, index: int) -> list[Vector]:
    """Return the end of the arm of a body that looks the same at all angles of its joint; empty for others."""
    arm = arm_of(scene, index, _points(scene, index))
    return [] if arm is None else [arm]


def _ground(plane: Plane, frame: Frame) -> list[list[list[float]]]:
    """Return the end points of the lines of a grid on the plane, in units of the extent."""
    normal, middle = np.array(plane.normal), np.array(frame.middle)
    along, across = np.array([normal[2], 0.0, -normal[0]]), np.array([0.0, 1.0, 0.0])
    under = middle - (middle @ normal) * normal
    centre, lines = (under - middle) / frame.extent, []
    for k in range(-GRID, GRID + 1):
        for apart, lengthwise in ((along, across), (across, along)):
            beside = centre + WIDE * k / GRID * apart
            lines.append([(beside + side * WIDE * lengthwise).tolist() for side in (-1, 1)])
    return lines


def _filled(trajectory: Trajectory, scene: AnyScene) -> Trajectory:
    """Return states (b, n, ...) in which unknown states are replaced by the last known or initial state, at rest."""
    known = np.asarray(np.isfinite(trajectory.position).all(axis=(0, 2)))
    if known.all():
        return trajectory
    count, start = int(np.argmin(known)), initial(scene)

    def held(values: Array, first: Array, moves: bool) -> Array:
        last = values[:, count - 1 : count] if count else first
        return np.where(known[:, None], values, last * (0.0 if moves else 1.0))

    return replace(
        trajectory,
        position=held(trajectory.position, start.position, moves=False),
        quaternion=held(trajectory.quaternion, start.quaternion, moves=False),
        velocity=held(trajectory.velocity, start.velocity, moves=True),
        angular_velocity=held(trajectory.angular_velocity, start.angular_velocity, moves=True),
    )


def finer_path(t: Array, position: Array, velocity: Array) -> tuple[Array, Array]:
    """Return instants and positions of a path at `FINER` times as many points, on a cubic curve through the samples."""
    from scipy.interpolate import CubicHermiteSpline  # its import takes as long as most reports without mechanisms

    shares = np.arange(len(t) * FINER - FINER + 1) / FINER
    instants = np.interp(shares, np.arange(len(t)), t)
    return instants, np.asarray(CubicHermiteSpline(t, position, velocity)(instants))


def _alt(runs: Sequence[Shown]) -> str:
    known = [run for run in runs if "position_error" in run.maxima]
    told = "Animation of all bodies of the truth and of some runs, side by side."
    if not known:
        return told
    worst = max(known, key=lambda run: run.maxima["position_error"])
    return f"{told} The largest position error is {number(worst.maxima['position_error'], 3)} m, with {name_of(worst.line)}."
