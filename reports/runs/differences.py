"""Differences between sets of results, as sentences that state measurements.

The numbers of a run in two sets agree to the last bit, agree within the truths' own errors and rounding, or differ. The
allowance for rounding is a lower limit: the rounding of all steps without its amplification by the motion, because no run is
repeated from perturbed initial states.
"""

from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

from bodycheck.casefile.identity import changed_keys, keys
from bodycheck.figures.columns import distance_from_ideal
from bodycheck.judging.baselines.rounding import unamplified
from bodycheck.judging.judgement import Verdict
from bodycheck.judging.result_set import ResultSet
from bodycheck.reference.truths import NoTruth, Truth
from bodycheck.reports.finding import Finding
from bodycheck.reports.quantities import QUANTITIES, count, listing, milliseconds, number, verb
from bodycheck.reports.runs.comparison import Comparison, Shown
from bodycheck.results.header import Header
from bodycheck.results.key import RunKey

#: The most runs whose change has its own sentence.
MOST_CHANGES = 5

#: The number of truths of each set that are kept in memory: the truths of one case at its time steps.
TRUTHS_KEPT = 8

#: The most methods, or keys of a case, that a sentence names.
MOST_NAMES = 4

#: The value that replaces zero in ratios of errors.
NEARLY_ZERO = 1e-300

#: The sentences after the number of changes.
ROUNDING_CAVEAT = (
    " The comparison allows for the rounding of each step, but not for its growth by the motion, because no run was repeated "
    "from nudged initial states. In an unstable motion, rounding alone can cause such a difference. A comparison with a "
    "baseline (bodycheck diff) also allows for this growth."
)

#: A function from the name of a case and a time step (s) to the truth.
Truths = Callable[[str, float], Truth | NoTruth]


@dataclass(frozen=True)
class Change:
    """The number that changed most in a run.

    Parameters
    ----------
    case
        The name of the case in the report.
    run
        The run.
    name
        The column of results that has the number.
    base, now
        The number in the first set and in the other set.
    least
        The largest difference that the truths' own errors and rounding explain.
    """

    case: str
    run: RunKey
    name: str
    base: float
    now: float
    least: float

    @property
    def factor(self) -> float:
        """Return the ratio of the larger to the smaller distance from the ideal; distances below `least` are raised to it."""
        low, high = sorted(
            max(distance_from_ideal(self.name, value), self.least, NEARLY_ZERO) for value in (self.base, self.now)
        )
        return high / low

    @property
    def grew(self) -> bool:
        """Return whether the number is now farther from the ideal."""
        return distance_from_ideal(self.name, self.now) > distance_from_ideal(self.name, self.base)

    @property
    def finding(self) -> Finding:
        """Return the change as a sentence, with enough digits that the two numbers differ."""
        quantity = QUANTITIES[self.name]
        for digits in (3, 6, 9, 12, 17):
            base, now = number(self.base, digits), number(self.now, digits)
            if base != now:
                break
        values = f"from {base} to {now} {quantity.unit}".rstrip()
        text = f", the {quantity.title.lower()} of {method_text(self.run)} changed {values}."
        return Finding("Changed", "In ", self.case, text)


