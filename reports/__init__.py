"""What people read of results: `report.html`, one file that works from disk without a network, and `report.md`.

Reports are computed from stored results and their verdicts; nothing is simulated here. `contents` holds what is said, once for
all writers; `html` and `markdown` only lay it out.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from bodycheck.attribution import Attribution
    from bodycheck.judgement import Verdict
    from bodycheck.store import Results

__all__ = ["write"]


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
    paths = folder / "report.html", folder / "report.md"
    for path, text in zip(paths, (html.render(contents), markdown.render(contents)), strict=True):
        path.write_text(text, encoding="utf-8", errors="replace")
    return paths
