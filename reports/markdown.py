"""Reports as Markdown that fits into a comment on a pull request: findings first, then as many tables as fit."""

import re
from collections.abc import Iterable, Iterator, Sequence

from bodycheck.reports.finding import Finding
from bodycheck.reports.quantities import count, verb
from bodycheck.reports.study import StudyReport
from bodycheck.reports.tables import Table
from bodycheck.results.header import Header

#: The most characters of a report; a comment on GitHub may have 65 536.
ROOM = 60_000

#: The most characters of a string from a case file or an engine.
LONGEST = 240

#: The most characters of a sentence that contains such strings.
LONGEST_SENTENCE = 1200

#: Matches control characters, line ends and direction marks, which break tables or reorder the text beside them.
INVISIBLE = re.compile(r"[\x00-\x1f\x7f-\x9f\u061c\u200b-\u200f\u2028-\u202e\u2060-\u2069\ufeff]+")

MARKUP = re.compile(r"([\\`*_\[\]!|~$])")


def escape(text: str, longest: int = LONGEST) -> str:
    """Return a string from outside as one line of Markdown that shows it literally, cut to `longest` characters."""
    line = cut(INVISIBLE.sub(" ", text).strip(), longest)
    line = MARKUP.sub(r"\\\1", line.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;"))
    # Word joiners keep GitHub and the like from turning names, numbers and addresses into links.
    return line.replace("@", "@\u2060").replace("#", "#\u2060").replace("://", ":\u2060//").replace("www.", "www\u2060.")


def cut(line: str, longest: int) -> str:
    """Return a line cut to the longest length, at the end of a word unless this is longer than half of the line."""
    if len(line) <= longest:
        return line
    kept = line[: longest - 1]
    whole = kept if line[longest - 1] == " " else kept.rpartition(" ")[0]
    return (whole if len(whole) >= longest // 2 else kept).rstrip() + "…"


def code(text: str) -> str:
    """Return a string from outside as inline code that shows it literally.

    A string of more than `LONGEST_SENTENCE` characters is replaced by its length, because a part of code is useless.
    """
    line = INVISIBLE.sub(" ", text).strip()
    if len(line) > LONGEST_SENTENCE:
        return f"*{len(line)} characters*"
    fence = "`" * (1 + max(map(len, re.findall("`+", line)), default=0))
    return f"{fence} {line} {fence}" if "`" in line else f"{fence}{line}{fence}"


def render_study(report: StudyReport) -> str:
    """Return the text of report.md for a study, in which each chart is replaced by a description."""
    return fitted(_study_parts(report), report.header)


def fitted(parts: Iterable[str], header: Header) -> str:
    """Return the parts that fit into `ROOM` characters, then the versions, machine and command of the results."""
    kept, room, left_out = [], ROOM, 0
    for part in parts:
        if len(part) + 2 > room:
            left_out += 1
            continue
        kept.append(part)
        room -= len(part) + 2
    if left_out:
        left = f"{count(left_out, 'table')} {verb(left_out, 'was', 'were')} left out"
        kept.append(f"*{left} to keep this text short. The file report.html contains all tables.*")
    return "\n\n".join([*kept, _footer(header)]) + "\n"


def _study_parts(report: StudyReport) -> Iterator[str]:
    yield opening(report.title, escape(report.headline), report.notices)
    if report.findings:
        yield findings_list(report.findings)
    for part in report.parts:
        texts = [escape(text, LONGEST_SENTENCE) for text in part.texts]
        shown = "\n".join(f"- {escape(chart.alt, LONGEST_SENTENCE)}" for chart in part.charts)
        tables = [f"{escape(caption)}:\n\n{table_with_notes(own)}" for caption, own in part.tables]
        yield details(f"<b>{escape(part.title)}</b>", *texts, shown, *tables)


def opening(title: str, subtitle: str, notices: Sequence[str]) -> str:
    """Return the beginning of a report: its title, a line under it, and its notices as quotations."""
    quoted = "\n>\n".join(f"> {escape(notice)}" for notice in notices)
    return "\n\n".join(filter(None, (f"# bodycheck: {title}", subtitle, quoted)))


def findings_list(findings: Sequence[Finding]) -> str:
    """Return findings as a list."""
    return "\n".join(f"- **{finding.subject}.** {escape(finding.text, LONGEST_SENTENCE)}" for finding in findings)


def details(summary: str, *blocks: str) -> str:
    """Return blocks that are folded under a summary until the reader opens them."""
    return "\n\n".join(filter(None, (f"<details><summary>{summary}</summary>", *blocks, "</details>")))


def table_with_notes(table: Table) -> str:
    """Return a table with its notes."""
    rows = [[entry.text for entry in row] for row in (*table.rows, *((table.footer,) if table.footer else ()))]
    numeric_from = table.numeric.index(True) if True in table.numeric else None
    return "\n\n".join([grid(table.columns, rows, numeric_from), *table.notes])


def grid(head: Sequence[str], rows: Iterable[Sequence[str]], numeric_from: int | None = None) -> str:
    """Return a Markdown table of texts. Columns from the index `numeric_from` on are aligned to the right."""
    marks = ["--:" if numeric_from is not None and place >= numeric_from else "---" for place in range(len(head))]
    cells = [[escape(text) for text in row] for row in (head, *rows)]
    return "\n".join("| " + " | ".join(row) + " |" for row in (cells[0], marks, *cells[1:]))


def _footer(header: Header) -> str:
    versions = {"bodycheck": header["bodycheck"], **header["engines"], **header["packages"]}
    machine = ", ".join(f"{name} {value}" for name, value in header["machine"].items())
    listed = ", ".join(f"{name} {version}" for name, version in versions.items())
    made = f"{listed}; {machine}; started {header['started']}; command: {' '.join(header['command'])}"
    return f"*{escape(made)}*"
