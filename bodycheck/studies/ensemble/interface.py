"""`bodycheck.ensemble`: how often methods fail over many members of a case, and how their errors are distributed."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from bodycheck import conversion
from bodycheck.casefile.content import Case
from bodycheck.console.arguments import Engines, load_engines
from bodycheck.console.progress import progress
from bodycheck.interface import arguments
from bodycheck.interface.arguments import Names, Numbers, OneCase
from bodycheck.interface.results import StudyResults, Table
from bodycheck.running.members.executors import Executor
from bodycheck.running.members.executors.own import Own
from bodycheck.studies.ensemble import header, study
from bodycheck.studies.ensemble.drawing import members as drawing
from bodycheck.studies.ensemble.drawing.members import Source
from bodycheck.studies.ensemble.report import page, publishing, reporting
from bodycheck.studies.ensemble.report.reporting import Made
from bodycheck.studies.ensemble.rows import DEPENDENCES, ROWS, DependenceRow, Row
from bodycheck.studies.output import Output


@dataclass(frozen=True, eq=False, repr=False)
class EnsembleResults(StudyResults):
    """The distributions of the errors of methods over the members of an ensemble, and how often methods fail.

    Attributes
    ----------
    analysed
        The analysis of the runs, and its findings.
    """

    analysed: Made

    @property
    def rows(self) -> Sequence[Row]:
        """A row for each method and figure."""
        return self.analysed.analysis.aggregates.rows()

    @property
    def sensitivity(self) -> Sequence[DependenceRow]:
        """The dependence of figures on drawn numbers."""
        return self.analysed.analysis.dependence_rows()

    @property
    def passed(self) -> bool:
        """True if no member breaks an expectation of the case."""
        return not self.analysed.broken

    @property
    def tables(self) -> dict[str, Table]:
        """The tables `ensemble` and `sensitivity`."""
        return {ROWS.name: Table.of(ROWS, self.rows), DEPENDENCES.name: Table.of(DEPENDENCES, self.sensitivity)}


def carry_out(
    case: Case,
    source: Source,
    engines: Engines,
    methods: tuple[Sequence[str], Sequence[float]],
    executor: Executor,
    command: Sequence[str],
    output: Output,
) -> EnsembleResults | None:
    """Run an ensemble, and write its tables, its worst members and its report unless nothing is kept.

    Parameters
    ----------
    case, source
        The case, and the source of the members.
    engines
        The engines.
    methods
        Spellings of methods and time steps (s).
    executor
        The executor of the chunks. If it carries out only a share of them, there are no results yet, and None is returned.
    command
        The words of the command, for the header of the results.
    output
        The folder and the formats of the results, and the display of progress. An interrupted ensemble in it is resumed.
    """
    shares = study.planned(case, engines.records, *methods)
    engines.check_planned([case], ((share.engine, method) for share in shares for method in share.methods))
    with output.work("running", study.size(source, shares)) as (folder, advance):
        run = partial(study.run, command=command, missing=engines.missing)
        folder = run(case, source, engines.records, *methods, folder, executor, advance)
        if not executor.whole:
            return None
        head = header.read(folder)
        analysed = reporting.read(folder, case, head)
    if output.folder is None:
        return EnsembleResults(page.present(reporting.material(case, head, analysed.analysis)), analysed)
    text_of, jobs = partial(drawing.text, case, source), study.executor_jobs(executor)
    with progress("worst members", analysed.worst, output.quiet) as advance:
        report = publishing.write(analysed, folder, case, head, text_of, jobs, advance, output.figures)
    return EnsembleResults(report, analysed)


def ensemble(
    case: OneCase,
    *,
    members: int | None = None,
    engine: Names = (),
    integrator: Names = (),
    timestep: Numbers = (),
    from_: str | Path | None = None,
    package_path: str | Path | Iterable[str | Path] = (),
    ignore: Names = (),
    out: str | Path | None = None,
    jobs: int | None = None,
) -> EnsembleResults:
    """Run many members drawn from a case, and find how often methods fail, as the command `bodycheck ensemble` does.

    Parameters
    ----------
    case
        The name of a shipped case, the path of a case file, or what `bodycheck.load` returned. It has a table [ensemble].
    members
        The number of members. By default, that of the case, or all of the table.
    engine, integrator, timestep, jobs
        The same as the parameters of `bodycheck.run`.
    from_
        A table (.parquet or .csv) with a row for each member, in place of [ensemble] in the case.
    package_path, ignore
        The same as the parameters of `bodycheck.run`.
    out
        A folder for the runs, the tables, the worst members as case files, and the report. An interrupted ensemble in it is
        resumed.

    Raises
    ------
    BadInput, Failed
        In the same cases as by `bodycheck.run`, and `BadInput` for a case without a table [ensemble].
    """
    loaded = arguments.one_case(case, read := arguments.robots(package_path, ignore))
    size = None if members is None else conversion.whole_number("--members", members)
    methods = arguments.names("--integrator", integrator), arguments.numbers("--timestep", timestep)
    named, table = arguments.names("--engine", engine), arguments.path("--from", from_)
    processes, folder = arguments.jobs_of(jobs), arguments.path("--out", out)
    source = drawing.drawn(loaded, size) if table is None else drawing.tabled(loaded, table, size)
    drawing.check(loaded, source)
    command = arguments.command(
        "ensemble",
        (case,),
        members=size,
        engine=named,
        integrator=methods[0],
        timestep=methods[1],
        from_=table,
        **arguments.of_robots(read),
    )
    results = carry_out(
        loaded, source, load_engines(named, integrators=methods[0]), methods, Own(processes), command, Output(folder)
    )
    assert results is not None  # the executor carries out all chunks
    return results
