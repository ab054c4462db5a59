"""What people read of results: `report.html`, one file that works from disk without a network, and `report.md`.

Reports are computed from stored results and their verdicts; nothing is simulated here. `contents` holds what is said of runs,
and `study` what is said of a study, once for all writers; `html`, `markdown`, `results_json` and `figures` only lay it out.
"""

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from bodycheck.judging.result_set import ResultSet
    from bodycheck.reports.figures import Format
    from bodycheck.reports.study import StudyReport

__all__ = ["tell_github", "write", "write_junit", "write_study"]


def write(sets: "Sequence[ResultSet]", folder: Path, formats: "Sequence[Format]" = ()) -> tuple[Path, ...]:
    """Write report.html, report.md and results.json into an existing folder and return their paths, in that order.

    sets: one, or several to be compared, which have labels then. formats: those in which every plot gets a file of its own.
    Earlier reports are replaced. Raises `OSError` where a file cannot be written.
    """
    # Imported when first used: who only runs cases must not wait for templates and charts.
    from bodycheck.reports import figures, html, markdown
    from bodycheck.reports.runs import results_json
    from bodycheck.reports.runs.contents import gather

    contents = gather(sets)
    texts = {"report.html": html.render(contents), "report.md": markdown.render(contents)}
    paths = _write(folder, texts | {"results.json": results_json.render(contents, sets)})
    figures.write(figures.of_runs(contents), folder, formats)
    return paths


def tell_github(found: "ResultSet", files: Mapping[str, Path], environment: Mapping[str, str]) -> None:
    """In a workflow of GitHub, annotate what is broken, on stderr, and add report.md to the summary of the step.

    files: those that cases were read from, by name.
    """
    from bodycheck.reports import markdown
    from bodycheck.reports.runs import github
    from bodycheck.reports.runs.contents import gather

    if github.is_running(environment):
        for line in github.annotations(found.verdicts, found.results.cases, files, environment):
            print(line, file=sys.stderr)
        github.add_summary(environment, markdown.render(gather([found])))


def write_junit(sets: "Sequence[ResultSet]", path: Path) -> None:
    """Write the verdicts as JUnit XML. Raises `OSError` where the file cannot be written."""
    from bodycheck.reports.runs import comparison, junit

    verdicts = [verdict for one in sets for verdict in one.verdicts]
    path.write_text(junit.render(verdicts, comparison.header(sets)), encoding="utf-8")


def write_study(report: "StudyReport", folder: Path, formats: "Sequence[Format]" = ()) -> tuple[Path, ...]:
    """Likewise for a study, without results.json."""
    from bodycheck.reports import figures, html, markdown

    paths = _write(folder, {"report.html": html.render_study(report), "report.md": markdown.render_study(report)})
    figures.write(figures.of_study(report), folder, formats)
    return paths


def _write(folder: Path, texts: Mapping[str, str]) -> tuple[Path, ...]:
    paths = tuple(folder / name for name in texts)
    for path, text in zip(paths, texts.values(), strict=True):
        path.write_text(text, encoding="utf-8", errors="replace")
    return paths
