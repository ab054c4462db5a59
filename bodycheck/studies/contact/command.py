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
        Integrators, Parameter(help="A method at which the search also begins. May be given several times.")
    ] = (),
    timestep: Timesteps = (),
    out: Out = None,
    jobs: Jobs = None,
    json: Json = False,
    view: Viewed = AS_USUAL,
    quiet: Quiet = False,
) -> int:
    """Show how bodies roll, bounce, rest and tip in an engine: at its defaults, as recommended, and at the best settings.

    Each scene of contact has a truth. It is run with the default method of the engine, with the method that its documentation
    recommends, and with the best one that a search finds: it changes the integrator, the options and the time step of these
    methods, and keeps what makes the errors of the position smaller in a few short scenes. Probes tell which contacts these
    methods have: restitution, depth, friction, sleeping. The tables are contact.csv, contact_settings.csv and
    contact_properties.csv. An interrupted study resumes when it is run again with the same --out.
    """
    from dataclasses import asdict

    from bodycheck.console import tables, terminal
    from bodycheck.console.output import end
    from bodycheck.console.ran import Selection, ran
    from bodycheck.judging.judgement import Compared
    from bodycheck.studies.contact import printing, sheet, study
    from bodycheck.studies.contact.interface import carry_out
    from bodycheck.studies.output import Output

    tables.check(view, *printing.TABLES)
    selection = Selection(case or sheet.scenes(), engines, integrator, timestep, jobs)
    compared = Compared()
    running = ran(selection, study.plan, out, quiet, compared.meet)
    results = carry_out(running, selection, compared, Output(out, quiet=quiet))
    if json:
        terminal.print_json([asdict(row) for row in results.rows])
    elif not quiet:
        printing.print_sheet(results, view)
    return end(results.decision, out, json=json, quiet=quiet)


#: The commands of the study.
COMMANDS = (contact,)
