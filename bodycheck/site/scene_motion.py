"""The motions of a scene as the player reads them: the truth and a run of each engine, from several submissions."""

from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from bodycheck.reports.lines import hue
from bodycheck.reports.quantities import milliseconds
from bodycheck.reports.runs.motions import tracks as reported
from bodycheck.reports.runs.motions.animation import described
from bodycheck.reports.runs.motions.cast import MOST_SHOWN
from bodycheck.reports.runs.motions.playback import Frame
from bodycheck.site.catalogue import Catalogue, Entry, Scene
from bodycheck.site.cells import cell
from bodycheck.site.submissions.tracks import Course, Motion, Part, RunMotion, arrays

#: The errors of a run, in the order of their columns.
ERRORS = ("attitude_error", "position_error")


@dataclass(frozen=True, eq=False)
class Found:
    """A run with its motion.

    Parameters
    ----------
    run
        The row of the run.
    motion
        The motions of the case, from the submission that contains the run.
    own
        The motion of this run, which is one of `motion.runs`.
    """

    run: Entry
    motion: Motion
    own: RunMotion


def moving(catalogue: Catalogue, scene: Scene) -> list[Found]:
    """Return the run that the front page shows for each engine in a scene, if its motion is known."""
    runs = [cell(catalogue, engine, scene).run for engine in catalogue.engines]
    return [found for run in runs if run is not None and (found := _found(run)) is not None]


def played(scene: Scene, found: list[Found]) -> dict[str, Any]:
    """Return the data that the player reads.

    The motion of the truth comes from the newest submission. found: at least one run; see `moving`.
    """
    motion = max(found, key=lambda one: (one.run.source.header.started, one.run.source.key)).motion
    frame = motion.shown
    data = described(scene.case.scene, frame, motion.end)
    if frame is None:
        data["momentum"] = motion.momentum
    return {
        **data,
        "end": motion.end,
        "truth": _entry(motion.truth, frame, frame),
        "runs": [_told(one) | _entry(one.own.parts, one.motion.shown, frame) for one in found],
        "shown": sorted(sorted(range(len(found)), key=lambda k: _badness(found[k]), reverse=True)[:MOST_SHOWN]),
    }


def _found(run: Entry) -> Found | None:
    named = (run.get("engine"), run.version, run.get("integrator"))
    for motion in run.source.tracks.motions:
        if (motion.case, motion.timestep) == (run.get("case"), run.get("timestep")):
            for own in motion.runs:
                if (own.engine, own.version, own.integrator) == named:
                    return Found(run, motion, own)
    return None


def _told(found: Found) -> dict[str, Any]:
    """Return the entry of a run for the player: its label, its colour and its errors."""
    run = found.run
    label = f"{run.engine} {run.version} {run.get('integrator')}, {milliseconds(found.motion.timestep)}"
    errors = {name: run.get(name) for name in ERRORS}
    rounded = {name: None if error is None else float(f"{error:.4g}") for name, error in errors.items()}
    return {"label": label, "colour": hue(run.engine)[0], **rounded}


def _badness(found: Found) -> float:
    return sum(found.run.get(name) or 0.0 for name in ERRORS)


def _entry(parts: list[Part], own: Frame | None, frame: Frame | None) -> dict[str, Any]:
    """Return a motion as the player reads it in `frame`, from parts that are stored in the frame `own`."""
    if frame is None or own is None:
        (part,) = parts
        return _encoded(part)
    return {"parts": [_encoded(_moved(part, own, frame)) for part in parts]} if parts else {}


def _encoded(part: Part) -> dict[str, Any]:
    return {name: asdict(way) for name, way in (("turning", part.turning), ("course", part.course)) if way is not None}


def _moved(part: Part, own: Frame, frame: Frame) -> Part:
    """Return a part with its positions converted from the frame `own` to another frame."""
    if part.course is None or (own.middle, own.extent) == (frame.middle, frame.extent):
        return part
    t, shares = arrays(part.course)
    places = shares / reported.LEVELS * part.course.farthest * own.extent + np.array(own.middle)
    within = part.course.within * own.extent / frame.extent
    course = reported.Course(t, (places - np.array(frame.middle)) / frame.extent, within).encoded()
    return replace(part, course=Course(**course))
