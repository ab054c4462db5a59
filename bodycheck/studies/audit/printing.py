"""Print the findings of the audit to the terminal."""

from collections.abc import Mapping, Sequence

from bodycheck.console.options import View
from bodycheck.console.output import bold, say, tell
from bodycheck.console.tables import Column, attribute, show
from bodycheck.reports.quantities import bound, count, listing
from bodycheck.reports.same_algorithm import WORDS
from bodycheck.studies.audit.rows import Classes, Facts, Row, is_finding
from bodycheck.studies.audit.wording import HEADINGS, method_classes, sentences, value, without_findings

#: The columns of the table of rows.
ROWS: tuple[Column[Row], ...] = (
    attribute("engine", goes=3),
    attribute("version", goes=7),
    attribute("integrator", wraps=True),
    attribute("timestep", "step", "g", goes=6),
    attribute("property"),
    Column("value", "value", value, lambda row: row.value),
    attribute("unit", asked=True),
    attribute("expected", goes=4),
    attribute("status"),
    attribute("attitude_error", "flip rad", goes=2),
    attribute("probe", goes=5, wraps=True),
)


def print_findings(rows: Sequence[Row], facts: Mapping[str, Facts]) -> None:
    """Print the statements of each engine about itself, and sentences about its findings."""
    for index, engine in enumerate(facts):
        engine_rows = [row for row in rows if row.engine == engine]
        if not engine_rows:
            continue
        if index:
            say("")
        bold(f"{engine} {engine_rows[0].version}")
        if facts[engine].text:
            tell(f"  read, not probed: {facts[engine].text}", "    ")
        for sentence in (engine_sentences := sentences(engine_rows)):
            tell(f"  {HEADINGS[sentence.status]}: it {sentence.text}", "    ")
        if not engine_sentences:
            tell(f"  {without_findings(engine_rows)}", "    ")
        if unknown := list(dict.fromkeys(row.property for row in engine_rows if row.status == "not-probed")):
            tell(f"  Not probed, of some method or all: {listing(unknown)}.", "    ")


def print_rows(rows: Sequence[Row], view: View) -> None:
    """Print one line for each property of each method."""
    show(ROWS, rows, view)


def print_classes(classes: Classes) -> None:
    """Print the classes that have more than one method."""
    several = [one for one in method_classes(classes) if len(one.methods) > 1]
    if several:
        say("")
        bold("the same algorithm")
    for one in several:
        tell(f"  {WORDS[one.kind]}, {one.name}: {listing(one.methods)} (to {bound(one.distance, 1)})", "    ")
    if several:
        say("")


def summary(rows: Sequence[Row]) -> str:
    """Return a phrase with the numbers of findings, methods and engines."""
    methods = len({(row.engine, row.integrator) for row in rows})
    findings = count(sum(is_finding(row) for row in rows), "finding")
    return f"{findings} in {count(methods, 'method')} of {count(len({row.engine for row in rows}), 'engine')}"
