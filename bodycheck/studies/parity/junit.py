"""What was found as JUnit XML: a test for each model and engine, and one for each file with faults."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

from bodycheck.files import writing
from bodycheck.reports.runs.junit import clean
from bodycheck.running.header import Header
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
    root = _element("testsuites", name="bodycheck", **counts)
    suite = _element("testsuite", name="bodycheck parity", timestamp=header["started"], **counts)
    suite.extend(tests)
    root.append(suite)
    ElementTree.indent(root)
    return '<?xml version="1.0" encoding="utf-8"?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n"


def _tests(one: Parity) -> Iterator[Element]:
    if faults := of_file(one):
        yield _test(one, FILE, [row for row in one.rows if row.engine == FILE], faults)
    for engine, rows in engines_of(one).items():
        yield _test(one, engine, rows, of_engine(rows))


def _test(one: Parity, engine: str, rows: Sequence[ParityRow], told: Sequence[str]) -> Element:
    test = _element("testcase", classname=one.name, name=engine, time="0.000000")
    text = "\n".join(told)
    if any(map(failed, rows)):
        failure = _element("failure", type="parity", message="; ".join(told))
        failure.text = clean("\n".join([text, *(_line(row) for row in rows if failed(row))]))
        test.append(failure)
    elif all(row.status == "not-modelled" for row in rows):
        test.append(_element("skipped", message=text))
    return test


def _line(row: ParityRow) -> str:
    return f"{row.quantity or ''} {row.subject}: {row.engine_value} instead of {row.truth_value} {row.cause}"


def _element(tag: str, **attributes: Any) -> Element:
    return Element(tag, {name: clean(str(value)) for name, value in attributes.items()})
