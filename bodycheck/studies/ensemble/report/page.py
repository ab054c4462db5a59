"""The report of an ensemble: how often each method fails, how its errors are distributed, and what they depend on.

It is made of aggregates, so that its size does not depend on the number of members.
"""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from bodycheck.reports.finding import MOST_NAMES, Finding
from bodycheck.reports.lines import Line
from bodycheck.reports.notices import Asked, not_supported, of_header
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

#: Most methods whose ranges of errors the description of a chart gives.
MOST_RANGES = 6

#: A largest value stands out if it is this many times the 99 % quantile.
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
    """A worst member: its number, the name of its case file (empty if there is none), and its failure."""

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
        The analysis of the runs.
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


def present(material: Material) -> StudyReport:
    """Return the contents of the report."""
    ensemble = material.aggregates
    lines = method_lines(ensemble)
    methods = [method for method in ensemble.methods if method.members]
    parts = (_methods(ensemble, lines), _distributions(ensemble, lines), _causes(material, lines), _worst(material, lines))
    return StudyReport(
        title=f"Ensemble of {ensemble.case}",
        headline=_headline(ensemble, methods),
        header=material.header,
        notices=(*of_header(material.header), *not_supported(_asked(material))),
        findings=tuple(findings(material)),
        parts=tuple(part for part in parts if part.charts or part.tables or part.animations),
        reading=READING,
    )


def findings(material: Material) -> list[Finding]:
    """Return the findings: failures, the ranking, members that stand out, and what errors depend on."""
    lines = method_lines(material.aggregates)
    return [
        *_failures(material.aggregates, lines),
        *_ranking(material.aggregates, lines),
        *_outliers(material.aggregates, lines),
        *_dependences(material, lines),
    ]


def _headline(ensemble: Aggregates, methods: Sequence[Method]) -> str:
    runs = sum(method.members for method in methods)
    failed = sum(way.count for method in methods for way in method.ways)
    size = f"{count(ensemble.members, 'member')} with {count(len(methods), 'method')}"
    return f"{size}: {failed} of {count(runs, 'run')} failed" if failed else f"{size}: no run failed"


def _asked(material: Material) -> list[Asked]:
    return [
        Asked(material.kind, method.engine_method.engine, method.engine_method.version, method.unsupported)
        for method in material.aggregates.methods
    ]


