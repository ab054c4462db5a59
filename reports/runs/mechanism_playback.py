"""The animation of a mechanism: the truth and the runs at one time step, as `templates/player/mechanism.js` shows them.

A body is drawn in its shape, and without one as sticks: from its own joint to its centre of mass, and from there to the joints
and loops that it carries; as a point if it has neither.
"""

import math
from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np

from bodycheck.reference.mechanisms.exact import nearest_inertia, nearest_turn
from bodycheck.reference.mechanisms.mechanism import WORLD, JointedBody, Mechanism
from bodycheck.reference.mechanisms.observables import floats, masses
from bodycheck.reference.scene import Solid, Vector
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reports.quantities import listing, milliseconds, number
from bodycheck.reports.runs import tracks
from bodycheck.reports.runs.cast import Cast, Shown, as_json, choose, fitting, name_of
from bodycheck.reports.runs.playback import (
    MOST_NAMES,
    PLACE_TOLERANCE,
    TOO_FAST,
    Frame,
    Playback,
    course_of,
    solid_of,
    turning_of,
)

#: Points between two samples of a path, which is a cubic curve with the velocities of both.
FINER = 4

#: Half the size (m) of a mechanism that has none, such as one point at rest.
SMALLEST = 1e-3


def mechanism_playback(mechanism: Mechanism, shown: Cast, most: int) -> Playback:
    """Return the animation of a mechanism; see `animation.animated`."""
    return staged(_Stage(mechanism, shown.exact), shown, most)


class Stage(Protocol):
    """What all pictures of an animation have in common."""

    @property
    def frame(self) -> Frame:
        """Return what the pictures show besides the bodies."""

    def described(self) -> dict[str, Any]:
        """Return what the player reads of the bodies, of what stands still, and of the side that they are seen from."""

    def parts(self, trajectory: Trajectory) -> list[dict[str, Any]] | None:
        """Return the motions of all bodies as the player reads them; None if one cannot be stored."""


def staged(stage: Stage, shown: Cast, most: int) -> Playback:
    """Return the animation of several bodies; see `animation.animated`."""
    played = shown.runs
    if not played:
        return Playback(None, "", ("There is no animation because the errors of no run are finite numbers.",))
    if (parts := stage.parts(shown.exact)) is None:
        return Playback(None, "", (f"There is no animation because a body turns by {TOO_FAST}.",))
    if (room := most - len(as_json(parts))) < 0:
        return Playback(None, "", ("There is no animation, to keep this file small.",))
    first = choose(played, stage.frame.extent)
    by_rank = (*first, *(other for other in played if other not in first))
    kept, left_out = fitting({one: _run(stage, one) for one in by_rank}, room)
    undrawn = [name_of(one.line) for one in by_rank if one not in kept and one not in left_out]
    order = [one for one in played if one in kept]
    data = {
        **stage.described(),
        "end": float(shown.exact.t[-1]),
        "truth": {"parts": parts},
        "runs": [kept[one] for one in order],
        "shown": [order.index(one) for one in first if one in kept],
    }
    notes = tuple(_notes(shown, undrawn, [name_of(one.line) for one in left_out]))
    return Playback(data, _alt(played), notes, stage.frame)


def described(mechanism: Mechanism, frame: Frame) -> dict[str, Any]:
    """Return what the player reads of the bodies, of what stands still, and of the side that they are seen from."""
    return {
        "bodies": [_drawn(mechanism, place, frame.extent) for place in range(len(mechanism.bodies))],
        "fixed": _fixed(mechanism, frame),
        "follows": floats(mechanism),
        "azimuth": frame.azimuth,
        "extent": frame.extent,
        "within": tracks.TOLERANCE,
    }


class _Stage:
    """What all pictures of a mechanism have in common: the middle of its motion, and its extent (m).

    Where nothing holds the mechanism, the pictures follow the centre of mass of the truth.
    """

    def __init__(self, mechanism: Mechanism, exact: Trajectory) -> None:
        self.mechanism, self.exact = mechanism, exact
        mass = masses(mechanism)[:, None, None]
        follows = floats(mechanism)
        self.centre = (mass * exact.position).sum(axis=0) / mass.sum() if follows else np.zeros((len(exact), 3))
        seen = exact.position - self.centre
        radii = np.array([_radius(mechanism, place) for place in range(len(mechanism.bodies))])[:, None, None]
        low, high = (seen - radii).min(axis=(0, 1)), (seen + radii).max(axis=(0, 1))
        x, y, z = ((low + high) / 2).tolist()
        self.frame = Frame((x, y, z), max(float((high - low).max()) / 2, SMALLEST), self._azimuth())

    def described(self) -> dict[str, Any]:
        """Return what the player reads besides motions; see `Stage`."""
        return described(self.mechanism, self.frame)

    def parts(self, trajectory: Trajectory) -> list[dict[str, Any]] | None:
        """Return the motions of all bodies as the player reads them; None if one cannot be stored."""
        found = []
        for place in range(len(self.mechanism.bodies)):
            own = trajectory.body(place)
            if (turning := turning_of(own, math.inf)) is None:
                return None
            t, path = finer_path(own.t, own.position, own.velocity)
            shift = np.column_stack([np.interp(t, self.exact.t, axis) for axis in self.centre.T]) + np.array(self.frame.middle)
            found.append(turning | course_of(t, (path - shift) / self.frame.extent, PLACE_TOLERANCE))
        return found

    def _azimuth(self) -> float:
        """Return the direction (rad) from which the motion is seen across its widest horizontal extent."""
        flat = (self.exact.position - self.centre)[..., :2].reshape(-1, 2)
        _, axes = np.linalg.eigh(np.cov(flat.T) if len(flat) > 1 else np.eye(2))
        x, y = axes[:, 1]
        return math.atan2(y, x) - math.pi / 2


