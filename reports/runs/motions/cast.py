"""The content of an animation: the truth, and the completed runs that are compared with it at the same instants."""

import json
import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from bodycheck.judging.judgement import Verdict
from bodycheck.reference.trajectory import Trajectory
from bodycheck.reference.truths import Truth
from bodycheck.reports.lines import Line
from bodycheck.results.outcome import Completed

#: The most runs that are shown at once beside the truth.
MOST_SHOWN = 3

#: The errors of a run that must be finite if they were measured, so that the run can be shown.
ERRORS = ("attitude_error", "angular_velocity_error", "position_error")


@dataclass(frozen=True, eq=False)
class Shown:
    """A completed run: the line of its method, its trajectory, the truth at the same instants, and its largest errors."""

    line: Line
    trajectory: Trajectory
    truth: Trajectory
    maxima: Mapping[str, float]


@dataclass(frozen=True, eq=False)
class Cast:
    """The truth and the runs of an animation.

    Parameters
    ----------
    sampling
        The sampling of all runs, as `Method.sampling` says: their time step (s), or 0 with error control.
    exact
        The truth at the instants of these runs.
    runs
        The runs that can be shown.
    compared
        The lines of all runs with this sampling that have a discrepancy; they include the lines of `runs`.
    several
        Whether there are runs with another sampling.
    """

    sampling: float
    exact: Trajectory
    runs: tuple[Shown, ...]
    compared: tuple[Line, ...]
    several: bool


def cast(runs: Mapping[Line, Verdict], truths: Mapping[float, Truth]) -> Cast | None:
    """Return the content of an animation, with the sampling of most runs; None if no run can be compared with a truth.

    Parameters
    ----------
    runs
        The verdicts on a case, by the lines of their methods.
    truths
        The truths of the case, by sampling.
    """
    compared = [line for line, verdict in runs.items() if verdict.discrepancy is not None]
    sampling = common_sampling([line for line in compared if line.key.method.sampling in truths])
    if sampling is None:
        return None
    truth = truths[sampling]
    own = {line: verdict for line, verdict in runs.items() if line.key.method.sampling == sampling}
    shown = [one for line, verdict in own.items() if (one := shown_run(line, verdict, truth)) is not None]
    return Cast(
        sampling,
        truth.trajectory,
        tuple(shown),
        tuple(line for line in compared if line in own),
        len({line.key.method.sampling for line in runs}) > 1,
    )


def shown_run(line: Line, verdict: Verdict, truth: Truth) -> Shown | None:
    """Return a run for an animation; None if it did not complete, has no discrepancy, or has an error that is not finite."""
    if not isinstance(verdict.outcome, Completed) or verdict.discrepancy is None:
        return None
    trajectory, maxima = verdict.outcome.trajectory, verdict.discrepancy.maxima()
    finite = all(math.isfinite(maxima.get(name, 0.0)) for name in ERRORS)
    return Shown(line, trajectory, truth.at(trajectory.t).trajectory, maxima) if finite else None


def common_sampling(lines: Sequence[Line]) -> float | None:
    """Return the most frequent sampling of lines, the first of equally frequent ones; None if there are no lines."""
    samplings = Counter(line.key.method.sampling for line in lines)
    return max(samplings, key=samplings.__getitem__, default=None)


def choose(runs: Sequence[Shown], reach: float) -> list[Shown]:
    """Return at most `MOST_SHOWN` runs to show first: the worst runs of the engines, and the best of the other runs.

    reach: the position error (m) that counts as much as an attitude error of 1 rad; infinite if only attitudes count.
    """

    def badness(run: Shown) -> float:
        return run.maxima.get("attitude_error", 0.0) + run.maxima.get("position_error", 0.0) / reach

    engines = dict.fromkeys(run.line.engine for run in runs)
    worst = [max((run for run in runs if run.line.engine == engine), key=badness) for engine in engines]
    largest = sorted(worst, key=badness, reverse=True)[:MOST_SHOWN]
    others = sorted((run for run in runs if run not in worst), key=badness)
    return [*(run for run in worst if run in largest), *others[:1]][:MOST_SHOWN]


def fitting(entries: Mapping[Shown, dict[str, Any] | None], room: int) -> tuple[dict[Shown, dict[str, Any]], list[Shown]]:
    """Return the entries that fit into `room` characters, with priority for the first entries, and the runs left out.

    Entries that are None belong to neither.
    """
    kept, left_out = dict[Shown, dict[str, Any]](), list[Shown]()
    for one, entry in entries.items():
        if entry is None:
            continue
        if (room := room - len(as_json(entry))) < 0:
            left_out.append(one)
        else:
            kept[one] = entry
    return kept, left_out


def name_of(line: Line) -> str:
    """Return the name of a method without its time step, which all methods of an animation share."""
    return f"{line.engine} {line.integrator}" + (f" ({line.results})" if line.results else "")


def as_json(value: Any) -> str:
    """Return data for the player as JSON text."""
    return json.dumps(value, separators=(",", ":"))
