"""The commands `bodycheck releases` and `bodycheck bisect`.

The imports are inside the functions, so that `--help` answers at once.
"""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from bodycheck.console.arguments import AS_THEY_ARE
from bodycheck.console.options import AS_USUAL, Again, Figures, Integrators, Jobs, Json, OfRobots, Out, Quiet, Timesteps, Viewed
from bodycheck.errors import FAILED, OK, BadInput

if TYPE_CHECKING:
    from bodycheck.studies.releases.rows import Found
    from bodycheck.studies.releases.study import Bar


def releases(
    engine: str,
    /,
    *versions: str,
    case: Annotated[
        tuple[str, ...],
        Parameter(help="A shipped case, case file, folder or pattern. May be given several times. Default: all shipped cases."),
    ] = (),
    model: Annotated[
        tuple[Path, ...],
        Parameter(help="The file of a robot, URDF or MJCF: say which release changed what it means, instead of running cases."),
    ] = (),
    integrator: Integrators = (),
    timestep: Timesteps = (),
    robots: OfRobots = AS_THEY_ARE,
    last: int | None = None,
    out: Out = None,
    figures: Figures = (),
    remove: bool = False,
    again: Again = False,
    jobs: Jobs = None,
    json: Json = False,
    view: Viewed = AS_USUAL,
    quiet: Quiet = False,
) -> int:
    """Run the same cases in several releases of an engine, and report what changed from release to release.

    Each release is installed into an environment of its own. Environments and measurements are kept for later commands. Time
    steps are those of `bodycheck run`. The tables are releases.csv and changes.csv; with --model it is parity.csv.

    Exit codes: 0 every release was measured, whether or not anything changed; 1 a release or a named method has no result, or a
    file has faults and was left out.

    Parameters
    ----------
    engine
        The name of the engine.
    versions
        The releases to compare, for example 3.2.7 3.3.0.
    last
        The number of newest releases to compare, in addition to the named ones.
    remove
        Delete the environments of the named versions, or of all versions if none is named. Nothing is measured.
    """
    from dataclasses import asdict
    from functools import partial

    from bodycheck.console import progress as shown
    from bodycheck.console import tables
    from bodycheck.console.arguments import check_engine, check_has_folder, make_folder, processes, read_cases, tell_left_out
    from bodycheck.console.output import end
    from bodycheck.console.terminal import print_json
    from bodycheck.running.named import Named, decide
    from bodycheck.studies.releases import printing, study

    check_engine(engine)
    if remove:
        return _remove(engine, versions, last, json)
    check_has_folder(figures, out)
    tables.check(view, printing.CHANGES)
    make_folder("--out", out)
    chosen, notices = study.chosen(engine, versions, last)
    bar = partial(shown.progress, quiet=quiet)
    if model:
        return _models(engine, chosen, notices, model, processes(jobs), bar, out, json, quiet)
    loaded = read_cases(case, robots)
    tell_left_out(loaded)
    results, tally = study.study(engine, chosen, loaded.cases, integrator, timestep, processes(jobs), bar, notices, again)
    _write(results, out, figures)
    if json:
        document = {"engine": engine, "versions": chosen, "notices": notices, "took": asdict(tally)}
        print_json(document | {"rows": results.rows, "changes": [asdict(change) for change in results.changes]})
    elif not quiet:
        printing.print_releases(results, view)
    for line in (*notices, *(() if quiet else (tally.text,))):
        print(line, file=sys.stderr)
    failed = bool(notices or results.header["unmeasured"] or loaded.faults)
    return end(decide(Named(integrator=integrator, version=chosen), results.rows, failed), out, json=json, quiet=quiet)


