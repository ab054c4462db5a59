"""What differs between sets of results, as sentences made of measurements.

Two figures of a run agree to the last bit; or they are no farther apart than the truths' own errors and rounding together
explain; or they differ. What rounding explains is the least of it, as no run was made again from nudged initial states: what n
steps can add up to where the motion does not amplify it.
"""

from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from statistics import median
from typing import Any

from bodycheck.casefile.identity import differences
from bodycheck.figures.columns import distance_from_ideal
from bodycheck.judging.judgement import Verdict
from bodycheck.judging.result_set import ResultSet
from bodycheck.judging.rounding import unamplified
from bodycheck.reference.truth import NoTruth, Truth
from bodycheck.reports.finding import Finding
from bodycheck.reports.quantities import QUANTITIES, count, listing, milliseconds, number
from bodycheck.reports.runs.comparison import Comparison, Shown, method
from bodycheck.running.machine import SPEED_TOLERANCE

#: Runs whose change gets a sentence.
MOST_CHANGES = 5

#: Methods, or keys of a case, that one sentence names.
MOST_NAMES = 4

NOTHING = 1e-300

HONESTLY = (
    " Of rounding only what the steps add up to is counted, not what the motion makes of it, as no run was repeated from "
    "nudged states: an unstable motion may make such a difference of rounding alone. A baseline measures that."
)

Method = tuple[str, str, float]
Truths = Callable[[str, float], Truth | NoTruth]


@dataclass(frozen=True)
class Change:
    """A run that is not what it was: the figure that changed most. least: what of it truths and rounding explain."""

    case: str
    method: Method
    name: str
    base: float
    now: float
    least: float

    @property
    def factor(self) -> float:
        """How many times farther from what is right the larger of the two is; what is explained counts as right."""
        low, high = sorted(max(distance_from_ideal(self.name, value), self.least, NOTHING) for value in (self.base, self.now))
        return high / low

    @property
    def grew(self) -> bool:
        return distance_from_ideal(self.name, self.now) > distance_from_ideal(self.name, self.base)

    @property
    def text(self) -> str:
        """What follows the name of the case."""
        quantity = QUANTITIES[self.name]
        for digits in (3, 6, 9, 12, 17):
            base, now = number(self.base, digits), number(self.now, digits)
            if base != now:
                break
        return f", {told(self.method)}: {quantity.title.lower()} {base} → {f'{now} {quantity.unit}'.rstrip()}"


@dataclass(frozen=True)
class Pair:
    """The first set, and another that is held against it. cases: the report's."""

    base: ResultSet
    other: ResultSet
    cases: Sequence[Shown]

    @cached_property
    def common(self) -> list[tuple[Shown, Verdict, Verdict]]:
        """The runs that both have of a case that is the same in both."""
        found = []
        for case in self.cases:
            here, there = ({method(v): v for v in case.verdicts if v.label == one.label} for one in (self.base, self.other))
            found += [(case, here[key], there[key]) for key in here if key in there]
        return found

    @cached_property
    def changed(self) -> list[Change]:
        """Runs with figures in both that differ beyond what is explained, the largest change first."""
        found = [change for case, *pair in self.common if (change := self._change(case, *pair)) is not None]
        return sorted(found, key=lambda change: -change.factor)

    @cached_property
    def ended_otherwise(self) -> list[tuple[Shown, Verdict, Verdict]]:
        return [entry for entry in self.common if entry[1].outcome.status != entry[2].outcome.status]

    @cached_property
    def without_figures(self) -> int:
        """How many runs ended alike in both, and have no figures."""
        alike = [pair for _, *pair in self.common if pair[0].outcome.status == pair[1].outcome.status]
        return sum(not _figures(one) and not _figures(other) for one, other in alike)

    @cached_property
    def same(self) -> int:
        """How many runs agree in every figure to the last bit."""
        told = [pair for _, *pair in self.common if all(map(_figures, pair))]
        return sum(not _differing(one, other) for one, other in told)

    @property
    def differing(self) -> int:
        return len(self.changed) + len(self.ended_otherwise)

    def _change(self, case: Shown, one: Verdict, other: Verdict) -> Change | None:
        here, there = _figures(one), _figures(other)
        names = _differing(one, other)
        if not names:
            return None
        least = [self._least(truths, case, verdict, names) for truths, verdict in zip(self._truths, (one, other), strict=True)]
        changes = (
            Change(case.name, method(one), name, here[name], there[name], sum(own[name] for own in least)) for name in names
        )
        beyond = [change for change in changes if abs(change.now - change.base) > change.least]
        return max(beyond, key=lambda change: (change.factor, change.name), default=None)

    @cached_property
    def _truths(self) -> tuple[Truths, Truths]:
        return cache(self.base.results.truth), cache(self.other.results.truth)

    def _least(self, truths: Truths, case: Shown, verdict: Verdict, names: Sequence[str]) -> dict[str, float]:
        truth = truths(case.case.name, verdict.run.method.timestep)
        assert isinstance(truth, Truth)  # the run has figures
        return unamplified(truth, verdict.run, names)


