"""Write the worst members of an ensemble, made simpler, as case files that fail when they are run."""

import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from textwrap import wrap
from typing import Any

from bodycheck.adapters.method import Method
from bodycheck.casefile.case import Case, parse
from bodycheck.casefile.expectation import unit
from bodycheck.casefile.finding import SUFFIX
from bodycheck.casefile.grammar import FORMAT
from bodycheck.casefile.toml_text import short
from bodycheck.casefile.values import MAX_NAME_LENGTH
from bodycheck.errors import BadInput
from bodycheck.figures.columns import FIGURES
from bodycheck.files import writing
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.running.campaign import Advance
from bodycheck.running.instants import check_timestep
from bodycheck.studies.ensemble.findings.stored import Ensemble
from bodycheck.studies.ensemble.findings.ways import Way, chosen
from bodycheck.studies.ensemble.header import WORST
from bodycheck.studies.ensemble.worst_members.shrinking import BLOCK, Document, shrink
from bodycheck.studies.ensemble.worst_members.trials import Trials, Tried, trials

#: The most lines of a case file, unless its numbers need more.
MOST_LINES = 30

#: The most characters in a line of a comment, and in the reason for a status.
COMMENT_WIDTH, REASON_LENGTH = 110, 200

#: Most further ways of failing that a file names.
MOST_NAMED = 4


@dataclass(frozen=True)
class Worst:
    """A worst member.

    Attributes
    ----------
    way
        The way in which it fails.
    path
        The case file that was written; None if the member does not fail when it is run alone.
    title
        The failure and its size, in words.
    """

    way: Way
    path: Path | None
    title: str


def write(
    folder: Path, case: Case, ensemble: Ensemble, text_of: Callable[[int], str], origin: str, progress: Advance
) -> list[Worst]:
    """Write the worst members of an ensemble into the folder `worst` of its results, and return them, the worst first.

    Each member is made simpler while it fails in the same way: with the same status, by breaking the same limit of an
    expectation, or, if it breaks none, by a value of the figure above the 99 % quantile of the members. A value that is more
    than 10 times the quantile must stay above half of itself. Figures whose values are only rounding are left out.

    Parameters
    ----------
    folder
        The folder of the results.
    case, ensemble
        The case and its runs.
    text_of
        Function from the number of a member to its case file.
    origin
        The source of the members, in words, such as "seed 1".
    progress
        A function that is called after each member.
    """
    written = []
    with trials() as tried:
        for way, others in chosen(case, ensemble):
            member = _write_one(folder, case.name, way, others, text_of(way.member), origin, tried)
            written += [member] if member is not None else []
            progress(f"worst member {way.member}")
    return written


def _write_one(folder: Path, case: str, way: Way, others: Sequence[Way], text: str, origin: str, tried: Trials) -> Worst | None:
    """Write one member and return it; return None if its figure is only rounding."""
    drawn = _document(tomllib.loads(text), case, way, origin)
    (alone,) = _tried([drawn], way, tried)
    if alone is not None and way.value is not None and _rounding(way, way.value, alone):
        return None
    if alone is None or not _fails(way, alone):
        return Worst(way, None, f"member {way.member} has {way.name} in the ensemble, and not when it is run alone")
    simple = _simplest(drawn, way, tried)
    (last,) = _tried([simple], way, tried)
    if last is None or not _fails(way, last):  # an engine that is not deterministic
        simple, last = drawn, alone
    simplified = simple != drawn
    simple["title"] = title = _title(way, last)
    path = folder / WORST / f"{case}-{way.member}{SUFFIX}"
    content = short(simple, _comments(case, way, others, origin, simplified), MOST_LINES)
    if len(content.splitlines()) > MOST_LINES:
        content = short(simple, _comments(case, way, (), origin, simplified), MOST_LINES)
    writing.write(path, content.encode("utf-8"), inside=folder)
    return Worst(way, path, title)


def _simplest(drawn: Document, way: Way, tried: Trials) -> Document:
    """Return the simplest document that fails in the same way. The search ends with the first trial that takes too long."""
    over = way.status == TimedOut.status

    def fails(documents: Sequence[Document]) -> list[bool]:
        nonlocal over
        outcomes = [None] * len(documents) if over else _tried(documents, way, tried)
        over = over or any(one is not None and one.status == TimedOut.status for one in outcomes)
        return [one is not None and _fails(way, one) for one in outcomes]

    # A run that ends its process costs a new process, so that only the runs that are needed are made.
    return shrink(drawn, fails, way.method.timestep, block=1 if way.status == Crashed.status else BLOCK)


