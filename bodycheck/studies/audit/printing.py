"""Print what the audit found to the terminal."""

from collections.abc import Mapping, Sequence

from bodycheck.console.options import View
from bodycheck.console.output import bold, say, tell
from bodycheck.console.tables import Column, attribute, show
from bodycheck.reports.quantities import bound, count, listing
from bodycheck.reports.same_algorithm import WORDS
from bodycheck.studies.audit.class_rows import Classes
from bodycheck.studies.audit.rows import Facts, Row, is_finding
from bodycheck.studies.audit.wording import HEADINGS, method_classes, sentences, value

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
    """Print what each engine was found to do, in sentences, and what it says of itself."""
    for place, engine in enumerate(facts):
        own = [row for row in rows if row.engine == engine]
        if not own:
            continue
        if place:
            say("")
        bold(f"{engine} {own[0].version}")
        if facts[engine].text:
            tell(f"  read, not probed: {facts[engine].text}", "    ")
        for sentence in (found := sentences(own)):
            tell(f"  {HEADINGS[sentence.status]}: it {sentence.text}", "    ")
        if not found:
            tell("  Nothing was found that mechanics does not have.", "    ")
        if unknown := list(dict.fromkeys(row.property for row in own if row.status == "not-probed")):
            tell(f"  Not probed, of some method or all: {listing(unknown)}.", "    ")


def print_rows(rows: Sequence[Row], view: View) -> None:
    """Print one line for each property of each method."""
    show(ROWS, rows, view)


def print_classes(found: Classes) -> None:
    """Print the classes of several methods that are the same algorithm."""
    several = [one for one in method_classes(found) if len(one.methods) > 1]
    if several:
        say("")
        bold("the same algorithm")
    for one in several:
        tell(f"  {WORDS[one.kind]}, {one.name}: {listing(one.methods)} (to {bound(one.distance, 1)})", "    ")
    if several:
        say("")


def summary(rows: Sequence[Row]) -> str:
    """Return in one sentence how much was found."""
    methods = len({(row.engine, row.integrator) for row in rows})
    found = count(sum(is_finding(row) for row in rows), "finding")
    return f"{found} of {count(methods, 'method')} of {count(len({row.engine for row in rows}), 'engine')}"
