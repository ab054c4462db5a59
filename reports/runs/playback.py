"""The animation of a case: the truth and the runs at one time step, as `templates/player/` shows them side by side."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bodycheck.reference.inertia import angular_momentum
from bodycheck.reference.kinematics import normalise
from bodycheck.reference.scene import Body, Brick, Cylinder, Ellipsoid, Scene, Shape, Sphere, Vector
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reports.quantities import listing, milliseconds, number
from bodycheck.reports.runs import tracks
from bodycheck.reports.runs.cast import MOST_SHOWN, Cast, Shown, as_json, choose, fitting, name_of

#: Most characters of all playback data of a report, shared evenly by its cases.
MOST_CHARACTERS = 1_500_000

#: Most methods that one note names.
MOST_NAMES = 6

#: Largest deviation of a body rate from its sample, relative to the largest rate: the width of a line on the polhode.
RATE_TOLERANCE = 0.01

#: Largest deviation of a position from its sample, relative to the body's reach.
PLACE_TOLERANCE = 0.01

#: Largest deviation of the position of a body that is farther than its reach from the truth, relative to that distance.
SHIFT_TOLERANCE = 0.003

#: Positions farther than this many reaches are not drawn, because 16 bits could not resolve the body there.
FARTHEST = 1e9

#: Smallest semi-axis that is drawn, relative to the longest, so that even a needle is visible.
THINNEST = 0.02

#: Why a rotation cannot be stored, for sentences that begin with what turns.
TOO_FAST = f"more than {tracks.COARSEST:g} rad between samples, or more than {tracks.MOST_INSTANTS} stored instants can show"


@dataclass(frozen=True)
class Frame:
    """What the pictures of several bodies show, besides the bodies themselves.

    Parameters
    ----------
    middle
        The middle of the pictures (m).
    extent
        Half the size (m) of what they show.
    azimuth
        The direction (rad) that the bodies are seen from.
    known
        The instant (s) until which mechanics gives a motion, negative where it gives none; None of bodies that touch nothing.
    """

    middle: Vector
    extent: float
    azimuth: float
    known: float | None = None


@dataclass(frozen=True)
class Playback:
    """The animation of one case.

    Parameters
    ----------
    data
        What the player reads; None if there is no animation, in which case a note says why.
    alt
        Description for readers who do not see it.
    notes
        Sentences below the animation.
    frame
        What the pictures show; None of a single body, whose pictures follow from the case.
    """

    data: Mapping[str, Any] | None
    alt: str
    notes: tuple[str, ...]
    frame: Frame | None = None


def playback(scene: Scene, shown: Cast, most: int) -> Playback:
    """Return the animation of a body; see `animation.animated`."""
    trajectory, played, reach = shown.exact, shown.runs, reach_of(scene.body)
    fastest = float(np.linalg.norm(trajectory.angular_velocity, axis=1).max())
    if not played:
        return Playback(None, "", ("There is no animation because the errors of no run are finite numbers.",))
    if scene.plane is None and not fastest and not any(one.trajectory.angular_velocity.any() for one in played):
        return Playback(None, "", ("There is no animation because nothing rotates in this case.",))
    rates = RATE_TOLERANCE * fastest if scene.plane is None and fastest else math.inf
    record = turning_of(trajectory, rates)
    if record is None:
        return Playback(None, "", (f"There is no animation because the body turns by {TOO_FAST}.",))
    if scene.plane is not None and _too_far(trajectory, reach):
        return Playback(None, "", ("There is no animation because the body goes too far to be drawn.",))
    if scene.plane is not None:
        record |= course_of(trajectory.t, trajectory.position / reach, PLACE_TOLERANCE)
    first = choose(played, reach if scene.plane is not None else math.inf)
    unseen = {one.line for one in played}
    undrawn = [name_of(line) for line in shown.compared if line not in unseen]
    if (room := most - len(as_json(record))) < 0:
        return Playback(None, "", ("There is no animation, to keep this file small.",))
    by_rank = (*first, *(other for other in played if other not in first))
    kept, left_out = fitting({one: _run(one, scene, reach, rates) for one in by_rank}, room)
    undrawn += [name_of(one.line) for one in by_rank if one not in kept and one not in left_out]
    order = [one for one in played if one in kept]
    data = {
        **described(scene),
        "momentum": _largest_momentum(scene.body, trajectory),
        "end": float(trajectory.t[-1]),
        "truth": record,
        "runs": [kept[one] for one in order],
        "shown": [order.index(one) for one in first if one in kept],
    }
    return Playback(data, _alt(scene, played), tuple(_notes(scene, shown, undrawn, [name_of(one.line) for one in left_out])))


def described(scene: Scene) -> dict[str, Any]:
    """Return what the player reads of a scene whatever moves in it."""
    body = _drawn(scene.body, reach_of(scene.body))
    return {"body": body, "plane": scene.plane is not None, "within": tracks.TOLERANCE}


def _largest_momentum(body: Body, trajectory: Trajectory) -> float:
    """Return the largest angular momentum of a motion, in a unit of its own: only its direction and ratios are drawn."""
    relative = replace(body, moments=_relative(body))
    return float(np.linalg.norm(angular_momentum(relative, trajectory.angular_velocity), axis=1).max())


def _run(run: Shown, scene: Scene, reach: float, rates: float) -> dict[str, Any] | None:
    """Return a run as the player reads it, or None if it cannot be drawn.

    It has no rotation of its own if it turns as the truth does.
    """
    entry: dict[str, Any] = {"label": name_of(run.line), "colour": run.line.colour}
    entry |= {f"{name}_error": float(f"{run.maxima[f'{name}_error']:.4g}") for name in ("attitude", "position")}
    if run.maxima["attitude_error"] > tracks.TOLERANCE or run.maxima["angular_velocity_error"] > rates:
        turning = turning_of(run.trajectory, rates)
        if turning is None:
            return None
        entry |= turning
    if scene.plane is not None:
        far = _too_far(run.trajectory, reach)
        return None if far else entry | course_of(run.trajectory.t, run.trajectory.position / reach, PLACE_TOLERANCE)
    offset = (run.trajectory.position - run.truth.position) / reach
    farthest = float(np.abs(offset).max())
    if PLACE_TOLERANCE < farthest < FARTHEST:
        entry |= course_of(run.trajectory.t, offset, max(PLACE_TOLERANCE, SHIFT_TOLERANCE * farthest))
    return entry


def turning_of(trajectory: Trajectory, rates: float) -> dict[str, Any] | None:
    """Return the rotation of a body as the player reads it; None if it cannot be stored. rates: see `tracks.turning`."""
    track = tracks.turning(trajectory.t, normalise(trajectory.quaternion), trajectory.angular_velocity, rates)
    return None if track is None else {"turning": track.encoded()}


def course_of(t: Array, place: Array, tolerance: float) -> dict[str, Any]:
    """Return the path of a body as the player reads it; see `tracks.course`."""
    return {"course": tracks.course(t, place, tolerance).encoded()}


def _drawn(body: Body, reach: float) -> dict[str, Any]:
    """Return a body as the player reads it.

    Lengths are in units of its reach (m). Moments are along the principal axes, which the quaternion `axes` takes to the body.
    """
    kind, semi_axes = _solid(body)
    turned = body.axes if body.shape is None else (1.0, 0.0, 0.0, 0.0)
    longest = max(semi_axes)
    lengths = [max(axis, THINNEST * longest) / reach for axis in semi_axes]
    return {"kind": kind, "semi_axes": lengths, "turned": turned, "reach": reach, "moments": _relative(body), "axes": body.axes}


def _relative(body: Body) -> Vector:
    """Return the moments in units of the largest, so that no product overflows."""
    a, b, c = (moment / max(body.moments) for moment in body.moments)
    return a, b, c


def _too_far(trajectory: Trajectory, reach: float) -> bool:
    return not float(np.abs(trajectory.position).max()) < FARTHEST * reach


def _solid(body: Body) -> tuple[str, Vector]:
    """Return the kind of solid that a body is drawn as, and its half-lengths along its axes (m)."""
    if body.shape is not None:
        return solid_of(body.shape)
    a, b, c = body.moments
    squares = (b + c - a, a + c - b, a + b - c)
    x, y, z = (math.sqrt(max(square, 0.0) * 5 / 2 / body.mass) for square in squares)
    return "ellipsoid", (x, y, z)


def solid_of(shape: Shape) -> tuple[str, Vector]:
    """Return the kind of solid that a shape is drawn as, and its half-lengths along its axes (m)."""
    match shape:
        case Brick(semi_axes):
            return "brick", semi_axes
        case Cylinder(radius, half_length):
            return "cylinder", (radius, radius, half_length)
        case Sphere(radius):
            return "ellipsoid", (radius, radius, radius)
        case Ellipsoid(semi_axes):
            return "ellipsoid", semi_axes


def reach_of(body: Body) -> float:
    """Return the distance (m) of the farthest point of a body, as it is drawn, from its centre of mass."""
    kind, (a, b, c) = _solid(body)
    return {"brick": math.hypot(a, b, c), "cylinder": math.hypot(a, c), "ellipsoid": max(a, b, c)}[kind]


def _alt(scene: Scene, runs: Sequence[Shown]) -> str:
    worst = max(runs, key=lambda run: run.maxima["attitude_error"])
    where = "on the plane" if scene.plane is not None else "about their centres of mass"
    return (
        f"Animation of the bodies of the truth and of up to {MOST_SHOWN} runs, side by side {where}. "
        f"The largest attitude error is {number(worst.maxima['attitude_error'], 3)} rad, with {name_of(worst.line)}."
    )


def _notes(scene: Scene, shown: Cast, undrawn: Sequence[str], left_out: Sequence[str]) -> list[str]:
    """Return sentences on what the animation leaves out or draws in another form."""
    notes = []
    if scene.body.shape is None:
        notes.append(
            "The case gives no shape. The animation shows the solid ellipsoid that has the same mass and moments of inertia."
        )
    if shown.several:
        notes.append(f"The animation shows the runs with a time step of {milliseconds(shown.timestep)}.")
    if undrawn:
        names = listing(undrawn, MOST_NAMES, "method")
        notes.append(f"The animation leaves out bodies that turn by {TOO_FAST}, or that go too far: {names}.")
    if left_out:
        notes.append(f"The animation leaves out methods to keep this file small: {listing(left_out, MOST_NAMES, 'method')}.")
    return notes
