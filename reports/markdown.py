"""Reports as Markdown that fits a comment on a pull request: what matters first and, as long as there is room, tables."""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from bodycheck.reports.quantities import count, milliseconds
from bodycheck.reports.runs.contents import Contents, Failure, Section
from bodycheck.reports.runs.matrix import Cell, Matrix
from bodycheck.reports.runs.summary import Finding
from bodycheck.reports.study import StudyReport
from bodycheck.reports.tables import Table

#: Characters; a comment on GitHub may have 65 536.
ROOM = 60_000

#: Characters of one string from outside.
LONGEST = 240

#: Characters of one that the report makes of such strings.
LONGEST_SENTENCE = 1200

MOST_FAILURES = 30

MATRICES = "## Cases and methods\n\n✗: failed. ≤: within the truth's own error, which is the figure given."

#: Controls, line ends and marks of direction: they break tables, or reorder what stands beside them.
INVISIBLE = re.compile(r"[\x00-\x1f\x7f-\x9f\u061c\u200b-\u200f\u2028-\u202e\u2060-\u2069\ufeff]+")

MARKUP = re.compile(r"([\\`*_\[\]!|~$])")


def escape(text: str, longest: int = LONGEST) -> str:
    """A string from outside as Markdown that shows it, on one line, cut where it is long."""
    line = INVISIBLE.sub(" ", text).strip()
    line = line if len(line) <= longest else line[: longest - 1] + "…"
    line = MARKUP.sub(r"\\\1", line.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;"))
    # A word joiner in them keeps a forge from making links of names, numbers and addresses.
    return line.replace("@", "@\u2060").replace("#", "#\u2060").replace("://", ":\u2060//").replace("www.", "www\u2060.")


def render(contents: Contents) -> str:
    """The text of report.md for runs."""
    return _fitted(_parts(contents), contents.header)


def render_study(report: StudyReport) -> str:
    """The text of report.md for a study; of its charts it says what they show."""
    return _fitted(_study_parts(report), report.header)


def _fitted(parts: Iterable[str], header: Mapping[str, Any]) -> str:
    """As many of the parts as there is room for, then what made them."""
    kept, room, left_out = [], ROOM, 0
    for part in parts:
        if len(part) + 2 > room:
            left_out += 1
            continue
        kept.append(part)
        room -= len(part) + 2
    if left_out:
        kept.append(f"*Left out here for their size: {count(left_out, 'table')}; report.html has them.*")
    return "\n\n".join([*kept, _footer(header)]) + "\n"


def _parts(contents: Contents) -> Iterator[str]:
    tally = " · ".join(f"{name} {amount}" for name, amount in contents.tally)
    yield _head(contents.headline, tally, contents.notices)
    if contents.failures:
        yield _failures(contents.failures)
    if contents.findings:
        yield _findings(contents.findings)
    if contents.matrices:
        yield MATRICES
    for matrix in contents.matrices:
        yield _matrix(matrix)
    for section in contents.sections:
        yield _section(section)


def _study_parts(report: StudyReport) -> Iterator[str]:
    yield _head(report.title, escape(report.headline), report.notices)
    if report.findings:
        yield _findings(report.findings)
    for part in report.parts:
        texts = [escape(text, LONGEST_SENTENCE) for text in part.texts]
        shown = "\n".join(f"- {escape(chart.alt, LONGEST_SENTENCE)}" for chart in part.charts)
        tables = [f"{escape(caption)}:\n\n{_filled(table)}" for caption, table in part.tables]
        yield _folded(f"<b>{escape(part.title)}</b>", *texts, shown, *tables)


def _head(title: str, subtitle: str, notices: Sequence[str]) -> str:
    quoted = "\n>\n".join(f"> {escape(notice)}" for notice in notices)
    return "\n\n".join(filter(None, (f"# bodycheck: {title}", subtitle, quoted)))


def _findings(findings: Sequence[Finding]) -> str:
    return "\n".join(f"- **{finding.subject}.** {escape(finding.text, LONGEST_SENTENCE)}" for finding in findings)


def _folded(summary: str, *blocks: str) -> str:
    """What shows its summary until it is opened."""
    return "\n\n".join(filter(None, (f"<details><summary>{summary}</summary>", *blocks, "</details>")))


def _failures(failures: Sequence[Failure]) -> str:
    rows = [(failure.case, failure.method, failure.status, failure.reason) for failure in failures[:MOST_FAILURES]]
    more = len(failures) - len(rows)
    table = _table(("Case", "Method", "How", "Why"), rows)
    return f"## What failed\n\n{table}" + (f"\n\n*And {count(more, 'run')} more.*" if more else "")


def _matrix(matrix: Matrix) -> str:
    title = f"{matrix.kind.title}: largest {matrix.quantity.title.lower()}, {matrix.quantity.unit}"
    steps = f"time step {milliseconds(matrix.timestep)}" + (" but where another is given" if matrix.several_steps else "")
    size = f"{count(len(matrix.rows), 'case')}, {count(matrix.methods, 'method')}, {steps}."
    rows = [(row.case, *(_cell(cell, matrix.timestep) for cell in row.cells)) for row in matrix.rows]
    head = ("Case", *(f"{column.engine} {column.integrator} {column.results}".rstrip() for column in matrix.columns))
    return f"### {title}\n\n{size}\n\n{_table(head, rows, numeric_from=1)}"


def _cell(cell: Cell | None, common: float) -> str:
    if cell is None:
        return ""
    return ", ".join(
        ("✗ " if figure.failed else "")
        + figure.text
        + ("" if figure.timestep == common else f" ({milliseconds(figure.timestep)})")
        for figure in cell.figures
    )


def _section(section: Section) -> str:
    facts = [f"- {fact.term}: {escape(fact.text)}" for fact in section.facts]
    source = [f"- Source: {escape(section.source)}"] if section.source else []
    body = "No run of this case finished." if section.table is None else _filled(section.table)
    origins = () if section.origins is None else ("Where it comes from:", _filled(section.origins.table))
    return _folded(f"<b>{section.name}</b>: {escape(section.title)}", "\n".join(source + facts), body, *origins)


def _filled(table: Table) -> str:
    rows = [[entry.text for entry in row] for row in table.rows]
    numeric_from = table.numeric.index(True) if True in table.numeric else None
    return "\n\n".join([_table(table.columns, rows, numeric_from), *table.notes])


def _table(head: Sequence[str], rows: Iterable[Sequence[str]], numeric_from: int | None = None) -> str:
    marks = ["--:" if numeric_from is not None and place >= numeric_from else "---" for place in range(len(head))]
    cells = [[escape(text) for text in row] for row in (head, *rows)]
    return "\n".join("| " + " | ".join(row) + " |" for row in (cells[0], marks, *cells[1:]))


def _footer(header: Mapping[str, Any]) -> str:
    versions = {"bodycheck": header["bodycheck"], **header["engines"], **header["packages"]}
    machine = ", ".join(f"{name} {value}" for name, value in header["machine"].items())
    listed = ", ".join(f"{name} {version}" for name, version in versions.items())
    made = f"{listed}; {machine}; started {header['started']}; command: {' '.join(header['command'])}"
    return f"*{escape(made)}*"
