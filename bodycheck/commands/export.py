"""The command `bodycheck export`.

Its imports are inside the function, so that `--help` answers at once.
"""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from bodycheck.console import arguments
from bodycheck.errors import OK, BadInput


def export(
    case: str,
    /,
    *,
    engine: str,
    integrator: str | None = None,
    timestep: Annotated[float | None, Parameter(help="The time step in s. Default: 0.002.")] = None,
    out: Path | None = None,
) -> int:
    """Write what a run does as a Python script for the engine alone.

    The script builds the same model, takes the same steps and prints the same states, to the last bit, without bodycheck, so
    that a finding can be shown to the authors of the engine. A script for MuJoCo contains the model as MJCF. Exit codes: 1 the
    engine cannot model the case, or there is no script of this method; 2 bad input.

    Parameters
    ----------
    case
        The name of a shipped case, or the path of a case file.
    engine
        The engine.
    integrator
        The integrator. Default: the first one that the engine offers for the case.
    out
        The file for the script. Default: standard output.
    """
    from bodycheck.adapters.method import DEFAULT_TIMESTEP
    from bodycheck.adapters.registry import EngineMissing
    from bodycheck.files import writing
    from bodycheck.running import exporting

    arguments.check_engine(engine)
    arguments.check_writable("--out", out)
    loaded = arguments.load_case(case)
    try:
        script = exporting.script(loaded, engine, integrator, DEFAULT_TIMESTEP if timestep is None else timestep)
    except EngineMissing as error:
        raise BadInput(str(error)) from error
    if out is None:
        print(script, end="")
    else:
        writing.write_named(out, script.encode("utf-8"))
        print(out)
    return OK