def compare(sets: Sequence[ResultSet], cases: Sequence[Shown]) -> Comparison:
    """What differs between the first set and each of the others. cases: what `comparison.shown` makes of the sets."""
    pairs = [Pair(sets[0], other, cases) for other in sets[1:]]
    common, differing = sum(len(pair.common) for pair in pairs), sum(pair.differing for pair in pairs)
    if not common:
        headline = "No run in common"
    elif differing:
        headline = f"{differing} of {count(common, 'run')} in common {'differs' if differing == 1 else 'differ'}"
    else:
        headline = f"No difference in {count(common, 'run')} in common"
    interrupted = "" if all(one.results.complete for one in sets) else "Interrupted. "
    return Comparison(
        headline=interrupted + headline,
        notices=tuple(text for pair in pairs for text in _notices(pair)),
        findings=tuple(finding for pair in pairs for finding in _findings(pair)),
    )


def told(key: Method) -> str:
    engine, integrator, timestep = key
    return f"{engine} {integrator} at {milliseconds(timestep)}"


def _findings(pair: Pair) -> Iterator[Finding]:
    yield Finding("Sets", _origins(pair))
    yield Finding("In common", _agreement(pair))
    for change in pair.changed[:MOST_CHANGES]:
        yield Finding("Changed", "", change.case, f"{change.text}.")
    if more := pair.changed[MOST_CHANGES:]:
        yield Finding("Changed", f"{count(len(more), 'run')} more, each by a factor of at most {number(more[0].factor, 2)}.")
    for case, one, other in pair.ended_otherwise:
        why = f" ({other.outcome.reason})" if other.outcome.reason else ""
        text = f", {told(method(one))}: {one.outcome.status} → {other.outcome.status}{why}."
        yield Finding("Ended otherwise", "", case.name, text)
    yield from _alone(pair)
    yield from _paces(pair)


def _origins(pair: Pair) -> str:
    """What the sets were made with."""
    one, other = (_leaves(side.results.header) for side in (pair.base, pair.other))
    apart = [
        f"{name} {other.get(name, 'none')} instead of {one.get(name, 'none')}"
        for name in {**one, **other}
        if one.get(name) != other.get(name)
    ]
    here, there = (side.label for side in (pair.base, pair.other))
    if not apart:
        return f"{here} and {there} were made with the same versions on the same machine."
    return f"{there} was made with {listing(apart)}; versions and machine are those of {here} otherwise."


def _agreement(pair: Pair) -> str:
    here, there = pair.base.label, pair.other.label
    if not pair.common:
        return f"{here} and {there} have no run in common."
    explained = len(pair.common) - pair.same - pair.differing - pair.without_figures
    text = (
        f"Of {count(len(pair.common), 'run')} that both {here} and {there} have, {pair.same} agree in every figure to the last "
        f"bit, {explained} within the truth's own error and rounding, and {pair.differing} "
        f"{'differs' if pair.differing == 1 else 'differ'}."
    )
    if pair.without_figures:
        text += f" {pair.without_figures} ended alike, and without figures."
    if pair.changed:
        grew = sum(change.grew for change in pair.changed)
        text += f" What changed most in a run became larger in {grew} and smaller in {len(pair.changed) - grew}."
    return text + (HONESTLY if pair.changed else "")


