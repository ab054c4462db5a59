"""Differences between sets of results, as sentences that state measurements.

The numbers of a run in two sets agree to the last bit, agree within the truths' own errors and rounding, or differ. The
allowance for rounding is a lower limit: the rounding of all steps without its amplification by the motion, because no run is
repeated from perturbed initial states.

Two releases of an engine are compared with each other if each set has one release of it, however the command named it:
`mujoco@3.2.0` and `mujoco`.
"""

from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
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
from bodycheck.reports.runs.kinds import kind_of
from bodycheck.results.header import Header
from bodycheck.results.key import RunKey

#: The most methods whose changes have a sentence.
MOST_CHANGES = 3

#: The error that shows discrepancies best is told of before other numbers if it changed by at least this factor.
NOTABLE = 1.01

#: The number of truths of each set that are kept in memory: the truths of one case at its time steps.
TRUTHS_KEPT = 8

#: The most methods, or keys of a case, that a sentence names.
MOST_NAMES = 4

#: The value that replaces zero in ratios of errors.
NEARLY_ZERO = 1e-300

#: The notice where numbers changed.
ROUNDING_CAVEAT = (
    "The comparison allows for the rounding of each step, but not for its growth by the motion, because no run was repeated "
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
        The run, with the name by which its engine is compared.
    methods
        The methods of the run in both sets, over all cases.
    name
        The column of results that has the number.
    telling
        Whether the column is the error that shows discrepancies best in scenes of this kind.
    base, now
        The number in the first set and in the other set.
    least
        The largest difference that the truths' own errors and rounding explain.
    """

    case: str
    run: RunKey
    methods: tuple[RunKey, RunKey]
    name: str
    telling: bool
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
    def rank(self) -> tuple[bool, float]:
        """A rank that is larger for what a reader should be told first."""
        return self.telling and self.factor >= NOTABLE, self.factor

    @property
    def text(self) -> str:
        """The change as the end of a sentence that names the case, with enough digits that the two numbers differ."""
        quantity = QUANTITIES[self.name]
        for digits in (3, 6, 9, 12, 17):
            base, now = number(self.base, digits), number(self.now, digits)
            if base != now:
                break
        values = f"from {base} to {now} {quantity.unit}".rstrip()
        return f", the {quantity.title.lower()} of {method_text(self.run)} changed {values}."


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
            here, there = (
                {_key(verdict, names): verdict for verdict in case.verdicts if verdict.label == one.label}
                for one in (self.base, self.other)
                for names in [_names(one)]
            )
            found += [(case, here[key], there[key]) for key in here if key in there]
        return found

    @cached_property
    def changed(self) -> list[Change]:
        """Return the changes of runs that the truths' own errors and rounding do not explain, in the order of their ranks."""
        found = [change for case, *pair in self.common if (change := self._change(case, *pair)) is not None]
        return sorted(found, key=lambda change: change.rank, reverse=True)

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
        run, telling = _key(other, _names(self.other)), kind_of(case.case.scene).quantity
        methods = one.key.over_cases, other.key.over_cases
        least = [self._least(truths, case, verdict, names) for truths, verdict in zip(self._truths, (one, other), strict=True)]
        changes = (
            Change(case.name, run, methods, name, name == telling, here[name], there[name], sum(own[name] for own in least))
            for name in names
        )
        beyond = [change for change in changes if abs(change.now - change.base) > change.least]
        return max(beyond, key=lambda change: (change.rank, change.name), default=None)

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
    changes = [change for pair in pairs for change in pair.changed]
    foremost = max(changes, key=lambda change: (change.telling, abs(change.now - change.base)), default=None)
    interrupted = "" if all(one.results.complete for one in sets) else "Interrupted. "
    return Comparison(
        headline=interrupted + headline,
        notices=tuple(text for pair in pairs for text in _notices(pair)),
        findings=tuple(finding for pair in pairs for finding in _findings(pair)),
        foremost=() if foremost is None else tuple((foremost.case, method) for method in foremost.methods),
    )


def _names(one: ResultSet) -> Mapping[str, str]:
    """Return the name of each engine of a set, without the release if the set has no other release of the engine."""
    engines = one.results.header["engines"]
    releases = Counter(engine.partition("@")[0] for engine in engines)
    return {engine: name if releases[name := engine.partition("@")[0]] == 1 else engine for engine in engines}


def _key(verdict: Verdict, names: Mapping[str, str]) -> RunKey:
    return replace(verdict.run.key, engine=names.get(verdict.run.engine, verdict.run.engine))


def method_text(key: RunKey) -> str:
    """Return the engine, the integrator and the time step of a run as text."""
    return f"{key.engine} {key.method.name} at {milliseconds(key.method.timestep)}"


def _findings(pair: Pair) -> Iterator[Finding]:
    yield Finding("Sets", _versions(pair))
    yield Finding("In common", _agreement(pair))
    by_method: dict[RunKey, list[Change]] = {}
    for change in pair.changed:
        by_method.setdefault(replace(change.run, case=""), []).append(change)
    methods = list(by_method.values())
    for first, *others in methods[:MOST_CHANGES]:
        yield Finding("Changed", "In ", first.case, first.text + _elsewhere(others))
    if rest := methods[MOST_CHANGES:]:
        factor = number(max(change.factor for changes in rest for change in changes), 2)
        yield Finding("Changed", f"{count(len(rest), 'more method')} changed, by a factor of at most {factor}.")
    ended: dict[tuple[str, str, str], list[Verdict]] = {}
    for case, one, other in pair.changed_status:
        ended.setdefault((case.name, one.outcome.status, other.outcome.status), []).append(other)
    for (name, before, now), verdicts in ended.items():
        runs = listing([method_text(_key(one, _names(pair.other))) for one in verdicts], MOST_NAMES, "run")
        why = f" ({verdicts[0].outcome.reason})" if verdicts[0].outcome.reason else ""
        yield Finding("Status", "In ", name, f", the status of {runs} changed from {before} to {now}{why}.")
    yield from _only_in_one(pair)


def _elsewhere(changes: Sequence[Change]) -> str:
    """Return a sentence on the changes of a method in cases that are not named; empty if there are none."""
    if not changes:
        return ""
    grew = sum(change.grew for change in changes)
    ways = [f"for the {way} in {amount}" for way, amount in (("better", len(changes) - grew), ("worse", grew)) if amount]
    return f" It also changed in {count(len(changes), 'more case')}: {listing(ways)}."


def _versions(pair: Pair) -> str:
    """Return sentences about the differences in versions and machines between both sets."""
    one, other = (_leaves(side.results.header, _names(side)) for side in (pair.base, pair.other))
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
        f"Of {count(len(pair.common), 'run')} that {here} and {there} have in common, {pair.same} "
        f"{verb(pair.same, 'agrees', 'agree')} in every number to the last bit, {explained} "
        f"{verb(explained, 'agrees', 'agree')} within the truth's own error and rounding, and {pair.differing} "
        f"{verb(pair.differing, 'differs', 'differ')}"
    )
    if pair.changed:
        grew = sum(change.grew for change in pair.changed)
        text += f": {grew} for the worse and {len(pair.changed) - grew} for the better"
        text += f", and {len(pair.changed_status)} in the status" if pair.changed_status else ""
    text += "."
    if pair.without_figures:
        have = verb(pair.without_figures, "has", "have")
        text += f" {pair.without_figures} ended with the same status and {have} no numbers."
    return text


