"""The command line. Each command imports what it needs when it runs, so that help answers at once."""

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import App, CycloptsError, Parameter

from bodycheck import arguments
from bodycheck.errors import BAD_INPUT, FAILED, INTERRUPTED, OK, BadInput
from bodycheck.options import CaseName, Engines, Figures, Integrators, Jobs, Json, JUnit, Out, Timesteps
from bodycheck.studies.commands import ablate, bisect, extremes, recommend, releases, tradeoff

if TYPE_CHECKING:
    from collections.abc import Sequence

    from bodycheck.result_set import ResultSet

app = App(
    name="bodycheck",
    help="Hold physics engines against rigid-body mechanics.",
    help_epilogue="Exit codes: 0 everything held; 1 an expectation or a run failed; 2 bad input or usage.",
    version_flags=["--version"],
    default_parameter=Parameter(negative=(), show_default=False),
)


for study in (tradeoff, recommend, extremes, ablate, releases, bisect):
    app.command(study)


@app.command
def run(
    *cases: CaseName,
    engine: Engines = (),
    integrator: Integrators = (),
    timestep: Timesteps = (),
    out: Out = None,
    figures: Figures = (),
    save: Path | None = None,
    junit: JUnit = None,
    jobs: Jobs = None,
    json: Json = False,
) -> int:
    """Run cases through engines, compare them with mechanics and report.

    Time steps are 2 ms by default, and what a case's expectations ask for. The tables are results.csv and results.parquet;
    results.json has them too, and the findings.
    In a workflow of GitHub, broken expectations are annotated in the case files, and the report is the summary of the step.

    Parameters
    ----------
    save
        A file (.parquet) for the results as a baseline, which `bodycheck diff` holds others against. Every run is made five
        times, to see what rounding does to it.
    """
    import contextlib
    import tempfile

    from bodycheck import baseline, campaign, judgement, reports, result_set, terminal
    from bodycheck.plan import plan

    for option, path in (("--save", save), ("--junit", junit)):
        arguments.check_writable(option, path)
    arguments.check_has_folder(figures, out)
    loaded = arguments.load_cases(cases)
    adapters, missing = arguments.load_engines(engine)
    tasks = plan(loaded, adapters, integrator, timestep)
    head = campaign.header(sys.argv, {name: adapter.version() for name, adapter in adapters.items()}, missing)

    with contextlib.ExitStack() as stack:
        folder = out or Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="bodycheck-")))
        with terminal.progress("running", campaign.size(tasks)) as progress:
            done = campaign.results(tasks, folder, head, arguments.processes(jobs), progress=progress)
            results = stack.enter_context(done)
        found = result_set.judged(results)
        verdicts = found.verdicts
        _write([found], out, figures, junit)
        reports.tell_github(found, arguments.files_of(loaded, cases), os.environ)
        if save is not None:
            with terminal.progress("nudging", baseline.size(verdicts)) as progress:
                baseline.save(save, results, verdicts, arguments.processes(jobs), progress)
    if json:
        terminal.print_json(judgement.records(verdicts))
    else:
        terminal.print_results(verdicts)
    return FAILED if any(verdict.passed is False for verdict in verdicts) else OK


@app.command
def report(*folders: Path, out: Path | None = None, figures: Figures = (), junit: JUnit = None) -> int:
    """Make reports again from saved results, without simulating anything: of runs or of a study, as `--out` has written them.

    Several folders of runs become one report, which says first what differs between them: those of two releases of an engine,
    of two machines, or before and after a change of a case; so do several of `bodycheck releases`. What is interrupted is
    reported as far as it went, with exit code 2.

    Parameters
    ----------
    folders
        Folders of results; what is in each is found from its files.
    out
        The folder for the report and its tables. By default that of the results, where one is given.
    """
    from bodycheck import reports, result_set
    from bodycheck.reports import saved
    from bodycheck.reports.study import StudyReport
    from bodycheck.studies import release_rows

    arguments.check_writable("--junit", junit)
    into = arguments.folder_for(folders, out)
    if all((folder / release_rows.RECORDS).is_file() for folder in folders):
        return _report_releases(folders, into, figures, junit)
    found = [saved.read(folder) for folder in folders]
    arguments.make_folder("--out", into)
    if isinstance(found[0], StudyReport) and len(found) == 1:
        if junit is not None:
            raise BadInput(f"--junit {junit}: {folders[0]} holds a study, of which nothing is expected")
        reports.write_study(found[0], into, figures)
        print(f"report: {into / 'report.html'}", file=sys.stderr)
        return OK
    sets = []
    for folder, label, one in zip(folders, result_set.labels(folders), found, strict=True):
        if isinstance(one, StudyReport):
            raise BadInput(f"{folder}: holds a study; several folders are compared in one report where all are of runs")
        with saved.undamaged(folder):
            sets.append(result_set.judged(one, label))
    _write(sets, into, figures, junit)
    if interrupted := [str(one.results.folder) for one in sets if not one.results.complete]:
        print(f"bodycheck: interrupted, and reported as far as it went: {', '.join(interrupted)}", file=sys.stderr)
        return BAD_INPUT
    return FAILED if any(verdict.passed is False for one in sets for verdict in one.verdicts) else OK


