"""`bodycheck.export`: a run as a script for its engine alone."""

from collections.abc import Iterable
from pathlib import Path

from bodycheck import conversion
from bodycheck.adapters.registry import EngineMissing
from bodycheck.console.arguments import check_engine, check_writable
from bodycheck.errors import BadInput
from bodycheck.files import writing
from bodycheck.interface import arguments
from bodycheck.interface.arguments import Names, OneCase
from bodycheck.running import exporting


def export(
    case: OneCase,
    *,
    engine: str,
    integrator: str | None = None,
    timestep: float | None = None,
    package_path: str | Path | Iterable[str | Path] = (),
    ignore: Names = (),
    out: str | Path | None = None,
) -> str:
    """Return a run as a Python script for the engine alone, as the command `bodycheck export` writes it.

    Parameters
    ----------
    case
        The name of a shipped case, the path of a case file, or a case that `bodycheck.load` returned.
    engine
        The engine.
    integrator
        The method, or `default` or `recommended`. If none is named, the first one that the engine offers for the case.
    timestep
        The time step (s). By default, the one that `simulate` chooses.
    package_path, ignore
        The same as the parameters of `bodycheck.run`.
    out
        A file to which the script is also written.

    Raises
    ------
    BadInput
        If the case, the engine, the method or the time step cannot be used.
    Failed
        If the engine cannot model the case, or there is no script of this method.
    """
    check_engine(name := conversion.name("--engine", engine))
    path = arguments.path("--out", out)
    check_writable("--out", path)
    method = None if integrator is None else conversion.name("--integrator", integrator)
    step = None if timestep is None else conversion.number("--timestep", timestep)
    loaded = arguments.one_case(case, arguments.robots(package_path, ignore))
    try:
        script = exporting.script(loaded, name, method, step)
    except EngineMissing as error:
        raise BadInput(str(error)) from error
    if path is not None:
        writing.write_named(path, script.encode("utf-8"))
    return script
