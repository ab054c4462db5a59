"""The animation of the runs of a robot's file: the finest run, and runs with the file's own time step, side by side."""

import math
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation, RotationSpline

from bodycheck.adapters.method import Method
from bodycheck.reference.kinematics import geodesic_angle, normalise
from bodycheck.reference.trajectory import Array
from bodycheck.reports.lines import assign
from bodycheck.reports.quantities import milliseconds
from bodycheck.reports.runs.motions import tracks
from bodycheck.reports.runs.motions.cast import as_json
from bodycheck.reports.runs.motions.playback import PLACE_TOLERANCE, TOO_FAST, course_of
from bodycheck.reports.study import Animation
from bodycheck.results.key import RunKey
from bodycheck.running.refining import Motion
from bodycheck.studies.estimate.levels import Level, own_steps
from bodycheck.studies.estimate.method import Refined

#: The most characters of the data of one animation, and the most runs beside the finest one.
MOST_CHARACTERS, MOST_RUNS = 1_500_000, 3

#: The number of pieces into which a path is divided between two samples.
FINER = 4

#: The least extent (m) of pictures.
SMALLEST = 1e-3


def animation(engine: str, timestep: float, known: Sequence[Refined], samples: Array) -> Animation | None:
    """Return the animation of the runs of one engine; None if the engine reports no lines along its bodies.

    Parameters
    ----------
    engine
        The name of the engine.
    timestep
        The time step of the file (s), of the runs that are shown beside the finest run of the first method.
    known
        The runs of the methods, the file's own method first.
    samples
        The instants of the scene (n,), s.
    """
    own = [(one.method, level) for one in known for level in one.levels.levels if level.timestep == timestep]
    if not own or not known[0].levels.levels or not own[0][1].motion.sticks:
        return None
    end = float(samples[-1])
    steps = own_steps(samples, timestep)
    finest = known[0].levels.levels[-1]
    exact = _at(finest, timestep, steps)
    span = [exact.position.min(axis=(0, 1)), exact.position.max(axis=(0, 1))]
    middle, extent = (span[0] + span[1]) / 2, max(float((span[1] - span[0]).max()) / 2, SMALLEST) * 1.2
    truth = _parts(exact, middle, extent)
    if truth is None:
        return Animation("Motion", None, "", (f"There is no animation because a body turns by {TOO_FAST}.",))
    lines = assign(RunKey("", engine, Method.parse(method.name, 0.0)) for method, _ in own)
    runs: list[dict[str, Any]] = []
    for (method, level), line in zip(own[:MOST_RUNS], lines.values(), strict=False):
        motion = _at(level, timestep, steps)
        if (parts := _parts(motion, middle, extent)) is not None:
            errors = {
                "attitude_error": float(geodesic_angle(normalise(motion.quaternion), normalise(exact.quaternion)).max()),
                "position_error": float(np.linalg.norm(motion.position - exact.position, axis=-1).max()),
            }
            runs.append({"label": f"{method.name}, {milliseconds(timestep)}", "colour": line.colour, **errors, "parts": parts})
    data = {
        "bodies": [{"joints": [], "sticks": _scaled(sticks, extent)} for sticks in exact.sticks],
        "driven": [],
        "fixed": [],
        "follows": False,
        "azimuth": -math.pi / 3,
        "extent": extent,
        "within": tracks.TOLERANCE,
        "end": end,
        "truth": {"label": f"the finest run ({milliseconds(finest.timestep)})", "parts": truth},
        "runs": runs,
        "shown": list(range(len(runs))),
    }
    while len(as_json(data)) > MOST_CHARACTERS and runs:
        runs.pop()
        data["shown"] = list(range(len(runs)))
    if not runs:
        return Animation("Motion", None, "", ("There is no animation, to keep this file small.",))
    return Animation(
        title="Motion: the finest run, and runs with the time step of the file",
        data=data,
        alt="Animation of all bodies of the robot in the finest run and in runs with the time step of the file, side by side.",
        notes=(
            "Bodies are drawn as lines along their links and their primitive shapes. The errors are distances from the "
            "finest run.",
        ),
    )


def stored(shown: Animation | None) -> dict[str, Any] | None:
    """Return an animation as a record; None if there is none."""
    return None if shown is None else asdict(shown)


def _at(level: Level, timestep: float, steps: Any) -> Motion:
    """Return a run at the ends of numbers of steps (m,) of a size (s)."""
    return level.motion.part(np.searchsorted(level.steps, steps * round(timestep / level.timestep)))


def _parts(motion: Motion, middle: Array, extent: float) -> list[dict[str, Any]] | None:
    """Return the motions of all bodies as the player reads them; None if one turns too fast to be stored."""
    parts = []
    finer = np.linspace(motion.t[0], motion.t[-1], FINER * (len(motion.t) - 1) + 1)
    for position, quaternion in zip(motion.position, normalise(motion.quaternion), strict=True):
        turned = RotationSpline(motion.t, Rotation.from_quat(quaternion, scalar_first=True))
        track = tracks.turning(motion.t, quaternion, np.asarray(turned(motion.t, 1)), math.inf)
        if track is None:
            return None
        path = (CubicSpline(motion.t, position)(finer) - middle) / extent
        parts.append({"turning": track.encoded()} | course_of(finer, path, PLACE_TOLERANCE))
    return parts


def _scaled(sticks: Any, extent: float) -> list[list[list[float]]]:
    """Return the lines of a body in units of the extent."""
    return [[[float(f"{component / extent:.5g}") for component in point] for point in line] for line in sticks]
