"""The commands `bodycheck report` and `diff`.

The imports are inside the functions, so that `--help` answers at once.
"""

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from bodycheck.console import arguments
from bodycheck.console.options import AS_USUAL, Figures, Json, JUnit, Viewed
from bodycheck.errors import BAD_INPUT, FAILED, OK, BadInput
from bodycheck.runner_log import print_command

if TYPE_CHECKING:
    from collections.abc import Sequence

    from bodycheck.judging.result_set import ResultSet
    from bodycheck.reports.study import StudyReport
    from bodycheck.results.store import Results


def report(
    *folders: Path, case: tuple[str, ...] = (), out: Path | None = None, figures: Figures = (), junit: JUnit = None
) -> int:
    """Write the report of saved results again, without new simulations. The results may be runs or a study.

    Several folders of runs are compared in one report, for example those of two releases of an engine, of two machines, or
    from before and after a change of a case. The report begins with the differences. Several folders of `bodycheck releases`
    are also combined into one report. Interrupted runs are reported up to the interruption, with exit code 2.

    Parameters
    ----------
    folders
        Folders that `--out` of an earlier command wrote.
    case
        A case that the report is about, by its name, with its curves and animation. May be given several times. Needs --out.
        Default: all cases.
    out
        The folder for the report and its tables. It may be omitted if there is only one folder of results; the report is then
        written into that folder.
    """
    from bodycheck.commands import saved
    from bodycheck.console import results
    from bodycheck.judging import result_set
    from bodycheck.reports.study import StudyReport
    from bodycheck.studies.releases import rows as release_rows

    arguments.check_writable("--junit", junit)
    into = arguments.folder_for(folders, out)
    if case and (out is None or into.resolve() in {folder.resolve() for folder in folders}):
        raise BadInput("--case: needs --out, another folder, for a report of these cases alone")
    if all((folder / release_rows.RECORDS).is_file() for folder in folders):
        _refuse_cases(case, folders[0])
        return _report_releases(folders, into, figures, junit)
    contents = [saved.read(folder) for folder in folders]
    if case:
        contents = _of_cases(contents, folders, case)
    arguments.make_folder("--out", into)
    if isinstance(contents[0], StudyReport) and len(contents) == 1:
        return _report_study(folders[0], contents[0], into, figures, junit)
    sets = []
    for folder, label, one in zip(folders, result_set.labels(folders), contents, strict=True):
        if isinstance(one, StudyReport):
            raise BadInput(f"{folder}: contains a study; only folders of runs can be compared in one report")
        with saved.undamaged(folder):
            sets.append(result_set.judged(one, label))
    with saved.undamaged(*folders):
        write(sets, into, figures, junit)
    print(f"report: {into / 'report.html'}", file=sys.stderr)
    if interrupted := [str(one.results.folder) for one in sets if not one.results.complete]:
        print(
            f"bodycheck: interrupted; the report contains the runs before the interruption: {', '.join(interrupted)}",
            file=sys.stderr,
        )
        return BAD_INPUT
    for judged in sets:
        results.print_unchecked(judged.results.unchecked, sys.stderr)
    return FAILED if any(judged.failed for judged in sets) else OK


def _refuse_cases(cases: tuple[str, ...], folder: Path) -> None:
    """Raise `BadInput` if cases are asked for of a study, whose report is about all."""
    if cases:
        raise BadInput(f"--case {cases[0]}: {folder} contains a study; only results of runs can be reported by case")


def _of_cases(
    contents: "Sequence[Results | StudyReport]", folders: tuple[Path, ...], cases: tuple[str, ...]
) -> "list[Results | StudyReport]":
    """Return results of runs without all other cases. Raises `BadInput` for a study, and for a case that is in no folder."""
    from bodycheck.results.store import Results
    from bodycheck.suggestion import did_you_mean

    for folder, one in zip(folders, contents, strict=True):
        if not isinstance(one, Results):
            _refuse_cases(cases, folder)
    results = [one for one in contents if isinstance(one, Results)]
    known = dict.fromkeys(entry["name"] for one in results for entry in one.header["cases"])
    for name in cases:
        if name not in known:
            raise BadInput(
                f"--case {name}: there is no such case in these results of {len(known)} cases{did_you_mean(name, known)}"
            )
    return [one.only(cases) for one in results]


