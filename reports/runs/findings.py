"""Findings about the runs of a report: sentences that state measurements, the most important first."""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

from bodycheck.judging.attribution import Attribution
from bodycheck.judging.discrepancy import Summary
from bodycheck.judging.judgement import Verdict
from bodycheck.reports.finding import COMPARABLE, COMPARABLE_POSITION_M, MOST_NAMES, Finding
from bodycheck.reports.lines import Line
from bodycheck.reports.quantities import QUANTITIES, bound, count, listing, number
from bodycheck.reports.same_algorithm import NO_CLASSES, Classes, memberships, same_algorithm
from bodycheck.results.key import RunKey

#: The attitude error (rad) below which errors may be the rounding of thousands of steps and are not compared.
ROUNDING_ATTITUDE_RAD = 1e-9

#: The relative difference up to which errors count as equal and their methods are named together.
TIE = 1e-3

#: The relative difference up to which two methods count as having the same errors.
ALIKE = 1e-3

#: The relative difference up to which methods are named together with the method that has the smallest errors.
NEAR = 1e-2

#: The relative drift below which a drift is rounding and is not reported.
ROUNDING = 1e-12

#: The subjects of findings about all methods, which must say so if methods are left out.
OF_ALL_METHODS = ("Position", "Attitude", "Closest", "Angular momentum")


@dataclass(frozen=True)
class Measured:
    """A completed run, its method and its maxima by column."""

    line: Line
    verdict: Verdict
    discrepancy: Summary
    maxima: Mapping[str, float]

    @property
    def case(self) -> str:
        """Return the name of the case."""
        return self.verdict.run.case

    def within_truth(self, name: str) -> bool:
        """Return whether the error in a column is within the error bound of the truth, so that its digits mean nothing."""
        return QUANTITIES[name].within_truth(self.maxima) is not None

    def at_most(self, name: str) -> float:
        """Return the error in a column, or the error bound of the truth if that is larger."""
        own = QUANTITIES[name].within_truth(self.maxima)
        return self.maxima[name] if own is None else own


def measured(verdicts: Sequence[Verdict], lines: Mapping[RunKey, Line]) -> list[Measured]:
    """Return the runs whose errors were measured and are all finite; only these are compared in findings."""
    return [
        Measured(lines[verdict.key.over_cases], verdict, verdict.discrepancy, maxima)
        for verdict in verdicts
        if verdict.discrepancy is not None and all(map(math.isfinite, (maxima := verdict.discrepancy.maxima()).values()))
    ]


def findings(
    runs: Sequence[Measured],
    parts: Sequence[Attribution],
    lines: Mapping[RunKey, Line],
    demonstrations: Collection[RunKey] = (),
    classes: Classes = NO_CLASSES,
) -> tuple[Finding, ...]:
    """Return findings about the completed runs and about the parts of their contact discrepancies.

    The largest errors come first, then the method with the smallest errors, then the causes. Demonstrations are left out, and
    the findings say so, unless only demonstrations were run.

    Parameters
    ----------
    runs
        The completed runs.
    parts
        The parts of their contact discrepancies.
    lines
        The lines of all methods.
    demonstrations
        The methods that are demonstrations.
    classes
        The classes of methods that are the same algorithm, by kind of scene.
    """
    shown = {lines[key] for key in demonstrations}
    if chosen := [run for run in runs if run.line not in shown]:
        parts = [part for part in parts if lines[part.key.over_cases] not in shown]
        found = _findings(chosen, parts, lines, classes)
        return tuple(map(_apart, found)) if len(chosen) < len(runs) else found
    return _findings(runs, parts, lines, classes)


def _apart(finding: Finding) -> Finding:
    """Return a finding, with the words "Demonstrations apart" added if it is about all methods."""
    if finding.subject not in OF_ALL_METHODS:
        return finding
    return replace(finding, before=f"Demonstrations apart, {finding.before[0].lower()}{finding.before[1:]}")


