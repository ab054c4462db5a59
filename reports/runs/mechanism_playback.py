"""The animation of a mechanism: the truth and the runs at one time step, as `templates/player/mechanism.js` shows them.

A body is drawn in its shape, and without one as sticks: from its own joint to its centre of mass, and from there to the joints
and loops that it carries; as a point if it has neither.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol

import numpy as np

from bodycheck.judging.judgement import Verdict
from bodycheck.reference.definition import Solid
from bodycheck.reference.mechanisms.exact import nearest_inertia, nearest_turn
from bodycheck.reference.mechanisms.mechanism import WORLD, JointedBody, Mechanism
from bodycheck.reference.mechanisms.observables import floats, masses
from bodycheck.reference.scene import Vector
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truth import Truth
from bodycheck.reports.lines import Line
from bodycheck.reports.quantities import listing, milliseconds, number
from bodycheck.reports.runs import tracks
from bodycheck.reports.runs.playback import (
    MOST_NAMES,
    PLACE_TOLERANCE,
    TOO_FAST,
    Playback,
    Shown,
    as_json,
    choose,
    common_step,
    course_of,
    fitting,
    name_of,
    shown_run,
    solid_of,
    turning_of,
)

#: Points between two samples of a path, which is a cubic curve with the velocities of both.
FINER = 4

#: Half the size (m) of a mechanism that has none, such as one point at rest.
SMALLEST = 1e-3


def mechanism_playback(
    mechanism: Mechanism, runs: Mapping[Line, Verdict], truths: Mapping[float, Truth], most: int
) -> Playback | None:
    """Return the animation of a mechanism, or None if no run has a truth to be compared with.

    Parameters are those of `playback.playback`.
    """
    return animation(runs, truths, most, lambda truth, _: _Stage(mechanism, truth.trajectory))


class Stage(Protocol):
    """What all pictures of an animation have in common.

    Attributes
    ----------
    extent
        Half the size (m) of what they show.
    """

    extent: float

    def described(self) -> dict[str, Any]:
        """Return what the player reads of the bodies, of what stands still, and of the side that they are seen from."""

    def parts(self, trajectory: Trajectory) -> list[dict[str, Any]] | None:
        """Return the motions of all bodies as the player reads them; None if one cannot be stored."""


def animation(
    runs: Mapping[Line, Verdict],
    truths: Mapping[float, Truth],
    most: int,
    staged: Callable[[Truth, Sequence[Shown]], Stage],
) -> Playback | None:
    """Return the animation of several bodies, or None if no run has a truth to be compared with.

    staged: makes the stage of a truth and of the runs that are compared with it. Other parameters: see `playback.playback`.
    """
    compared = [line for line, verdict in runs.items() if verdict.discrepancy is not None and line.timestep in truths]
    timestep = common_step(compared)
    if timestep is None:
        return None
    truth = truths[timestep]
    own_runs = {line: verdict for line, verdict in runs.items() if line.timestep == timestep}
    played = [one for line, verdict in own_runs.items() if (one := shown_run(line, verdict, truth)) is not None]
    if not played:
        return Playback(None, "", ("There is no animation because the errors of no run are finite numbers.",))
    stage = staged(truth, played)
    if (parts := stage.parts(truth.trajectory)) is None:
        return Playback(None, "", (f"There is no animation because a body turns by {TOO_FAST}.",))
    if (room := most - len(as_json(parts))) < 0:
        return Playback(None, "", ("There is no animation, to keep this file small.",))
    first = choose(played, stage.extent)
    by_rank = (*first, *(other for other in played if other not in first))
    kept, left_out = fitting({one: _run(stage, one) for one in by_rank}, room)
    undrawn = [name_of(one.line) for one in by_rank if one not in kept and one not in left_out]
    order = [one for one in played if one in kept]
    data = {
        **stage.described(),
        "extent": stage.extent,
        "within": tracks.TOLERANCE,
        "end": float(truth.trajectory.t[-1]),
        "truth": {"parts": parts},
        "runs": [kept[one] for one in order],
        "shown": [order.index(one) for one in first if one in kept],
    }
    return Playback(data, _alt(played), tuple(_notes(timestep, runs, undrawn, [name_of(one.line) for one in left_out])))


class _Stage:
    """What all pictures of a mechanism have in common: the middle of its motion, its extent (m), and the sticks of its bodies.

    `follows` is whether the pictures follow the centre of mass of the truth, as they do where nothing holds the mechanism.
    """

    def __init__(self, mechanism: Mechanism, exact: Trajectory) -> None:
        self.mechanism, self.exact, self.follows = mechanism, exact, floats(mechanism)
        self.points = [_points(mechanism, place) for place in range(len(mechanism.bodies))]
        mass = masses(mechanism)[:, None, None]
        self.centre = (mass * exact.position).sum(axis=0) / mass.sum() if self.follows else np.zeros((len(exact), 3))
        seen = exact.position - self.centre
        radii = np.array([self._radius(place) for place in range(len(mechanism.bodies))])[:, None, None]
        low, high = (seen - radii).min(axis=(0, 1)), (seen + radii).max(axis=(0, 1))
        self.middle = (low + high) / 2
        self.extent = max(float((high - low).max()) / 2, SMALLEST)

    def described(self) -> dict[str, Any]:
        """Return what the player reads of the bodies, of what stands still, and of the side that they are seen from."""
        return {
            "bodies": [self.drawn(place) for place in range(len(self.mechanism.bodies))],
            "fixed": self.fixed(),
            "follows": self.follows,
            "azimuth": self.azimuth(),
        }

    def drawn(self, place: int) -> dict[str, Any]:
        """Return a body as the player reads it: points along its axes, from its centre of mass, in units of the extent."""
        body = self.mechanism.bodies[place]
        own, carried = self.points[place]
        made: dict[str, Any] = {"joints": [self._scaled(point) for point in (*own, *carried)], "sticks": []}
        if isinstance(body.inertia, Solid):
            kind, semi_axes = solid_of(body.inertia.shape)
            lengths = [axis / self.extent for axis in semi_axes]
            return made | {"solid": {"kind": kind, "semi_axes": lengths, "turned": nearest_turn(body.inertia.attitude)}}
        middle = [0.0, 0.0, 0.0]
        sticks = [[self._scaled(point), middle] for point in (*own, *carried) if any(point)]
        return made | ({"sticks": sticks} if sticks else {"joints": [middle]})

    def fixed(self) -> list[list[float]]:
        """Return the places of the world where joints and loops are, in units of the extent."""
        if self.follows:
            return []
        joints = [joint.position for joint in self.mechanism.joints if joint.parent == WORLD]
        loops = [
            point
            for loop in self.mechanism.loops
            for place, point in zip(loop.bodies, loop.points, strict=True)
            if place == WORLD
        ]
        return [((np.array(point) - self.middle) / self.extent).tolist() for point in (*joints, *loops)]

    def azimuth(self) -> float:
        """Return the direction (rad) from which the motion is seen across its widest horizontal extent."""
        flat = (self.exact.position - self.centre)[..., :2].reshape(-1, 2)
        _, axes = np.linalg.eigh(np.cov(flat.T) if len(flat) > 1 else np.eye(2))
        x, y = axes[:, 1]
        return math.atan2(y, x) - math.pi / 2

    def parts(self, trajectory: Trajectory) -> list[dict[str, Any]] | None:
        """Return the motions of all bodies as the player reads them; None if one cannot be stored."""
        found = []
        for place in range(len(self.mechanism.bodies)):
            own = trajectory.body(place)
            if (turning := turning_of(own, math.inf)) is None:
                return None
            t, path = finer_path(own.t, own.position, own.velocity)
            shift = np.column_stack([np.interp(t, self.exact.t, axis) for axis in self.centre.T]) + self.middle
            found.append(turning | course_of(t, (path - shift) / self.extent, PLACE_TOLERANCE))
        return found

    def _radius(self, place: int) -> float:
        """Return the distance (m) of the farthest point of a body from its centre of mass."""
        body, (own, carried) = self.mechanism.bodies[place], self.points[place]
        reaches = [math.hypot(*point) for point in (*own, *carried)]
        if isinstance(body.inertia, Solid):
            reaches.append(math.hypot(*solid_of(body.inertia.shape)[1]))
        return max(reaches, default=0.0)

    def _scaled(self, point: Vector) -> list[float]:
        return [component / self.extent for component in point]


def _run(stage: Stage, run: Shown) -> dict[str, Any] | None:
    """Return a run as the player reads it, or None if it cannot be drawn.

    It has no parts of its own if it moves as the truth does. It has no errors where mechanics gives no motion.
    """
    entry: dict[str, Any] = {"label": name_of(run.line), "colour": run.line.colour}
    errors = {f"{name}_error": run.maxima.get(f"{name}_error", math.nan) for name in ("attitude", "position")}
    entry |= {name: float(f"{error:.4g}") if math.isfinite(error) else None for name, error in errors.items()}
    is_known = np.isfinite(run.truth.position).all()
    near = errors["attitude_error"] <= tracks.TOLERANCE and errors["position_error"] <= PLACE_TOLERANCE * stage.extent
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


def _notes(timestep: float, runs: Mapping[Line, Verdict], undrawn: Sequence[str], left_out: Sequence[str]) -> list[str]:
    """Return sentences on what the animation leaves out."""
    notes = []
    if len({line.timestep for line in runs}) > 1:
        notes.append(f"The animation shows the runs with a time step of {milliseconds(timestep)}.")
    if undrawn:
        names = listing(undrawn, MOST_NAMES, "method")
        notes.append(f"The animation leaves out methods of which a body turns by {TOO_FAST}: {names}.")
    if left_out:
        notes.append(f"The animation leaves out methods to keep this file small: {listing(left_out, MOST_NAMES, 'method')}.")
    return notes
