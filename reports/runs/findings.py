"""Findings about the runs of a report: sentences made of measurements, the most telling first."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from statistics import median

from bodycheck.judging.attribution import Attribution
from bodycheck.judging.discrepancy import Summary
from bodycheck.judging.judgement import Verdict
from bodycheck.reports.finding import MOST_NAMES, TELLING, TELLING_POSITION, Finding
from bodycheck.reports.lines import Key, Line
from bodycheck.reports.quantities import bound, count, listing, number
from bodycheck.reports.runs.summary import key_of

#: Attitude errors (rad) below this may be the rounding of thousands of steps and are not compared between engines.
TELLING_ATTITUDE = 1e-9

#: Errors this close, relatively, are named together.
TIE = 1e-3

#: Two methods whose errors differ by less than this, relatively, err alike.
ALIKE = 1e-3

#: Methods whose worst errors are this close, relatively, to the best one's are named with it.
NEAR = 1e-2

#: A drift below this is rounding and no finding.
ROUNDING = 1e-12


@dataclass(frozen=True)
class Measured:
    """A completed run, its method and its maxima by column."""

    line: Line
    verdict: Verdict
    discrepancy: Summary
    maxima: Mapping[str, float]

    @property
    def case(self) -> str:
        return self.verdict.run.case

    @property
    def within_truth(self) -> bool:
        """Whether the attitude error is no larger than the truth's own, and so says nothing."""
        return within_truth(self.maxima)

    @property
    def attitude_bound(self) -> float:
        """The attitude error (rad), or the truth's own where that is larger and the attitude error says nothing."""
        return max(self.maxima["attitude_error"], self.maxima["truth_error"])


def within_truth(maxima: Mapping[str, float]) -> bool:
    """Whether an attitude error is no larger than the truth's own, and so says nothing."""
    return maxima["attitude_error"] <= maxima["truth_error"]


def measured(verdicts: Sequence[Verdict], lines: Mapping[Key, Line]) -> list[Measured]:
    """The runs that have figures."""
    return [
        Measured(lines[key_of(verdict)], verdict, verdict.discrepancy, verdict.discrepancy.maxima())
        for verdict in verdicts
        if verdict.discrepancy is not None
    ]


def findings(runs: Sequence[Measured], parts: Sequence[Attribution], lines: Mapping[Key, Line]) -> tuple[Finding, ...]:
    """What the completed runs and the parts of their discrepancies of contact show, the most telling first.

    How far off they are, which method is closest, then what explains it.
    """
    if not runs:
        return ()
    # A contact is another model, and no integrator's doing: what is said of methods is said of flight.
    flight = [run for run in runs if "penetration" not in run.maxima]
    flights = len({run.case for run in flight})
    everywhere = f"in each of {flights} flights" if flights > 1 else "in the one flight"
    everywhere = everywhere if len(flight) < len(runs) else "in every case"
    found = (
        _position(runs),
        _attitude(runs),
        _closest(flight, everywhere) if flight else None,
        _contact(parts, lines),
        _angular_momentum(runs),
        _alike(flight) if flight else None,
    )
    return tuple(finding for finding in found if finding is not None)


def _contact(parts: Sequence[Attribution], lines: Mapping[Key, Line]) -> Finding | None:
    """What the form of a contact's model does: the largest part of a turn to the stop that no time step mends."""
    formed = [part for part in parts if part.quantity == "stop_yaw" and part.model_form]
    if not formed:
        return None
    worst = max(formed, key=lambda part: abs(part.model_form or 0.0))
    form, label = worst.model_form or 0.0, lines[worst.engine, worst.integrator, worst.timestep, ""].label
    rest = ""
    if worst.constraint is not None and worst.time_step is not None:
        constraint, time_step = number(worst.constraint, 3), number(worst.time_step, 3)
        rest = f" The contact's own part is {constraint} rad, that of the time step {time_step} rad."
    less = "less" if worst.total < 0 else "more"
    text = (
        f" the body turns {number(abs(worst.total), 3)} rad {less} until it stops with {label} "
        "than with the friction of the case. "
        f"The form of the model, corners instead of an area, makes {number(form, 3)} rad of it, at any time step.{rest}"
    )
    return Finding("Contact", "In ", worst.case, text)


def _attitude(runs: Sequence[Measured]) -> Finding | None:
    subject = "Attitude"
    telling = [run for run in runs if not run.within_truth]
    if not telling:
        most = max(run.maxima["truth_error"] for run in runs)
        return Finding(subject, f"Every completed run is within the truth's own error ({bound(most)} rad at most).")
    worst, tied = _worst(telling, "attitude_error")
    return Finding(
        subject,
        f"With {_names(tied)} the body is up to {number(worst.maxima['attitude_error'])} rad off, in ",
        worst.case,
        f" {_when(worst, 'attitude_error')}. The truth there is known to {bound(worst.maxima['truth_error'], 2)} rad.",
    )


