"""The outcomes of runs: the headline, the number of runs with each outcome, the limits of the report, and failed runs."""

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence

from bodycheck.adapters.scheduling import lateness
from bodycheck.figures.columns import BEFORE_DEPARTURE, DEPARTURE
from bodycheck.judging.judgement import Verdict
from bodycheck.judging.result_set import ResultSet
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reports.finding import Finding
from bodycheck.reports.lines import Line
from bodycheck.reports.notices import missing_engines, of_robots
from bodycheck.reports.quantities import count, milliseconds, number, verb
from bodycheck.reports.runs.unsupported import is_unsupported, not_supported
from bodycheck.results.key import RunKey
from bodycheck.results.outcome import Completed, Unsupported
from bodycheck.results.store import Results
from bodycheck.results.unchecked import Unchecked, sentences
from bodycheck.results.verdicts import EXPECTATIONS, KNOWN, SCENES


def headline(results: Results, verdicts: Sequence[Verdict]) -> str:
    """Return the verdict on all runs in one line."""
    runs, failed = len(verdicts), sum(verdict.passed is False for verdict in verdicts)
    tolerated = sum(map(_tolerated, verdicts))
    held = sum(verdict.passed is True for verdict in verdicts) - tolerated
    refused = sum(is_unsupported(verdict) for verdict in verdicts)
    if not runs:
        text = "No run finished"
    elif failed:
        text = f"{failed} of {count(runs, 'run')} failed"
    elif refused == runs:
        reasons = {verdict.outcome.reason for verdict in verdicts if isinstance(verdict.outcome, Unsupported)}
        why = reasons.pop() if len(reasons) == 1 else "the engines or the truth do not support them"
        text = f"None of {count(runs, 'run')} has a result: {why}"
    elif held or tolerated:
        known = f" and {tolerated} {verb(tolerated, 'has', 'have')} a known discrepancy" if tolerated else ""
        text = f"None of {count(runs, 'run')} failed: {held} met all expectations{known}"
    else:
        text = f"None of {count(runs, 'run')} failed; no expectations were set"
    text += _unchecked(results.unchecked)
    return text if results.complete else f"Interrupted. {text}"


def _unchecked(unchecked: Sequence[Unchecked]) -> str:
    """Return the end of a headline with the number of unchecked expectations; empty if there are none."""
    failed, tolerated = (sum(one.failed is counts for one in unchecked) for counts in (True, False))
    told = f"; {count(failed, 'expectation')} could not be checked, which counts as failed" if failed else ""
    return told + (f"; {count(tolerated, 'expectation')} {verb(tolerated, 'was', 'were')} not checked" if tolerated else "")


def tally(verdicts: Sequence[Verdict], unchecked: Sequence[Unchecked] = ()) -> tuple[tuple[str, int], ...]:
    """Return the number of runs with each outcome. Rare outcomes are left out if no run has them."""
    statuses = Counter(verdict.outcome.status for verdict in verdicts)
    passed = Counter(verdict.passed for verdict in verdicts)
    completed, refused = statuses.pop(Completed.status, 0), statuses.pop(Unsupported.status, 0)
    asked = [("runs", len(verdicts)), ("completed", completed), ("passed", passed[True]), ("failed", passed[False])]
    unasked = sum(verdict.passed is None and not is_unsupported(verdict) for verdict in verdicts)
    more = [
        ("known discrepancies", sum(map(_tolerated, verdicts))),
        ("without expectations", unasked),
        ("expectations not checked", len(unchecked)),
    ]
    return (*asked, *statuses.items(), ("unsupported", refused), *((name, amount) for name, amount in more if amount))


def notices(one: ResultSet) -> tuple[str, ...]:
    """Return sentences about the limits of a set of results: robots, interruption, missing engines, and unsupported runs."""
    robots = (_labelled(one, text) for text in of_robots(one.results.header))
    return (*robots, *limits(one), *(_labelled(one, text) for text in not_supported(one.verdicts)))


