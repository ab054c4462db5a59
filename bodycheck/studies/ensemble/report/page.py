"""The report of an ensemble: how often each method fails, how its errors are distributed, and what they depend on.

It is made of aggregates, so that its size does not depend on the number of members.
"""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from bodycheck.reports.finding import MOST_NAMES, Finding
from bodycheck.reports.lines import Line
from bodycheck.reports.notices import Asked, missing_engines, not_supported
from bodycheck.reports.quantities import PLOTTED, QUANTITIES, count, listing, number, verb
from bodycheck.reports.study import Animation, Chart, Part, StudyReport
from bodycheck.results.header import Header
from bodycheck.studies.ensemble.findings.aggregates import Aggregates, Figure, Method
from bodycheck.studies.ensemble.findings.analysis import Analysis
from bodycheck.studies.ensemble.findings.maps import Map
from bodycheck.studies.ensemble.findings.sensitivity import FAILURE, MOST_MEMBERS, RELEVANT, Dependence
from bodycheck.studies.ensemble.report import charts
from bodycheck.studies.ensemble.report.page_tables import (
    dependence_table,
    figure_table,
    file_table,
    method_lines,
    method_table,
    percent,
    share_text,
    ways_table,
    worst_table,
)

#: The names of the parts.
METHODS, ERRORS, CAUSES, WORST = "methods", "distributions", "causes", "worst"

#: A largest value this many times the 99 % quantile is told as one that stands out.
OUTLYING = 10.0

#: Explanations for readers.
READING = (
    "The members of the ensemble are drawn from the case, and every method is run with each of them. A member has failed "
    "with a method if its run has another status than ok, or if it breaks an expectation of the case. Members that an "
    "engine does not support are not counted.",
    "Intervals have a confidence of 95 %. Members are drawn from 16 sequences that are scrambled independently of each other, "
    "and intervals come from the spread of the 16 shares. Where no member failed, the probability is at most 3 divided by the "
    "number of members.",
    "Quantiles and largest values are those of the members that have the figure, and each of them is the value of a member. "
    "The charts with tails show the share of all members whose figure is larger than a value, or that have none because they "
    "failed.",
    "Methods are ranked by the share of members that failed, and then by the 99 % quantile of the figure that is named.",
    "The rank correlation is Spearman's: positive if the figure rises with the drawn number. The share of the variance is how "
    "much of the variance of the logarithm of the figure the number explains by itself (the first-order index of Sobol), in "
    "whatever way the figure depends on it. Shares of all numbers may sum to less than 1, since numbers also act together. "
    "|KEY| is the length of a drawn vector.",
)


class File(NamedTuple):
    """A worst member: its number, the name of its case file (empty if there is none), and what fails."""

    member: int
    name: str
    title: str


@dataclass(frozen=True, eq=False)
class Material:
    """The material of an ensemble's report.

    Attributes
    ----------
    header
        Versions, machine and command.
    kind
        The kind of the scene: turning, translation, drag or contact.
    analysis
        What the runs say.
    files
        The case files of the worst members.
    animations
        Animations of the worst members.
    """

    header: Header
    kind: str
    analysis: Analysis
    files: tuple[File, ...] = ()
    animations: tuple[Animation, ...] = ()

    @property
    def aggregates(self) -> Aggregates:
        """The counts and distributions."""
        return self.analysis.aggregates


def present(found: Material) -> StudyReport:
    """Return the contents of the report."""
    ensemble = found.aggregates
    lines = method_lines(ensemble)
    made = [method for method in ensemble.methods if method.members]
    parts = (_methods(ensemble, lines), _distributions(ensemble, lines), _causes(found, lines), _worst(found, lines))
    return StudyReport(
        title=f"Ensemble of {ensemble.case}",
        headline=_headline(ensemble, made),
        header=found.header,
        notices=(*missing_engines(found.header), *not_supported(_asked(found))),
        findings=tuple(findings(found)),
        parts=tuple(part for part in parts if part.charts or part.tables or part.animations),
        reading=READING,
    )


def findings(found: Material) -> list[Finding]:
    """Return the findings: failures, the ranking, members that stand out, and what errors depend on."""
    lines = method_lines(found.aggregates)
    return [
        *_failures(found.aggregates, lines),
        *_ranking(found.aggregates, lines),
        *_outliers(found.aggregates, lines),
        *_dependences(found, lines),
    ]