@dataclass(frozen=True)
class Pair:
    """The first set of results and another set that is compared with it; `cases` are the cases of the report."""

    base: ResultSet
    other: ResultSet
    cases: Sequence[Shown]

    @cached_property
    def common(self) -> list[tuple[Shown, Verdict, Verdict]]:
        """Return the runs that both sets have, each as the case and the two verdicts; the case is the same in both sets."""
        found = []
        for case in self.cases:
            here, there = ({v.run.key: v for v in case.verdicts if v.label == one.label} for one in (self.base, self.other))
            found += [(case, here[key], there[key]) for key in here if key in there]
        return found

    @cached_property
    def changed(self) -> list[Change]:
        """Return the changes of runs that the truths' own errors and rounding do not explain, the largest change first."""
        found = [change for case, *pair in self.common if (change := self._change(case, *pair)) is not None]
        return sorted(found, key=lambda change: -change.factor)

    @cached_property
    def changed_status(self) -> list[tuple[Shown, Verdict, Verdict]]:
        """Return the runs whose status differs, each as the case and the two verdicts."""
        return [entry for entry in self.common if entry[1].outcome.status != entry[2].outcome.status]

    @cached_property
    def without_figures(self) -> int:
        """Return the number of runs that have the same status and no numbers in either set."""
        alike = [pair for _, *pair in self.common if pair[0].outcome.status == pair[1].outcome.status]
        return sum(not _figures(one) and not _figures(other) for one, other in alike)

    @cached_property
    def same(self) -> int:
        """Return the number of runs whose numbers all agree to the last bit."""
        complete = [pair for _, *pair in self.common if all(map(_figures, pair))]
        return sum(not _differing(one, other) for one, other in complete)

    @property
    def differing(self) -> int:
        """Return the number of runs that differ in a number or in their status."""
        return len(self.changed) + len(self.changed_status)

    def _change(self, case: Shown, one: Verdict, other: Verdict) -> Change | None:
        here, there = _figures(one), _figures(other)
        names = _differing(one, other)
        if not names:
            return None
        least = [self._least(truths, case, verdict, names) for truths, verdict in zip(self._truths, (one, other), strict=True)]
        changes = (
            Change(case.name, one.run.key, name, here[name], there[name], sum(own[name] for own in least)) for name in names
        )
        beyond = [change for change in changes if abs(change.now - change.base) > change.least]
        return max(beyond, key=lambda change: (change.factor, change.name), default=None)

    @cached_property
    def _truths(self) -> tuple[Truths, Truths]:
        return lru_cache(TRUTHS_KEPT)(self.base.results.truth), lru_cache(TRUTHS_KEPT)(self.other.results.truth)

    def _least(self, truths: Truths, case: Shown, verdict: Verdict, names: Sequence[str]) -> dict[str, float]:
        truth = truths(case.case.name, verdict.run.method.sampling)
        assert isinstance(truth, Truth)  # because the run has numbers
        return unamplified(truth, verdict.run, names)


def compare(sets: Sequence[ResultSet], cases: Sequence[Shown]) -> Comparison:
    """Return the differences between the first set and each other set. cases: the result of `comparison.shown`."""
    pairs = [Pair(sets[0], other, cases) for other in sets[1:]]
    common, differing = sum(len(pair.common) for pair in pairs), sum(pair.differing for pair in pairs)
    if not common:
        headline = "No runs in common"
    elif differing:
        headline = f"{differing} of {count(common, 'common run')} {verb(differing, 'differs', 'differ')}"
    else:
        headline = f"No difference in {count(common, 'common run')}"
    interrupted = "" if all(one.results.complete for one in sets) else "Interrupted. "
    return Comparison(
        headline=interrupted + headline,
        notices=tuple(text for pair in pairs for text in _notices(pair)),
        findings=tuple(finding for pair in pairs for finding in _findings(pair)),
    )


def method_text(key: RunKey) -> str:
    """Return the engine, the integrator and the time step of a run as text."""
    return f"{key.engine} {key.method.name} at {milliseconds(key.method.timestep)}"


def _findings(pair: Pair) -> Iterator[Finding]:
    yield Finding("Sets", _versions(pair))
    yield Finding("In common", _agreement(pair))
    for change in pair.changed[:MOST_CHANGES]:
        yield change.finding
    if more := pair.changed[MOST_CHANGES:]:
        factor = number(more[0].factor, 2)
        yield Finding("Changed", f"{count(len(more), 'more run')} changed, by a factor of at most {factor}.")
    for case, one, other in pair.changed_status:
        why = f" ({other.outcome.reason})" if other.outcome.reason else ""
        statuses = f"from {one.outcome.status} to {other.outcome.status}{why}"
        yield Finding("Status", "In ", case.name, f", the status of {method_text(one.run.key)} changed {statuses}.")
    yield from _only_in_one(pair)


