"""The animation of a case: the truth and the runs at one time step, as `templates/player/` shows them side by side."""

import json
import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bodycheck.judging.judgement import Verdict
from bodycheck.reference.inertia import angular_momentum
from bodycheck.reference.kinematics import normalise
from bodycheck.reference.scene import Body, Brick, Cylinder, Ellipsoid, Scene, Shape, Sphere, Vector
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truth import Truth
from bodycheck.reports.lines import Line
from bodycheck.reports.quantities import listing, milliseconds, number
from bodycheck.reports.runs import tracks
from bodycheck.running.outcome import Completed

#: Most characters of all playback data of a report, shared evenly by its cases.
MOST_CHARACTERS = 1_500_000

#: Most runs that are shown at once beside the truth.
MOST_SHOWN = 3

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
    """

    data: Mapping[str, Any] | None
    alt: str
    notes: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Shown:
    """A completed run: the line of its method, its trajectory, the truth at the same instants, and its largest errors."""

    line: Line
    trajectory: Trajectory
    truth: Trajectory
    maxima: Mapping[str, float]


def playback(scene: Scene, runs: Mapping[Line, Verdict], truths: Mapping[float, Truth], most: int) -> Playback | None:
    """Return the animation of one case, or None if no run has a truth to be compared with.

    It shows the time step that most runs have. If not all of its runs fit, those that are shown first are kept first.

    Parameters
    ----------
    scene
        The scene of the case.
    runs
        The verdicts on the case, by the lines of their methods.
    truths
        The truths of the case, by time step (s).
    most
        Most characters of the data.
    """
    timestep = common_step(
        [line for line, verdict in runs.items() if verdict.discrepancy is not None and line.timestep in truths]
    )
    if timestep is None:
        return None
    truth, trajectory, reach = truths[timestep], truths[timestep].trajectory, _reach(scene.body)
    fastest = float(np.linalg.norm(trajectory.angular_velocity, axis=1).max())
    own_runs = {line: verdict for line, verdict in runs.items() if line.timestep == timestep}
    played = [one for line, verdict in own_runs.items() if (one := shown_run(line, verdict, truth)) is not None]
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
    unseen = own_runs.keys() - {one.line for one in played}
    undrawn = [name_of(line) for line, verdict in own_runs.items() if verdict.discrepancy is not None and line in unseen]
    if (room := most - len(as_json(record))) < 0:
        return Playback(None, "", ("There is no animation, to keep this file small.",))
    by_rank = (*first, *(other for other in played if other not in first))
    kept, left_out = fitting({one: _run(one, scene, reach, rates) for one in by_rank}, room)
    undrawn += [name_of(one.line) for one in by_rank if one not in kept and one not in left_out]
    order = [one for one in played if one in kept]
    data = {
        "body": _drawn(scene.body, reach),
        "momentum": _largest_momentum(scene.body, trajectory),
        "plane": scene.plane is not None,
        "within": tracks.TOLERANCE,
        "end": float(trajectory.t[-1]),
        "truth": record,
        "runs": [kept[one] for one in order],
        "shown": [order.index(one) for one in first if one in kept],
    }
    notes = _notes(scene, timestep, runs, undrawn, [name_of(one.line) for one in left_out])
    return Playback(data, _alt(scene, played), tuple(notes))


def fitting(entries: Mapping[Shown, dict[str, Any] | None], room: int) -> tuple[dict[Shown, dict[str, Any]], list[Shown]]:
    """Return the entries that have room in so many characters, the first ones first, and those that are left out."""
    kept, left_out = dict[Shown, dict[str, Any]](), list[Shown]()
    for one, entry in entries.items():
        if entry is None:
            continue
        if (room := room - len(as_json(entry))) < 0:
            left_out.append(one)
        else:
            kept[one] = entry
    return kept, left_out


def _largest_momentum(body: Body, trajectory: Trajectory) -> float:
    """Return the largest angular momentum of a motion, in a unit of its own: only its direction and ratios are drawn."""
    relative = replace(body, moments=_relative(body))
    return float(np.linalg.norm(angular_momentum(relative, trajectory.angular_velocity), axis=1).max())


def choose(runs: Sequence[Shown], reach: float) -> list[Shown]:
    """Return the MOST_SHOWN runs that are shown first: the worst of each engine, then the best of all.

    `reach` (m) is the position error that counts as much as an attitude error of 1 rad; infinite if only attitudes count.
    """

    def badness(run: Shown) -> float:
        return run.maxima.get("attitude_error", 0.0) + run.maxima.get("position_error", 0.0) / reach

    engines = dict.fromkeys(run.line.engine for run in runs)
    worst = [max((run for run in runs if run.line.engine == engine), key=badness) for engine in engines]
    largest = sorted(worst, key=badness, reverse=True)[:MOST_SHOWN]
    others = sorted((run for run in runs if run not in worst), key=badness)
    return [*(run for run in worst if run in largest), *others[:1]][:MOST_SHOWN]


def common_step(lines: Sequence[Line]) -> float | None:
    """Return the time step (s) that most of the lines have, the first of equals, or None without lines."""
    return max(steps, key=steps.__getitem__) if (steps := Counter(line.timestep for line in lines)) else None


def shown_run(line: Line, verdict: Verdict, truth: Truth) -> Shown | None:
    """Return a run that can be shown; None if it did not complete, or if an error that it has is not finite."""
    if not isinstance(verdict.outcome, Completed) or verdict.discrepancy is None:
        return None
    trajectory, maxima = verdict.outcome.trajectory, verdict.discrepancy.maxima()
    errors = ("attitude_error", "angular_velocity_error", "position_error")
    finite = all(math.isfinite(maxima.get(name, 0.0)) for name in errors)
    return Shown(line, trajectory, truth.at(trajectory.t).trajectory, maxima) if finite else None


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


def name_of(line: Line) -> str:
    """Return the name of a method without its time step, which all methods of an animation share."""
    return f"{line.engine} {line.integrator}" + (f" ({line.results})" if line.results else "")


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


def _reach(body: Body) -> float:
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


def _notes(
    scene: Scene, timestep: float, runs: Mapping[Line, Verdict], undrawn: Sequence[str], left_out: Sequence[str]
) -> list[str]:
    """Return sentences on what the animation leaves out or draws in another form."""
    notes = []
    if scene.body.shape is None:
        notes.append(
            "The case gives no shape. The animation shows the solid ellipsoid that has the same mass and moments of inertia."
        )
    if len({line.timestep for line in runs}) > 1:
        notes.append(f"The animation shows the runs with a time step of {milliseconds(timestep)}.")
    if undrawn:
        names = listing(undrawn, MOST_NAMES, "method")
        notes.append(f"The animation leaves out bodies that turn by {TOO_FAST}, or that go too far: {names}.")
    if left_out:
        notes.append(f"The animation leaves out methods to keep this file small: {listing(left_out, MOST_NAMES, 'method')}.")
    return notes


def as_json(value: Any) -> str:
    """Return what the player reads as text."""
    return json.dumps(value, separators=(",", ":"))