def _headline(ensemble: Aggregates, made: Sequence[Method]) -> str:
    runs = sum(method.members for method in made)
    failed = sum(way.count for method in made for way in method.ways)
    of = f"{count(ensemble.members, 'member')} with {count(len(made), 'method')}"
    return f"{of}: {failed} of {count(runs, 'run')} failed" if failed else f"{of}: no run failed"


def _asked(found: Material) -> list[Asked]:
    return [
        Asked(found.kind, method.engine_method.engine, method.engine_method.version, method.unsupported)
        for method in found.aggregates.methods
    ]


def _failures(ensemble: Aggregates, lines: Sequence[Line]) -> list[Finding]:
    failing = [
        (method, line)
        for method, line in zip(ensemble.methods, lines, strict=True)
        if method.failed and method.failed.value > 0
    ]
    sound = [method for method in ensemble.methods if method.failed and not method.failed.value]
    told = []
    for method, line in sorted(failing, key=lambda one: -_failed(one[0]))[:MOST_NAMES]:
        ways = listing([f"{way.count} {way.name}" for way in method.ways])
        told.append(
            Finding(
                "Failures",
                f"{line.label} fails in {share_text(method)} of the members: {ways}. Member {method.ways[0].first} is the "
                f"first: {method.ways[0].reason or method.ways[0].name}. See ",
                METHODS,
                ".",
            )
        )
    if sound:
        bound = max(method.failed.high for method in sound if method.failed)
        methods = listing(
            [line.label for method, line in zip(ensemble.methods, lines, strict=True) if method in sound], 4, "method"
        )
        told.append(Finding("No failures", f"No member failed with {methods}: the probability is at most {percent(bound)}."))
    return told


def _failed(method: Method) -> float:
    return method.failed.value if method.failed else 0.0


def _ranking(ensemble: Aggregates, lines: Sequence[Line]) -> list[Finding]:
    """Return a sentence on the best and the worst method; none for a single one."""
    figure, ranked = ensemble.figures.get(ensemble.ranking), ensemble.ranked
    if figure is None or len(ranked) < 2:
        return []
    quantity = QUANTITIES[figure.name]

    def told(place: int) -> str:
        method, own = ensemble.methods[place], figure.distributions.get(place)
        failing = f"{percent(_failed(method))} failed" if _failed(method) else "none failed"
        return f"{lines[place].label} ({failing}" + (
            f", 99 % up to {quantity.with_unit(own.quantiles['q99'])})" if own else ")"
        )

    title = quantity.title.lower()
    text = f"By failures and then the {title}, the best method is {told(ranked[0])}, and the last is {told(ranked[-1])}."
    wins = max(figure.best, key=figure.best.__getitem__) if figure.best else None
    most = (
        f" {lines[wins].label} has the smallest {title} in {percent(figure.best[wins])} of the members."
        if wins is not None
        else ""
    )
    return [Finding("Rank", text + most)]


def _outliers(ensemble: Aggregates, lines: Sequence[Line]) -> list[Finding]:
    """Return a sentence on the largest value of the figure that methods are ranked by."""
    figure = ensemble.figures.get(ensemble.ranking)
    if figure is None:
        return []
    own = max(figure.distributions.values(), key=lambda one: one.largest)
    quantity, most = QUANTITIES[figure.name], own.quantiles["q99"]
    factor = own.largest / most if most else 0.0
    stands = f", {number(factor, 2)} times its 99 % quantile" if factor >= OUTLYING else ""
    text = (
        f"The largest {quantity.title.lower()} is {quantity.with_unit(own.largest)}, with {lines[own.method].label} in member "
    )
    return [Finding("Worst member", f"{text}{own.worst}{stands}. See ", WORST, ".")]


