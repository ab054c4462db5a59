"""The commands about case files: `bodycheck cases`, `validate`, `new`, `schema` and `expect`.

The imports are inside the functions, so that `--help` answers at once.
"""

import shlex
import sys
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from bodycheck.console import arguments
from bodycheck.console.arguments import AS_THEY_ARE
from bodycheck.console.options import AS_USUAL, Engines, Integrators, Jobs, Json, OfRobots, Quiet, Timesteps, Viewed
from bodycheck.errors import FAILED, OK, BadInput


def cases(*, requires: bool = False, json: Json = False, view: Viewed = AS_USUAL) -> int:
    """List the cases that come with bodycheck.

    Parameters
    ----------
    requires
        Also print which properties a model needs to represent each scene exactly.
    """
    from bodycheck.casefile.case import shipped
    from bodycheck.console import tables, terminal
    from bodycheck.reference.requirements import COLUMNS, as_row

    if not requires:
        tables.check(view, terminal.CASES)
    loaded = arguments.load_cases(shipped())
    if requires:
        tables.check(view, terminal.requirement_columns(COLUMNS))
        needs = {case.name: as_row(case.scene) for case in loaded}
        if json:
            terminal.print_json([{"name": name, **needed} for name, needed in needs.items()])
        else:
            shown = [name for name in COLUMNS if any(name in row for row in needs.values())]
            terminal.print_requirements({case: dict.fromkeys(shown, False) | row for case, row in needs.items()}, view)
    elif json:
        terminal.print_json([{"name": c.name, "title": c.title, "source": c.source, "tags": c.tags} for c in loaded])
    else:
        tables.show(terminal.CASES, loaded, view)
    return OK


def validate(*files: str, robots: OfRobots = AS_THEY_ARE) -> int:
    """Check case files and files of robots, and print every fault with its file and line, what was read and what is allowed.

    Exit codes: 0 all files are valid; 1 some are valid; 2 none is valid.

    Parameters
    ----------
    files
        Case files, files of robots (URDF or MJCF), folders of them, patterns, or names of shipped cases.
    """
    from bodycheck.running import robot_notices

    if not files:
        raise BadInput("validate: give at least one case file")
    loaded = arguments.read_cases(files, robots)
    for case in loaded.cases:
        print(f"{case.name}: valid")
        if case.robot is not None:
            said = [*robot_notices.left_out(case.robot), *case.robot.notices]
            print(f"  {case.robot.file}: {robot_notices.described(case)}", *said, sep="\n  ")
    for fault in loaded.faults:
        print(fault, file=sys.stderr)
    return FAILED if loaded.faults else OK


def new(
    name: str | None = None,
    /,
    *,
    source: Annotated[Path | None, Parameter(name="--from")] = None,
    body: str | None = None,
    mechanism: bool = False,
    model: Path | None = None,
    robots: OfRobots = AS_THEY_ARE,
) -> int:
    """Write a new case file, NAME.case.toml, into the working directory.

    The file contains comments that explain every key, and runs without changes.

    Parameters
    ----------
    name
        The name of the case. It may contain small letters, digits and hyphens. With --from, the default is that of the body.
    source
        A robot model, URDF or MJCF, of which one body is taken: mass, inertia, and a shape about the centre of mass. Comments
        say where each number is from. Files that it names, such as meshes, are not opened.
    body
        The name of the body in the robot model. Default: the only one.
    mechanism
        Write a case of bodies on joints, and not of one body.
    model
        The file of a robot, URDF or MJCF, in this folder: write a case that names it, with the initial states of all joints.
        The default name is that of the file.
    """
    from bodycheck.casefile import authoring

    if sum((source is not None, mechanism, model is not None)) > 1:
        raise BadInput("new: --from, --mechanism and --model exclude each other; a case of a whole robot is written by --model")
    if model is not None:
        if body is not None:
            raise BadInput(f"new --body {body}: needs --from; --model takes the whole robot")
        print(authoring.new_of_model(name, Path(), model, robots.package_path, robots.ignore))
        return OK
    if source is not None:
        path, left_out = authoring.new_of_robot(name, Path(), source, body)
        if left_out:
            print(f"bodycheck: a case has one body; left out: {left_out}", file=sys.stderr)
        print(path)
        return OK
    if name is None or body is not None:
        raise BadInput("new: give a name" if name is None else "new --body: needs --from, the robot model of the body")
    print(authoring.new(name, Path(), mechanism=mechanism))
    return OK


def schema(of: Literal["cases", "results"] = "cases", /, *, draft: Literal["2020-12", "07"] = "2020-12") -> int:
    """Print the JSON Schema of case files or of results.json.

    Editors use the schema of case files to complete keys and to mark faults.

    Parameters
    ----------
    of
        Which schema to print: cases (the default) or results.
    draft
        The draft of JSON Schema: 2020-12 (the default), or for case files 07, which some editors and catalogues need.
    """
    from bodycheck.casefile import authoring
    from bodycheck.reports.runs import results_json

    if draft == "07":
        if of == "results":
            raise BadInput("schema results --draft 07: read 07; allowed: 2020-12; only the schema of cases has both drafts")
        print(authoring.draft_07(), end="")
    else:
        print(authoring.schema() if of == "cases" else results_json.schema(), end="")
    return OK


def expect(
    *files: str,
    margin: float = 3.0,
    figure: tuple[str, ...] = (),
    engine: Engines = (),
    integrator: Integrators = (),
    timestep: Timesteps = (),
    jobs: Jobs = None,
    view: Viewed = AS_USUAL,
    quiet: Quiet = False,
) -> int:
    """Run cases, and write the measured errors, times a margin, into the case files as expectations.

    Existing expectations of the same engine and method are updated, with the version of the engine. The default time steps are
    2 ms and those of the existing expectations. A limit that no run could exceed is not written. Exit codes: 0 all expectations
    were written; 1 some could not be written.

    Parameters
    ----------
    files
        Case files, folders of them, or patterns.
    margin
        The limit divided by the measured value. The default is 3. Limits are rounded down to two digits.
    figure
        A figure to limit, for example attitude_error. May be given several times. Default: all figures in new expectations, and
        those that the existing ones limit.
    """
    from bodycheck.casefile.robots import loading
    from bodycheck.console import tables, terminal
    from bodycheck.console.output import end
    from bodycheck.console.ran import Selection, ran
    from bodycheck.judging import expectation_writer, judgement

    expectation_writer.check_margin(margin)
    tables.check(view, terminal.WRITTEN)
    expectation_writer.check_figures(figure)
    names = arguments.case_names(files) if files else ()
    if robots := [name for name in names if loading.is_robot(name)]:
        raise BadInput(
            f"{robots[0]}: is the file of a robot, which has no place for expectations; write a case of it: "
            f"bodycheck new NAME --model {shlex.quote(robots[0])}"
        )
    places = expectation_writer.places(names, arguments.load_cases(names) if names else ())
    with ran(Selection(names, engine, integrator, timestep, jobs), expectation_writer.plan, None, quiet) as runs:
        changes = expectation_writer.write(runs.results, judgement.judge(runs.results), places, margin, figure)
    terminal.print_changes([change for change in changes if not quiet or not change.done], view)
    written = [change.verdict.row() | {"passed": change.done} for change in changes]  # a status is written too
    return end(runs.decided(written, failed=not all(change.done for change in changes)), None, quiet=quiet)