def _failures(ensemble: Aggregates, lines: Sequence[Line]) -> list[Finding]:
    failing = [
        (method, line)
        for method, line in zip(ensemble.methods, lines, strict=True)
        if method.failed and method.failed.value > 0
    ]
    sound = [method for method in ensemble.methods if method.failed and not method.failed.value]
    sentences = []
    for method, line in sorted(failing, key=lambda one: -_failed(one[0]))[:MOST_NAMES]:
        ways = listing([f"{way.count} {way.name}" for way in method.ways])
        sentences.append(
            Finding(
                "Failures",
                f"{line.label} fails in {share_text(method)}: {ways}. Member {method.ways[0].first} is the "
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
        sentences.append(
            Finding("No failures", f"No member failed with {methods}: the probability is at most {percent(bound)}.")
        )
    return sentences


def _failed(method: Method) -> float:
    return method.failed.value if method.failed else 0.0


def _ranking(ensemble: Aggregates, lines: Sequence[Line]) -> list[Finding]:
    """Return a sentence on the best and the worst method; none for a single method."""
    figure, ranked = ensemble.figures.get(ensemble.ranking), ensemble.ranked
    if figure is None or len(ranked) < 2:
        return []
    quantity = QUANTITIES[figure.name]

    def in_words(index: int) -> str:
        method, distribution = ensemble.methods[index], figure.distributions.get(index)
        failing = f"{percent(_failed(method))} failed" if _failed(method) else "none failed"
        return f"{lines[index].label} ({failing}" + (
            f", 99 % up to {quantity.with_unit(distribution.quantiles['q99'])})" if distribution else ")"
        )

    title = quantity.title.lower()
    text = (
        f"Ranked by failures and then by the {title}, {in_words(ranked[0])} is the best method, and {in_words(ranked[-1])} the "
        "last."
    )
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
    extreme = max(figure.distributions.values(), key=lambda one: one.largest)
    quantity, most = QUANTITIES[figure.name], extreme.quantiles["q99"]
    factor = extreme.largest / most if most else 0.0
    stands = f", {number(factor, 2)} times its 99 % quantile" if factor >= OUTLYING else ""
    text = f"The largest {quantity.title.lower()} is {quantity.with_unit(extreme.largest)}"
    where = f"with {lines[extreme.method].label} in member {extreme.worst}"
    return [Finding("Worst member", f"{text}, {where}{stands}. See ", WORST, ".")]


def _dependences(material: Material, lines: Sequence[Line]) -> list[Finding]:
    """Return a sentence for the failures and one for the ranking figure: the number that each method depends on most."""
    sentences = []
    for figure in (FAILURE, material.aggregates.ranking):
        strongest: dict[str, list[Dependence]] = defaultdict(list)
        for index in range(len(lines)):
            of_method = [one for one in material.analysis.dependences if (one.method, one.figure) == (index, figure)]
            if of_method and (first := max(of_method, key=lambda one: one.share)).share >= RELEVANT:
                strongest[first.number].append(first)
        what = "Whether a member fails" if figure == FAILURE else f"The {QUANTITIES[figure].title.lower()}" if figure else ""
        for name, on_number in strongest.items():
            shares = sorted(one.share for one in on_number)
            explains = " to ".join(dict.fromkeys((percent(shares[0]), percent(shares[-1]))))
            methods = listing([lines[one.method].label for one in on_number], MOST_NAMES, "method")
            logarithm = "" if figure == FAILURE else f" of the logarithm of the {QUANTITIES[figure].title.lower()}"
            alone = f"This number alone explains {explains} of the variance{logarithm}."
            sentences.append(Finding("Causes", f"{what} depends most on {name} with {methods}. {alone}"))
    return sentences


def _methods(ensemble: Aggregates, lines: Sequence[Line]) -> Part:
    tables = [("Methods, the best first", method_table(ensemble, lines))]
    if any(method.ways for method in ensemble.methods):
        tables.append(("Ways of failing", ways_table(ensemble, lines)))
    return Part(METHODS, "Methods", (), (), tuple(tables))


def _distributions(ensemble: Aggregates, lines: Sequence[Line]) -> Part:
    drawn = [ensemble.figures[name] for name in PLOTTED if name in ensemble.figures and ensemble.figures[name].edges.size]
    shown = tuple(chart for figure in drawn for chart in _charts(figure, lines))
    tables = tuple((QUANTITIES[name].label, figure_table(figure, lines)) for name, figure in ensemble.figures.items())
    there = [line for index, line in enumerate(lines) if any(index in figure.distributions for figure in drawn)]
    return Part(ERRORS, "Distribution of errors", (), shown, tables, tuple(there))


def _charts(figure: Figure, lines: Sequence[Line]) -> list[Chart]:
    quantity = QUANTITIES[figure.name]
    title = quantity.title.lower()
    ranges: list[str] = []
    for index, distribution in figure.distributions.items():
        low, high = (number(distribution.quantiles[name], 3) for name in ("q05", "q95"))
        are = "" if ranges else "nine tenths of the values are "
        ranges.append(f"with {lines[index].label}, {are}from {low} to {high} {quantity.unit}".rstrip())
    more = f" The chart has {count(len(ranges) - MOST_RANGES, 'more method')}." if len(ranges) > MOST_RANGES else ""
    nine_tenths = f"W{'; '.join(ranges[:MOST_RANGES])[1:]}.{more}"
    histograms = f"Histograms of the {title} of the members on a log scale. {nine_tenths}"
    tails = f"Share of the members whose {title} is larger than a value, on log scales. {nine_tenths}"
    zeros = [lines[index].label for index, distribution in figure.distributions.items() if distribution.zeros]
    notes = [f"Errors of zero, which are not drawn, occur with {listing(zeros, MOST_NAMES, 'method')}."] if zeros else []
    if figure.truth is not None:
        median, largest = (quantity.with_unit(value) for value in figure.truth)
        notes.append(f"The truth's own error is at most {largest}, in half of the members at most {median}.")
    return [
        Chart(quantity.title, charts.histogram(figure, lines), histograms, tuple(notes)),
        Chart(f"{quantity.title}: tail", charts.tail(figure, lines), tails),
    ]


def _causes(material: Material, lines: Sequence[Line]) -> Part:
    texts = []
    if material.aggregates.members > MOST_MEMBERS:
        texts.append(f"The table is computed from the first {MOST_MEMBERS} members; the maps show all of them.")
    maps = tuple(_map(drawn, index, lines) for drawn in material.analysis.maps for index in drawn.values)
    shown = dependence_table(material.analysis.dependences, lines)
    return Part(CAUSES, "What errors depend on", tuple(texts), maps, (("Strongest dependences", shown),) if shown.rows else ())


def _map(drawn: Map, index: int, lines: Sequence[Line]) -> Chart:
    what = "Failures" if drawn.figure == FAILURE else f"{QUANTITIES[drawn.figure].title}"
    alt = f"Map of the {what.lower()} of {lines[index].label} over {drawn.x} and {drawn.y}."
    return Chart(f"{what}: {lines[index].label}", charts.failure_map(drawn, index), alt)


def _worst(material: Material, lines: Sequence[Line]) -> Part:
    files = [file for file in material.files if file.name]
    text = (
        f"{count(len(files), 'case file')} in the folder worst {verb(len(files), 'has', 'have')} a member that was made "
        "simpler while it fails in the same way. The command bodycheck run FILE runs it by itself."
    )
    table = worst_table(material.aggregates, lines)
    tables = [("Worst member of each method", table)] if table.rows else []
    tables += [("Case files of worst members", file_table(material.files))] if material.files else []
    return Part(WORST, "Worst members", (text,) if files else (), (), tuple(tables), (), material.animations)
