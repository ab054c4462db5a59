"""The report as Markdown that fits a comment on a pull request: verdict, matrix and, as long as there is room, tables."""

import re
from collections.abc import Iterable, Iterator, Sequence

from bodycheck.reports.contents import Contents, Failure, Section
from bodycheck.reports.quantities import count, milliseconds
from bodycheck.reports.tables import Table

ROOM = 60_000
"""Characters; a comment on GitHub may have 65 536."""

LONGEST = 240
"""Characters of one string from outside."""

MOST_FAILURES = 30

INVISIBLE = re.compile(r"[\x00-\x1f\x7f-\x9f\u061c\u200b-\u200f\u2028-\u202e\u2060-\u2069\ufeff]+")
"""Controls, line ends and marks of direction: they break tables, or reorder what stands beside them."""

MARKUP = re.compile(r"([\\`*_\[\]!|~$])")


def escape(text: str) -> str:
    """A string from outside as Markdown that shows it, on one line, cut where it is long."""
    line = INVISIBLE.sub(" ", text).strip()
    line = line if len(line) <= LONGEST else line[: LONGEST - 1] + "…"
    line = MARKUP.sub(r"\\\1", line.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;"))
    # A word joiner in them keeps a forge from making links of names, numbers and addresses.
    return line.replace("@", "@\u2060").replace("#", "#\u2060").replace("://", ":\u2060//").replace("www.", "www\u2060.")


def render(contents: Contents) -> str:
    """The text of report.md."""
    parts, room, left_out = [], ROOM, []
    for name, part in _parts(contents):
        if len(part) + 2 > room:
            left_out.append(name)
            continue
        parts.append(part)
        room -= len(part) + 2
    if left_out:
        parts.append(f"*Left out here for their size: {count(len(left_out), 'table')}; report.html has them.*")
    return "\n\n".join([*parts, _footer(contents)]) + "\n"


def _parts(contents: Contents) -> Iterator[tuple[str, str]]:
    yield "head", _head(contents)
    if contents.failures:
        yield "failures", _failures(contents.failures)
    if contents.findings:
        yield "findings", "\n".join(f"- **{finding.subject}.** {escape(finding.text)}" for finding in contents.findings)
    if contents.lines:
        yield "matrix", _matrix(contents)
    for section in contents.sections:
        yield section.name, _section(section)


def _head(contents: Contents) -> str:
    tally = " · ".join(f"{name} {amount}" for name, amount in contents.tally)
    notices = [f"> {escape(notice)}" for notice in contents.notices]
    return "\n\n".join(filter(None, (f"# bodycheck: {contents.headline}", tally, "\n>\n".join(notices))))


def _failures(failures: Sequence[Failure]) -> str:
    rows = [(failure.case, failure.method, failure.status, failure.reason) for failure in failures[:MOST_FAILURES]]
    more = len(failures) - len(rows)
    table = _table(("Case", "Method", "How", "Why"), rows)
    return f"## What failed\n\n{table}" + (f"\n\n*And {count(more, 'run')} more.*" if more else "")


def _matrix(contents: Contents) -> str:
    steps = f", time step {milliseconds(contents.timesteps[0])}" if len(contents.timesteps) == 1 else ""
    rows = [
        (name, *("" if cell is None else f"{'✗ ' if cell.failed else ''}{cell.text}" for cell in cells))
        for name, cells in contents.matrix
    ]
    note = "≤: within the truth's own error, which is the figure given."
    size = f"{count(len(rows), 'case')}, {count(len(contents.lines), 'method')}{steps}"
    table = _table(("Case", *(line.label for line in contents.lines)), rows, numeric_from=1)
    return f"## Largest attitude error, rad\n\n{size}. {note}\n\n{table}"


def _section(section: Section) -> str:
    facts = [f"- {fact.term}: {escape(fact.text)}" for fact in section.facts]
    source = [f"- Source: {escape(section.source)}"] if section.source else []
    body = "No run of this case finished." if section.table is None else _filled(section.table)
    if section.origins is not None:
        body += f"\n\nWhere it comes from:\n\n{_filled(section.origins)}"
    listed = "\n".join(source + facts)
    summary = f"<b>{section.name}</b>: {escape(section.title)}"
    return f"<details><summary>{summary}</summary>\n\n{listed}\n\n{body}\n\n</details>"


def _filled(table: Table) -> str:
    rows = [[entry.text for entry in row] for row in table.rows]
    return "\n\n".join([_table(table.columns, rows, table.numeric.index(True)), *table.notes])


def _table(head: Sequence[str], rows: Iterable[Sequence[str]], numeric_from: int | None = None) -> str:
    marks = ["--:" if numeric_from is not None and place >= numeric_from else "---" for place in range(len(head))]
    cells = [[escape(text) for text in row] for row in (head, *rows)]
    return "\n".join("| " + " | ".join(row) + " |" for row in (cells[0], marks, *cells[1:]))


def _footer(contents: Contents) -> str:
    header = contents.header
    versions = {"bodycheck": header["bodycheck"], **header["engines"], **header["packages"]}
    machine = ", ".join(f"{name} {value}" for name, value in header["machine"].items())
    listed = ", ".join(f"{name} {version}" for name, version in versions.items())
    made = f"{listed}; {machine}; started {header['started']}; command: {' '.join(header['command'])}"
    return f"*{escape(made)}*"
