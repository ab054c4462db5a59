"""The report of the audit: a table of the properties of all engines, the classes of methods, and a part for each engine."""

from collections import defaultdict
from collections.abc import Mapping, Sequence

from bodycheck.reports.finding import Finding
from bodycheck.reports.notices import of_header
from bodycheck.reports.quantities import bound, count, listing, milliseconds, number, verb
from bodycheck.reports.same_algorithm import WORDS
from bodycheck.reports.study import Part, StudyReport
from bodycheck.reports.tables import Entry, Table
from bodycheck.results.header import Header
from bodycheck.results.verdicts import AUDIT
from bodycheck.studies.audit.probe import Property
from bodycheck.studies.audit.rows import PROPERTIES, Classes, Facts, Fault, Row, Status, is_finding
from bodycheck.studies.audit.wording import DOES, HEADINGS, method_classes, ranges, sentences, value, without_findings

#: The name of the part with all engines side by side.
OVERVIEW = "properties"

#: The name of the part with the methods that are the same algorithm.
CLASSES = "classes"

#: The signs in the cells of rows that are not findings.
SIGNS: dict[str, str] = {status: word.mark for status, word in AUDIT.items() if word.mark}

#: The statuses in the order of their importance. An engine has the first of them that any of its methods has.
WORST: tuple[Status, ...] = ("deviates", "default", "not-probed", "none")

#: Explanations for readers.
READING = (
    "Each probe is a short flight, or a few of them, of a free rigid body whose motion is known without computing it. What is "
    "found is therefore what the engine did, whatever its documentation says. The value is its size, and the expected value is "
    "that of an engine that computes mechanics alone.",
    "The status “default” means that users get it without asking for it: it is found with the engine's own settings, or the "
    "engine has no switch for it and says so. The status “deviates” means that a method has it although everything that can be "
    "switched off is off; that may be the definition of an integrator, such as the energy that an explicit step adds, and need "
    f"not be a fault. In tables, {AUDIT['none'].mark} means that {AUDIT['none'].meaning}, and {AUDIT['not-probed'].mark} that "
    f"{AUDIT['not-probed'].meaning}.",
    "The error of the flip is the largest error of the attitude in the shipped case intermediate-axis-flip within 10 s at the "
    "same time step. It shows what a method with these properties does, together with the error of its integrator. What an "
    "engine says of itself is marked as read.",
)


def present(
    header: Header, facts: Mapping[str, Facts], rows: Sequence[Row], faults: Sequence[Fault], classes: Classes
) -> StudyReport:
    """Return the contents of the report.

    Parameters
    ----------
    header
        The header of the results, with versions, machine and command.
    facts
        The statements of the engines about themselves, by the name of the engine.
    rows
        The rows, in the order of the study.
    faults
        The probes that gave no answer.
    classes
        The classes of equal methods.
    """
    engines: dict[str, list[Row]] = defaultdict(list)
    for row in rows:
        engines[row.engine].append(row)
    methods = len({(row.engine, row.integrator) for row in rows})
    number = sum(is_finding(row) for row in rows)
    timesteps = [milliseconds(step) for step in dict.fromkeys(row.timestep for row in rows)]
    steps = f"{verb(len(timesteps), 'a time step', 'time steps')} of {listing(timesteps)}"
    return StudyReport(
        title="What engines really do",
        headline=f"{count(number, 'finding')} in {count(methods, 'method')} of {count(len(engines), 'engine')} at {steps}",
        header=header,
        notices=(*of_header(header), *(f"{fault.text}." for fault in faults)),
        findings=tuple(_by_property(rows)),
        parts=(
            *((_overview(engines),) if len(engines) > 1 else ()),
            *((_classes(classes),) if classes.rows else ()),
            *(_engine(name, facts[name], engine_rows) for name, engine_rows in engines.items()),
        ),
        reading=READING,
    )


def _by_property(rows: Sequence[Row]) -> list[Finding]:
    """Return findings for each property that was found: the engines that have it by default, and those with some methods."""
    sentences = []
    for name in PROPERTIES:
        texts = []
        for status, heading in (("default", "By default"), ("deviates", "With some methods")):
            engines: dict[str, list[Row]] = defaultdict(list)
            for row in rows:
                if row.property == name and row.status == status:
                    engines[row.engine].append(row)
            sizes = {engine: f" ({size})" if (size := ranges(same)) else "" for engine, same in engines.items()}
            if len(sizes) == 1:
                ((engine, size),) = sizes.items()
                texts.append(f"{heading}, {engine} {DOES[name]}{size}.")
            elif sizes:
                named = listing([f"{engine}{size}" for engine, size in sizes.items()])
                texts.append(f"{heading}, each of {named} {DOES[name]}.")
        if texts:
            sentences.append(Finding(name, " ".join(texts)))
    return sentences


