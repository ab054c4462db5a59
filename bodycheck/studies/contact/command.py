"""The command `bodycheck contact`.

Its imports are inside the function, so that `--help` answers at once.
"""

from typing import Annotated

from cyclopts import Parameter

from bodycheck.console.options import AS_USUAL, Integrators, Jobs, Json, Out, Quiet, Timesteps, Viewed


def contact(
    *engines: Annotated[str, Parameter(help="Engines. Default: all that are installed.")],
    case: Annotated[
        tuple[str, ...], Parameter(help="A case. May be given several times. Default: the shipped cases of contact.")
    ] = (),
    integrator: Annotated[
        Integrators, Parameter(help="A method to try besides those that the engine offers. May be given several times.")
    ] = (),
    timestep: Timesteps = (),
    out: Out = None,
    jobs: Jobs = None,
    json: Json = False,
    view: Viewed = AS_USUAL,
    quiet: Quiet = False,
) -> int:
    """Show how bodies roll, bounce, rest and tip in an engine: at its defaults, and at the best settings found.

    Each scene of contact has a truth. It is run with the default method of the engine, and with every method that it offers, at
    the time step of the default method and at a quarter of it. For each figure the sheet has the value at the defaults, and the
    smallest with the method that has it. The table is contact.csv.
    """
    from dataclasses import asdict

    from bodycheck.console import tables, terminal
    from bodycheck.console.output import end
    from bodycheck.console.ran import Selection, ran
    from bodycheck.judging.judgement import Compared
    from bodycheck.studies.contact import printing, sheet, study
    from bodycheck.studies.contact.interface import carry_out
    from bodycheck.studies.output import Output

    tables.check(view, printing.LINES)
    selection = Selection(case or sheet.scenes(), engines, integrator, timestep, jobs)
    compared = Compared()
    results = carry_out(ran(selection, study.plan, out, quiet, compared.meet), compared, Output(out))
    if json:
        terminal.print_json([asdict(row) for row in results.rows])
    elif not quiet:
        printing.print_sheet(results.rows, view)
    return end(results.decision, out, json=json, quiet=quiet)


#: The commands of the study.
COMMANDS = (contact,)