def _drawn(mechanism: Mechanism, place: int, extent: float) -> dict[str, Any]:
    """Return a body as the player reads it: points along its axes, from its centre of mass, in units of the extent."""
    body = mechanism.bodies[place]
    own, carried = _points(mechanism, place)
    points = [_scaled(point, extent) for point in (*own, *carried)]
    made: dict[str, Any] = {"joints": points, "sticks": []}
    if isinstance(body.inertia, Solid):
        kind, semi_axes = solid_of(body.inertia.shape)
        lengths = [axis / extent for axis in semi_axes]
        return made | {"solid": {"kind": kind, "semi_axes": lengths, "turned": nearest_turn(body.inertia.attitude)}}
    middle = [0.0, 0.0, 0.0]
    sticks = [[point, middle] for point in points if any(point)]
    return made | ({"sticks": sticks} if sticks else {"joints": [middle]})


def _fixed(mechanism: Mechanism, frame: Frame) -> list[list[float]]:
    """Return the places of the world where joints and loops are, in units of the extent."""
    if floats(mechanism):
        return []
    joints = [joint.position for joint in mechanism.joints if joint.parent == WORLD]
    loops = [point for loop in mechanism.loops for place, point in zip(loop.bodies, loop.points, strict=True) if place == WORLD]
    return [((np.array(point) - frame.middle) / frame.extent).tolist() for point in (*joints, *loops)]


def _radius(mechanism: Mechanism, place: int) -> float:
    """Return the distance (m) of the farthest point of a body from its centre of mass."""
    body, (own, carried) = mechanism.bodies[place], _points(mechanism, place)
    reaches = [math.hypot(*point) for point in (*own, *carried)]
    if isinstance(body.inertia, Solid):
        reaches.append(math.hypot(*solid_of(body.inertia.shape)[1]))
    return max(reaches, default=0.0)


def _scaled(point: Vector, extent: float) -> list[float]:
    return [component / extent for component in point]


def _run(stage: Stage, run: Shown) -> dict[str, Any] | None:
    """Return a run as the player reads it, or None if it cannot be drawn.

    It has no parts of its own if it moves as the truth does. It has no errors where mechanics gives no motion.
    """
    entry: dict[str, Any] = {"label": name_of(run.line), "colour": run.line.colour}
    errors = {f"{name}_error": run.maxima.get(f"{name}_error", math.nan) for name in ("attitude", "position")}
    entry |= {name: float(f"{error:.4g}") if math.isfinite(error) else None for name, error in errors.items()}
    is_known = np.isfinite(run.truth.position).all()
    near = errors["attitude_error"] <= tracks.TOLERANCE and errors["position_error"] <= PLACE_TOLERANCE * stage.frame.extent
    if is_known and near:
        return entry
    parts = stage.parts(run.trajectory)
    return None if parts is None else entry | {"parts": parts}


def _points(mechanism: Mechanism, place: int) -> tuple[list[Vector], list[Vector]]:
    """Return the points (m) of a body's own joint, and of the joints and loops that it carries, from its centre of mass."""
    body = mechanism.bodies[place]
    own = [_beside(body, (0.0, 0.0, 0.0))] if mechanism.joint_of[place] is not None else []
    carried = [_beside(body, joint.position) for joint in mechanism.joints if joint.parent == place]
    for loop in mechanism.loops:
        carried += [_beside(body, point) for held, point in zip(loop.bodies, loop.points, strict=True) if held == place]
    return own, carried


def _beside(body: JointedBody, point: Vector) -> Vector:
    (x, y, z), (a, b, c) = point, nearest_inertia(body).centre
    return x - a, y - b, z - c


def finer_path(t: Array, position: Array, velocity: Array) -> tuple[Array, Array]:
    """Return a path at more instants, between which straight lines follow it better: a cubic curve through the samples."""
    from scipy.interpolate import CubicHermiteSpline  # takes as long to import as most reports without mechanisms take

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


def _notes(shown: Cast, undrawn: Sequence[str], left_out: Sequence[str]) -> list[str]:
    """Return sentences on what the animation leaves out."""
    notes = []
    if shown.several:
        notes.append(f"The animation shows the runs with a time step of {milliseconds(shown.timestep)}.")
    if undrawn:
        names = listing(undrawn, MOST_NAMES, "method")
        notes.append(f"The animation leaves out methods of which a body turns by {TOO_FAST}: {names}.")
    if left_out:
        notes.append(f"The animation leaves out methods to keep this file small: {listing(left_out, MOST_NAMES, 'method')}.")
    return notes
