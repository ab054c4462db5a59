"""The report of a parity study: the verdict, a matrix of robots and quantities, and a part for each robot.

The results are also written as JUnit XML.
"""

import re
from collections.abc import Iterable, Iterator, Sequence
from xml.etree.ElementTree import Element

from bodycheck.reports.finding import Finding
from bodycheck.reports.notices import of_header
from bodycheck.reports.quantities import count, number
from bodycheck.reports.runs.junit import clean, document, element
from bodycheck.reports.study import Part, StudyReport
from bodycheck.reports.tables import Entry, Table
from bodycheck.results.header import Header
from bodycheck.results.verdicts import AGREES, MISSING, ROBOTS
from bodycheck.studies.parity.quantities import FAILED, FILE, MEANINGS, MODEL, QUANTITIES, TERMS, Status
from bodycheck.studies.parity.rows import ParityRow, failed
from bodycheck.studies.parity.study import Parity
from bodycheck.studies.parity.wording import (
    brief,
    differs,
    engines_of,
    headline,
    name_of,
    of_engine,
    of_engine_counted,
    of_file,
    unreadable,
)

#: The name of the part with all robots beside each other.
MATRIX = "matrix"

#: The statuses in order of precedence, of which a cell shows the first that any of its rows has; the statuses that are shown by
#: their marks; and the text for each status.
WORST: tuple[Status, ...] = (*FAILED, "accepted-unphysical", "agrees", "not-modelled")
MARKED: tuple[Status, ...] = ("agrees", "not-modelled")
SIGNS: dict[Status, str] = {status: ROBOTS[status].mark if status in MARKED else ROBOTS[status].title for status in WORST}

#: Explanations for readers.
READING = (
    "Each engine reads the file by its own reader, as its users do. The truth is the file, read as its specification says, "
    "with bodycheck's own algorithms for the mass matrix and the forces in 80-bit arithmetic; of an MJCF it is the model that "
    "MuJoCo makes of it. The terms are compared at seeded states.",
    "The mass matrix is compared entry by entry relative to the roots of its diagonal. Forces are divided by the same roots, "
    "which makes joints of all kinds comparable, and are relative to the largest of their kind. Accelerations are compared as "
    "the forces that their difference takes. Lengths are relative to the reach of the robot.",
    "A cause is named only if the file, with that fault put into it, has the engine's numbers. What is not explained in this "
    "way is called unexplained. Values with the source behaviour are what the engine computes, or how its joints move: limits, "
    "mimics, damping and friction are tried by the engine's own steps. Values with the source told are in the engine's records "
    "and were not tried. The conventions in which an engine writes velocities and Jacobians are found by trying and are "
    "no difference. A base that an engine welds to the world and whose mass it forgets is no difference either.",
)


def present(header: Header, models: Sequence[Parity]) -> StudyReport:
    """Return the contents of the report.

    Parameters
    ----------
    header
        Versions, machine and command.
    models
        The results of each model, in the order of the study.
    """
    return StudyReport(
        title="How engines read robot files",
        headline=headline(models),
        header=header,
        notices=tuple(of_header(header)),
        findings=tuple(_findings(models)),
        parts=(_matrix(models), *(_robot(anchor, one) for anchor, one in zip(_anchors(models), models, strict=True))),
        reading=READING,
    )


def _anchors(models: Sequence[Parity]) -> list[str]:
    """Return a distinct name of an anchor for each model, made from the name of the model."""
    names = [re.sub(r"[^A-Za-z0-9]+", "-", one.name).strip("-") for one in models]
    return [name if names.count(name) == 1 else f"{name}-{index + 1}" for index, name in enumerate(names)]


def _findings(models: Sequence[Parity]) -> Iterable[Finding]:
    for anchor, one in zip(_anchors(models), models, strict=True):
        if differs(one):
            sentences = [f"{engine} {brief(rows)}" for engine, rows in engines_of(one).items() if any(map(failed, rows))]
            faults = of_file(one)
            first = "; the first is" if len(faults) > 1 else ":"
            sentences += [f"The file has {count(len(faults), 'fault')}{first} {faults[0]}"] if faults else []
            yield Finding(anchor, f"{'. '.join(sentences)}.")


def _matrix(models: Sequence[Parity]) -> Part:
    """Return the part with a row for each robot and engine and a column for each quantity."""
    rows, marks = [], []
    for anchor, one in zip(_anchors(models), models, strict=True):
        for engine, side_rows in (*_file_rows(one), *engines_of(one).items()):
            cells = [_cell([row for row in side_rows if row.quantity == quantity]) for quantity in QUANTITIES]
            verdict = of_engine(side_rows)[0] if engine != FILE else ROBOTS[_worst(side_rows)].title
            rows.append((Entry(one.name, link=f"part-{anchor}"), Entry(engine), Entry(verdict), *cells))
            marks.append(any(map(failed, side_rows)))
    table = Table(
        columns=("Robot", "Engine", "Reason", *(name_of(quantity) for quantity in QUANTITIES)),
        numeric=(False,) * (3 + len(QUANTITIES)),
        rows=tuple(rows),
        failed=tuple(marks),
        notes=(f"{AGREES} agrees, {MISSING} is not modelled or not told. A cell that differs has the cause.",),
    )
    return Part(MATRIX, "All robots", (), (), (("Robots and quantities", table),))


