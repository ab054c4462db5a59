"""Notices: sentences about the limits of a report, such as missing engines and unsupported runs."""

import re
from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from bodycheck.adapters.engine_name import adapter_of
from bodycheck.reports.quantities import count, listing
from bodycheck.results.header import Header

#: The effect that an engine must model for a kind of scene, by the name of the kind. Notices use this order.
KINDS = {"turning": "rotation", "translation": "translation", "drag": "drag", "contact": "contact", "mechanism": "mechanisms"}

#: The most reasons, other than a missing model, that a notice gives for a kind of scene. Tables of results have all reasons.
MOST_REASONS = 3


def of_header(header: Header) -> list[str]:
    """Return sentences on the robots' files of cases, and one on each engine that could not be used, with the reason."""
    return [*of_robots(header), *missing_engines(header)]


def of_robots(header: Header) -> list[str]:
    """Return the sentences on the robots' files of cases."""
    return [f"{case}: {sentence}" for case, sentences in header["robots"].items() for sentence in sentences]


def missing_engines(header: Header) -> list[str]:
    """Return a sentence for each engine that could not be used, with the reason."""
    return [f"The engine {engine} was not used: {reason}." for engine, reason in header["missing"].items()]


@dataclass(frozen=True)
class Asked:
    """A run that was requested.

    Parameters
    ----------
    scene
        The kind of its scene, or the name of its case if the kind is not known.
    engine, version
        The engine and its version.
    refused
        Why its engine does not support the run; empty if the engine supports it.
    """

    scene: str
    engine: str
    version: str
    refused: str

    @property
    def lacks(self) -> str:
        """The effects in the scene that the engine does not model; empty unless the run is refused for that reason."""
        names = "|".join(map(re.escape, (self.engine, adapter_of(self.engine))))
        found = re.fullmatch(rf"(?:{names}) {re.escape(self.version)} does not model ([\w, ]+)", self.refused)
        if found is None:
            return ""
        effect = KINDS.get(self.scene, "")
        return effect if effect in found[1].split(", ") else found[1]


def not_supported(asked: Iterable[Asked]) -> tuple[str, ...]:
    """Return sentences about unsupported runs: about effects that are not modelled, then about other reasons by kind of scene.

    If an engine refuses only some of its runs of such scenes, the sentence gives their number.
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
    """Return the key that sorts effects in the order of `KINDS`, with all other effects last."""
    effects = list(KINDS.values())
    return (effects.index(what) if what in effects else len(effects), what)
