"""How the runs ended: the headline, how many ended how, what limits the report, and what failed."""

from collections import Counter
from collections.abc import Mapping, Sequence

from bodycheck.judging.judgement import Verdict
from bodycheck.judging.result_set import ResultSet
from bodycheck.reports.finding import Finding
from bodycheck.reports.lines import Key, Line
from bodycheck.reports.quantities import count
from bodycheck.running.outcome import Completed, Unsupported
from bodycheck.running.store import Results


def key_of(verdict: Verdict) -> Key:
    """The method of a run."""
    run = verdict.run
    return run.engine, run.method.name, run.method.timestep, verdict.label


def headline(results: Results, verdicts: Sequence[Verdict]) -> str:
    """The verdict in one line."""
    runs, failed = len(verdicts), sum(verdict.passed is False for verdict in verdicts)
    tolerated = sum(map(_tolerated, verdicts))
    held = sum(verdict.passed is True for verdict in verdicts) - tolerated
    unsupported = sum(_unsupported(verdict) for verdict in verdicts)
    if not runs:
        text = "No run finished"
    elif failed:
        text = f"{failed} of {count(runs, 'run')} failed"
    elif unsupported == runs:
        text = f"None of {count(runs, 'run')} is supported"
    elif held or tolerated:
        known = f", {tolerated} broke it in a way that is known" if tolerated else ""
        text = f"None of {count(runs, 'run')} failed; {held} held what was expected of them{known}"
    else:
        text = f"None of {count(runs, 'run')} failed; no expectations were set"
    return text if results.complete else f"Interrupted. {text}"


def tally(verdicts: Sequence[Verdict]) -> tuple[tuple[str, int], ...]:
    """How many runs ended how; what did not occur is left out, but for what everyone asks for."""
    statuses = Counter(verdict.outcome.status for verdict in verdicts)
    passed = Counter(verdict.passed for verdict in verdicts)
    completed, unsupported = statuses.pop(Completed.status, 0), statuses.pop(Unsupported.status, 0)
    asked = [("runs", len(verdicts)), ("completed", completed), ("passed", passed[True]), ("failed", passed[False])]
    unasked = sum(verdict.passed is None and not _unsupported(verdict) for verdict in verdicts)
    more = [("known to be broken", sum(map(_tolerated, verdicts))), ("without expectation", unasked)]
    return (*asked, *statuses.items(), ("unsupported", unsupported), *((name, amount) for name, amount in more if amount))


def notices(one: ResultSet) -> tuple[str, ...]:
    """What limits what is said of a set of results: interruption, missing engines, runs that were not supported."""
    results, verdicts, texts = one.results, one.verdicts, []
    if not results.complete:
        texts.append(
            f"The run was interrupted after {count(len(verdicts), 'run')}. What had not finished by then is not in this report."
        )
    for engine, reason in results.header["missing"].items():
        texts.append(f"Without the engine {engine}: {reason}.")
    for reason, amount in Counter(verdict.outcome.reason for verdict in verdicts if _unsupported(verdict)).items():
        texts.append(f"{count(amount, 'run')} unsupported: {reason}.")
    return tuple(f"{one.label}: {text}" if one.label else text for text in texts)


def told_as(verdict: Verdict) -> str:
    """What became of what was expected of a run."""
    if _tolerated(verdict):
        return "known"
    return {True: "held", False: "failed", None: "–"}[verdict.passed]


def result(verdict: Verdict) -> str:
    """How a run failed."""
    return "expectation broken" if isinstance(verdict.outcome, Completed) else verdict.outcome.status


def broken(verdicts: Sequence[Verdict], lines: Mapping[Key, Line]) -> Finding | None:
    """What failed: how many runs, and the first of them, how and why; None where all is well."""
    failed = [verdict for verdict in verdicts if verdict.passed is False]
    if not failed:
        return None
    first, cases = failed[0], len({verdict.run.case for verdict in failed})
    amount = f"{count(len(failed), 'run')} in {count(cases, 'case')}. The first: " if len(failed) > 1 else ""
    why = f"{result(first)}: {first.reason}" if first.reason else result(first)
    return Finding("Failed", f"{amount}{lines[key_of(first)].label} in ", first.run.case, f", {why}.")


def _tolerated(verdict: Verdict) -> bool:
    """Whether a run breaks what is expected of it in a way that is known, and still passes."""
    return verdict.passed is True and any(one.breaches for one in verdict.judged)


def _unsupported(verdict: Verdict) -> bool:
    return isinstance(verdict.outcome, Unsupported)
