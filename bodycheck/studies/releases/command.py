"""The commands `bodycheck releases` and `bodycheck bisect`.

Each imports what it needs when it runs, so that `--help` answers at once.
"""

import sys
from typing import Annotated

from cyclopts import Parameter

from bodycheck.console.options import Figures, Integrators, Jobs, Json, Out, Timesteps
from bodycheck.errors import FAILED, OK, BadInput


def releases(
    engine: str,
    /,
    *versions: str,
    case: Annotated[
        tuple[str, ...],
        Parameter(help="A shipped case or the path of a case file; may be given several times. By default all shipped cases."),
    ] = (),
    integrator: Integrators = (),
    timestep: Timesteps = (),
    last: int | None = None,
    out: Out = None,
    figures: Figures = (),
    remove: bool = False,
    jobs: Jobs = None,
    json: Json = False,
) -> int:
    """Say what an upgrade of an engine changed: the same cases and methods in each of its releases, held against one another.

    Each release has an environment of its own, which is kept, and so is what was measured in it. Time steps are as in `run`.
    The tables are releases.csv and changes.csv. Exit codes: 0 every release was measured, whatever changed; 1 one was not.

    Parameters
    ----------
    engine
        The engine.
    versions
        Releases of it.
    last
        So many of its newest releases, besides those that are named.
    remove
        Instead of all this, delete the environments of the versions that are named; of all where none is.
    """
    from dataclasses import asdict

    from bodycheck import reports
    from bodycheck.console import terminal
    from bodycheck.console.arguments import check_engine, check_has_folder, load_cases, make_folder, processes
    from bodycheck.environments import environments
    from bodycheck.studies.releases import printing, study
    from bodycheck.studies.releases import rows as release_rows
    from bodycheck.studies.releases.page import present

    check_engine(engine)
    if remove:
        if last is not None:
            raise BadInput("--remove goes with versions, not with --last")
        named = tuple(map(study.version, versions)) or tuple(study.kept(engine))
        removed = environments.remove(engine, named)
        terminal.print_json({"removed": removed}) if json else printing.print_removed(engine, removed)
        return OK
    check_has_folder(figures, out)
    make_folder("--out", out)
    loaded = load_cases(case)
    chosen, notices = study.chosen(engine, versions, last)
    found, tally = study.study(engine, chosen, loaded, integrator, timestep, processes(jobs), terminal.progress, notices)
    if out is not None:
        release_rows.write(found, out)
        reports.write_study(present({"": found}), out, figures)
    if json:
        document = {"engine": engine, "versions": chosen, "notices": notices, "took": asdict(tally)}
        terminal.print_json(document | {"rows": found.rows, "changes": [asdict(change) for change in found.changes]})
    else:
        printing.print_releases(found)
    for line in (*notices, tally.text, *(() if out is None else (f"report: {out / 'report.html'}",))):
        print(line, file=sys.stderr)
    return FAILED if notices or found.header["unmeasured"] else OK


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
    jobs: Jobs = None,
    json: Json = False,
) -> int:
    """Find the release of an engine at which a figure broke a limit, with as few releases installed as possible.

    Either of the two releases may be the newer one. Releases that cannot be installed, or that lack the integrator, are stepped
    around. Exit codes: 0 found; 1 one of the two cannot be told, or releases beside the one that was found; 2 the one that is
    to be good is not, or the one that is to be bad is not bad, and bad usage.

    Parameters
    ----------
    engine
        The engine.
    good
        A release that keeps the limit.
    bad
        A release that breaks it; a run that fails breaks it too.
    case
        The name of a shipped case, or the path of a case file.
    quantity
        A column of results, attitude_error for one.
    limit
        The most that the figure may be.
    integrator
        The integrator. By default the first of the engine.
    timestep
        The time step in s, 0.002 by default.
    """
    from dataclasses import asdict

    from bodycheck.adapters.method import DEFAULT_TIMESTEP
    from bodycheck.console import terminal
    from bodycheck.console.arguments import check_engine, load_cases, processes
    from bodycheck.studies.releases import bisection, printing

    check_engine(engine)
    (loaded,) = load_cases((case,))
    kept = bisection.Limit(loaded, integrator, timestep or DEFAULT_TIMESTEP, quantity, limit)
    observer = bisection.Observer(engine, kept, processes(jobs), lambda text: print(text, file=sys.stderr))
    try:
        found, notice = bisection.find(engine, good, bad, observer)
    except bisection.Undecided as error:
        print(f"bodycheck: cannot be told: {error}", file=sys.stderr)
        return FAILED
    if notice:
        print(notice, file=sys.stderr)
    if json:
        looks = [asdict(look) for look in observer.looks.values()]
        where = {"case": loaded.name, "integrator": observer.limit.integrator, "timestep": kept.timestep}
        what = {"quantity": quantity, "limit": limit, **asdict(found), "looks": looks, "made": observer.made}
        terminal.print_json(where | what)
    else:
        printing.print_bisection(found, observer)
    return FAILED if found.unknown or notice else OK
