"""`bodycheck.extremes`: where and how methods fail when cases are pushed to extreme values."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path

from bodycheck import reports
from bodycheck.console.arguments import load_engines
from bodycheck.interface import arguments
from bodycheck.interface.arguments import Cases, Names
from bodycheck.interface.folders import kept
from bodycheck.interface.results import StudyResults, Table
from bodycheck.results import origin
from bodycheck.running import campaign
from bodycheck.studies.extremes import study
from bodycheck.studies.extremes.page import present
from bodycheck.studies.extremes.rows import Limit, Row

#: The units of the columns of the limits.
LIMIT_UNITS = {
    "spin": "rad/s",
    "largest_stable_timestep": "s",
    "spin_times_step": "rad",
    "smallest_unstable_timestep": "s",
}

#: The columns that a notebook shows.
SHOWN = ("case", "engine", "integrator", "timestep", "axis", "value", "status", "engine_said")
SHOWN_LIMITS = ("case", "engine", "integrator", *LIMIT_UNITS)


@dataclass(frozen=True, eq=False, repr=False)
class ExtremesResults(StudyResults):
    """How runs end at extreme values, and the limits of stability.

    Attributes
    ----------
    rows
        One for each run.
    limits
        The largest stable time step of each method at each spin.
    """

    rows: Sequence[Row]
    limits: Sequence[Limit]

    @property
    def tables(self) -> dict[str, Table]:
        """The tables `extremes` and `limits`. The unit of a value is that of its axis."""
        rows, limits = [asdict(row) for row in self.rows], [asdict(limit) for limit in self.limits]
        of_rows, of_limits = ([field.name for field in fields(kind)] for kind in (Row, Limit))
        return {
            "extremes": Table(rows, of_rows, frozenset(("timestep", "value")), {"timestep": "s"}, SHOWN),
            "limits": Table(limits, of_limits, frozenset(LIMIT_UNITS), LIMIT_UNITS, SHOWN_LIMITS),
        }


def extremes(
    cases: Cases = (),
    *,
    engine: Names = (),
    integrator: Names = (),
    out: str | Path | None = None,
    jobs: int | None = None,
) -> ExtremesResults:
    """Push cases and methods to extreme values, and find where and how they fail, as the command `bodycheck extremes` does.

    Parameters
    ----------
    cases
        As those of `bodycheck.run`; all shipped cases with a table [extremes] for none.
    engine, integrator, jobs
        As those of `bodycheck.run`.
    out
        A folder for the tables and the report, which continues what was interrupted there.

    Raises
    ------
    BadInput, Failed
        As `bodycheck.run`, and `BadInput` for a case without a table [extremes].
    """
    each = arguments.listed(cases)
    named, spellings = arguments.names("--engine", engine), arguments.names("--integrator", integrator)
    jobs = arguments.jobs_of(jobs)
    loaded = [case for case in arguments.given_cases(each).cases if each or case.extremes]
    engines = load_engines(named)
    planned = study.prepare(loaded, engines.records, spellings)
    command = arguments.command("extremes", each, engine=named, integrator=spellings)
    head = campaign.header(command, engines.records, engines.missing)
    folder = arguments.path("--out", out)
    with (
        kept(folder) as place,
        study.results(planned, place.folder, head, jobs, lambda done, count=1: None) as (rows, limits),
    ):
        report = present(head, rows, limits)
        if folder is not None:
            study.write(rows, limits, folder, [origin.origin(head, {case.name: case.text for case in loaded})])
            reports.write_study(report, folder)
    return ExtremesResults(report, rows, limits)
