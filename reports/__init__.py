"""Reports about results, for people and programs.

A report consists of `report.html`, one file that works from disk without a network, and `report.md`. Reports of runs also have
`results.json`. They are made from stored results and their verdicts; nothing is simulated here.

The modules in this folder are shared by all reports:

- `study`: the contents of a study's report before layout; the `page` modules of `bodycheck.studies` make them.
- `finding`, `notices`, `tables`, `lines`, `quantities`: sentences, tables, the line of each method, names of quantities, and
  numbers as text.
- `charts`, `series`, `plot_files`: parts of charts, curves with few points, and plots as files.
- `html`, `markdown`: the writers. `templates/` has the pages, styles and scripts; `player` assembles the player from the files
  in `templates/player/`.

The folder `runs` has the report of runs, which uses these modules; they import nothing from it.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from bodycheck.files import writing
from bodycheck.runner_log import print_command

if TYPE_CHECKING:
    from bodycheck.judging.result_set import ResultSet
    from bodycheck.reports.plot_files import Format
    from bodycheck.reports.runs.brief import Brief
    from bodycheck.reports.study import StudyReport

__all__ = ["annotate_github", "brief", "write", "write_junit", "write_study"]

# Imports are inside functions, because templates and charts are slow to import and many commands write no report.


def write(sets: "Sequence[ResultSet]", folder: Path, formats: "Sequence[Format]" = ()) -> tuple[Path, ...]:
    """Write the report of runs into an existing folder and return the paths of report.html, report.md and results.json.

    Earlier reports are replaced.

    Parameters
    ----------
    sets
        One set of results, or several sets to compare, which must have labels.
    folder
        The folder into which to write.
    formats
        The formats in which every plot is also written as a separate file.

    Raises
    ------
    OSError
        A file cannot be written.
    """
    from bodycheck.reports import plot_files
    from bodycheck.reports.runs import html_report, markdown_report, plots, results_json
    from bodycheck.reports.runs.contents import gather

    contents = gather(sets)
    texts = {
        "report.html": html_report.render(contents),
        "report.md": markdown_report.render(contents),
        "results.json": results_json.render(contents, sets),
    }
    paths = _write(folder, texts)
    plot_files.write(plots.of_runs(contents), folder, formats)
    return paths


def brief(sets: "Sequence[ResultSet]") -> "Brief":
    """Return the beginning of the report of runs, without charts or animations. sets: see `write`."""
    from bodycheck.reports.runs.brief import brief as made

    return made(sets)


def annotate_github(found: "ResultSet", files: Mapping[str, Path], environment: Mapping[str, str]) -> None:
    """In a step of a GitHub workflow, print annotations of failures and add report.md to the summary of the step.

    Parameters
    ----------
    found
        The results.
    files
        The files from which cases were read, by the name of the case.
    environment
        Environment variables of the process.
    """
    from bodycheck.reports.runs import github, markdown_report
    from bodycheck.reports.runs.contents import gather

    if github.is_running(environment):
        cases = found.results.cases
        for line in github.annotations(found.verdicts, cases, files, environment):
            print_command(line)
        for line in github.unchecked_annotations(found.results.unchecked, cases, files, environment):
            print_command(line)
        github.add_summary(environment, markdown_report.render(gather([found])))


def write_junit(sets: "Sequence[ResultSet]", path: Path) -> None:
    """Write the verdicts as JUnit XML. Raises `NotWritten` if the file cannot be written."""
    from bodycheck.reports.runs import comparison, junit

    verdicts = [verdict for one in sets for verdict in one.verdicts]
    unchecked = [lost for one in sets for lost in one.results.unchecked]
    files = {name: file for one in sets for name, file in one.results.files.items()}
    writing.write_named(path, junit.render(verdicts, comparison.header(sets), unchecked, files).encode("utf-8", "replace"))


def write_study(report: "StudyReport", folder: Path, formats: "Sequence[Format]" = ()) -> tuple[Path, ...]:
    """Write the report of a study into an existing folder and return the paths of report.html and report.md.

    `folder`, `formats` and errors are as for `write`.
    """
    from bodycheck.reports import html, markdown, plot_files

    paths = _write(folder, {"report.html": html.render_study(report), "report.md": markdown.render_study(report)})
    plot_files.write(plot_files.of_study(report), folder, formats)
    return paths


def _write(folder: Path, texts: Mapping[str, str]) -> tuple[Path, ...]:
    """Write texts to files in a folder and return the paths of the files. texts: the texts by file name."""
    paths = tuple(folder / name for name in texts)
    for path, text in zip(paths, texts.values(), strict=True):
        writing.write(path, text.encode("utf-8", "replace"))
    return paths
