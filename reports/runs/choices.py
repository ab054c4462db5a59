"""Choices of methods: the one that is accurate enough for a kind of scene, its cost, and the defaults of engines beside it.

Methods are compared on cases that all of them completed, by the error that shows the discrepancies of the kind best.
"""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import isfinite

from bodycheck.adapters.contract import Efforts
from bodycheck.judging.judgement import Verdict
from bodycheck.reports.finding import Finding
from bodycheck.reports.lines import Line
from bodycheck.reports.quantities import bound, count, milliseconds, number
from bodycheck.reports.runs.comparison import Shown
from bodycheck.reports.runs.kinds import KINDS, Kind, kind_of
from bodycheck.results.key import RunKey
from bodycheck.results.outcome import Completed

#: The error (rad or m) up to which a method counts as accurate enough.
ENOUGH = 1e-3

#: Costs whose ratio is smaller count as equal, since each is measured once. Among these the smallest error decides.
SAME_COST = 1.2

#: The most engines whose defaults have a sentence each at the beginning of a report.
MOST_DEFAULTS = 3


@dataclass(frozen=True)
class Tried:
    """A method in a case: its error (rad or m), or the error bound of the truth if that is larger, and the cost of its run.

    The truth's own error (rad or m) is at most `truth_error`, which is 0 if it is not known. `efforts` says when those of
    driven joints were computed, on which the wall time depends.
    """

    line: Line
    case: str
    error: float
    truth_error: float
    wall_time: float
    duration: float
    efforts: Efforts
    default: bool

    @property
    def method(self) -> str:
        """The method with its time step, without its engine."""
        return f"{self.line.integrator} at {milliseconds(self.line.timestep, 4)}"


@dataclass(frozen=True)
class Option:
    """A method in all compared cases of a kind.

    Attributes
    ----------
    worst
        The run with the largest error.
    cost
        The computing time (s) of a second of motion, on average over the cases in which all methods computed the efforts of
        driven joints at the same instants; None if there is none, or if it was not measured.
    """

    worst: Tried
    cost: float | None

    @property
    def line(self) -> Line:
        """The line of the method."""
        return self.worst.line

    @property
    def error(self) -> float:
        """The largest error (rad or m)."""
        return self.worst.error

    @property
    def name(self) -> str:
        """The engine and the method with its time step."""
        return f"{self.line.engine} {self.worst.method}"


@dataclass(frozen=True)
class Choice:
    """The methods that completed the same cases of a kind, and one of them.

    Attributes
    ----------
    kind
        The kind of the scenes.
    compared, cases
        The number of the cases that all options completed, and of all cases of the kind in which any method has an error.
    options
        The methods, in the order of the report.
    chosen
        The cheapest method that is accurate enough; the most accurate one if none is, or if no costs can be compared.
    """

    kind: Kind
    compared: int
    cases: int
    options: tuple[Option, ...]
    chosen: Option

    @property
    def enough(self) -> bool:
        """Return whether the chosen method is accurate enough."""
        return self.chosen.error <= ENOUGH

    @property
    def finding(self) -> Finding:
        """The choice as a sentence."""
        unit = self.kind.figure.unit
        limit, most = f"{number(ENOUGH)} {unit}", f"at most {bound(self.chosen.error, 2)} {unit}"
        cost = "" if self.chosen.cost is None else f" A second of motion costs {number(self.chosen.cost, 2)} s of computing."
        where = f"in all {self.compared} cases" if self.compared > 1 else "in the only case"
        if self.compared < self.cases:
            where = f"in the {count(self.compared, 'case')} of {self.cases} that most methods complete"
        if not self.enough:
            text = f"No method stays within {limit} {where}. {self.chosen.name} is closest, with {most} in "
            return Finding(self.kind.title, text, self.chosen.worst.case, f".{cost}")
        start = f"{self.chosen.name} stays"
        if len(self.options) > 1:
            best = "the most accurate, and stays" if self.chosen.cost is None else "the cheapest that stays"
            start = f"Of {len(self.options)} methods, {self.chosen.name} is {best}"
        text = f"{start} within {limit} {where}: {most} in "
        last = max(self.options, key=lambda option: option.error)
        rest = f" The largest error is {number(last.error, 2)} {unit}, with {last.name}." if last != self.chosen else ""
        return Finding(self.kind.title, text, self.chosen.worst.case, f".{cost}{rest}")


