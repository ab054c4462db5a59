"""The command `bodycheck extremes`.

Its imports are inside the function, so that `--help` answers at once.
"""

import sys
from contextlib import ExitStack

from bodycheck.console.options import AS_USUAL, CaseName, Engines, Figures, Integrators, Jobs, Json, Out, Quiet, Viewed
from bodycheck.errors import FAILED, OK


def extremes(
    *cases: CaseName,
    engine: Engines = (),
    integrator: Integrators = (),
    out: Out = None,
    figures: Figures = (),
    jobs: Jobs = None,
    json: Json = False,
    view: Viewed = AS_USUAL,
    quiet: Quiet = False,
) -> int:
    """Push cases and methods to extreme values, and report where and how the methods fail.

    By default, all shipped cases with a table [extremes] are run. The tables are extremes.csv and limits.csv. An interrupted
    study resumes when it is run again with the same --out.
    """
    from dataclasses import asdict

    from bodycheck import reports
    from bodycheck.console import tables, terminal
    from bodycheck.console.arguments import check_has_folder, load_cases, load_engines, processes
    from bodycheck.console.output import say_where
    from bodycheck.files.temporary import temporary_folder
    from bodycheck.results import origin
    from bodycheck.running import campaign
    from bodycheck.studies.extremes import printing, study
    from bodycheck.studies.extremes.page import present

    check_has_folder(figures, out)
    tables.check(view, printing.RUNS, printing.LIMITS)
    loaded = [case for case in load_cases(cases) if cases or case.extremes]
    engines = load_engines(engine)
    planned = study.prepare(loaded, engines.records, integrator)
    head = campaign.header(sys.argv, engines.records, engines.missing)
    with ExitStack() as stack:
        folder = out or stack.enter_context(temporary_folder())
        progress = stack.enter_context(terminal.progress("pushing", planned.size, quiet))
        rows, limits = stack.enter_context(study.results(planned, folder, head, processes(jobs), progress))
        if out is not None:
            study.write(rows, limits, out, [origin.origin(head, {case.name: case.text for case in loaded})])
            reports.write_study(present(head, rows, limits), out, figures)
    if json:
        terminal.print_json({"rows": [asdict(row) for row in rows], "limits": [asdict(limit) for limit in limits]})
    elif not quiet:
        printing.print_extremes(rows, limits, view)
    say_where(out, quiet)
    return FAILED if engines.failed(loaded) else OK
