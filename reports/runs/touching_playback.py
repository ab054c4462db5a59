"""The animation of bodies that touch: the truth and the runs at one time step, on the plane.

It is played as that of a mechanism is. Where mechanics gives inequalities alone, the bodies of the truth are not drawn.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from bodycheck.reference.contact.touching import Touching, touching
from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reports.runs import tracks
from bodycheck.reports.runs.cast import Cast, Shown
from bodycheck.reports.runs.mechanism_playback import SMALLEST, finer_path, staged
from bodycheck.reports.runs.playback import PLACE_TOLERANCE, Frame, Playback, course_of, solid_of, turning_of

#: Lines of the grid of the plane to either side of the middle, and half of its width in extents.
GRID, WIDE = 6, 1.5


def touching_playback(scene: AnyScene, shown: Cast, most: int) -> Playback:
    """Return the animation of bodies that touch; see `animation.animated`."""
    return staged(_Stage(scene, shown.exact, shown.runs), shown, most)


def described(scene: AnyScene, frame: Frame) -> dict[str, Any]:
    """Return what the player reads of the bodies, of the plane, and of the side that they are seen from."""
    return {
        "bodies": [_drawn(body, frame.extent) for body in touching(scene)],
        "fixed": [],
        "follows": False,
        "azimuth": frame.azimuth,
        "ground": _ground(touching(scene)[0], frame),
        "known": frame.known,
        "extent": frame.extent,
        "within": tracks.TOLERANCE,
    }


class _Stage:
    """What all pictures have in common: the middle of a motion, half its size (m), and until when the truth is known."""

    def __init__(self, scene: AnyScene, truth: Trajectory, played: Sequence[Shown]) -> None:
        self.scene = scene
        exact = _several(truth)
        known = np.asarray(np.isfinite(exact.position).all(axis=(0, 2)))
        count = len(known) if known.all() else int(np.argmin(known))
        seen = [exact.position[:, :count], _start(scene).position]
        if not known.all():
            seen += [_several(one.trajectory).position for one in played]
        radii = np.array([math.hypot(*solid_of(body.shape)[1]) for body in touching(scene)])[:, None, None]
        low = np.min([(each - radii).min(axis=(0, 1)) for each in seen if each.size], axis=0)
        high = np.max([(each + radii).max(axis=(0, 1)) for each in seen if each.size], axis=0)
        x, y, z = ((low + high) / 2).tolist()
        end = float(exact.t[count - 1]) if count else -1.0
        self.frame = Frame((x, y, z), max(float((high - low).max()) / 2, SMALLEST), -math.pi / 2, end)

    def described(self) -> dict[str, Any]:
        """Return what the player reads besides motions; see `mechanism_playback.Stage`."""
        return described(self.scene, self.frame)

    def parts(self, trajectory: Trajectory) -> list[dict[str, Any]] | None:
        """Return the motions of all bodies as the player reads them, those of a truth at rest after it is known."""
        whole, found = _filled(_several(trajectory), _start(self.scene)), []
        for place in range(len(whole.position)):
            own = whole.body(place)
            if (turning := turning_of(own, math.inf)) is None:
                return None
            t, path = finer_path(own.t, own.position, own.velocity)
            found.append(turning | course_of(t, (path - np.array(self.frame.middle)) / self.frame.extent, PLACE_TOLERANCE))
        return found


def _drawn(body: Touching, extent: float) -> dict[str, Any]:
    kind, semi_axes = solid_of(body.shape)
    solid = {"kind": kind, "semi_axes": [axis / extent for axis in semi_axes], "turned": (1.0, 0.0, 0.0, 0.0)}
    return {"joints": [], "sticks": [], "solid": solid}


def _ground(body: Touching, frame: Frame) -> list[list[list[float]]]:
    """Return the ends of the lines of a grid on the plane, in units of the extent. body: any of those that touch it."""
    normal, middle = np.array(body.normal), np.array(frame.middle)
    along, across = np.array([normal[2], 0.0, -normal[0]]), np.array([0.0, 1.0, 0.0])
    under = middle - (middle @ normal) * normal
    centre, lines = (under - middle) / frame.extent, []
    for k in range(-GRID, GRID + 1):
        for one, other in ((along, across), (across, along)):
            beside = centre + WIDE * k / GRID * one
            lines.append([(beside + side * WIDE * other).tolist() for side in (-1, 1)])
    return lines


def _several(trajectory: Trajectory) -> Trajectory:
    """Return the states (b, n, ...) of all bodies, of one body alone too."""
    if trajectory.position.ndim == 3:
        return trajectory
    states = (trajectory.position, trajectory.quaternion, trajectory.velocity, trajectory.angular_velocity)
    return Trajectory(trajectory.t, *(values[None] for values in states))


def _start(scene: AnyScene) -> Trajectory:
    """Return the states (b, 1, ...) at t = 0."""
    if isinstance(scene, Mechanism):
        return kinematics.initial(scene)
    assert isinstance(scene, Scene)
    begin = scene.initial
    states = (begin.position, begin.quaternion, begin.velocity, begin.angular_velocity)
    return Trajectory(np.zeros(1), *(np.array(values)[None, None] for values in states))


def _filled(trajectory: Trajectory, start: Trajectory) -> Trajectory:
    """Return states (b, n, ...) of which those that are not known are the last known ones, at rest."""
    known = np.asarray(np.isfinite(trajectory.position).all(axis=(0, 2)))
    if known.all():
        return trajectory
    count = int(np.argmin(known))

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