def _findings(
    runs: Sequence[Measured], parts: Sequence[Attribution], lines: Mapping[RunKey, Line], classes: Classes
) -> tuple[Finding, ...]:
    if not runs:
        return ()
    # In contact the model matters more than the integrator, so methods are compared only by flights.
    flight = [run for run in runs if "penetration" not in run.maxima]
    flights = len({run.case for run in flight})
    everywhere = f"over {flights} flights" if flights > 1 else "in the only flight"
    everywhere = everywhere if len(flight) < len(runs) else "over all cases"
    found = (
        _position(runs),
        _attitude(runs),
        _closest(flight, everywhere) if flight else None,
        _contact(parts, lines),
        _angular_momentum(runs),
        same_algorithm(classes),
        _alike(flight, classes) if flight else None,
    )
    return tuple(finding for finding in found if finding is not None)


def _contact(parts: Sequence[Attribution], lines: Mapping[RunKey, Line]) -> Finding | None:
    """Return a finding about the largest effect of the form of a contact model on the rotation until the stop, or None."""
    formed = [part for part in parts if part.quantity == "stop_yaw" and part.model_form]
    if not formed:
        return None
    worst = max(formed, key=lambda part: abs(part.model_form or 0.0))
    form, label = worst.model_form or 0.0, lines[worst.key.over_cases].label
    rest = ""
    if worst.constraint is not None and worst.time_step is not None:
        constraint, time_step = number(worst.constraint, 3), number(worst.time_step, 3)
        rest = f" The contact constraint contributes {constraint} rad and the time step {time_step} rad."
    less = "less" if worst.total < 0 else "more"
    text = (
        f", the body turns {number(abs(worst.total), 3)} rad {less} until it stops with {label} "
        "than with the friction law of the case. The model form (friction at the corners instead of over the area) "
        f"contributes {number(form, 3)} rad at any time step.{rest}"
    )
    return Finding("Contact", "In ", worst.case, text)


def _attitude(runs: Sequence[Measured]) -> Finding | None:
    subject = "Attitude"
    above = [run for run in runs if not run.within_truth("attitude_error")]
    if not above:
        most = max(run.maxima["truth_error"] for run in runs)
        return Finding(
            subject,
            f"In every completed run the attitude error is within the truth's own error, which is at most {bound(most)} rad.",
        )
    worst, tied = _worst(above, "attitude_error")
    return Finding(
        subject,
        f"The largest attitude error is {number(worst.maxima['attitude_error'])} rad, with {_names(tied)} in ",
        worst.case,
        f" {_when(worst, 'attitude_error')}. "
        f"The truth's own error there is at most {bound(worst.maxima['truth_error'], 2)} rad.",
    )


def _position(runs: Sequence[Measured]) -> Finding | None:
    subject, name = "Position", "position_error"
    above = [run for run in runs if not run.within_truth(name)]
    most = max(run.at_most(name) for run in runs)
    if not above or most < COMPARABLE_POSITION_M:
        return Finding(subject, f"No completed run has a position error of more than {bound(most)} m.")
    worst, tied = _worst(above, name)
    distance = worst.maxima[name]
    named = {run.line for run in tied}
    rest = max((run.at_most(name) for run in runs if run.line not in named), default=None)
    contrast = (
        f" No completed run of another method has a position error of more than {bound(rest)} m."
        if rest is not None and rest < distance / 3
        else ""
    )
    return Finding(
        subject,
        f"The largest position error is {number(distance)} m, with {_names(tied)} in ",
        worst.case,
        f" {_when(worst, name)}.{contrast}",
    )


def _angular_momentum(runs: Sequence[Measured]) -> Finding | None:
    name = "angular_momentum_drift"
    conserved = [run for run in runs if name in run.maxima and not run.within_truth(name)]
    if not conserved or (found := _worst(conserved, name))[0].maxima[name] < ROUNDING:
        return None
    worst, tied = found
    return Finding(
        "Angular momentum",
        "The angular momentum, which should be constant, changes by up to "
        f"{_share(worst.maxima[name])} with {_names(tied)} in ",
        worst.case,
        f" {_when(worst, name)}.",
    )


