"""What people read of results: `report.html`, one file that works from disk without a network, and `report.md`.

Reports are computed from stored results and their verdicts; nothing is simulated here. `contents` holds what is said of runs,
and `study` what is said of a study, once for all writers; `html` and `markdown` only lay it out.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from bodycheck.attribution import Attribution
    from bodycheck.judgement import Verdict
    from bodycheck.reports.study import StudyReport
    from bodycheck.store import Results

__all__ = ["as_markdown", "write", "write_junit", "write_study"]


def write(
    results: "Results", verdicts: "Sequence[Verdict]", folder: Path, parts: "Sequence[Attribution]" = ()
) -> tuple[Path, ...]:
    """Write report.html and report.md into an existing folder and return their paths, in that order.

    verdicts: those on the runs of `results`. parts: those of their discrepancies of contact. Earlier reports are replaced.
    Raises `OSError` where a file cannot be written.
    """
    # Imported when first used: who only runs cases must not wait for templates and charts.
    from bodycheck.reports import html, markdown
    from bodycheck.reports.contents import gather

    contents = gather(results, verdicts, parts)
    return _write(folder, html.render(contents), markdown.render(contents))


def as_markdown(results: "Results", verdicts: "Sequence[Verdict]") -> str:
    """The text of report.md."""
    from bodycheck.reports import markdown
    from bodycheck.reports.contents import gather

    return markdown.render(gather(results, verdicts))


def write_junit(results: "Results", verdicts: "Sequence[Verdict]", path: Path) -> None:
    """Write the verdicts as JUnit XML. Raises `OSError` where the file cannot be written."""
    from bodycheck.reports import junit

    path.write_text(junit.render(verdicts, results.header), encoding="utf-8")


def write_study(report: "StudyReport", folder: Path) -> tuple[Path, ...]:
    """Likewise for a study."""
    from bodycheck.reports import html, markdown

    return _write(folder, html.render_study(report), markdown.render_study(report))


def _write(folder: Path, *texts: str) -> tuple[Path, ...]:
    paths = folder / "report.html", folder / "report.md"
    for path, text in zip(paths, texts, strict=True):
        path.write_text(text, encoding="utf-8", errors="replace")
    return paths