def _versions(pair: Pair) -> str:
    """Return sentences about the differences in versions and machines between both sets."""
    one, other = (_leaves(side.results.header) for side in (pair.base, pair.other))
    apart = [
        f"{name} {other.get(name, 'none')} instead of {one.get(name, 'none')}"
        for name in {**one, **other}
        if one.get(name) != other.get(name)
    ]
    here, there = (side.label for side in (pair.base, pair.other))
    if not apart:
        return f"{here} and {there} were made with the same versions on the same machine."
    return f"{there} was made with {listing(apart)}. Otherwise, versions and machine are the same as for {here}."


def _agreement(pair: Pair) -> str:
    here, there = pair.base.label, pair.other.label
    if not pair.common:
        return f"{here} and {there} have no runs in common."
    explained = len(pair.common) - pair.same - pair.differing - pair.without_figures
    text = (
        f"{here} and {there} have {count(len(pair.common), 'run')} in common. Of these, {pair.same} "
        f"{verb(pair.same, 'agrees', 'agree')} in every number to the last bit, {explained} "
        f"{verb(explained, 'agrees', 'agree')} within the truth's own error and rounding, and {pair.differing} "
        f"{verb(pair.differing, 'differs', 'differ')}."
    )
    if pair.without_figures:
        have = verb(pair.without_figures, "has", "have")
        text += f" {pair.without_figures} ended with the same status and {have} no numbers."
    if pair.changed:
        grew = sum(change.grew for change in pair.changed)
        larger, smaller = count(grew, "run"), count(len(pair.changed) - grew, "run")
        became = f"one number changed most: it became larger in {larger} and smaller in {smaller}"
        each = f"the number that changed most became {'larger' if grew else 'smaller'}"
        text += verb(
            len(pair.changed), f" In the run whose numbers differ, {each}.", f" In each run whose numbers differ, {became}."
        )
    return text + (ROUNDING_CAVEAT if pair.changed else "")


def _only_in_one(pair: Pair) -> Iterator[Finding]:
    """Yield a finding about the runs that only one of the sets has, without cases that differ between the sets."""
    both = {one.run.key for _, one, _ in pair.common}
    for side in (pair.base, pair.other):
        amounts: dict[str, int] = defaultdict(int)
        for case in pair.cases:
            for verdict in case.verdicts if case.name == case.case.name else ():
                if verdict.label == side.label and verdict.run.key not in both:
                    amounts[f"{verdict.run.engine} {verdict.run.method.name}"] += 1
        if amounts:
            amount = sum(amounts.values())
            where = f"{count(amount, 'run')} {verb(amount, 'is', 'are')} in {side.label} only"
            methods = [f"{runs} with {name}" for name, runs in amounts.items()]
            named = f": {listing(methods, MOST_NAMES, 'method')}" if len(methods) > 1 else f", with {next(iter(amounts))}"
            yield Finding("In one only", f"{where}{named}.")


def _notices(pair: Pair) -> Iterator[str]:
    """Yield a notice about each case whose files differ between the sets."""
    here, there = pair.base.results.cases, pair.other.results.cases
    sets = f"{pair.base.label} and {pair.other.label}"
    for name in here:
        if name not in there or here[name].text == there[name].text:
            continue
        apart = changed_keys(keys(here[name]), keys(there[name]))
        if apart:
            told = listing([f"{key} {one or 'none'} → {other or 'none'}" for key, one, other in apart], MOST_NAMES, "key")
            yield (
                f"The case {name} differs between {sets}: {told}. "
                "Each is compared with its own truth, and their runs are not compared with each other."
            )
        else:
            yield f"The file of {name} differs between {sets}, but not in anything that affects the physics."


def _leaves(header: Header) -> dict[str, str]:
    machine = {("processors" if name == "cores" else name): value for name, value in header["machine"].items()}
    return {"bodycheck": header["bodycheck"], **header["engines"], **header["packages"], **machine}


def _figures(verdict: Verdict) -> dict[str, float]:
    """Return the measured numbers of a run by column, without error bounds of the truth."""
    maxima = verdict.discrepancy.maxima() if verdict.discrepancy is not None else {}
    return {name: value for name, value in maxima.items() if name in QUANTITIES}


def _differing(one: Verdict, other: Verdict) -> list[str]:
    """Return the columns in which both runs have a number and the numbers are not identical."""
    here, there = _figures(one), _figures(other)
    return [name for name in here if name in there and here[name] != there[name]]
