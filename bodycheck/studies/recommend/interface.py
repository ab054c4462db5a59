"""`bodycheck.recommend`: the cheapest method that keeps its error within a limit, and its largest such time step."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from bodycheck import conversion
from bodycheck.console.arguments import Engines, load_engines
from bodycheck.console.robots import noticed
from bodycheck.interface import arguments
from bodycheck.interface.arguments import Names, OneCase
from bodycheck.interface.results import StudyResults, Table
from bodycheck.results import origin, store
from bodycheck.running import campaign
from bodycheck.studies.output import Output
from bodycheck.studies.recommend import study
from bodycheck.studies.recommend.page import present
from bodycheck.studies.recommend.rows import ANSWERS, STEPS, Answer, Recommendation


@dataclass(frozen=True, eq=False, repr=False)
class RecommendResults(StudyResults):
    """The methods that keep an error within a limit, each with the largest time step at which it does.

    Attributes
    ----------
    found
        The question, an answer for each method, and all measured time steps.
    """

    found: Recommendation

    @property
    def best(self) -> Answer | None:
        """The answer for the cheapest method that keeps the limit; None if no method does."""
        return self.found.best

    @property
    def answers(self) -> tuple[Answer, ...]:
        """The answers for all methods: first for those that keep the limit, by cost; then for the others, by error."""
        return self.found.answers

    @property
    def tables(self) -> dict[str, Table]:
        """The table `recommend` with the answers, and the table `steps` with all measured time steps."""
        unit = self.found.asked.unit
        units = {"error": unit} if unit else {}
        of_steps = {"error": unit, "truth_error": unit} if unit else {}
        return {
            ANSWERS.name: Table.of(ANSWERS, self.found.answers, units),
            STEPS.name: Table.of(STEPS, self.found.probes, of_steps),
        }


def carry_out(
    planned: study.Study,
    engines: Engines,
    command: Sequence[str],
    jobs: int,
    output: Output,
    reuse: Path | None = None,
) -> RecommendResults:
    """Make the searches of a study, and write the tables and the report.

    Parameters
    ----------
    planned
        The searches.
    engines
        The engines.
    command
        The words of the command, for the header of the results.
    jobs
        The number of processes.
    output
        The folder and the formats of the results, and the display of progress. An interrupted study in the folder is resumed.
    reuse
        A folder with results of runs. The time steps of these runs are not measured again.

    Raises
    ------
    BadInput, BadJournal, Failed
        As `study.results` and `study.reused` raise them.
    """
    engines.check_planned([planned.case], ((search.engine, search.method) for search in planned.searches))
    known = study.reused(store.read(reuse), planned) if reuse is not None else []
    robots = noticed([planned.case], jobs, output.quiet)
    head = campaign.header(command, engines.records, engines.missing, robots=robots)
    with (
        output.work("searching", len(planned.searches)) as (folder, progress),
        study.results(planned, folder, head, jobs, progress, known) as recommendation,
    ):
        report = present(head, recommendation)
        origins = [origin.origin(head, {planned.case.name: planned.case.text})]
        output.write(report, ((ANSWERS, recommendation.answers), (STEPS, recommendation.probes)), origins)
    return RecommendResults(report, recommendation)


def recommend(
    case: OneCase,
    *,
    error: float,
    quantity: str = "attitude",
    engine: Names = (),
    integrator: Names = (),
    reuse: str | Path | None = None,
    package_path: str | Path | Iterable[str | Path] = (),
    ignore: Names = (),
    out: str | Path | None = None,
    jobs: int | None = None,
) -> RecommendResults:
    """Find the method that keeps an error within a limit at the lowest cost, and the largest time step at which it does.

    This function does the same as the command `bodycheck recommend`.

    Parameters
    ----------
    case
        The name of a shipped case, the path of a case file, or a case that `bodycheck.load` returned.
    error
        The largest allowed error over the duration of the case, in the unit of the figure: rad for the attitude, m for the
        position, relative for energy and angular momentum.
    quantity
        The figure whose error is limited: attitude, position, energy, angular_momentum, or the name of a figure in the tables
        of results.
    engine, integrator, jobs
        The same as the parameters of `bodycheck.run`.
    reuse
        A folder with results of `tradeoff` or `run`. The time steps of these runs are not measured again.
    package_path, ignore
        The same as the parameters of `bodycheck.run`.
    out
        A folder for the tables and the report. An interrupted search in it is resumed.

    Raises
    ------
    BadInput
        If a case, an engine, a method, a figure or a number cannot be used, or if the truth of the case has an error at least
        as large as `error`. The message is the same as on the command line.
    Failed
        If the case has no truth, or if all named engines fail when they are loaded.
    """
    loaded = arguments.one_case(case, read := arguments.robots(package_path, ignore))
    wanted = conversion.number("--error", error)
    figure = conversion.name("--quantity", quantity)
    named, spellings = arguments.names("--engine", engine), arguments.names("--integrator", integrator)
    jobs = arguments.jobs_of(jobs)
    engines = load_engines(named, integrators=spellings)
    planned = study.prepare(loaded, engines.records, spellings, figure, wanted)
    earlier = arguments.path("--reuse", reuse)
    command = arguments.command(
        "recommend",
        (case,),
        error=wanted,
        quantity=figure,
        engine=named,
        integrator=spellings,
        reuse=earlier,
        **arguments.of_robots(read),
    )
    output = Output(arguments.path("--out", out))
    return carry_out(planned, engines, command, jobs, output, earlier)
