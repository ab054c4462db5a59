"""The animation of a case, for all kinds of scenes."""

from collections.abc import Mapping
from typing import Any

from bodycheck.judging.judgement import Verdict
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.requirements import touches
from bodycheck.reference.truths import Truth
from bodycheck.reports.lines import Line
from bodycheck.reports.runs.motions import several_bodies, single_body
from bodycheck.reports.runs.motions.cast import Cast, cast
from bodycheck.reports.runs.motions.playback import Frame, Playback, none_because, played


def animated(scene: AnyScene, runs: Mapping[Line, Verdict], truths: Mapping[float, Truth], most: int) -> Playback | None:
    """Return the animation of one case; None if no run has a truth with which it can be compared.

    The animation shows the time step of most runs. If not all its runs fit, the runs that are shown first have priority.

    Parameters
    ----------
    scene
        The scene of the case.
    runs
        The verdicts on the case, by the lines of their methods.
    truths
        The truths of the case, by time step (s).
    most
        The most characters of the data.
    """
    shown = cast(runs, truths)
    return None if shown is None else animation(scene, shown, most)


def animation(scene: AnyScene, shown: Cast, most: int) -> Playback:
    """Return the animation of a truth and runs. most: the most characters of the data; see `animated`."""
    if not shown.runs:
        return none_because("the errors of no run are finite numbers")
    # A body in flight is drawn about its own centre of mass, with its axes, its angular momentum and its polhode, which several
    # bodies do not have. A sliding body is drawn in the same way on the plane.
    several = isinstance(scene, Mechanism) or touches(scene)
    stage = several_bodies.stage_of(scene, shown) if several else single_body.stage_of(scene, shown)
    return none_because(stage) if isinstance(stage, str) else played(stage, shown, most)


def described(scene: AnyScene, frame: Frame | None, end: float) -> dict[str, Any]:
    """Return the data of a scene for the player that do not depend on motions.

    frame: see `Playback`. end: the last instant (s).
    """
    return single_body.described(scene) if frame is None else several_bodies.described(scene, frame, end)
