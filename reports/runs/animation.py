"""The animation of a case of any scene."""

from collections.abc import Mapping
from typing import Any

from bodycheck.judging.judgement import Verdict
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.requirements import touches
from bodycheck.reference.truths import Truth
from bodycheck.reports.lines import Line
from bodycheck.reports.runs import mechanism_playback, playback, touching_playback
from bodycheck.reports.runs.cast import Cast, cast
from bodycheck.reports.runs.playback import Frame, Playback


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
    found = cast(runs, truths)
    return None if found is None else animation(scene, found, most)


def animation(scene: AnyScene, shown: Cast, most: int) -> Playback:
    """Return the animation of a truth and runs in at most so many characters; see `animated`."""
    if touches(scene):
        return touching_playback.touching_playback(scene, shown, most)
    if isinstance(scene, Mechanism):
        return mechanism_playback.mechanism_playback(scene, shown, most)
    return playback.playback(scene, shown, most)


def described(scene: AnyScene, frame: Frame | None) -> dict[str, Any]:
    """Return what the player reads of a scene whatever moves in it. frame: that of its animation; None of a single body."""
    if frame is None:
        assert not isinstance(scene, Mechanism)
        return playback.described(scene)
    if touches(scene):
        return touching_playback.described(scene, frame)
    assert isinstance(scene, Mechanism)
    return mechanism_playback.described(scene, frame)
