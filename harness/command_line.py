"""The command line. Each command imports what it needs when it runs, so that help answers at once."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import App, CycloptsError, Parameter

from bodycheck.errors import BadInput

if TYPE_CHECKING:
    from bodycheck.adapters.contract import Adapter
    from bodycheck.case import Case

OK, FAILED, BAD_INPUT, INTERRUPTED = 0, 1, 2, 130

app = App(
    name="bodycheck",
    help="Hold physics engines against rigid-body mechanics.",
    help_epilogue="Exit codes: 0 everything held; 1 an expectation or a run failed; 2 bad input or usage.",
    version_flags=["--version"],
    default_parameter=Parameter(negative=(), show_default=False),
)


@app.command
def run(
    *cases: str,
    engine: tuple[str, ...] = (),
    integrator: tuple[str, ...] = (),
    timestep: tuple[float, ...] = (),
    out: Path | None = None,
    jobs: int | None = None,
    json: bool = False,
) -> int:
    """Run cases through engines, compare them with mechanics and report.

    Parameters
    ----------
    cases
        Names of shipped cases, or paths of case files; all shipped cases if none is given.
    engine
        An engine to run; may be given several times. All that are installed by default.
    integrator
        An integrator to run; may be given several times. All of each engine by default.
    timestep
        A time step in s; may be given several times. By default 0.002, and what a case's expectations ask for.
    out
        The folder for results.csv, results.parquet, trajectories/, report.html and report.md.
    jobs
        How many processes. By default as many as there are processors.
    json
        Print the results as JSON instead of a table.
    """
    import contextlib
    import os
    import tempfile

    from bodycheck import attribution, campaign, judgement, reports, store, terminal
    from bodycheck.plan import plan

    loaded = _load_all(cases)
    adapters, missing = _engines(engine)
    if jobs is not None and jobs < 1:
        raise BadInput(f"--jobs {jobs}: must be at least 1")
    tasks = plan(loaded, adapters, integrator, timestep)
    head = campaign.header(sys.argv, {name: adapter.version() for name, adapter in adapters.items()}, missing)

    with contextlib.ExitStack() as stack:
        folder = out or Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="bodycheck-")))
        progress = stack.enter_context(terminal.progress("running", campaign.size(tasks)))
        campaign.execute(tasks, folder, head, jobs or os.cpu_count() or 1, progress=progress)
        results = store.read(folder)
        verdicts = judgement.judge(results)
        if out is not None:
            judgement.write(verdicts, folder)
            if parts := attribution.attribute(results, verdicts):
                attribution.write(parts, folder)
            reports.write(results, verdicts, folder, parts)
    if json:
        terminal.print_json(judgement.records(verdicts))
    else:
        terminal.print_results(verdicts)
    if out is not None:
        print(f"report: {folder / 'report.html'}", file=sys.stderr)
    return FAILED if any(verdict.passed is False for verdict in verdicts) else OK


@app.command
def truth(
    case: str,
    /,
    *,
    at: Annotated[tuple[float, ...], Parameter(consume_multiple=True)] = (),
    certify: bool = False,
    json: bool = False,
) -> int:
    """Print the reference trajectory of a case and the bound of its error.

    Parameters
    ----------
    case
        The name of a shipped case, or the path of a case file.
    at
        Instants in s, in any order; the case's own by default.
    certify
        Also run every other way to the truth, 128-bit arithmetic among them, and print how far they are apart.
    json
        Print one JSON object with all instants.
    """
    from bodycheck import terminal, truths
    from bodycheck.reference.integration import OutOfReach
    from bodycheck.reference.truth import NotModelled

    (loaded,) = _load_all((case,))
    if not all(0 <= instant < float("inf") for instant in at):
        raise BadInput("--at: instants must be finite and at least 0 s")
    times = sorted(at) or None
    try:
        certificate = truths.certify(loaded, times) if certify else None
        found = certificate.truth if certificate else truths.truth(loaded, times)
    except NotModelled as error:
        print(f"{loaded.name}: unsupported: the reference does not model {error}", file=sys.stderr)
        return FAILED
    except OutOfReach as error:
        print(f"{loaded.name}: the reference cannot follow this motion: {error}", file=sys.stderr)
        return FAILED
    if json:
        terminal.print_json(truths.as_json(loaded, found) | (truths.certificate_as_json(certificate) if certificate else {}))
    else:
        terminal.print_truth(found, most_rows=len(at) or 11)
        if certificate:
            terminal.print_certificate(certificate)
    return OK


@app.command
def cases(*, json: bool = False) -> int:
    """List the cases that come with bodycheck.

    Parameters
    ----------
    json
        Print as JSON.
    """
    from bodycheck import terminal
    from bodycheck.case import shipped

    loaded = _load_all(shipped())
    if json:
        terminal.print_json([{"name": c.name, "title": c.title, "source": c.source, "tags": c.tags} for c in loaded])
    else:
        terminal.print_table(("case", "title", "tags"), [(c.name, c.title, ", ".join(c.tags)) for c in loaded])
    return OK


@app.command
def engines(
    *,
    check: bool = False,
    json: bool = False,
) -> int:
    """List the engines, their versions and integrators.

    Parameters
    ----------
    check
        Also run each adapter through scenes with one obvious answer; exit 1 if one is wrong.
    json
        Print as JSON.
    """
    from bodycheck import smoke, terminal

    adapters, missing = _engines(())
    faults = {name: smoke.check(name) for name in adapters} if check else {}
    if json:
        checked: dict[str, dict[str, list[str]]] = {name: {"faults": found} for name, found in faults.items()}
        terminal.print_json(
            [
                {"name": name, "version": adapter.version(), "integrators": adapter.integrators(), **checked.get(name, {})}
                for name, adapter in adapters.items()
            ]
            + [{"name": name, "missing": why} for name, why in missing.items()]
        )
    else:
        rows = [(name, adapter.version(), ", ".join(adapter.integrators())) for name, adapter in adapters.items()]
        terminal.print_table(("engine", "version", "integrators"), rows + [(name, "-", why) for name, why in missing.items()])
        for name, found in faults.items():
            print("\n".join(found) if found else f"{name}: the adapter does what is obvious")
    return FAILED if any(faults.values()) else OK


@app.command
def validate(*files: str) -> int:
    """Check case files and show every fault: file, line, key, what was read, what is allowed.

    Parameters
    ----------
    files
        Paths of case files, or names of shipped cases.
    """
    if not files:
        raise BadInput("validate: give at least one case file")
    for case in _load_all(files):
        print(f"{case.name}: valid")
    return OK


def _load_all(names: "tuple[str, ...]") -> "list[Case]":
    """The named cases, or all shipped ones. Raises `CaseFaults` with the faults of all files together."""
    from bodycheck.case import CaseFaults, Fault, load, shipped

    loaded: dict[str, Case] = {}
    faults: list[Fault] = []
    for name in dict.fromkeys(names or shipped()):
        try:
            case = load(name)
        except CaseFaults as error:
            faults += error.faults
            continue
        if case.name in loaded:
            faults.append(Fault(name, f"another case that was given has the name {case.name!r} too"))
        loaded[case.name] = case
    if faults:
        raise CaseFaults(tuple(faults))
    return list(loaded.values())


def _engines(names: tuple[str, ...]) -> "tuple[dict[str, Adapter], dict[str, str]]":
    """The named adapters, or all, and why others cannot be used; a named one that is missing is bad usage."""
    from bodycheck.adapters import registry

    adapters: dict[str, Adapter] = {}
    missing: dict[str, str] = {}
    for name in dict.fromkeys(names or registry.names()):
        try:
            adapters[name] = registry.load(name)
        except registry.EngineMissing as error:
            if names:
                raise BadInput(str(error)) from error
            missing[name] = str(error)
            print(f"bodycheck: {error}; going on without it", file=sys.stderr)
    if not adapters:
        raise BadInput("no engine can be used")
    return adapters, missing


def main() -> None:
    """The entry point of the command `bodycheck`."""
    try:
        code = app(exit_on_error=False, print_error=False, result_action="return_value")
    except (CycloptsError, BadInput) as error:
        print(error, file=sys.stderr)
        code = BAD_INPUT
    except KeyboardInterrupt:
        print("bodycheck: interrupted", file=sys.stderr)
        code = INTERRUPTED
    sys.exit(code)
