"""The animation of a single body: in flight, about its own centre of mass, or sliding on a plane."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from bodycheck.reference.inertia import angular_momentum
from bodycheck.reference.mechanisms.mechanism import AnyScene, alone
from bodycheck.reference.scene import Body, Scene, Vector
from bodycheck.reference.trajectory import Trajectory
from bodycheck.reports.quantities import number
from bodycheck.reports.runs.motions import tracks
from bodycheck.reports.runs.motions.cast import MOST_SHOWN, Cast, Shown, name_of
from bodycheck.reports.runs.motions.playback import PLACE_TOLERANCE, TOO_FAST, Stage, course_of, solid_of, turning_of

#: The largest deviation of a body rate from its sample, relative to the largest rate: the width of a line on the polhode.
RATE_TOLERANCE = 0.01

#: The largest deviation of the offset of a body from the truth, relative to the largest offset.
SHIFT_TOLERANCE = 0.003

#: The distance, in reaches, beyond which positions are not drawn, because 16 bits cannot resolve the body there.
FARTHEST = 1e9

#: The smallest drawn semi-axis, relative to the longest, so that even a needle is visible.
THINNEST = 0.02

#: The note about a body without a shape, which is drawn as an ellipsoid.
NO_SHAPE = "The case gives no shape. The animation shows the solid ellipsoid that has the same mass and moments of inertia."


def stage_of(scene: AnyScene, shown: Cast) -> Stage | str:
    """Return the pictures of a single body, or the reason why there are none."""
    scene = alone(scene)
    trajectory, runs, reach, slides = shown.exact, shown.runs, reach_of(scene.body), scene.plane is not None
    fastest = float(np.linalg.norm(trajectory.angular_velocity, axis=1).max())
    if not slides and not fastest and not any(run.trajectory.angular_velocity.any() for run in runs):
        return "nothing rotates in this case"
    rates = RATE_TOLERANCE * fastest if not slides and fastest else math.inf
    truth = turning_of(trajectory, rates)
    if truth is None:
        return f"the body turns by {TOO_FAST}"
    if slides and _too_far(trajectory, reach):
        return "the body goes too far to be drawn"
    if slides:
        truth |= course_of(trajectory.t, trajectory.position / reach, PLACE_TOLERANCE)
    drawn = {run.line for run in runs}
    return Stage(
        described(scene) | {"momentum": _largest_momentum(scene.body, trajectory)},
        truth,
        lambda run: _run(run, scene, reach, rates),
        reach if slides else math.inf,
        _alt(scene, runs),
        f"bodies that turn by {TOO_FAST}, or that go too far",
        tuple(name_of(line) for line in shown.compared if line not in drawn),
        (NO_SHAPE,) if scene.body.shape is None else (),
    )


def described(scene: AnyScene) -> dict[str, Any]:
    """Return the data of a scene with a single body for the player, which do not depend on motions."""
    scene = alone(scene)
    body = _drawn(scene.body, reach_of(scene.body))
    return {"body": body, "plane": scene.plane is not None, "within": tracks.TOLERANCE}


def _largest_momentum(body: Body, trajectory: Trajectory) -> float:
    """Return the largest angular momentum of a motion in an arbitrary unit, since only directions and ratios are drawn."""
    relative = replace(body, moments=_relative(body))
    return float(np.linalg.norm(angular_momentum(relative, trajectory.angular_velocity), axis=1).max())


def _run(run: Shown, scene: Scene, reach: float, rates: float) -> dict[str, Any] | None:
    """Return the motion of a run as the player reads it, or None if it cannot be drawn, as a recorded one without velocities.

    The motion has no rotation if the run turns as the truth does.
    """
    if "angular_velocity_error" not in run.maxima:
        return None
    motion: dict[str, Any] = {}
    if run.maxima["attitude_error"] > tracks.TOLERANCE or run.maxima["angular_velocity_error"] > rates:
        turning = turning_of(run.trajectory, rates)
        if turning is None:
            return None
        motion |= turning
    if scene.plane is not None:
        far = _too_far(run.trajectory, reach)
        return None if far else motion | course_of(run.trajectory.t, run.trajectory.position / reach, PLACE_TOLERANCE)
    offset = (run.trajectory.position - run.truth.position) / reach
    farthest = float(np.abs(offset).max())
    if PLACE_TOLERANCE < farthest < FARTHEST:
        motion |= course_of(run.trajectory.t, offset, max(PLACE_TOLERANCE, SHIFT_TOLERANCE * farthest))
    return motion


def _drawn(body: Body, reach: float) -> dict[str, Any]:
    """Return a body as the player reads it.

    Lengths are in units of its reach (m). Moments are about the principal axes; the quaternion `axes` turns components along
    these axes into components in the body.
    """
    kind, semi_axes = solid_in_flight(body)
    turned = body.axes if body.shape is None else (1.0, 0.0, 0.0, 0.0)
    longest = max(semi_axes)
    lengths = [max(axis, THINNEST * longest) / reach for axis in semi_axes]
    return {"kind": kind, "semi_axes": lengths, "turned": turned, "reach": reach, "moments": _relative(body), "axes": body.axes}


def _relative(body: Body) -> Vector:
    """Return the principal moments of a body divided by the largest, so that no product overflows."""
    a, b, c = (moment / max(body.moments) for moment in body.moments)
    return a, b, c


def _too_far(trajectory: Trajectory, reach: float) -> bool:
    return not float(np.abs(trajectory.position).max()) < FARTHEST * reach


def solid_in_flight(body: Body) -> tuple[str, Vector]:
    """Return the kind of solid as which a body is drawn, and its half-lengths along its axes (m)."""
    if body.shape is not None:
        return solid_of(body.shape)
    a, b, c = body.moments
    squares = (b + c - a, a + c - b, a + b - c)
    x, y, z = (math.sqrt(max(square, 0.0) * 5 / 2 / body.mass) for square in squares)
    return "ellipsoid", (x, y, z)


def reach_of(body: Body) -> float:
    """Return the distance (m) of the farthest point of a drawn body from its centre of mass."""
    kind, (a, b, c) = solid_in_flight(body)
    return {"brick": math.hypot(a, b, c), "cylinder": math.hypot(a, c), "ellipsoid": max(a, b, c)}[kind]


def _alt(scene: Scene, runs: Sequence[Shown]) -> str:
    worst = max(runs, key=lambda run: run.maxima["attitude_error"])
    where = "on the plane" if scene.plane is not None else "about their centres of mass"
    return (
        f"Animation of the bodies of the truth and of up to {MOST_SHOWN} runs, side by side {where}. "
        f"The largest attitude error is {number(worst.maxima['attitude_error'], 3)} rad, with {name_of(worst.line)}."
    )