def _only_in_one(pair: Pair) -> Iterator[Finding]:
    """Yield a finding about the runs that only one of the sets has, without cases that differ between the sets."""
    both = {verdict.key for _, *compared in pair.common for verdict in compared}
    for side in (pair.base, pair.other):
        amounts: dict[str, int] = defaultdict(int)
        for case in pair.cases:
            for verdict in case.verdicts if case.name == case.case.name else ():
                if verdict.label == side.label and verdict.key not in both:
                    amounts[f"{verdict.run.engine} {verdict.run.method.name}"] += 1
        if amounts:
            amount = sum(amounts.values())
            where = f"{count(amount, 'run')} {verb(amount, 'is', 'are')} in {side.label} only"
            methods = [f"{runs} with {name}" for name, runs in amounts.items()]
            named = f": {listing(methods, MOST_NAMES, 'method')}" if len(methods) > 1 else f", with {next(iter(amounts))}"
            yield Finding("In one only", f"{where}{named}.")


def _notices(pair: Pair) -> Iterator[str]:
    """Yield notices about each case whose files differ between the sets, and about rounding."""
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
    if pair.changed:
        yield ROUNDING_CAVEAT


def _leaves(header: Header, names: Mapping[str, str]) -> dict[str, str]:
    engines = {names[engine]: version for engine, version in header["engines"].items()}
    machine = {("processors" if name == "cores" else name): value for name, value in header["machine"].items()}
    return {"bodycheck": header["bodycheck"], **engines, **header["packages"], **machine}


def _figures(verdict: Verdict) -> dict[str, float]:
    """Return the measured numbers of a run by column, without error bounds of the truth."""
    maxima = verdict.discrepancy.maxima() if verdict.discrepancy is not None else {}
    return {name: value for name, value in maxima.items() if name in QUANTITIES}


def _differing(one: Verdict, other: Verdict) -> list[str]:
    """Return the columns in which both runs have a number and the numbers are not identical."""
    here, there = _figures(one), _figures(other)
    return [name for name in here if name in there and here[name] != there[name]]