def _models(
    engine: str,
    versions: tuple[str, ...],
    notices: tuple[str, ...],
    models: tuple[Path, ...],
    jobs: int,
    bar: "Bar",
    out: Path | None,
    json: bool,
    quiet: bool,
) -> int:
    """Compare the robots that releases build from robot files, and report the changes from release to release."""
    from dataclasses import asdict

    from bodycheck.console import terminal
    from bodycheck.console.output import end
    from bodycheck.results import origin
    from bodycheck.running import campaign, engines
    from bodycheck.running.named import Named, decide
    from bodycheck.studies.output import Output
    from bodycheck.studies.parity import printing, releases
    from bodycheck.studies.parity.page import present
    from bodycheck.studies.parity.rows import READINGS, comparisons
    from bodycheck.studies.parity.study import Asking
    from bodycheck.studies.parity.wording import unreadable

    models_read, missing = releases.measured(engine, versions, models, Asking(), jobs, bar)
    changed = releases.changes(models_read)
    if out is not None:
        records = engines.describe([f"{engine}@{version}" for version in versions if version not in missing])[0]
        head = campaign.header(sys.argv, records, {f"{engine}@{version}": why for version, why in missing.items()})
        readings = [row for one in models_read for row in one.rows]
        Output(out).write(present(head, models_read), ((READINGS, readings),), [origin.origin(head, {})])
    if json:
        readings_as_json = [asdict(row) for one in models_read for row in one.rows]
        terminal.print_json(
            {"rows": readings_as_json, "changes": [asdict(change) for change in changed], "unmeasured": missing}
        )
    elif not quiet:
        printing.print_models(models_read)
        printing.print_changes(changed)
    printing.tell_unread(models_read, ())
    for line in (*notices, *(f"bodycheck: {engine}@{version}: {why}" for version, why in missing.items())):
        print(line, file=sys.stderr)
    answers = [row | {"version": row["engine"].partition("@")[2]} for one in models_read for row in comparisons(one.rows)]
    failed = bool(notices or missing or any(map(unreadable, models_read)))
    decision = decide(Named(version=versions), answers, failed, measured=("ok", "refused"))
    return end(decision, out, json=json, quiet=quiet)


def _write(results: "Found", out: Path | None, figures: Figures) -> None:
    """Write the tables and the report of a study into a folder; do nothing if it is None."""
    if out is None:
        return
    from bodycheck import reports
    from bodycheck.studies.releases import rows
    from bodycheck.studies.releases.page import present

    rows.write(results, out)
    reports.write_study(present({"": results}), out, figures)


def _remove(engine: str, versions: tuple[str, ...], last: int | None, json: bool) -> int:
    """Delete the environments of some releases of an engine, or of all if none is named, and print which were deleted."""
    if last is not None:
        raise BadInput("--remove cannot be combined with --last; name the versions to remove")
    from bodycheck.console import terminal
    from bodycheck.environments import environments
    from bodycheck.studies.releases import printing, study

    named = tuple(map(study.version, versions)) or tuple(study.kept(engine))
    removed = environments.remove(engine, named)
    terminal.print_json({"removed": removed}) if json else printing.print_removed(engine, removed)
    return OK


def bisect(
    engine: str,
    good: str,
    bad: str,
    /,
    *,
    case: str,
    quantity: str,
    limit: float,
    integrator: str = "",
    timestep: float | None = None,
    robots: OfRobots = AS_THEY_ARE,
    again: Again = False,
    jobs: Jobs = None,
    json: Json = False,
) -> int:
    """Find the release of an engine at which an error exceeded a limit, with as few installations as possible.

    Either of the two releases may be the newer one. Releases that cannot be installed, or that lack the integrator, are
    skipped.

    Exit codes: 0 the release was found; 1 one of the two releases could not be measured, or skipped releases leave several
    possible answers; 2 the good release is not good, the bad one is not bad, or bad usage.

    Parameters
    ----------
    engine
        The name of the engine.
    good
        A release that keeps the limit.
    bad
        A release that exceeds the limit, or in which the run fails.
    case
        The name of a shipped case, the path of a case file, or the file of a robot (URDF or MJCF).
    quantity
        A column of results, for example attitude_error.
    limit
        The largest allowed value of the quantity.
    integrator
        The method, or default or recommended. If none is named: the first one that the engine offers for the case.
    timestep
        The time step in s. Default: 0.002, or that of the alias.
    """
    from bodycheck.adapters.method import Method
    from bodycheck.console import terminal
    from bodycheck.console.arguments import check_engine, load_case, processes
    from bodycheck.studies.releases import bisection, printing

    check_engine(engine)
    loaded = load_case(case, robots)
    if timestep is None and integrator and Method.parse(integrator, 0.0).accuracy is not None:
        raise BadInput(f"{integrator}: its largest step may differ between releases; name one by --timestep")
    kept = bisection.Limit(loaded, integrator, timestep, quantity, limit)
    observer = bisection.Observer(engine, kept, processes(jobs), lambda text: print(text, file=sys.stderr), again)
    try:
        result, notice = bisection.find(engine, good, bad, observer)
    except bisection.Undecided as error:
        print(f"bodycheck: the release cannot be determined: {error}", file=sys.stderr)
        return FAILED
    if notice:
        print(notice, file=sys.stderr)
    terminal.print_json(bisection.as_json(result, observer)) if json else printing.print_bisection(result, observer)
    return FAILED if result.unknown or notice else OK


#: The commands of the study.
COMMANDS = (releases, bisect)
