"""`bodycheck.parity`: what engines make of the files of robots, compared with what the files say."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from bodycheck import conversion
from bodycheck.console.arguments import Engines, load_engines, make_folder
from bodycheck.errors import BadInput
from bodycheck.interface import arguments
from bodycheck.interface.arguments import Names
from bodycheck.interface.results import StudyResults, Table
from bodycheck.results import origin
from bodycheck.results.header import Header
from bodycheck.running import campaign
from bodycheck.studies.output import Output
from bodycheck.studies.parity import files, study
from bodycheck.studies.parity.files import NamedFile
from bodycheck.studies.parity.page import present
from bodycheck.studies.parity.rows import READINGS, ParityRow, failed


@dataclass(frozen=True, eq=False, repr=False)
class ParityResults(StudyResults):
    """The robots that engines build from files, compared with the files.

    Attributes
    ----------
    models
        The results of each file, with its notes.
    header
        The versions, the machine and the command.
    """

    models: Sequence[study.Parity]
    header: Header

    @property
    def rows(self) -> list[ParityRow]:
        """The rows about all files and engines."""
        return [row for model in self.models for row in model.rows]

    @property
    def agrees(self) -> bool:
        """True if every engine reads every file as it is meant."""
        return not any(map(failed, self.rows))

    @property
    def tables(self) -> dict[str, Table]:
        """The table `parity`. A difference has the unit of its quantity."""
        return {READINGS.name: Table.of(READINGS, self.rows)}


def check(asks: study.Asking) -> None:
    """Raise `BadInput` for an option that has no meaning."""
    if asks.states < 1:
        raise BadInput(f"--states {asks.states}: must be at least 1")
    if not 0 < asks.tolerance < 1:
        raise BadInput(f"--tolerance {asks.tolerance}: must be greater than 0 and less than 1; it is relative")
    if not 0 <= asks.motion <= study.LONGEST_MOTION:
        raise BadInput(f"--motion {asks.motion}: must be from 0 to {study.LONGEST_MOTION:g} s")


def carry_out(
    robots: Sequence[NamedFile], engines: Engines, asks: study.Asking, command: Sequence[str], jobs: int, output: Output
) -> ParityResults:
    """Compare the files of robots, and write the table and the report unless nothing is kept.

    Parameters
    ----------
    robots
        The files.
    engines
        The engines. If the user names none, those that read no files of robots are left out.
    asks
        What is compared.
    command
        The words of the command, for the header of the results.
    jobs
        The number of processes.
    output
        The folder of the results, and the display of progress.
    """
    only_readers = not engines.named.engine
    with output.work("comparing", len(robots)) as (_, progress):
        results = tuple(study.study(engines.records, robots, asks, jobs, progress, only_readers=only_readers))
    head = campaign.header(command, engines.records, engines.missing)
    report = present(head, results)
    output.write(report, ((READINGS, [row for model in results for row in model.rows]),), [origin.origin(head, {})])
    return ParityResults(report, results, head)


def parity(
    models: str | Path | Iterable[str | Path],
    *,
    engine: Names = (),
    states: int = 100,
    seed: int = 0,
    tolerance: float = 1e-9,
    package_path: str | Path | Iterable[str | Path] = (),
    motion: float = 0.0,
    out: str | Path | None = None,
    jobs: int | None = None,
) -> ParityResults:
    """Compare what engines make of the files of robots with what the files say, as the command `bodycheck parity` does.

    Parameters
    ----------
    models
        One or several files of robots: URDF, MJCF, or cases of format 2; folders of them, and patterns.
    engine, jobs
        The same as the parameters of `bodycheck.run`. By default, all installed engines that read files of robots.
    states, seed
        The number of states at which terms are compared, and the seed of the states.
    tolerance
        The largest relative difference that counts as agreement.
    package_path
        One or several folders in which packages are found.
    motion
        A time (s): also say how far each difference takes a free motion within it.
    out
        A folder for the table and the report.

    Raises
    ------
    BadInput, Failed
        If a file, an engine or a number cannot be used; the message is the same as on the command line.
    """
    paths, packages = arguments.paths("MODEL", models), arguments.paths("--package-path", package_path)
    if not paths:
        raise BadInput("parity: give at least one file of a robot")
    asks = study.Asking(
        conversion.whole_number("--states", states),
        conversion.whole_number("--seed", seed),
        conversion.number("--tolerance", tolerance),
        packages,
        conversion.number("--motion", motion),
    )
    check(asks)
    named, processes = arguments.names("--engine", engine), arguments.jobs_of(jobs)
    output = Output(arguments.path("--out", out))
    make_folder("--out", output.folder)
    command = arguments.command(
        *("parity", tuple(map(str, paths))),
        engine=named,
        states=asks.states,
        seed=asks.seed,
        tolerance=asks.tolerance,
        motion=asks.motion,
        package_path=list(map(str, packages)),
    )
    return carry_out(files.named(paths).files, load_engines(named), asks, command, processes, output)