def _fails(way: Way, tried: Tried) -> bool:
    """Return whether a run fails in a way, by more than rounding."""
    shown = way.shown(tried.status, tried.figures)
    return shown and (way.limit is None or not _rounding(way, tried.figures[way.limit.name], tried))


def _rounding(way: Way, value: float, tried: Tried) -> bool:
    """Return whether the largest value of a figure, of which the case expects nothing, is only rounding."""
    return way.is_largest and way.limit is not None and value < tried.floors.get(way.limit.name, 0.0)


def _document(drawn: Document, case: str, way: Way, origin: str) -> Document:
    """Return the case file of a member, with the expectation that it breaks as its only expectation."""
    number = f"-{way.member}"
    expect: dict[str, Any] = {
        "engine": way.method.engine,
        "integrator": way.method.integrator,
        "timestep": way.method.timestep,
        "version": way.method.version,
    }
    if way.limit is None:
        expect["status"] = way.expected
    elif way.limit.at_least is None:
        expect[way.limit.name] = way.limit.at_most
    else:
        ends = {"at_least": way.limit.at_least, "at_most": way.limit.at_most}
        expect[way.limit.name] = {end: value for end, value in ends.items() if value is not None}
    head = {
        "format": drawn.get("format", FORMAT),
        "name": case[: MAX_NAME_LENGTH - len(number)] + number,
        "title": "",
        "source": f"member {way.member} of the ensemble {case}, {origin}",
    }
    tables: Document = {name: drawn[name] for name in ("body", "initial", "scene", "run") if name in drawn}
    return {**head, **tables, "expect": [expect]}


def _tried(documents: Sequence[Document], way: Way, tried: Trials) -> list[Tried | None]:
    """Return the outcomes of documents with the method of `way`; None for a document that is no valid case."""
    method = Method.parse(way.method.integrator, way.method.timestep)
    cases: dict[int, Case] = {}
    for index, document in enumerate(documents):
        try:
            cases[index] = parse(short(document), "")
            check_timestep(cases[index], method.timestep)
        except BadInput:
            cases.pop(index, None)
    outcomes = dict(zip(cases, tried(way.method.engine, method, list(cases.values())), strict=True))
    return [outcomes.get(index) for index in range(len(documents))]


def _title(way: Way, tried: Tried) -> str:
    """Return the title of a case file: the failure of a run, and its size."""
    by = f"{way.method.engine} {way.method.version} with {way.method.integrator} at {way.method.timestep:g} s"
    if way.limit is None:
        reason = "".join(sign if sign.isprintable() else " " for sign in tried.reason)[:REASON_LENGTH]
        return f"{by}: the run has the status {tried.status}{f' ({reason})' if reason else ''}, expected is {way.expected}"
    name = way.limit.name
    return f"{by}: {FIGURES[name].title.lower()} {tried.figures[name]:.3g}{unit(name)}, expected is {way.limit.text}"


def _comments(case: str, way: Way, others: Sequence[Way], origin: str, simplified: bool) -> list[str]:
    """Return the comments at the beginning of a file: the source of the case, and other ways in which it is the worst."""
    how = "made simpler while it fails in the same way" if simplified else "as it was drawn"
    first = f"Member {way.member} of the ensemble {case} ({origin}), {how}."
    if way.limit is not None and way.value is not None:
        there = f"In the ensemble its {way.limit.name} is {way.value:.3g}{unit(way.limit.name)}. {way.explanation}"
    else:
        there = f"It is the first member whose run with this method has the status {way.status}."
    names = list(dict.fromkeys(other.name for other in others if other.name != way.name))
    more = [f"{len(names) - MOST_NAMED} more"] if len(names) > MOST_NAMED else []
    also = [f"It is also the worst in: {', '.join(names[:MOST_NAMED] + more)}."] if names else []
    return [line for sentence in (first, there, *also) for line in wrap(sentence, COMMENT_WIDTH, break_on_hyphens=False)]