def tried(cases: Sequence[Shown], lines: Mapping[RunKey, Line], demonstrations: Collection[RunKey]) -> dict[Kind, list[Tried]]:
    """Return the runs with finite errors by kind of scene; demonstrations are left out.

    Parameters
    ----------
    cases
        The cases of the report.
    lines
        The lines of all methods.
    demonstrations
        The methods that are demonstrations.
    """
    runs: dict[Kind, list[Tried]] = {kind: [] for kind in KINDS}
    for case in cases:
        kind = kind_of(case.case.scene)
        for verdict in case.verdicts:
            key = verdict.key.over_cases
            if key not in demonstrations and (errors := _errors(verdict, kind)) is not None:
                outcome = verdict.outcome
                wall_time, efforts = (outcome.wall_time, outcome.efforts) if isinstance(outcome, Completed) else (0.0, "")
                default = "default" in (verdict.run.role or "")
                runs[kind].append(Tried(lines[key], case.name, *errors, wall_time, verdict.duration, efforts, default))
    return {kind: of_kind for kind, of_kind in runs.items() if of_kind}


def _errors(verdict: Verdict, kind: Kind) -> tuple[float, float] | None:
    """Return the error of a run in the quantity of a kind, and the truth's own (rad or m); None if it has no finite error."""
    if verdict.discrepancy is None:
        return None
    maxima = verdict.discrepancy.maxima()
    within = kind.figure.within_truth(maxima)
    error = maxima[kind.quantity] if within is None else within
    return (error, maxima.get(kind.figure.bound_name, 0.0)) if isfinite(error) else None


def choices(runs: Mapping[Kind, Sequence[Tried]]) -> tuple[Choice, ...]:
    """Return a choice for each kind of scene: first where a method is accurate enough, and then the kind with the most runs.

    runs: those of `tried`.
    """
    amounts = {_choice(kind, tries): len(tries) for kind, tries in runs.items()}
    return tuple(sorted(amounts, key=lambda choice: (not choice.enough, -amounts[choice])))


def _choice(kind: Kind, runs: Sequence[Tried]) -> Choice:
    by_line: dict[Line, dict[str, Tried]] = {}
    for one in runs:
        by_line.setdefault(one.line, {})[one.case] = one
    sets = [frozenset(own) for own in by_line.values()]
    compared = max(sets, key=lambda cases: (len(cases), sets.count(cases)))
    complete = [tries for tries in by_line.values() if compared <= tries.keys()]
    timed = [case for case in sorted(compared) if len({tries[case].efforts for tries in complete}) == 1]
    options = [_option([tries[case] for case in sorted(compared)], timed) for tries in complete]
    return Choice(kind, len(compared), len({one.case for one in runs}), tuple(options), _chosen(options))


def _option(runs: Sequence[Tried], timed: Collection[str]) -> Option:
    """Return a method in some cases. timed: those in which the costs of all methods can be compared."""
    costs = [one for one in runs if one.case in timed]
    known = costs and all(one.wall_time and one.duration for one in costs)
    cost = sum(one.wall_time for one in costs) / sum(one.duration for one in costs) if known else None
    return Option(max(runs, key=lambda one: one.error), cost)


def _chosen(options: Sequence[Option]) -> Option:
    """Return the cheapest option that is accurate enough, or the most accurate one.

    Of one method the largest time step is the cheapest, whatever was measured.
    """
    largest: dict[tuple[str, str], Option] = {}
    for one in options:
        method = (one.line.engine, one.line.integrator)
        enough = one.error <= ENOUGH and one.cost is not None
        if enough and (method not in largest or one.line.timestep > largest[method].line.timestep):
            largest[method] = one
    if not largest:
        return min(options, key=lambda one: one.error)
    least = min(one.cost or 0.0 for one in largest.values())
    return min((one for one in largest.values() if (one.cost or 0.0) <= SAME_COST * least), key=lambda one: one.error)


@dataclass(frozen=True)
class Extreme:
    """The method with the smallest or the largest error in a case, and this error, in words."""

    method: str
    error: str


