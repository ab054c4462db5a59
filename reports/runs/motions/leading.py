"""The motion at the beginning of a report: of the case that a reader should see first."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from bodycheck.reports.lines import Line
from bodycheck.reports.runs.motions.cast import MOST_SHOWN, name_of
from bodycheck.reports.runs.motions.playback import Playback


@dataclass(frozen=True)
class Leading:
    """The animation of a case at the beginning of a report.

    Parameters
    ----------
    case
        The name of the case.
    alt
        Description for readers who cannot see the animation.
    shown
        The positions, among the runs of the animation, of those that are shown beside the truth.
    """

    case: str
    alt: str
    shown: tuple[int, ...]


def leading(playbacks: Mapping[str, Playback | None], foremost: Sequence[tuple[str, Line]]) -> Leading | None:
    """Return the animation for the beginning of a report; None if no case has one.

    Parameters
    ----------
    playbacks
        The animations by case, in the order of the report.
    foremost
        The cases and methods that should be seen first.
    """
    for case in dict.fromkeys([*(case for case, _ in foremost), *playbacks]):
        played = playbacks.get(case)
        if played is None or played.data is None:
            continue
        labels = [run["label"] for run in played.data["runs"]]
        names = dict.fromkeys(name_of(line) for wanted, line in foremost if wanted == case)
        shown = [labels.index(name) for name in names if name in labels] or list(played.data["shown"])
        if shown:
            return Leading(case, played.alt, tuple(shown[:MOST_SHOWN]))
    return None
