"""Runs that their engines do not support. They have no row in matrices and tables; a few sentences describe them."""

from collections.abc import Sequence

from bodycheck.judging.judgement import Verdict
from bodycheck.reports import notices
from bodycheck.reports.notices import Asked
from bodycheck.results.outcome import Unsupported


def is_unsupported(verdict: Verdict) -> bool:
    """Return whether a run is not supported by its engine."""
    return isinstance(verdict.outcome, Unsupported)


def with_place(verdicts: Sequence[Verdict]) -> tuple[Verdict, ...]:
    """Return the verdicts that appear in matrices and tables: supported runs, and unsupported runs that count as failed."""
    return tuple(verdict for verdict in verdicts if verdict.passed is False or not is_unsupported(verdict))


def not_supported(verdicts: Sequence[Verdict]) -> tuple[str, ...]:
    """Return sentences about unsupported runs; see `bodycheck.reports.notices.not_supported`."""
    return notices.not_supported(
        Asked(one.kind, one.run.engine, one.run.version, one.outcome.reason if is_unsupported(one) else "") for one in verdicts
    )