def limits(one: ResultSet) -> tuple[str, ...]:
    """Return the notices of a set of results, without those about unsupported runs, and about robots, which come first."""
    texts = []
    if not one.results.complete:
        texts.append(
            f"The command was interrupted after {count(len(one.verdicts), 'run')}. "
            "Runs that had not finished by then are missing from this report."
        )
    texts += _before_departures(one.verdicts)
    texts += _late_efforts(one.verdicts)
    texts += missing_engines(one.results.header)
    texts += sentences(one.results.unchecked)
    return tuple(_labelled(one, text) for text in texts)


def _before_departures(verdicts: Sequence[Verdict]) -> Iterator[str]:
    """Yield a sentence on the attitude errors up to the departure of each robot from its file."""
    column, errors = BEFORE_DEPARTURE["attitude_error"], defaultdict[str, list[tuple[float, float, str]]](list)
    for verdict in verdicts:
        before = {} if verdict.discrepancy is None else verdict.discrepancy.before
        if column in before:
            method = f"{verdict.run.engine} {verdict.run.method}"
            errors[verdict.run.case].append((before[column], before[DEPARTURE], method))
    for case, of_case in errors.items():
        (least, departure, best), (most, _, worst) = min(of_case), max(of_case)
        ends = f"{number(least)} rad, with {best}"
        if least != most:
            ends = f"from {ends}, to {number(most)} rad, with {worst}"
        yield f"{case}: up to {departure:.4g} s, the largest attitude error is {ends}."


def _late_efforts(verdicts: Sequence[Verdict]) -> Iterator[str]:
    """Yield a sentence on each case and time step at which controllers compute between steps."""
    runs = {
        (run.case, run.method.timestep, verdict.duration): run
        for verdict in verdicts
        if isinstance((run := verdict.run).scene, Mechanism) and run.method.accuracy is None and not run.is_recorded
    }
    for (case, timestep, duration), run in runs.items():
        assert run.scene is not None
        for joint, late in lateness(run.scene, run.method, duration).items():
            text = f"its effort is late by up to {milliseconds(late, 4)}"
            yield f"{case}: instants of {joint}'s controller are not steps at {milliseconds(timestep, 4)}: {text}."


def _labelled(one: ResultSet, text: str) -> str:
    return f"{one.label}: {text}" if one.label else text


def unsupported(verdicts: Sequence[Verdict]) -> str:
    """Return the number of unsupported runs and the reasons, in one line; empty if all runs are supported."""
    amount, told = sum(map(is_unsupported, verdicts)), " ".join(not_supported(verdicts))
    return f"{count(amount, 'run')} unsupported. {told}" if amount else ""


def expectation_status(verdict: Verdict) -> str:
    """Return the status of the expectations of a run: held, known (broken in a known way), failed, or a dash if it has none."""
    if _tolerated(verdict):
        return KNOWN
    return EXPECTATIONS[verdict.passed]


def failure_status(verdict: Verdict) -> str:
    """Return how a run failed: the verdict for broken expectations if it completed, otherwise its status."""
    return SCENES["broken"].title if isinstance(verdict.outcome, Completed) else verdict.outcome.status


def broken(verdicts: Sequence[Verdict], lines: Mapping[RunKey, Line]) -> Finding | None:
    """Return a finding with the number of failed runs, and how and why the first of them failed; None if no run failed.

    Of several reasons the first is given: the table of failed runs has them all.
    """
    failed = [verdict for verdict in verdicts if verdict.passed is False]
    if not failed:
        return None
    first, cases = failed[0], len({verdict.run.case for verdict in failed})
    label, status = lines[first.key.over_cases].label, failure_status(first)
    start = f"{label} failed in "
    if len(failed) > 1:
        start = f"{count(len(failed), 'run')} failed in {count(cases, 'case')}. The first is {label} in "
    reason = first.reason.partition(";")[0]
    return Finding("Failed", start, first.run.case, f" ({status})" + (f": {reason}." if reason else "."))


def _tolerated(verdict: Verdict) -> bool:
    """Return whether a run breaks an expectation in a way that is listed as known, and therefore passes."""
    return verdict.passed is True and any(one.breaches for one in verdict.judged)
