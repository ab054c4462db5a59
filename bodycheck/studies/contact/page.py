"""The report of contact: for each scene, the exact values, the figures of engines at their defaults, and the best figures."""

from collections.abc import Mapping, Sequence

from bodycheck.casefile.content import Case
from bodycheck.reports.finding import Finding
from bodycheck.reports.notices import of_header
from bodycheck.reports.quantities import QUANTITIES, count, number
from bodycheck.reports.study import Part, StudyReport
from bodycheck.reports.tables import Entry, Table
from bodycheck.results.header import Header
from bodycheck.studies.contact.rows import ContactRow, Line, lines

#: Explanations for readers.
READING = (
    "“At defaults” is the default method of the engine, which a user of its quick start gets: its integrator, time step and "
    "contact settings. A library without a stepper has none. “Best” is the smallest value among all methods that the adapter "
    "offers, at the time step of the default method and at a quarter of it, each figure for itself: the method that is best in "
    "one figure need not be good in another.",
    "“In mechanics” is the exact value of what the figure measures the error of, such as the instant of an impact; it is 0 for "
    "what should not be at all, such as creep. A dash means that the figure does not exist in the scene.",
)


def present(
    header: Header, cases: Mapping[str, Case], rows: Sequence[ContactRow], reasons: Mapping[tuple[str, str], str]
) -> StudyReport:
    """Return the contents of the report.

    Parameters
    ----------
    header
        The header of the results, with versions, machine and command.
    cases
        The cases, by name.
    rows
        The rows of the study.
    reasons
        The reasons why default methods did not complete a case, by the names of engine and case.
    """
    sheet = lines(rows)
    scenes = {name: [line for line in sheet if line.scene == name] for name in cases}
    return StudyReport(
        title="Contact: rolling, bouncing, resting, tipping",
        headline=f"{count(len(cases), 'scene')} in {count(len({row.engine for row in rows}), 'engine')}",
        header=header,
        notices=tuple(of_header(header)),
        findings=tuple(findings(sheet, reasons)),
        parts=tuple(_part(cases[name], scene_lines, reasons) for name, scene_lines in scenes.items()),
        reading=READING,
    )


def findings(sheet: Sequence[Line], reasons: Mapping[tuple[str, str], str]) -> list[Finding]:
    """Return findings about each engine's largest creep and energy gain at its defaults, and scenes it did not complete."""
    sentences = []
    for engine in dict.fromkeys(line.engine for line in sheet):
        for figure, subject, does in (
            ("creep", "a body that should rest", "creeps at"),
            ("energy_gain", "the energy", "grows by"),
        ):
            having = [line for line in sheet if line.engine == engine and line.figure == figure and line.default]
            if having:
                worst = max(having, key=lambda line: line.default or 0.0)
                unit = " of the largest energy" if figure == "energy_gain" else f" {worst.unit}"
                default, best = (f"{does} {number(value, 3)}{unit}" for value in (worst.default, worst.best))
                before = f"With {engine} at its defaults, {subject} {default} in "
                after = f". At the best settings, it {best}."
                sentences.append(Finding(QUANTITIES[figure].title, before, worst.scene, after))
        lacking = [case for one, case in reasons if one == engine]
        if lacking:
            several = f"{len(lacking)} scenes; one of them is " if len(lacking) > 1 else ""
            what = f"{engine} does not complete {several}"
            sentences.append(Finding("Not completed", what, lacking[0], f": {reasons[engine, lacking[0]]}."))
    return sentences


def _part(case: Case, scene_lines: Sequence[Line], reasons: Mapping[tuple[str, str], str]) -> Part:
    """Return the part of one scene: a table with a row for each engine and figure."""
    ran = [line for line in scene_lines if line.figure]
    why = tuple(f"{engine}: {reason}." for (engine, name), reason in reasons.items() if name == case.name)
    return Part(
        name=case.name,
        title=case.name,
        texts=(f"{case.title}.", *([case.source] if case.source else []), *why),
        charts=(),
        tables=(("Figures", _table(ran)),) if ran else (),
    )


def _table(shown: Sequence[Line]) -> Table:
    columns = ("Engine", "Figure", "In mechanics", "At defaults", "Best", "Best method")
    return Table(
        columns=columns,
        numeric=(False, False, True, True, True, False),
        rows=tuple(
            (
                Entry(line.engine),
                Entry(QUANTITIES[line.figure].label),
                *(Entry(number(value, 3), value) for value in (line.truth, line.default, line.best)),
                Entry(line.method),
            )
            for line in shown
        ),
        failed=(False,) * len(shown),
        notes=(),
    )