def _report_study(folder: Path, study: "StudyReport", into: Path, figures: Figures, junit: JUnit) -> int:
    """Write the report of a study."""
    from bodycheck import reports
    from bodycheck.commands import saved

    if junit is not None:
        raise BadInput(f"--junit {junit}: {folder} contains a study, and studies have no expectations")
    with saved.undamaged(folder):
        reports.write_study(study, into, figures)
    print(f"report: {into / 'report.html'}", file=sys.stderr)
    return OK


def _report_releases(folders: tuple[Path, ...], into: Path, figures: Figures, junit: Path | None) -> int:
    """Write one report of several studies of releases, made for example on several machines."""
    from bodycheck import reports
    from bodycheck.commands import saved
    from bodycheck.files import reading
    from bodycheck.studies.releases import rows as release_rows
    from bodycheck.studies.releases.page import present

    if junit is not None:
        raise BadInput(f"--junit {junit}: {folders[0]} contains a study, and studies have no expectations")
    for folder in folders:
        reading.refuse_links(folder)
    arguments.make_folder("--out", into)
    with saved.undamaged(*folders):
        measurements = release_rows.comparable([release_rows.read(folder) for folder in folders])
        reports.write_study(present(dict(zip(release_rows.labels(measurements), measurements, strict=True))), into, figures)
    print(f"report: {into / 'report.html'}", file=sys.stderr)
    return OK


def write(sets: "Sequence[ResultSet]", out: Path | None, figures: Figures, junit: Path | None) -> None:
    """Write the report and the tables of judged results, and their JUnit XML.

    Parameters
    ----------
    sets
        The judged results; several are compared.
    out
        The folder for the report and the tables; None to write neither.
    figures
        The formats in which plots are written as files.
    junit
        The file for the JUnit XML; None to write none.
    """
    from bodycheck import reports
    from bodycheck.judging import result_set

    if out is not None:
        result_set.write(sets, out)
        reports.write(sets, out, figures)
    if junit is not None:
        reports.write_junit(sets, junit)


def diff(base: Path, now: Path, /, *, fail_on: tuple[str, ...] = (), json: Json = False, view: Viewed = AS_USUAL) -> int:
    """Compare two baselines, and print the changes that exceed the effect of rounding and the error of the truth.

    The worst change comes first; the last line summarises the changes, or says that there are none. A figure whose definition
    has changed between the versions of bodycheck that made the baselines is named and not compared. The command also prints
    improvements and new runs, which do not make it fail.

    Exit codes: 0 nothing got worse; 1 an error or a status got worse, a run is missing, or nothing could be compared; 2 the
    files are not baselines of the same cases, or a figure of --fail-on could not be compared.

    Parameters
    ----------
    base
        The older baseline: a file that `bodycheck run --save` wrote.
    now
        The newer baseline, made later, on another machine, or with other versions.
    fail_on
        A figure and by how much its error may grow, for example attitude_error:10%. May be given several times. Other figures
        then do not make the command fail; a worse status and a missing run still do. Default: any growth of any figure fails.
    """
    from bodycheck.console import tables, terminal
    from bodycheck.console.output import end
    from bodycheck.judging.baselines import baseline, difference
    from bodycheck.reports.runs import github
    from bodycheck.running.named import Named, decide

    allowed = difference.tolerances_of(fail_on)
    tables.check(view, terminal.DIFFERENCES)
    changed = difference.diff(baseline.read(base), baseline.read(now))
    broken = difference.failing(changed, allowed)
    summary = [changed.text, *((difference.summary(broken, allowed),) if allowed else ())]
    if json:
        terminal.print_json(difference.as_json(changed) | {"failed": len(broken)})
    else:
        terminal.print_difference(changed, summary, view)
    if changed.changes and github.is_running(os.environ):
        print_command(github.annotation("error" if broken else "notice", "; ".join(summary), "bodycheck diff"))
    return end(decide(Named(), difference.comparisons(changed), bool(broken)), None, json=json)
