"""The motion at the beginning of a report: the case in which a default method is worst, beside a better method."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from bodycheck.reports.runs.choices import Choice, Default
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


def leading(playbacks: Mapping[str, Playback | None], default: Default | None, choices: Sequence[Choice]) -> Leading | None:
    """Return the animation for the beginning of a report; None if no case has one.

    Parameters
    ----------
    playbacks
        The animations by case, in the order of the report.
    default
        The worst default method; None if no default was run.
    choices
        The methods that are accurate enough for each kind of scene.
    """
    wanted = [] if default is None else [default.worst, default.better]
    wanted += [choice.chosen.worst for choice in choices]
    for case in dict.fromkeys([*(one.case for one in wanted), *playbacks]):
        played = playbacks.get(case)
        if played is None or played.data is None:
            continue
        labels = [run["label"] for run in played.data["runs"]]
        names = dict.fromkeys(name_of(one.line) for one in wanted if one.case == case)
        shown = [labels.index(name) for name in names if name in labels] or list(played.data["shown"])
        if shown:
            return Leading(case, played.alt, tuple(shown[:MOST_SHOWN]))
    return None