def _report_releases(folders: tuple[Path, ...], into: Path, figures: Figures, junit: Path | None) -> int:
    """One report of studies of releases, made on several machines for one."""
    from bodycheck import reports
    from bodycheck.reports.releases import present
    from bodycheck.studies import release_rows

    if junit is not None:
        raise BadInput(f"--junit {junit}: {folders[0]} holds a study, of which nothing is expected")
    found = [release_rows.read(folder) for folder in folders]
    arguments.make_folder("--out", into)
    reports.write_study(present(dict(zip(release_rows.labels(found), found, strict=True))), into, figures)
    print(f"report: {into / 'report.html'}", file=sys.stderr)
    return OK


def _write(sets: "Sequence[ResultSet]", out: Path | None, figures: Figures, junit: Path | None) -> None:
    """What is asked for of results."""
    from bodycheck import reports, result_set

    if out is not None:
        result_set.write(sets, out)
        reports.write(sets, out, figures)
        print(f"report: {out / 'report.html'}", file=sys.stderr)
    if junit is not None:
        reports.write_junit(sets, junit)


@app.command
def diff(base: Path, now: Path, /, *, json: Json = False) -> int:
    """Say what has changed between two baselines, beyond what rounding and the truth's own error explain; else say nothing.

    Exit codes: 0 nothing got worse; 1 a figure or a status got worse, or a run is gone; 2 no baselines of the same cases.
    What got better or is new is told, and what steps cost where both were made on one machine: neither fails.

    Parameters
    ----------
    base
        What `bodycheck run --save` wrote before.
    now
        What it wrote later, elsewhere, or with other versions.
    """
    from bodycheck import baseline, terminal
    from bodycheck.reports import github

    found = baseline.diff(baseline.read(base), baseline.read(now))
    if json:
        terminal.print_json(baseline.as_json(found))
    elif found.changes or found.paces:
        terminal.print_difference(found)
    if found.changes and github.is_running(os.environ):
        print(github.annotation("error" if found.worse else "notice", found.text, "bodycheck diff"), file=sys.stderr)
    return FAILED if found.worse else OK


@app.command
def truth(
    case: str,
    /,
    *,
    at: Annotated[tuple[float, ...], Parameter(consume_multiple=True)] = (),
    certify: bool = False,
    json: Json = False,
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
    """
    from bodycheck import terminal, truths
    from bodycheck.reference.integration import OutOfReach
    from bodycheck.reference.truth import NotModelled

    (loaded,) = arguments.load_cases((case,))
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
def cases(*, requires: bool = False, json: Json = False) -> int:
    """List the cases that come with bodycheck.

    Parameters
    ----------
    requires
        Show what each scene requires of a model.
    """
    from dataclasses import asdict

    from bodycheck import terminal
    from bodycheck.case import shipped
    from bodycheck.reference.requirements import requirements

    loaded = arguments.load_cases(shipped())
    if requires:
        needs = {case.name: asdict(requirements(case.scene)) for case in loaded}
        if json:
            terminal.print_json([{"name": name, **needed} for name, needed in needs.items()])
        else:
            terminal.print_requirements(needs)
    elif json:
        terminal.print_json([{"name": c.name, "title": c.title, "source": c.source, "tags": c.tags} for c in loaded])
    else:
        terminal.print_table(("case", "title", "tags"), [(c.name, c.title, ", ".join(c.tags)) for c in loaded])
    return OK


@app.command
def engines(
    *,
    check: bool = False,
    json: Json = False,
) -> int:
    """List the engines, their versions and integrators.

    Parameters
    ----------
    check
        Also run each adapter through scenes with one obvious answer; exit 1 if one is wrong.
    """
    from bodycheck import smoke, terminal

    adapters, missing = arguments.load_engines(())
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
    for case in arguments.load_cases(files):
        print(f"{case.name}: valid")
    return OK


@app.command
def new(name: str, /) -> int:
    """Write NAME.case.toml, a commented case that runs as it is, into the working directory.

    Parameters
    ----------
    name
        The name of the case: small letters, digits and hyphens.
    """
    from bodycheck import authoring

    print(authoring.new(name, Path()))
    return OK


@app.command
def schema(of: Literal["cases", "results"] = "cases", /) -> int:
    """Print the JSON Schema of case files, by which editors complete and check them, or that of results.json.

    Parameters
    ----------
    of
        What the schema is of, case files by default.
    """
    from bodycheck import authoring
    from bodycheck.reports import results_json

    print(authoring.schema() if of == "cases" else results_json.schema(), end="")
    return OK


@app.command
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
    import contextlib
    import tempfile

    from bodycheck import campaign, expectation_writer, judgement, terminal
    from bodycheck.plan import plan

    expectation_writer.check_margin(margin)
    loaded = arguments.load_cases(files)
    places = expectation_writer.places(files, loaded)
    adapters, missing = arguments.load_engines(engine)
    tasks = expectation_writer.chosen(plan(loaded, adapters, integrator, timestep), timestep)
    head = campaign.header(sys.argv, {name: adapter.version() for name, adapter in adapters.items()}, missing)
    with contextlib.ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="bodycheck-")))
        progress = stack.enter_context(terminal.progress("measuring", campaign.size(tasks)))
        results = stack.enter_context(campaign.results(tasks, folder, head, arguments.processes(jobs), progress=progress))
        changes = expectation_writer.write(results, judgement.judge(results), places, margin)
    terminal.print_changes(changes)
    return OK if all(change.done for change in changes) else FAILED


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
