"""The animation of a case of any scene."""

from collections.abc import Mapping

from bodycheck.judging.judgement import Verdict
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.requirements import touches
from bodycheck.reference.truth import Truth
from bodycheck.reports.lines import Line
from bodycheck.reports.runs.mechanism_playback import mechanism_playback
from bodycheck.reports.runs.playback import Playback, playback
from bodycheck.reports.runs.touching_playback import touching_playback


def animated(scene: AnyScene, runs: Mapping[Line, Verdict], truths: Mapping[float, Truth], most: int) -> Playback | None:
    """Return the animation of one case, or None if no run has a truth to be compared with; see `playback`."""
    if touches(scene):
        return touching_playback(scene, runs, truths, most)
    if isinstance(scene, Mechanism):
        return mechanism_playback(scene, runs, truths, most)
    return playback(scene, runs, truths, most)
