"""Runs that their engines do not support: they have no row in matrices and tables, and are told in a line or two."""

import re
from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence

from bodycheck.adapters.engine_name import adapter_of
from bodycheck.judging.judgement import Verdict
from bodycheck.reports.quantities import count, listing
from bodycheck.running.outcome import Unsupported

#: What an engine models that can make the runs of a kind of scene, by the name of the kind, in the order in which it is told.
KINDS = {"turning": "rotation", "translation": "translation", "drag": "drag", "contact": "contact"}

#: Most reasons other than a missing model that are told for a kind of scene. Tables of results have all of them.
MOST_REASONS = 3


def is_unsupported(verdict: Verdict) -> bool:
    """Return whether a run is not supported by its engine."""
    return isinstance(verdict.outcome, Unsupported)


def with_place(verdicts: Sequence[Verdict]) -> tuple[Verdict, ...]:
    """Return the verdicts that have a place in matrices and tables: all but the unsupported ones, unless these failed."""
    return tuple(verdict for verdict in verdicts if verdict.passed is False or not is_unsupported(verdict))


def not_supported(verdicts: Sequence[Verdict]) -> tuple[str, ...]:
    """Return what engines do not model in one sentence, and one for each kind of scene of which they refuse runs otherwise.

    An engine that refuses only some of its runs of a kind is told with their number.
    """
    runs = Counter((verdict.kind, verdict.run.engine) for verdict in verdicts)
    lacking: dict[str, Counter[tuple[str, str]]] = defaultdict(Counter)
    refusing: dict[str, dict[str, Counter[tuple[str, str]]]] = defaultdict(lambda: defaultdict(Counter))
    for verdict in filter(is_unsupported, verdicts):
        of = (verdict.kind, verdict.run.engine)
        what = _lack(verdict)
        (lacking[what] if what else refusing[verdict.kind][verdict.outcome.reason])[of] += 1
    models = [f"{what} by {_engines(lacking[what], runs)}" for what in sorted(lacking, key=_place)]
    return (
        *((f"Not modelled: {'; '.join(models)}.",) if models else ()),
        *(_refused(kind, refusing[kind], runs) for kind in sorted(refusing, key=_place_of_kind)),
    )


def _lack(verdict: Verdict) -> str:
    """Return what an engine does not model of the scene of a run; empty if it refused the run for another reason."""
    named = rf"(?:{re.escape(verdict.run.engine)}|{re.escape(adapter_of(verdict.run.engine))})"
    found = re.fullmatch(rf"{named} {re.escape(verdict.run.version)} does not model ([\w, ]+)", verdict.outcome.reason)
    if found is None:
        return ""
    effect = KINDS.get(verdict.kind, "")
    return effect if effect in found[1].split(", ") else found[1]


def _refused(kind: str, reasons: Mapping[str, Counter[tuple[str, str]]], runs: Mapping[tuple[str, str], int]) -> str:
    told = [f"by {_engines(own, runs)} ({reason})" for reason, own in reasons.items()]
    if more := told[MOST_REASONS:]:
        told = [*told[:MOST_REASONS], f"and for {count(len(more), 'other reason')}"]
    return f"Without results: {KINDS.get(kind, '')} {'; '.join(told)}.".replace("  ", " ")


def _engines(refused: Mapping[tuple[str, str], int], runs: Mapping[tuple[str, str], int]) -> str:
    names: dict[str, tuple[int, int]] = {}
    for (kind, engine), amount in refused.items():
        own, of = names.get(engine, (0, 0))
        names[engine] = own + amount, of + runs[kind, engine]
    return listing([name if own == of else f"{name} in {own} of {of} runs" for name, (own, of) in names.items()])


def _place_of_kind(kind: str) -> tuple[int, str]:
    return _place(KINDS.get(kind, kind))


def _place(what: str) -> tuple[int, str]:
    """Return the place of what is not modelled in the order of `KINDS`; what is none of them comes last."""
    effects = list(KINDS.values())
    return (effects.index(what) if what in effects else len(effects), what)