def extremes(runs: Mapping[Kind, Sequence[Tried]]) -> dict[str, tuple[Extreme, ...]]:
    """Return the methods with the smallest and the largest error of each case; one if both are the same."""
    ends: dict[str, tuple[Extreme, ...]] = {}
    for kind, tries in runs.items():
        by_case: dict[str, list[Tried]] = {}
        for one in tries:
            by_case.setdefault(one.case, []).append(one)
        for case, alike in by_case.items():
            both = (min(alike, key=lambda one: one.error), max(alike, key=lambda one: one.error))
            words = (Extreme(one.line.label, f"{number(one.error, 2)} {kind.figure.unit}") for one in both)
            ends[case] = tuple(dict.fromkeys(words))
    return ends


@dataclass(frozen=True)
class Default:
    """The default method of an engine in the case in which it is worst, and the best of the engine's methods there.

    `better` is `worst` itself if no other method has a smaller error.
    """

    kind: Kind
    worst: Tried
    better: Tried

    @property
    def finding(self) -> Finding:
        """The error of the default method as a sentence, beside that of the better one."""
        worst, better, unit = self.worst, self.better, self.kind.figure.unit
        start = f"The default of {worst.line.engine}, {worst.method}, "
        if worst.error <= ENOUGH:
            return Finding("Default", f"{start}is off by at most {bound(worst.error, 2)} {unit}, in ", worst.case, ".")
        rest = "."
        if better.error < worst.error / 2:
            times = better.wall_time / worst.wall_time if worst.wall_time and better.efforts == worst.efforts else 0.0
            cost = f" at {number(times, 2)} times the cost" if times else ""
            rest = f", where {better.method} is off by {number(better.error, 2)} {unit}{cost}."
        if worst.truth_error:
            rest += f" The truth's own error there is at most {bound(worst.truth_error, 2)} {unit}."
        return Finding("Default", f"{start}is off by {number(worst.error, 2)} {unit} in ", worst.case, rest)


def defaults(runs: Mapping[Kind, Sequence[Tried]]) -> tuple[Default, ...]:
    """Return the default method of each engine in the case in which it is worst, the worst engine first.

    Cases in which a reader can do something about it come first: those in which another method of the engine is accurate
    enough. Cases with contact count only if there are no others, since the model of the contact matters more there than the
    method.
    """
    chosen = {kind: tries for kind, tries in runs.items() if kind.name != "contact"} or runs
    better: dict[tuple[str, str], Tried] = {}
    for one in (one for tries in chosen.values() for one in tries):
        pair = (one.line.engine, one.case)
        if pair not in better or one.error < better[pair].error:
            better[pair] = one
    worst: dict[str, Default] = {}
    for kind, tries in chosen.items():
        for one in tries:
            if one.default:
                default = Default(kind, one, better[one.line.engine, one.case])
                if one.line.engine not in worst or _urgency(default) > _urgency(worst[one.line.engine]):
                    worst[one.line.engine] = default
    return tuple(sorted(worst.values(), key=_urgency, reverse=True))


def _urgency(default: Default) -> tuple[bool, float]:
    return default.better.error <= ENOUGH < default.worst.error, default.worst.error


def attention(cases: Sequence[Shown], lines: Mapping[RunKey, Line], demonstrations: Collection[RunKey]) -> Iterator[Finding]:
    """Yield a sentence for each status of runs that ended without an error, and that no expectation counts as failed.

    The sentence names the first of them that is no demonstration.
    """
    ended: dict[str, list[Verdict]] = {}
    for case in cases:
        for verdict in case.verdicts:
            if verdict.outcome.failed and verdict.passed is not False:
                ended.setdefault(verdict.outcome.status, []).append(verdict)
    for status, verdicts in ended.items():
        first, amount = min(verdicts, key=lambda one: one.key.over_cases in demonstrations), len(verdicts)
        label = lines[first.key.over_cases].label
        start = f"{label} has the status {status} in "
        if amount > 1:
            start = f"{amount} runs have the status {status}. The first is {label} in "
        yield Finding(status.capitalize(), start, first.run.case, f": {first.reason}.")
