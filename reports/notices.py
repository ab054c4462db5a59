"""Notices: sentences on what limits a report."""

from collections import Counter
from collections.abc import Iterable

from bodycheck.reports.quantities import count, verb
from bodycheck.running.header import Header


def missing_engines(header: Header) -> list[str]:
    """Return a sentence for each engine that could not be used, with the reason."""
    return [f"The engine {engine} was not used: {reason}." for engine, reason in header["missing"].items()]


def unsupported(reasons: Iterable[str]) -> list[str]:
    """Return a sentence for each reason why an engine does not support runs, with their number."""
    return [
        f"{count(amount, 'run')} {verb(amount, 'is', 'are')} not supported by the engine: {reason}."
        for reason, amount in Counter(reasons).items()
    ]