def _closest(runs: Sequence[Measured], everywhere: str) -> Finding | None:
    """Return a finding about the method whose largest attitude error is smallest, among methods that completed every case.

    everywhere: the cases in words. Return None if fewer than two methods completed all cases, or if all are equally close.
    """
    cases = {run.case for run in runs}
    eligible = [own for own in _by_line(runs).values() if len(own) == len(cases)]
    if len(eligible) < 2:
        return None
    worsts = [(max(run.at_most("attitude_error") for run in own), own) for own in eligible]
    limit = min(worst for worst, _ in worsts) * (1 + NEAR)
    tied = [own for worst, own in worsts if worst <= limit]
    if len(tied) == len(eligible):
        return None
    named = [run for own in tied for run in own]
    turn, shift = (max(run.at_most(name) for run in named) for name in ("attitude_error", "position_error"))
    attitude = f"at most {bound(turn)} rad"
    if all(run.within_truth("attitude_error") for run in named):
        attitude = f"within the truth's own error ({bound(turn)} rad)"
    return Finding(
        "Closest",
        f"The attitude error {everywhere} is smallest with {_names([own[0] for own in tied])}: {attitude}, "
        f"with position errors of at most {bound(shift)} m.",
    )


def _alike(runs: Sequence[Measured], classes: Classes) -> Finding | None:
    """Return a finding about two methods of different engines with the same errors, which come from the integration scheme.

    Methods that are the same algorithm are excluded, because another finding describes them. Return None without such methods.
    """
    by_line, known = _by_line(runs), memberships(classes)
    within = {line: known.get(line.key.over_steps, set()) for line in by_line}
    pairs = [
        (one, other, found)
        for one, other in combinations(by_line, 2)
        if not within[one] & within[other] and (found := _scheme_difference(by_line, one, other))
    ]
    if not pairs:
        return None
    one, other, (difference, cases) = max(pairs, key=lambda pair: (pair[2][1], -pair[2][0]))
    agreement = f" to within {bound(100 * difference, 1)} %" if difference else ""
    return Finding(
        "Alike",
        f"{one.label} and {other.label} have the same attitude and position errors{agreement} in all cases where "
        f"these are large enough to compare ({count(cases, 'case')}). "
        "The errors come from the integration scheme, not from either engine.",
    )


def _scheme_difference(by_line: Mapping[Line, Sequence[Measured]], one: Line, other: Line) -> tuple[float, int] | None:
    """Return the largest relative difference of the comparable errors of two methods, and the number of cases with such errors.

    Return None if the methods cannot be compared or their errors are not the same.
    """
    if one.engine == other.engine or one.timestep != other.timestep:
        return None
    theirs = {run.case: run.maxima for run in by_line[other]}
    largest, cases = 0.0, 0
    for run in by_line[one]:
        mine, their = run.maxima, theirs.get(run.case)
        if their is None:
            return None
        floors = {
            "attitude_error": max(ROUNDING_ATTITUDE_RAD, COMPARABLE * mine["truth_error"]),
            "position_error": max(COMPARABLE_POSITION_M, COMPARABLE * mine.get("truth_position_error", 0.0)),
        }
        sizes = [(mine[name], their[name]) for name, floor in floors.items() if max(mine[name], their[name]) > floor]
        largest = max([largest, *(abs(a - b) / max(a, b) for a, b in sizes)])
        cases += any(mine[name] > floor for name, floor in floors.items())
    if cases == 0 or largest > ALIKE:
        return None
    return largest, cases


def _worst(runs: Sequence[Measured], name: str) -> tuple[Measured, list[Measured]]:
    """Return the run with the largest value of a column, and all runs of its case that have the same value within `TIE`."""
    worst = max(runs, key=lambda run: run.maxima[name])
    limit = worst.maxima[name] * (1 - TIE)
    return worst, [run for run in runs if run.case == worst.case and run.maxima[name] >= limit]


def _names(runs: Sequence[Measured]) -> str:
    return listing([run.line.label for run in runs], MOST_NAMES, "method")


def _when(run: Measured, name: str) -> str:
    instant = number(run.discrepancy.instants[name])
    return f"at t\u00a0=\u00a0{instant}\u00a0s"  # with non-breaking spaces


def _by_line(runs: Sequence[Measured]) -> dict[Line, list[Measured]]:
    groups: dict[Line, list[Measured]] = {}
    for run in runs:
        groups.setdefault(run.line, []).append(run)
    return groups


def _share(value: float, digits: int = 3) -> str:
    return f"{number(100 * value, digits)} %" if value < 10 else f"{number(value, digits)} times its initial size"
