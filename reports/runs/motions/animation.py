"""The animation of a case of any scene."""

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
    shown = cast(runs, truths)
    return None if shown is None else animation(scene, shown, most)


def animation(scene: AnyScene, shown: Cast, most: int) -> Playback:
    """Return the animation of a truth and runs in at most so many characters; see `animated`."""
    if not shown.runs:
        return none_because("the errors of no run are finite numbers")
    # A body in flight is drawn about its own centre of mass, with its axes, its angular momentum and its polhode, which several
    # bodies do not have. A body that slides is drawn in the same way on the plane.
    several = isinstance(scene, Mechanism) or touches(scene)
    stage = several_bodies.stage_of(scene, shown) if several else single_body.stage_of(scene, shown)
    return none_because(stage) if isinstance(stage, str) else played(stage, shown, most)


def described(scene: AnyScene, frame: Frame | None) -> dict[str, Any]:
    """Return what the player reads of a scene whatever moves in it. frame: that of its animation; None of a single body."""
    return single_body.described(scene) if frame is None else several_bodies.described(scene, frame)
