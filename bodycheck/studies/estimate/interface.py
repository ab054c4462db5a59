"""`bodycheck.estimate`: estimates of the errors of engines on the file of a robot, or on a case whose truth is hidden."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

from bodycheck import conversion
from bodycheck.adapters.file_motion import Controls
from bodycheck.casefile.case import Case
from bodycheck.casefile.robots import loading
from bodycheck.console.arguments import Engines, Robots, check_engine, load_engines
from bodycheck.errors import BadInput
from bodycheck.files.temporary import temporary_folder
from bodycheck.interface import arguments
from bodycheck.interface.arguments import Names, OneCase
from bodycheck.interface.results import StudyResults, Table
from bodycheck.results import origin
from bodycheck.results.outcome import Completed
from bodycheck.robots import whole_copy
from bodycheck.running import campaign, logs
from bodycheck.running.named import Decision
from bodycheck.running.plan import check_method
from bodycheck.studies.estimate import study
from bodycheck.studies.estimate.method import ERROR
from bodycheck.studies.estimate.page import present
from bodycheck.studies.estimate.rows import CHAOTIC, MEASURED, ROWS, EstimateRow, Estimates
from bodycheck.studies.estimate.study import DURATION_S, SAMPLES, Asked
from bodycheck.studies.output import Output

#: The largest duration (s) of runs.
MAX_DURATION = 1e4


@dataclass(frozen=True)
class Wanted:
    """The options of a study.

    Attributes
    ----------
    integrators, duration, keyframe, controls, quantity, error, blind
        As the options of the command; a duration of None stands for that of the case, or 1 s.
    packages
        The folders in which packages may be found.
    """

    integrators: tuple[str, ...] = ()
    duration: float | None = None
    keyframe: str = ""
    controls: Path | None = None
    quantity: str = ""
    error: float = ERROR
    blind: bool = False
    packages: tuple[Path, ...] = ()


@dataclass(frozen=True, eq=False, repr=False)
class EstimateResults(StudyResults):
    """Estimates of errors, with intervals and verdicts.

    Attributes
    ----------
    estimates
        The question, and the rows of all engines.
    decision
        Whether every engine and method that was named has a result.
    """

    estimates: Estimates
    decision: Decision

    @property
    def rows(self) -> Sequence[EstimateRow]:
        """A row for each engine, method, time step and quantity."""
        return self.estimates.rows

    @property
    def tables(self) -> dict[str, Table]:
        """The table `estimate`. An error has the unit of its quantity."""
        return {ROWS.name: Table.of(ROWS, self.estimates.rows)}


@contextmanager
def asked(given: OneCase, wanted: Wanted) -> Iterator[Asked]:
    """Provide the question about a file or a case; the copy of a file is removed at the end of the context.

    Raises `BadInput` and `CaseFaults`.
    """
    quantities, compared = study.quantities_of(wanted.quantity)
    if not 0 < wanted.error < float("inf"):
        raise BadInput(f"--error {wanted.error:g}: must be positive and finite")
    if wanted.duration is not None and not 0 < wanted.duration <= MAX_DURATION:
        raise BadInput(f"--duration {wanted.duration:g}: must be positive, and at most {MAX_DURATION:g} s")
    if not isinstance(given, Case) and loading.is_robot(given):
        with temporary_folder() as folder:
            yield _about_file(Path(given), wanted, folder, quantities, compared)
        return
    if wanted.keyframe or wanted.controls is not None:
        option = "--keyframe" if wanted.keyframe else "--controls"
        raise BadInput(f"{option}: is for files of robots; a case states its own start and controllers")
    yield _about_case(arguments.one_case(given, Robots(wanted.packages)), wanted, quantities, compared)


def _about_file(path: Path, wanted: Wanted, folder: Path, quantities: tuple[str, ...], compared: tuple[str, ...]) -> Asked:
    if not path.exists():
        raise BadInput(f"{path}: there is no such file")
    if wanted.blind:
        raise BadInput("--blind: is for cases, whose truth is not used then; a robot's file has none")
    copy, lines = whole_copy.copied(path, wanted.packages, folder)
    digest = sha256(b"".join(one.read_bytes() for one in sorted(folder.iterdir()))).hexdigest()
    controls = None if wanted.controls is None else _controls(wanted.controls)
    return Asked(
        *(shown_name(path), wanted.duration or DURATION_S, wanted.error, quantities, compared, wanted.integrators),
        file=copy,
        keyframe=wanted.keyframe,
        controls=controls,
        samples=SAMPLES,
        identity=digest + ("" if controls is None else repr(controls.values.tolist())),
        path=path,
        packages=wanted.packages,
        lines=lines,
    )


def shown_name(path: Path) -> str:
    """Return the name of a file with that of its folder, since files of several robots often have the same name."""
    folder = path.resolve().parent.name
    return f"{folder}/{path.name}" if folder else path.name


def _about_case(case: Case, wanted: Wanted, quantities: tuple[str, ...], compared: tuple[str, ...]) -> Asked:
    if wanted.duration is not None:
        intervals = max(1, round((case.samples - 1) * wanted.duration / case.duration))
        case = replace(case, duration=wanted.duration, samples=intervals + 1)
    return Asked(
        *(case.name, case.duration, wanted.error, quantities, compared, wanted.integrators),
        case=case,
        samples=case.samples,
        blind=wanted.blind,
        identity=sha256(case.text.encode("utf-8")).hexdigest() + repr(wanted.blind),
    )


def _controls(path: Path) -> Controls:
    """Return the controls in a CSV file. Raises `BadInput` with all faults of the file."""
    columns = logs.columns_of(path, fewest=1)
    times = columns.pop(logs.TIME)
    if times[0] < 0 or (times[1:] <= times[:-1]).any():
        raise BadInput(f"{path}: the instants of the column t must be at least 0 s and ascend")
    if not columns:
        raise BadInput(f"{path}: has no columns of actuators; allowed: t, and the names of actuators")
    values = [columns[name] for name in columns]
    return Controls(times, np.stack(values, axis=-1), tuple(columns))


def carry_out(given: OneCase, wanted: Wanted, engines: Engines, command: Sequence[str], output: Output) -> EstimateResults:
    """Make a study, and write its table and its report.

    Parameters
    ----------
    given
        The file or the case.
    wanted
        The options.
    engines
        The engines.
    command
        The words of the command, for the header of the results.
    output
        The folder and the formats of the results, and the display of progress.

    Raises
    ------
    BadInput, BadJournal, CaseFaults
        As `asked` and `study.results` raise them.
    """
    with asked(given, wanted) as question:
        for spelling in () if question.case is None else wanted.integrators:  # those of a file are the engine's own words
            check_method(spelling, list(engines.records.values()))
        head = campaign.header(command, engines.records, engines.missing)
        with (
            output.work("estimating", len(engines.records)) as (folder, progress),
            study.results(question, engines.records, folder, head, progress) as estimates,
        ):
            kept = estimates if engines.named.engine else without_unsupported(estimates)
            report = present(head, kept)
            texts = {} if question.case is None else {question.case.name: question.case.text}
            output.write(report, ((ROWS, kept.rows),), [origin.origin(head, texts)])
    return EstimateResults(report, kept, engines.decided(map(_measurement, kept.rows)))


def without_unsupported(estimates: Estimates) -> Estimates:
    """Return results without the engines that cannot run the file, unless none can."""
    can = {engine: method for engine, method in estimates.present.items() if method[0]}
    if not can:
        return estimates
    return replace(estimates, present=can, rows=tuple(row for row in estimates.rows if row.engine in can))


def _measurement(row: EstimateRow) -> Mapping[str, Any]:
    """Return a row as a record with a status, which is ok for verdicts that are results."""
    is_measured = row.verdict in MEASURED or row.verdict.startswith(CHAOTIC)
    return asdict(row) | {"status": Completed.status if is_measured else row.verdict}


def estimate(
    file: OneCase,
    *,
    engine: Names = (),
    integrator: Names = (),
    duration: float | None = None,
    keyframe: str = "",
    controls: str | Path | None = None,
    quantity: str = "",
    error: float = ERROR,
    blind: bool = False,
    package_path: str | Path | Iterable[str | Path] = (),
    out: str | Path | None = None,
) -> EstimateResults:
    """Estimate the errors of engines on the file of a robot, or on a case, by runs with smaller and smaller time steps.

    This function does the same as the command `bodycheck estimate`.

    Parameters
    ----------
    file
        The path of a URDF or MJCF file, or a case as in `bodycheck.recommend`.
    engine, integrator
        The same as the parameters of `bodycheck.run`.
    duration
        The duration of the runs (s). By default, that of the case, or 1 s for a file.
    keyframe
        The keyframe of the file in which the runs start. By default, its first one.
    controls
        A CSV file with the controls of actuators: the column `t` (s), and a column for each actuator.
    quantity
        The figure whose error is estimated. By default, all that the scene has.
    error
        The error that is allowed (rad or m; relative for energy).
    blind
        Whether the truth of a case is not used.
    package_path
        The same as the parameter of `bodycheck.run`.
    out
        A folder for the table and the report. An interrupted study in it is resumed.

    Raises
    ------
    BadInput, Failed
        In the same cases as by `bodycheck.run`.
    """
    named, spellings = arguments.names("--engine", engine), arguments.names("--integrator", integrator)
    for name in named:
        check_engine(name)
    wanted = Wanted(
        integrators=spellings,
        duration=None if duration is None else conversion.number("--duration", duration),
        keyframe=conversion.name("--keyframe", keyframe) if keyframe else "",
        controls=arguments.path("--controls", controls),
        quantity=conversion.name("--quantity", quantity) if quantity else "",
        error=conversion.number("--error", error),
        blind=bool(blind),
        packages=arguments.paths("--package-path", package_path),
    )
    options: dict[str, object] = {"engine": named, "integrator": spellings, "duration": wanted.duration}
    options |= {"keyframe": keyframe, "quantity": quantity, "error": wanted.error, "blind": wanted.blind}
    command = arguments.command("estimate", (file,), **options)
    output = Output(arguments.path("--out", out))
    return carry_out(file, wanted, load_engines(named, integrators=spellings), command, output)