def _position(runs: Sequence[Measured]) -> Finding | None:
    subject = "Position"
    worst, tied = _worst(runs, "position_error")
    distance = worst.maxima["position_error"]
    if distance < TELLING_POSITION:
        return Finding(subject, f"In no completed run is the centre of mass more than {bound(distance)} m off.")
    named = {run.line for run in tied}
    rest = max((run.maxima["position_error"] for run in runs if run.line not in named), default=None)
    contrast = (
        f" No completed run of another method is more than {bound(rest)} m off."
        if rest is not None and rest < distance / 3
        else ""
    )
    return Finding(
        subject,
        f"With {_names(tied)} the centre of mass is up to {number(distance)} m from where mechanics has it, in ",
        worst.case,
        f" {_when(worst, 'position_error')}.{contrast}",
    )


def _angular_momentum(runs: Sequence[Measured]) -> Finding | None:
    name = "angular_momentum_drift"
    conserved = [run for run in runs if name in run.maxima]
    if not conserved or (found := _worst(conserved, name))[0].maxima[name] < ROUNDING:
        return None
    worst, tied = found
    return Finding(
        "Angular momentum",
        f"With {_names(tied)} it changes by up to {_share(worst.maxima[name])}, in ",
        worst.case,
        f" {_when(worst, name)}. Mechanics keeps it constant.",
    )


def _closest(runs: Sequence[Measured], everywhere: str) -> Finding | None:
    """The method whose worst attitude error over all cases is the smallest, of those that completed every case.

    everywhere: these cases in words.
    """
    cases = {run.case for run in runs}
    eligible = [own for own in _by_line(runs).values() if len(own) == len(cases)]
    if len(eligible) < 2:
        return None
    worsts = [(max(run.attitude_bound for run in own), own) for own in eligible]
    limit = min(worst for worst, _ in worsts) * (1 + NEAR)
    tied = [own for worst, own in worsts if worst <= limit]
    if len(tied) == len(eligible):
        return None
    named = [run for own in tied for run in own]
    turn, shift = max(run.attitude_bound for run in named), max(run.maxima["position_error"] for run in named)
    attitude = f"at most {bound(turn)} rad"
    if all(run.within_truth for run in named):
        attitude = f"within the truth's own error ({bound(turn)} rad)"
    costs = listing([f"{number(_cost(own), 2)} µs" for own in tied[:MOST_NAMES]])
    return Finding(
        "Closest",
        f"With {_names([own[0] for own in tied])} the body is {attitude} and at most {bound(shift)} m off {everywhere}. "
        f"A step takes {costs} (medians over the cases).",
    )


def _alike(runs: Sequence[Measured]) -> Finding | None:
    """Methods of different engines that err alike: then it is the scheme that errs."""
    by_line = _by_line(runs)
    pairs = [(one, other, found) for one, other in combinations(by_line, 2) if (found := _difference(by_line, one, other))]
    if not pairs:
        return None
    one, other, (difference, cases) = max(pairs, key=lambda pair: (pair[2][1], -pair[2][0]))
    same = f"the same to {bound(100 * difference, 1)} %" if difference else "the same"
    return Finding(
        "Alike",
        f"Wherever they are large enough to compare ({count(cases, 'case')}), the attitude and position errors of "
        f"{one.label} and {other.label} are {same}: they are the scheme's, not either engine's.",
    )


def _difference(by_line: Mapping[Line, Sequence[Measured]], one: Line, other: Line) -> tuple[float, int] | None:
    """The largest relative difference of two methods' telling errors, and in how many cases they have any."""
    if one.engine == other.engine or one.timestep != other.timestep:
        return None
    theirs = {run.case: run.maxima for run in by_line[other]}
    largest, cases = 0.0, 0
    for run in by_line[one]:
        mine, their = run.maxima, theirs.get(run.case)
        if their is None:
            return None
        floors = {"attitude_error": max(TELLING_ATTITUDE, TELLING * mine["truth_error"]), "position_error": TELLING_POSITION}
        sizes = [(mine[name], their[name]) for name, floor in floors.items() if max(mine[name], their[name]) > floor]
        largest = max([largest, *(abs(a - b) / max(a, b) for a, b in sizes)])
        cases += any(mine[name] > floor for name, floor in floors.items())
    if cases == 0 or largest > ALIKE:
        return None
    return largest, cases


def _worst(runs: Sequence[Measured], name: str) -> tuple[Measured, list[Measured]]:
    """The run with the largest value of a column, and all runs of its case that come to the same."""
    worst = max(runs, key=lambda run: run.maxima[name])
    limit = worst.maxima[name] * (1 - TIE)
    return worst, [run for run in runs if run.case == worst.case and run.maxima[name] >= limit]


def _names(runs: Sequence[Measured]) -> str:
    return listing([run.line.label for run in runs], MOST_NAMES, "method")


def _when(run: Measured, name: str) -> str:
    return f"at t\u00a0=\u00a0{number(run.discrepancy.instants[name])}\u00a0s"  # not to be broken over lines


def _by_line(runs: Sequence[Measured]) -> dict[Line, list[Measured]]:
    groups: dict[Line, list[Measured]] = {}
    for run in runs:
        groups.setdefault(run.line, []).append(run)
    return groups


def _cost(runs: Sequence[Measured]) -> float:
    """The median time of a step (µs)."""
    return 1e6 * float(median(run.verdict.row()["time_per_step"] for run in runs))


def _share(value: float, digits: int = 3) -> str:
    return f"{number(100 * value, digits)} %" if value < 10 else f"{number(value, digits)} times its initial size"
