"""The command `bodycheck rerun`.

The imports are inside the functions, so that `--help` answers at once.
"""

import sys
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bodycheck.console import arguments
from bodycheck.console.options import AS_USUAL, Jobs, Json, Out, Quiet, Viewed
from bodycheck.errors import BadFolder, BadInput

if TYPE_CHECKING:
    from bodycheck.adapters.contract import Engine
    from bodycheck.casefile.case import Case
    from bodycheck.judging.baselines.baseline import Row
    from bodycheck.judging.baselines.difference import Difference
    from bodycheck.judging.judgement import Verdict
    from bodycheck.results.key import RunKey
    from bodycheck.results.store import Results
    from bodycheck.running.plan import Task

#: The name of the file whose numbers are compared.
FILE = "results.json"


def rerun(
    results: Path,
    /,
    *,
    out: Out = None,
    jobs: Jobs = None,
    json: Json = False,
    view: Viewed = AS_USUAL,
    quiet: Quiet = False,
) -> int:
    """Make the runs of saved results again, and print the numbers of results.json that differ beyond rounding.

    Cases, engines, methods and time steps are those of the results; the engines must be installed in the same versions. Runs
    whose numbers differ at all are repeated from nudged initial states, to measure the effect of rounding. Only results of
    `bodycheck run` can be made again: studies write no results.json, and are repeated by their own command.

    Exit codes: 0 nothing differs beyond rounding and the error of the truth; 1 a status or a figure differs, or a run fails to
    be made; 2 the folder is not as bodycheck wrote it, or an engine is not installed in this version.

    Parameters
    ----------
    results
        A results.json that `bodycheck run` wrote, or its folder, which has the cases.
    """
    from bodycheck.commands.report import write
    from bodycheck.console import output, tables, terminal
    from bodycheck.console.ran import Given, Selection, ran_of
    from bodycheck.judging import judgement, result_set
    from bodycheck.running.named import Decision

    tables.check(view, terminal.DIFFERENCES)
    folder = results if results.is_dir() else results.parent
    if folder == results.parent and results.name != FILE:
        raise BadInput(f"{results}: read {results.name!r}; allowed: a {FILE} that bodycheck wrote, or its folder")
    if out is not None and out.resolve() == folder.resolve():
        raise BadInput(f"--out {out}: is the folder of the results that are made again; allowed: another folder")
    stored, rows = _read(folder)
    cases, names = list(stored.cases.values()), tuple({run.engine: None for run in stored.runs()})
    selection = Selection(cases=(), engines=names, jobs=jobs, allow_missing=True)
    given, compared = Given(cases, {}, frozenset()), judgement.Compared()
    with ran_of(given, selection, partial(_plan, stored), out, sys.argv, quiet, compared.meet) as runs:
        again = result_set.judged(runs.results, compared=compared)
        write([again], out, (), None)
        differing = [one for one in again.verdicts if _differs(rows[one.run.key], one)]
        with terminal.progress("nudging", len(differing), quiet) as progress:
            difference = _difference(stored, rows, runs.results, again.verdicts, differing, arguments.processes(jobs), progress)
    if json:
        from bodycheck.judging.baselines.difference import as_json

        terminal.print_json(as_json(difference))
    elif not quiet or difference.changes:
        terminal.print_difference(difference, [difference.text], view)
    decision = Decision(failed=bool(difference.changes) or runs.loaded.failed(runs.cases))
    return output.end(decision, out, json=json, quiet=quiet)


def _read(folder: Path) -> "tuple[Results, Mapping[RunKey, Row]]":
    """Return the stored runs in a folder, and the rows of its results.json by the keys of the runs.

    Raises `BadInput` if the folder contains a study or interrupted runs, or is not as bodycheck wrote it.
    """
    from bodycheck.commands import saved
    from bodycheck.reports.study import StudyReport

    stored = saved.read(folder)
    if isinstance(stored, StudyReport):
        raise BadInput(f"{folder}: contains a study, which has no {FILE}; run the command of the study again")
    if not stored.complete:
        raise BadFolder(f"{folder}: the runs were interrupted; allowed: results of a command that came to its end")
    if not stored.runs():
        raise BadInput(f"{folder}: has no runs that could be made again")
    if any(run.is_recorded for run in stored.runs()):
        raise BadInput(
            f"{folder}: has a recorded motion, which cannot be made again; `bodycheck compare` compares its log again"
        )
    with saved.undamaged(folder):
        rows = _published(folder / FILE)
        if rows.keys() != {run.key for run in stored.runs()}:
            raise BadFolder(f"{folder}: damaged: {FILE} does not list the same runs as the records")
        return stored, rows


