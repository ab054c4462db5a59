"""Notices: sentences on what limits a report."""

import re
from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from bodycheck.adapters.engine_name import adapter_of
from bodycheck.reports.quantities import count, listing
from bodycheck.results.header import Header

#: What an engine must model for a kind of scene, by the name of the kind, in the order in which it is told.
KINDS = {"turning": "rotation", "translation": "translation", "drag": "drag", "contact": "contact", "mechanism": "mechanisms"}

#: Most reasons other than a missing model that are told for a kind of scene. Tables of results have all of them.
MOST_REASONS = 3


def missing_engines(header: Header) -> list[str]:
    """Return a sentence for each engine that could not be used, with the reason."""
    return [f"The engine {engine} was not used: {reason}." for engine, reason in header["missing"].items()]


@dataclass(frozen=True)
class Asked:
    """A run that was asked for.

    Parameters
    ----------
    scene
        The kind of its scene, or where that is not known the name of its case.
    engine, version
        The engine and its version.
    refused
        Why its engine does not support it; empty if it does.
    """

    scene: str
    engine: str
    version: str
    refused: str

    @property
    def lacks(self) -> str:
        """What the engine does not model of the scene; empty if it refused the run for another reason."""
        names = "|".join(map(re.escape, (self.engine, adapter_of(self.engine))))
        found = re.fullmatch(rf"(?:{names}) {re.escape(self.version)} does not model ([\w, ]+)", self.refused)
        if found is None:
            return ""
        effect = KINDS.get(self.scene, "")
        return effect if effect in found[1].split(", ") else found[1]


def not_supported(asked: Iterable[Asked]) -> tuple[str, ...]:
    """Return what engines do not model in one sentence, and one for each kind of scene of which they refuse runs otherwise.

    An engine that refuses only some of its runs of such scenes is told with their number.
    """
    runs: Counter[tuple[str, str]] = Counter()
    lacking: dict[str, Counter[tuple[str, str]]] = defaultdict(Counter)
    refusing: dict[str, dict[str, Counter[tuple[str, str]]]] = defaultdict(lambda: defaultdict(Counter))
    for run in asked:
        of = (run.scene, run.engine)
        runs[of] += 1
        if run.lacks:
            lacking[run.lacks][of] += 1
        elif run.refused:
            refusing[KINDS.get(run.scene, "")][run.refused][of] += 1
    models = [f"{what} by {_engines(lacking[what], runs)}" for what in sorted(lacking, key=_place)]
    return (
        *((f"Not modelled: {'; '.join(models)}.",) if models else ()),
        *(_refused(kind, refusing[kind], runs) for kind in sorted(refusing, key=_place)),
    )


def _refused(kind: str, reasons: Mapping[str, Mapping[tuple[str, str], int]], runs: Mapping[tuple[str, str], int]) -> str:
    told = [f"by {_engines(own, runs)} ({reason})" for reason, own in reasons.items()]
    if more := told[MOST_REASONS:]:
        told = [*told[:MOST_REASONS], f"and for {count(len(more), 'other reason')}"]
    return f"Without results: {kind} {'; '.join(told)}.".replace("  ", " ")


def _engines(refused: Mapping[tuple[str, str], int], runs: Mapping[tuple[str, str], int]) -> str:
    names: dict[str, tuple[int, int]] = {}
    for (scene, engine), amount in refused.items():
        own, of = names.get(engine, (0, 0))
        names[engine] = own + amount, of + runs[scene, engine]
    return listing([name if own == of else f"{name} in {own} of {of} runs" for name, (own, of) in names.items()])


def _place(what: str) -> tuple[int, str]:
    """Return the place of what is not modelled in the order of `KINDS`; what is none of them comes last."""
    effects = list(KINDS.values())
    return (effects.index(what) if what in effects else len(effects), what)