def _overview(engines: Mapping[str, Sequence[Row]]) -> Part:
    """Return the part with one row for each property and one column for each engine."""

    def cell(engine: str, name: Property) -> Entry:
        statuses = {row.status for row in engines[engine] if row.property == name}
        status = next((one for one in WORST if one in statuses), "not-probed")
        values = list(dict.fromkeys(value(row) for row in engines[engine] if row.property == name and is_finding(row)))
        return Entry(SIGNS.get(status, status), meaning=listing(list(filter(None, values))))

    table = Table(
        columns=("Property", *engines),
        numeric=(False,) * (1 + len(engines)),
        rows=tuple((Entry(name, meaning=DOES[name]), *(cell(engine, name) for engine in engines)) for name in PROPERTIES),
        failed=(False,) * len(PROPERTIES),
        notes=("A cell has the status that matters most among the methods of the engine.",),
        keys=1,
    )
    return Part(OVERVIEW, "All engines", (), (), (("Properties by engine", table),))


def _classes(classes: Classes) -> Part:
    """Return the part with the methods that are the same algorithm."""
    same_methods = method_classes(classes)
    table = Table(
        columns=("Scenes", "Algorithm", "Methods", "Difference"),
        numeric=(False, False, False, True),
        rows=tuple(
            (
                *(Entry(WORDS[one.kind]), Entry(one.name), Entry(listing(one.methods))),
                Entry(bound(one.distance, 2) if len(one.methods) > 1 else "–", one.distance),
            )
            for one in same_methods
        ),
        failed=(False,) * len(same_methods),
        notes=(
            "The difference is the largest of two motions in the class. An algorithm is named if the motions are those of a "
            "textbook scheme.",
        ),
    )
    left: dict[tuple[str, str], list[str]] = defaultdict(list)
    for one in classes.unclassed:
        left[WORDS[one.kind], one.reason].append(f"{one.engine} {one.integrator}")
    text = "Methods in one row are the same algorithm: their motions agree to the precision of their arithmetic."
    without = [
        f"{listing(methods)} {verb(len(methods), 'is', 'are')} in no class {scenes}: {reason}."
        for (scenes, reason), methods in left.items()
    ]
    return Part(CLASSES, "Equal methods", (text, *without), (), (("Classes of methods", table),))


def _engine(name: str, facts: Facts, rows: Sequence[Row]) -> Part:
    said = f"Read from the engine, not probed: {facts.text}." if facts.text else ""
    stated = f"{name} {rows[0].version} says that it computes in {facts.precision}. {said}".rstrip()
    texts = tuple(f"{HEADINGS[one.status]}: it {one.text}" for one in sentences(rows))
    return Part(
        name=name,
        title=f"{name} {rows[0].version}",
        texts=(stated, *(texts or (without_findings(rows),))),
        charts=(),
        tables=(
            *((("Findings", _findings(rows)),) if texts else ()),
            ("All properties by method", _properties(rows)),
        ),
    )


def _findings(rows: Sequence[Row]) -> Table:
    shown = [row for row in rows if is_finding(row)]
    return Table(
        columns=("Method", "Property", "Value", "Unit", "Expected", "Status", "Error of the flip, rad", "Reason"),
        numeric=(False, False, True, False, False, False, True, False),
        rows=tuple(
            (
                *(Entry(row.integrator), Entry(row.property, meaning=DOES[row.property])),
                *(Entry(number(row.value, 4), row.value), Entry(row.unit), Entry(row.expected), Entry(row.status)),
                *(Entry(number(row.attitude_error, 3), row.attitude_error), Entry(row.probe)),
            )
            for row in shown
        ),
        failed=(False,) * len(shown),
        notes=("The reason is the probe and what it saw.",),
    )


def _properties(rows: Sequence[Row]) -> Table:
    """Return the table of properties by method. Methods with the same cells for all properties share a column."""
    methods: dict[str, dict[Property, list[Row]]] = defaultdict(lambda: defaultdict(list))
    for row in rows:
        methods[row.integrator][row.property].append(row)
    columns: dict[tuple[Entry, ...], list[str]] = defaultdict(list)
    for method, by_property in methods.items():
        columns[tuple(_cell(by_property[name]) for name in PROPERTIES)].append(method)
    return Table(
        columns=("Property", *(listing(names) for names in columns.values())),
        numeric=(False,) * (1 + len(columns)),
        rows=tuple(
            (Entry(name, meaning=DOES[name]), *(cells[index] for cells in columns)) for index, name in enumerate(PROPERTIES)
        ),
        failed=(False,) * len(PROPERTIES),
        notes=(),
        keys=1,
    )


def _cell(rows: Sequence[Row]) -> Entry:
    """Return the cell of a property of a method, from all rows of this property and method."""
    deviating = [row for row in rows if is_finding(row)]
    if deviating:
        return Entry(listing(list(dict.fromkeys(value(row) or "found" for row in deviating))), meaning=deviating[0].probe)
    status = next((one for one in WORST if one in {row.status for row in rows}), "not-probed")
    return Entry(SIGNS[status], meaning=next((row.probe for row in rows if row.status == status), ""))
