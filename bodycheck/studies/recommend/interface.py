"""`bodycheck.recommend`: the method that keeps an error at the lowest cost, and the largest time step with which it does."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from bodycheck import conversion
from bodycheck.console.arguments import Engines, load_engines
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
    """The methods that keep an error, each with the largest time step that does.

    Attributes
    ----------
    found
        What was asked for, an answer for each method, and all measured time steps.
    """

    found: Recommendation

    @property
    def best(self) -> Answer | None:
        """The cheapest method that keeps the error; None if none does."""
        return self.found.best

    @property
    def answers(self) -> tuple[Answer, ...]:
        """One for each method: those that keep the error, the cheapest first, then the others, the smallest error first."""
        return self.found.answers

    @property
    def tables(self) -> dict[str, Table]:
        """The tables `recommend`, the answers, and `steps`, all measured time steps."""
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
        Where the results go. An interrupted study in its folder is resumed.
    reuse
        A folder with results of runs, whose time steps are not measured again.

    Raises
    ------
    BadInput, BadJournal, Failed
        As `study.results` and `study.reused`.
    """
    known = study.reused(store.read(reuse), planned) if reuse is not None else []
    head = campaign.header(command, engines.records, engines.missing)
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
    out: str | Path | None = None,
    jobs: int | None = None,
) -> RecommendResults:
    """Find the method that keeps an error at the lowest cost, and the largest time step with which it does.

    It is what the command `bodycheck recommend` does.

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
        As those of `bodycheck.run`.
    reuse
        A folder with results of `tradeoff` or `run`; steps that were measured there are not measured again.
    out
        A folder for the tables and the report, which continues what was interrupted there.

    Raises
    ------
    BadInput
        If a case, an engine, a method, a figure or a number cannot be used, or if the truth of the case has an error as large
        as the one that is asked for; the text is that of the command line.
    Failed
        If the case has no truth, or if all engines that are named fail when they are loaded.
    """
    loaded = arguments.one_case(case)
    wanted = conversion.number("--error", error)
    figure = conversion.name("--quantity", quantity)
    named, spellings = arguments.names("--engine", engine), arguments.names("--integrator", integrator)
    jobs = arguments.jobs_of(jobs)
    engines = load_engines(named)
    planned = study.prepare(loaded, engines.records, spellings, figure, wanted)
    earlier = arguments.path("--reuse", reuse)
    command = arguments.command(
        "recommend", (case,), error=wanted, quantity=figure, engine=named, integrator=spellings, reuse=earlier
    )
    output = Output(arguments.path("--out", out))
    return carry_out(planned, engines, command, jobs, output, earlier)