def _file_rows(one: Parity) -> list[tuple[str, list[ParityRow]]]:
    rows = [row for row in one.rows if row.engine == FILE]
    return [(FILE, rows)] if rows else []


def _worst(rows: Sequence[ParityRow]) -> Status:
    return next(status for status in WORST if any(row.status == status for row in rows))


def _cell(rows: Sequence[ParityRow]) -> Entry:
    if not rows:
        return Entry("")
    status = _worst(rows)
    worst = [row for row in rows if row.status == status]
    causes = list(dict.fromkeys(row.cause for row in worst if row.cause))
    text = ", ".join(causes) if status == "differs" and causes else SIGNS[status]
    largest = max((row.relative for row in worst if row.relative is not None), default=None)
    return Entry(text, largest, meaning="" if largest is None else f"largest relative difference {number(largest, 2)}")


def _robot(anchor: str, one: Parity) -> Part:
    """Return the part of a robot: the results of each engine in sentences, and tables with the values of both sides."""
    texts = [] if unreadable(one) else [f"Read from {one.path}."]
    texts += [f"The file: {fault}." for fault in of_file(one)]
    if one.removed:
        texts.append(f"What engines read is a copy without what names other files: {', '.join(one.removed)}.")
    tables = []
    for engine, rows in engines_of(one).items():
        texts.append(f"{engine} {rows[0].version}: {'; '.join(of_engine_counted(rows))}.")
        texts += [f"{engine}: {note}." for note in one.notes.get(engine, ())]
        different = [row for row in rows if failed(row) or row.status == "accepted-unphysical"]
        if different:
            tables.append((f"{engine}: what is not as in the file", _rows(different)))
    terms = [row for rows in engines_of(one).values() for row in rows if row.quantity in TERMS and row.subject == MODEL]
    if terms:
        tables.append(("Terms at the states", _terms(terms)))
    return Part(anchor, one.name, tuple(texts), (), tuple(tables))


def _rows(rows: Sequence[ParityRow]) -> Table:
    return Table(
        columns=("Quantity", "Subject", "Engine has", "File has", "Relative", "Cause", "Source"),
        numeric=(False, False, False, False, True, False, False),
        rows=tuple(
            (
                Entry(name_of(row.quantity), meaning="" if row.quantity is None else MEANINGS[row.quantity]),
                *(Entry(row.subject), Entry(row.engine_value), Entry(row.truth_value)),
                *(Entry(number(row.relative, 3), row.relative), Entry(row.cause or row.status), Entry(row.source)),
            )
            for row in rows
        ),
        failed=tuple(map(failed, rows)),
        notes=(),
    )


def _terms(rows: Sequence[ParityRow]) -> Table:
    engines = list(dict.fromkeys(row.engine for row in rows))
    by_place = {(row.quantity, row.engine): row for row in rows}
    cells = []
    for quantity in TERMS:
        by_engine = [by_place.get((quantity, engine)) for engine in engines]
        cells.append((Entry(name_of(quantity), meaning=MEANINGS[quantity]), *map(_relative, by_engine)))
    return Table(
        columns=("Quantity", *engines),
        numeric=(False, *(True for _ in engines)),
        rows=tuple(cells),
        failed=(False,) * len(cells),
        notes=("The largest difference at all states, relative to the size of the quantity.",),
        keys=1,
    )


def _relative(row: ParityRow | None) -> Entry:
    if row is None or row.relative is None:
        return Entry("–")
    return Entry(number(row.relative, 2), row.relative, meaning=row.cause)


def as_junit(models: Sequence[Parity], header: Header) -> str:
    """Return the results as JUnit XML: a test for each model and engine, and one for each file with faults.

    A model that an engine does not read is a skipped test.
    """
    tests = [test for one in models for test in _junit_tests(one)]
    counts = {
        "tests": len(tests),
        "failures": sum(test.find("failure") is not None for test in tests),
        "errors": 0,
        "skipped": sum(test.find("skipped") is not None for test in tests),
    }
    root = element("testsuites", name="bodycheck", **counts)
    suite = element("testsuite", name="bodycheck parity", timestamp=header["started"], **counts)
    suite.extend(tests)
    root.append(suite)
    return document(root)


def _junit_tests(one: Parity) -> Iterator[Element]:
    if faults := of_file(one):
        yield _junit_test(one, FILE, [row for row in one.rows if row.engine == FILE], faults)
    for engine, rows in engines_of(one).items():
        yield _junit_test(one, engine, rows, of_engine(rows))


def _junit_test(one: Parity, engine: str, rows: Sequence[ParityRow], sentences: Sequence[str]) -> Element:
    test = element("testcase", classname=one.name, name=engine, time="0.000000")
    text = "\n".join(sentences)
    if any(map(failed, rows)):
        failure = element("failure", type="parity", message="; ".join(sentences))
        failure.text = clean("\n".join([text, *(_junit_line(row) for row in rows if failed(row))]))
        test.append(failure)
    elif all(row.status == "not-modelled" for row in rows):
        test.append(element("skipped", message=text))
    return test


def _junit_line(row: ParityRow) -> str:
    return f"{row.quantity or ''} {row.subject}: {row.engine_value} instead of {row.truth_value} {row.cause}"