def _dependences(found: Material, lines: Sequence[Line]) -> list[Finding]:
    """Return a sentence for the failures and one for the ranking figure: the number that each method depends on most."""
    told = []
    for figure in (FAILURE, found.aggregates.ranking):
        strongest: dict[str, list[Dependence]] = defaultdict(list)
        for place in range(len(lines)):
            own = [one for one in found.analysis.dependences if (one.method, one.figure) == (place, figure)]
            if own and (first := max(own, key=lambda one: one.share)).share >= RELEVANT:
                strongest[first.number].append(first)
        what = "Whether a member fails" if figure == FAILURE else f"The {QUANTITIES[figure].title.lower()}" if figure else ""
        for name, own in strongest.items():
            shares = sorted(one.share for one in own)
            explains = " to ".join(dict.fromkeys((percent(shares[0]), percent(shares[-1]))))
            methods = listing([lines[one.method].label for one in own], MOST_NAMES, "method")
            told.append(
                Finding("Causes", f"{what} depends most on {name} with {methods}: it explains {explains} of the variance.")
            )
    return told


def _methods(ensemble: Aggregates, lines: Sequence[Line]) -> Part:
    tables = [("Methods, the best first", method_table(ensemble, lines))]
    if any(method.ways for method in ensemble.methods):
        tables.append(("Ways of failing", ways_table(ensemble, lines)))
    return Part(METHODS, "Methods", (), (), tuple(tables))


def _distributions(ensemble: Aggregates, lines: Sequence[Line]) -> Part:
    drawn = [ensemble.figures[name] for name in PLOTTED if name in ensemble.figures and ensemble.figures[name].edges.size]
    shown = tuple(chart for figure in drawn for chart in _charts(figure, lines))
    tables = tuple((QUANTITIES[name].label, figure_table(figure, lines)) for name, figure in ensemble.figures.items())
    there = [line for place, line in enumerate(lines) if any(place in figure.distributions for figure in drawn)]
    return Part(ERRORS, "Distribution of errors", (), shown, tables, tuple(there))


def _charts(figure: Figure, lines: Sequence[Line]) -> list[Chart]:
    quantity = QUANTITIES[figure.name]
    ends = [
        f"{lines[place].label} from {number(own.quantiles['q05'], 3)} to {number(own.quantiles['q95'], 3)}"
        for place, own in figure.distributions.items()
    ]
    of = f"{quantity.title.lower()} of the members on a log scale; nine tenths are, in {quantity.unit or 'relative units'}, for"
    what = f"{of} {listing(ends, 6, 'method')}."
    zeros = [lines[place].label for place, own in figure.distributions.items() if own.zeros]
    notes = [f"Errors of zero, which are not drawn, occur with {listing(zeros, MOST_NAMES, 'method')}."] if zeros else []
    if figure.truth is not None:
        median, largest = (quantity.with_unit(value) for value in figure.truth)
        notes.append(f"The truth's own error is at most {largest}, in half of the members at most {median}.")
    return [
        Chart(quantity.title, charts.histogram(figure, lines), f"Histograms of the {what}", tuple(notes)),
        Chart(f"{quantity.title}: tail", charts.tail(figure, lines), f"Share of members with a larger {what}"),
    ]


def _causes(found: Material, lines: Sequence[Line]) -> Part:
    texts = []
    if found.aggregates.members > MOST_MEMBERS:
        texts.append(f"The table is computed from the first {MOST_MEMBERS} members; the maps show all of them.")
    maps = tuple(_map(drawn, place, lines) for drawn in found.analysis.maps for place in drawn.values)
    shown = dependence_table(found.analysis.dependences, lines)
    return Part(CAUSES, "What errors depend on", tuple(texts), maps, (("Strongest dependences", shown),) if shown.rows else ())


def _map(drawn: Map, place: int, lines: Sequence[Line]) -> Chart:
    what = "Failures" if drawn.of == FAILURE else f"{QUANTITIES[drawn.of].title}"
    alt = f"Map of the {what.lower()} of {lines[place].label} over {drawn.x} and {drawn.y}."
    return Chart(f"{what}: {lines[place].label}", charts.failure_map(drawn, place), alt)


def _worst(found: Material, lines: Sequence[Line]) -> Part:
    files = [file for file in found.files if file.name]
    text = (
        f"{count(len(files), 'case file')} in the folder worst {verb(len(files), 'has', 'have')} a member that was made "
        "simpler while it fails in the same way. The command bodycheck run FILE runs it by itself."
    )
    table = worst_table(found.aggregates, lines)
    tables = [("Worst member of each method", table)] if table.rows else []
    tables += [("Case files of worst members", file_table(found.files))] if found.files else []
    return Part(WORST, "Worst members", (text,) if files else (), (), tuple(tables), (), found.animations)
