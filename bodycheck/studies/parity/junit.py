"""The results as JUnit XML: a test for each model and engine, and one for each file with faults."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from xml.etree.ElementTree import Element

from bodycheck.files import writing
from bodycheck.reports.runs.junit import clean, document, element
from bodycheck.results.header import Header
from bodycheck.studies.parity.quantities import FILE
from bodycheck.studies.parity.rows import ParityRow, failed
from bodycheck.studies.parity.study import Parity
from bodycheck.studies.parity.wording import engines_of, of_engine, of_file


def write(found: Sequence[Parity], header: Header, path: Path) -> None:
    """Write the document. Raises `NotWritten` if the file cannot be written."""
    writing.write_named(path, render(found, header).encode("utf-8", "replace"))


def render(found: Sequence[Parity], header: Header) -> str:
    """Return the XML document. A model that an engine does not read is a skipped test."""
    tests = [test for one in found for test in _tests(one)]
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


def _tests(one: Parity) -> Iterator[Element]:
    if faults := of_file(one):
        yield _test(one, FILE, [row for row in one.rows if row.engine == FILE], faults)
    for engine, rows in engines_of(one).items():
        yield _test(one, engine, rows, of_engine(rows))


def _test(one: Parity, engine: str, rows: Sequence[ParityRow], told: Sequence[str]) -> Element:
    test = element("testcase", classname=one.name, name=engine, time="0.000000")
    text = "\n".join(told)
    if any(map(failed, rows)):
        failure = element("failure", type="parity", message="; ".join(told))
        failure.text = clean("\n".join([text, *(_line(row) for row in rows if failed(row))]))
        test.append(failure)
    elif all(row.status == "not-modelled" for row in rows):
        test.append(element("skipped", message=text))
    return test


def _line(row: ParityRow) -> str:
    return f"{row.quantity or ''} {row.subject}: {row.engine_value} instead of {row.truth_value} {row.cause}"
