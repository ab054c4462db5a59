"""The commands for authors of case files: `bodycheck validate`, `new`, `schema` and `expect`.

Each imports what it needs when it runs, so that `--help` answers at once.
"""

from pathlib import Path
from typing import TYPE_CHECKING, Literal

from bodycheck.console import arguments
from bodycheck.console.options import Engines, Integrators, Jobs, Timesteps
from bodycheck.errors import FAILED, OK, BadInput

if TYPE_CHECKING:
    pass


def validate(*files: str) -> int:
    """Check case files and show every fault: file, line, key, what was read, what is allowed.

    Parameters
    ----------
    files
        Paths of case files, or names of shipped cases.
    """
    if not files:
        raise BadInput("validate: give at least one case file")
    for case in arguments.load_cases(files):
        print(f"{case.name}: valid")
    return OK


def new(name: str, /) -> int:
    """Write NAME.case.toml, a commented case that runs as it is, into the working directory.

    Parameters
    ----------
    name
        The name of the case: small letters, digits and hyphens.
    """
    from bodycheck.casefile import authoring

    print(authoring.new(name, Path()))
    return OK


def schema(of: Literal["cases", "results"] = "cases", /) -> int:
    """Print the JSON Schema of case files, by which editors complete and check them, or that of results.json.

    Parameters
    ----------
    of
        What the schema is of, case files by default.
    """
    from bodycheck.casefile import authoring
    from bodycheck.reports.runs import results_json

    print(authoring.schema() if of == "cases" else results_json.schema(), end="")
    return OK


def expect(
    *files: str,
    margin: float = 3.0,
    engine: Engines = (),
    integrator: Integrators = (),
    timestep: Timesteps = (),
    jobs: Jobs = None,
) -> int:
    """Measure what methods give, and write it into case files as what is expected of them from now on.

    Time steps are 2 ms by default, and those of the expectations that are there.

    Parameters
    ----------
    files
        Paths of case files.
    margin
        How many times what was measured is allowed, 3 by default; the limit is rounded down to two digits.
    """
    from bodycheck.console import terminal
    from bodycheck.console.ran import Selection, ran
    from bodycheck.judging import expectation_writer, judgement

    expectation_writer.check_margin(margin)
    places = expectation_writer.places(files, arguments.load_cases(files))
    with ran(Selection(files, engine, integrator, timestep, jobs), expectation_writer.plan, None) as made:
        changes = expectation_writer.write(made.results, judgement.judge(made.results), places, margin)
    terminal.print_changes(changes)
    return OK if all(change.done for change in changes) else FAILED
