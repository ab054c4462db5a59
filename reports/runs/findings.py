"""Findings about the runs of a report: sentences on where discrepancies come from."""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
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

#: The relative drift below which a drift is rounding and is not reported.
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
        """Return the name of the case."""
        return self.verdict.run.case

    def within_truth(self, name: str) -> bool:
        """Return whether the error in a column is within the error bound of the truth, so that its digits mean nothing."""
        return QUANTITIES[name].within_truth(self.maxima) is not None


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
    """Return findings on where discrepancies come from: contact models, schemes, and invariants that are not kept.

    Demonstrations are left out, unless only demonstrations were run.

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
        runs, parts = chosen, [part for part in parts if lines[part.key.over_cases] not in shown]
    # In contact the model matters more than the integrator, so methods are compared only by flights.
    flight = [run for run in runs if "penetration" not in run.maxima]
    every = (
        _contact(parts, lines),
        same_algorithm(classes),
        _alike(flight, classes) if flight else None,
        _angular_momentum(runs),
    )
    return tuple(finding for finding in every if finding is not None)


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