def _alone(pair: Pair) -> Iterator[Finding]:
    """Runs that only one of the two has, of cases that are the same where both have them."""
    both = {(case.name, method(one)) for case, one, _ in pair.common}
    for side in (pair.base, pair.other):
        amounts: dict[str, int] = defaultdict(int)
        for case in pair.cases:
            for verdict in case.verdicts if case.name == case.case.name else ():
                if verdict.label == side.label and (case.name, method(verdict)) not in both:
                    amounts[f"{verdict.run.engine} {verdict.run.method.name}"] += 1
        if amounts:
            methods = listing([f"{name} ({amount})" for name, amount in amounts.items()], MOST_NAMES, "method")
            yield Finding("In one only", f"In {side.label} only: {count(sum(amounts.values()), 'run')}, with {methods}.")


def _paces(pair: Pair) -> Iterator[Finding]:
    """Methods whose steps take another time, told where the machine is the same."""
    if pair.base.results.header["machine"] != pair.other.results.header["machine"]:
        yield Finding("Cost", "Made on different machines: what steps cost is not compared.")
        return
    factors: dict[str, list[float]] = defaultdict(list)
    for _, one, other in pair.common:
        times = [verdict.row().get("time_per_step") for verdict in (one, other)]
        if times[0] and times[1]:
            factors[f"{one.run.engine} {one.run.method.name}"].append(times[1] / times[0])
    beyond = {name: median(own) for name, own in factors.items() if not 1 / SPEED_TOLERANCE <= median(own) <= SPEED_TOLERANCE}
    if beyond:
        texts = [
            f"{number(factor, 2)} times as long with {name} ({count(len(factors[name]), 'run')})"
            for name, factor in beyond.items()
        ]
        yield Finding("Cost", f"A step takes {listing(texts)}: medians of runs timed once, on one machine.")
    elif factors:
        yield Finding(
            "Cost",
            f"By medians on one machine, no method became slower or faster by more than a factor of {SPEED_TOLERANCE:g}.",
        )


def _notices(pair: Pair) -> Iterator[str]:
    """Cases of one name whose files differ."""
    here, there = pair.base.results.cases, pair.other.results.cases
    sets = f"{pair.base.label} and {pair.other.label}"
    for name in here:
        if name not in there or here[name].text == there[name].text:
            continue
        apart = differences(here[name], there[name])
        if apart:
            keys = listing([f"{key} {_said(one)} → {_said(other)}" for key, one, other in apart], MOST_NAMES, "key")
            yield (
                f"{name} is not the same case in {sets}: {keys}. Each is held against its own truth, and they are not compared."
            )
        else:
            yield f"The file of {name} is not the same in {sets}, but for nothing that happens in it."


def _leaves(header: Mapping[str, Any]) -> dict[str, str]:
    machine = {("processors" if name == "cores" else name): value for name, value in header["machine"].items()}
    return {"bodycheck": header["bodycheck"], **header["engines"], **header["packages"], **machine}


def _figures(verdict: Verdict) -> dict[str, float]:
    """The figures of a run by their columns, but for the truth's own."""
    maxima = verdict.discrepancy.maxima() if verdict.discrepancy is not None else {}
    return {name: value for name, value in maxima.items() if name in QUANTITIES}


def _differing(one: Verdict, other: Verdict) -> list[str]:
    """The columns of the figures that both runs have, and that are not the same to the last bit."""
    here, there = _figures(one), _figures(other)
    return [name for name in here if name in there and here[name] != there[name]]


def _said(value: Any) -> str:
    return "none" if value is None else str(value)
