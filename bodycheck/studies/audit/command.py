"""The command `bodycheck audit`.

Its imports are inside the function, so that `--help` answers at once.
"""

import sys
from typing import Annotated

from cyclopts import Parameter

from bodycheck.console.options import AS_USUAL, Integrators, Jobs, Json, Out, Quiet, Viewed


def audit(
    *engines: Annotated[str, Parameter(help="Engines to audit. Default: all installed engines.")],
    integrator: Integrators = (),
    timestep: Annotated[float | None, Parameter(help="The time step in s. Default: 0.002, or that of the alias.")] = None,
    long: bool = False,
    out: Out = None,
    jobs: Jobs = None,
    json: Json = False,
    table: bool = False,
    view: Viewed = AS_USUAL,
    quiet: Quiet = False,
) -> int:
    """Find by short flights what engines do that mechanics does not have, such as damping, limits or a sleeping body.

    Each probe is a flight with one obvious answer, so that nothing is taken from documentation. What an engine does by its
    own settings is called a default. The tables are audit.csv and classes.csv. An interrupted audit resumes when it is run
    again with the same --out.

    Exit codes: 0 every probe gave an answer, whatever was found; 1 a probe
    crashed, or no probe of a named engine or method gave an answer; 2 bad
    input or usage.

    Parameters
    ----------
    long
        Also take ten million steps with the default method of each engine, or as many as it takes in three minutes.
    table
        Print the table of all properties of all methods after the findings. --columns, --sort and --wide do so too.
    """
    from dataclasses import asdict

    from bodycheck.console import tables, terminal
    from bodycheck.console.arguments import load_engines, processes
    from bodycheck.console.output import end, tell
    from bodycheck.studies.audit import printing, study
    from bodycheck.studies.audit.interface import carry_out
    from bodycheck.studies.audit.rows import ANSWERED
    from bodycheck.studies.output import Output

    tables.check(view, printing.ROWS)
    loaded = load_engines(engines, integrators=integrator)
    planned = study.prepare(loaded.records, integrator, timestep, long=long)
    results = carry_out(planned, loaded, sys.argv, processes(jobs), Output(out, quiet=quiet))
    if json:
        terminal.print_json([asdict(row) for row in results.rows])
    elif not quiet:
        printing.print_findings(results.rows, results.facts)
        if table or view != AS_USUAL:
            printing.print_rows(results.rows, view)
        printing.print_classes(results.classes)
        tell(printing.summary(results.rows))
    for fault in results.faults:
        print(f"bodycheck: {fault.text}", file=sys.stderr)
    answers = [asdict(row) | {"reason": row.probe} for row in results.rows]
    decision = loaded.decided(answers, failed=bool(results.faults), measured=ANSWERED)
    return end(decision, out, json=json, quiet=quiet)


#: The commands of the study.
COMMANDS = (audit,)
