"""The common parts of the animations of all scenes: pictures, the choice of runs that fit, and notes about omissions."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from bodycheck.reference.kinematics import normalise
from bodycheck.reference.scene import Brick, Cylinder, Ellipsoid, Shape, Sphere, Vector
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reports.quantities import listing, milliseconds
from bodycheck.reports.runs.motions import tracks
from bodycheck.reports.runs.motions.cast import Cast, Shown, as_json, choose, fitting, name_of

#: The most characters of all playback data of a report; each case has an equal share.
MOST_CHARACTERS = 1_500_000

#: The most methods that a note names.
MOST_NAMES = 6

#: The largest deviation of a position from its sample, relative to the body's reach or to the extent of the pictures.
PLACE_TOLERANCE = 0.01

#: Why a rotation cannot be stored, for sentences such as "a body turns by ...".
TOO_FAST = f"more than {tracks.COARSEST:g} rad between samples, or more than {tracks.MOST_INSTANTS} stored instants can show"


@dataclass(frozen=True)
class Frame:
    """The view of pictures of several bodies.

    Parameters
    ----------
    middle
        The middle of the pictures (m).
    extent
        Half the size (m) of the region that they show.
    azimuth
        The direction (rad) from which the bodies are seen.
    known
        The instant (s) until which mechanics determines the motion; negative if it never does; None for bodies that touch
        nothing.
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
        The data that the player reads; None if there is no animation, in which case a note says why.
    alt
        Description for readers who cannot see the animation.
    notes
        Sentences below the animation.
    frame
        The frame of the pictures; None for a single body, whose pictures follow from the case.
    """

    data: Mapping[str, Any] | None
    alt: str
    notes: tuple[str, ...]
    frame: Frame | None = None


@dataclass(frozen=True, eq=False)
class Stage:
    """The pictures of one scene.

    Parameters
    ----------
    described
        The data of the scene for the player, which do not depend on the motions.
    truth
        The motion of the truth as the player reads it.
    run
        A function from a run to its data for the player, without name and errors; it returns None if the run cannot be drawn.
    extent
        The position error (m) that counts as much as an attitude error of 1 rad; infinite if only attitudes count.
    alt
        Description for readers who cannot see the animation.
    undrawn
        A phrase for the methods that are left out because they cannot be drawn.
    unseen
        The names of methods that cannot be drawn because they have no finite errors.
    notes
        Sentences about the pictures.
    frame
        The frame of the pictures of several bodies; None for a single body.
    """

    described: Mapping[str, Any]
    truth: Mapping[str, Any]
    run: Callable[[Shown], Mapping[str, Any] | None]
    extent: float
    alt: str
    undrawn: str
    unseen: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    frame: Frame | None = None


def none_because(reason: str) -> Playback:
    """Return a playback without an animation, and with a note that gives the reason."""
    return Playback(None, "", (f"There is no animation because {reason}.",))


def played(stage: Stage, shown: Cast, most: int) -> Playback:
    """Return the animation of a truth and at least one run. most: the most characters of the motions."""
    if (room := most - len(as_json(stage.truth))) < 0:
        return Playback(None, "", ("There is no animation, to keep this file small.",))
    first = choose(shown.runs, stage.extent)
    by_rank = (*first, *(other for other in shown.runs if other not in first))
    kept, left_out = fitting({run: _entry(stage, run) for run in by_rank}, room)
    undrawn = [*stage.unseen, *(name_of(run.line) for run in by_rank if run not in kept and run not in left_out)]
    order = [run for run in shown.runs if run in kept]
    data = {
        **stage.described,
        "end": float(shown.exact.t[-1]),
        "truth": stage.truth,
        "runs": [kept[run] for run in order],
        "shown": [order.index(run) for run in first if run in kept],
    }
    notes = (*stage.notes, *_notes(stage, shown, undrawn, [name_of(run.line) for run in left_out]))
    return Playback(data, stage.alt, notes, stage.frame)


def _entry(stage: Stage, run: Shown) -> dict[str, Any] | None:
    """Return a run as the player reads it; None if it cannot be drawn. Errors that are unknown or not finite are None."""
    if (motion := stage.run(run)) is None:
        return None
    errors = {f"{name}_error": run.maxima.get(f"{name}_error", math.nan) for name in ("attitude", "position")}
    rounded = {name: float(f"{error:.4g}") if math.isfinite(error) else None for name, error in errors.items()}
    return {"label": name_of(run.line), "colour": run.line.colour, **rounded, **motion}


def turning_of(trajectory: Trajectory, rates: float) -> dict[str, Any] | None:
    """Return the rotation of a body as the player reads it; None if it cannot be stored. rates: see `tracks.turning`."""
    track = tracks.turning(trajectory.t, normalise(trajectory.quaternion), trajectory.angular_velocity, rates)
    return None if track is None else {"turning": track.encoded()}


def course_of(t: Array, place: Array, tolerance: float) -> dict[str, Any]:
    """Return the path of a body as the player reads it; see `tracks.course`."""
    return {"course": tracks.course(t, place, tolerance).encoded()}


def solid_of(shape: Shape) -> tuple[str, Vector]:
    """Return the kind of solid as which a shape is drawn, and its half-lengths along its axes (m)."""
    match shape:
        case Brick(semi_axes):
            return "brick", semi_axes
        case Cylinder(radius, half_length):
            return "cylinder", (radius, radius, half_length)
        case Sphere(radius):
            return "ellipsoid", (radius, radius, radius)
        case Ellipsoid(semi_axes):
            return "ellipsoid", semi_axes


def _notes(stage: Stage, shown: Cast, undrawn: Sequence[str], left_out: Sequence[str]) -> list[str]:
    """Return sentences about the runs that the animation shows and the methods that it leaves out."""
    notes = []
    if shown.several:
        which = f"a time step of {milliseconds(shown.sampling)}" if shown.sampling else "error control"
        notes.append(f"The animation shows the runs with {which}.")
    if undrawn:
        notes.append(f"The animation leaves out {stage.undrawn}: {listing(undrawn, MOST_NAMES, 'method')}.")
    if left_out:
        notes.append(f"The animation leaves out methods to keep this file small: {listing(left_out, MOST_NAMES, 'method')}.")
    return notes