def _published(path: Path) -> "dict[RunKey, Row]":
    """Return the entry `runs` of a results.json by the keys of the runs.

    Raises `BadInput` if it is of another format, incomplete or of several sets of results. For a file that bodycheck did not
    write, it also raises `OSError`, `LookupError`, `TypeError`, `ValueError`, `AttributeError` or `RecursionError`.
    """
    import json

    from bodycheck.files import reading
    from bodycheck.judging.baselines.baseline import MAX_BYTES, by_key
    from bodycheck.reports.runs.results_json import FORMAT

    stored = json.loads(reading.content(path, MAX_BYTES, follow=True))
    if stored["format"] != FORMAT:
        raise BadInput(f"{path}: read {stored['format']!r:.60} as the format; allowed: {FORMAT}")
    if len(stored["sets"]) != 1 or stored["complete"] is not True:
        raise BadInput(f"{path}: allowed: the results of one command that came to its end")
    runs_by_key = by_key(stored["runs"])
    if len(runs_by_key) != len(stored["runs"]):
        raise BadInput(f"{path}: lists a run more than once")
    return runs_by_key


def _plan(
    stored: "Results",
    cases: "Sequence[Case]",
    engines: "Mapping[str, Engine]",
    integrators: Sequence[str],
    timesteps: Sequence[float],
) -> "tuple[Task, ...]":
    """Return the tasks of stored runs. The last two parameters, which other commands take from their user, are empty.

    Raises `BadInput` if an engine cannot be used, is installed in another version or lacks a method, and for an impossible time
    step.
    """
    from bodycheck.adapters import offers
    from bodycheck.running.instants import check_timestep
    from bodycheck.running.plan import Task

    by_name = {case.name: case for case in cases}
    tasks = tuple(Task(by_name[run.case], run.engine, run.method) for run in stored.runs())
    for name in {task.engine: None for task in tasks}:
        version = stored.header["engines"].get(name, "")
        if name not in engines:
            raise BadInput(f"{stored.folder}: was made with {name} {version}, which cannot be used here")
        if engines[name].version != version:
            raise BadInput(
                f"{stored.folder}: was made with {name} {version}, and {name} {engines[name].version} is installed; allowed: "
                "the same version"
            )
    for task in tasks:
        offers.check(engines[task.engine], task.method)
        check_timestep(task.case, task.method.timestep)
    return tasks


def _differs(row: "Row", verdict: "Verdict") -> bool:
    """Return whether a figure of a completed run differs from the row of the earlier run in results.json."""
    from bodycheck.judging.baselines.baseline import FIGURES
    from bodycheck.reports.runs import results_json

    if verdict.discrepancy is None:
        return False
    (now,) = results_json.rows([verdict])
    return any(row.get(name) != now.get(name) for name in FIGURES)


def _difference(
    stored: "Results",
    rows: "Mapping[RunKey, Row]",
    again: "Results",
    verdicts: "Sequence[Verdict]",
    differing: "Sequence[Verdict]",
    jobs: int,
    progress: Any,
) -> "Difference":
    """Return the differences of results and the same runs made again, with the allowances of runs that differ."""
    from bodycheck.casefile.identity import identity
    from bodycheck.figures.revisions import REVISIONS
    from bodycheck.judging.baselines import baseline, difference
    from bodycheck.reports.runs import results_json
    from bodycheck.results import records

    allowances = baseline.allowances(again, differing, jobs, progress)
    identities = {name: identity(case) for name, case in again.cases.items()}
    revisions = records.typed(records.RevisionsRecord, stored.header).revisions
    before = {key: row | allowances.get(key, {}) for key, row in rows.items()}
    keys = [verdict.run.key for verdict in verdicts]
    now = {key: row | allowances.get(key, {}) for key, row in zip(keys, results_json.rows(verdicts), strict=True)}
    return difference.diff(
        baseline.Baseline(stored.header, identities, before, revisions),
        baseline.Baseline(again.header, identities, now, REVISIONS),
    )
