"""`bodycheck.recommend`: the method that keeps an error at the lowest cost, and the largest time step with which it does."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path

from bodycheck import conversion, reports
from bodycheck.console.arguments import load_engines
from bodycheck.interface import arguments
from bodycheck.interface.arguments import Names, OneCase
from bodycheck.interface.folders import kept
from bodycheck.interface.results import StudyResults, Table
from bodycheck.results import origin, store
from bodycheck.running import campaign
from bodycheck.studies.recommend import study
from bodycheck.studies.recommend.page import present
from bodycheck.studies.recommend.rows import Answer, Probe, Recommendation

#: The units of the columns of answers and steps; that of a cost is computing time for simulated time.
UNITS = {
    **dict.fromkeys(("timestep", "smallest", "broken"), "s"),
    **dict.fromkeys(("cost", "cost_low", "cost_high"), "s/s"),
}

#: The columns that a notebook shows.
SHOWN = ("engine", "integrator", "timestep", "error", "margin", "cost", "broken", "reached", "reason")
SHOWN_STEPS = ("engine", "integrator", "timestep", "error", "status", "reason")


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
        units = UNITS | ({"error": unit, "truth_error": unit} if unit else {})
        numbers = frozenset((*UNITS, "error", "truth_error", "margin"))

        def table(rows: Sequence[Answer] | Sequence[Probe], kind: type[Answer | Probe], shown: Sequence[str]) -> Table:
            columns = [field.name for field in fields(kind)]
            own = {name: units[name] for name in columns if name in units}
            return Table([asdict(row) for row in rows], columns, numbers, own, shown)

        return {
            "recommend": table(self.found.answers, Answer, SHOWN),
            "steps": table(self.found.probes, Probe, SHOWN_STEPS),
        }


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
    known = study.reused(store.read(earlier), planned) if earlier is not None else []
    command = arguments.command(
        "recommend", (case,), error=wanted, quantity=figure, engine=named, integrator=spellings, reuse=earlier
    )
    head = campaign.header(command, engines.records, engines.missing)
    folder = arguments.path("--out", out)
    with kept(folder) as place, study.results(planned, place.folder, head, jobs, known=known) as found:
        report = present(head, found)
        if folder is not None:
            study.write(found, folder, [origin.origin(head, {loaded.name: loaded.text})])
            reports.write_study(report, folder)
    return RecommendResults(report, found)
