"""Verdicts as JUnit XML, the format in which CI systems read test results."""

import re
from collections.abc import Mapping, Sequence
from typing import Any
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

from bodycheck.judging import advice
from bodycheck.judging.judgement import Verdict
from bodycheck.results.header import Header
from bodycheck.results.unchecked import Unchecked

#: Matches characters that an XML 1.0 document must not contain, and control characters that it should not contain.
NOT_XML = re.compile("[^\t\n\r\x20-\x7e\x85\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")

#: The files of cases if all cases are shipped.
NO_FILES: Mapping[str, str] = {}

#: The columns that are not properties of a test, because they appear elsewhere in it.
NOT_PROPERTIES = {"case", "passed", "reason"}


def render(
    verdicts: Sequence[Verdict], header: Header, unchecked: Sequence[Unchecked] = (), files: Mapping[str, str] = NO_FILES
) -> str:
    """Return the XML document, with a test for each run that has expectations or failed, and for each unchecked expectation.

    A tolerated known discrepancy is a passed test with its message in the output. An expectation that no run could check is a
    failed test, or a skipped test if that is tolerated. A case without any check is a skipped test that says so. files: the
    paths of the cases that are not shipped, by name.
    """
    asked = [verdict for verdict in verdicts if verdict.passed is not None]
    rows = [verdict.row() for verdict in asked]
    told = {*(verdict.run.case for verdict in asked), *(one.case for one in unchecked)}
    untested = [name for name in dict.fromkeys(verdict.run.case for verdict in verdicts) if name not in told]
    lost = sum(one.failed for one in unchecked)
    counts = {
        "tests": len(asked) + len(unchecked) + len(untested),
        "failures": sum(not verdict.passed for verdict in asked) + lost,
        "errors": 0,
        "skipped": len(unchecked) - lost + len(untested),
        "time": _seconds(rows),
    }
    root = element("testsuites", name="bodycheck", **counts)
    suite = _sub(root, "testsuite", name="bodycheck", timestamp=header["started"], **counts)
    versions = {"bodycheck": header["bodycheck"], **header["engines"]}
    _properties(suite, {f"version of {name}": version for name, version in versions.items()})
    for verdict, row in zip(asked, rows, strict=True):
        method = f"{row['engine']} {row['integrator']} {row['timestep']!r} s" + (f" ({verdict.label})" if verdict.label else "")
        test = _sub(suite, "testcase", classname=row["case"], name=method, time=_seconds([row]))
        _properties(test, {name: value for name, value in row.items() if name not in NOT_PROPERTIES})
        if not verdict.passed:
            text = "\n".join((verdict.reason, *advice.lines(verdict, files.get(row["case"], row["case"]))))
            _sub(test, "failure", type=row["status"], message=verdict.reason).text = clean(text)
        elif verdict.reason:
            _sub(test, "system-out").text = clean(verdict.reason)
    for one in unchecked:
        test = _sub(suite, "testcase", classname=one.case, name=f"{one.engine} {one.integrator} {one.timestep!r} s")
        if one.failed:
            _sub(test, "failure", type="missing", message=one.text).text = clean(one.text)
        else:
            _sub(test, "skipped", message=one.text)
    for name in untested:
        test = _sub(suite, "testcase", classname=name, name="expectations")
        _sub(test, "skipped", message="none of its runs has expectations: nothing was checked")
    return document(root)


def document(root: Element) -> str:
    """Return the text of an XML document with this root, which is indented in place."""
    ElementTree.indent(root)
    return '<?xml version="1.0" encoding="utf-8"?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n"


def _properties(parent: Element, values: Mapping[str, Any]) -> None:
    properties = _sub(parent, "properties")
    for name, value in values.items():
        _sub(properties, "property", name=name, value=value)


def _seconds(rows: Sequence[Mapping[str, Any]]) -> str:
    """Return the total time of stepping (s) as text."""
    return f"{sum(row.get('wall_time', 0.0) for row in rows):.6f}"


def element(tag: str, **attributes: Any) -> Element:
    """Return an element with attributes. Their values are converted to text that XML allows."""
    return Element(tag, {name: clean(str(value)) for name, value in attributes.items()})


def _sub(parent: Element, tag: str, **attributes: Any) -> Element:
    made = element(tag, **attributes)
    parent.append(made)
    return made


def clean(text: str) -> str:
    """Return a text that XML allows; all other characters are replaced by escapes."""
    return NOT_XML.sub(lambda found: found.group().encode("unicode_escape").decode("ascii"), text)
