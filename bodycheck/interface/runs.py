"""`bodycheck.run`: run cases in engines, and compare the motions with exact mechanics."""

import weakref
from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from bodycheck import reports
from bodycheck.console.ran import Selection, ran_of
from bodycheck.errors import OK, BadInput
from bodycheck.files.temporary import temporary_folder
from bodycheck.interface import arguments
from bodycheck.interface.arguments import Cases, Names, Numbers
from bodycheck.interface.plots import Plot, chosen
from bodycheck.interface.results import Results, Table
from bodycheck.judging import frames, judgement, result_set
from bodycheck.judging.judgement import Verdict
from bodycheck.judging.result_set import ResultSet
from bodycheck.results.tables import RESULTS
from bodycheck.running.plan import plan_with_roles
from bodycheck.suggestion import did_you_mean

if TYPE_CHECKING:
    import pandas as pd

    from bodycheck.reports.runs.brief import Brief


@dataclass(frozen=True)
class _Kept:
    """A folder, and the stack of callbacks that removes it if it is temporary."""

    folder: Path
    stack: ExitStack

    def keep_for(self, owner: object) -> None:
        """Keep a temporary folder until `owner` is garbage-collected or this process ends."""
        weakref.finalize(owner, self.stack.pop_all().close)


@contextmanager
def _kept(out: Path | None) -> Iterator[_Kept]:
    """Provide a folder: `out`, or a temporary one that the end of the context removes unless it is kept for an object."""
    with ExitStack() as stack:
        yield _Kept(out or stack.enter_context(temporary_folder()), stack)


@dataclass(frozen=True, eq=False, repr=False)
class RunResults(Results):
    """The runs of some cases, with their verdicts.

    The trajectories of runs, and of their truths, are read from a folder when they are needed. Without `out`, this is a
    temporary folder, which exists as long as this object.

    Attributes
    ----------
    found
        The results and the verdicts on them.
    passed
        Whether all expectations hold, all that was named has a result, and no engine failed that a case has expectations of.
    """

    found: ResultSet
    passed: bool = field(repr=False)

    @property
    def verdicts(self) -> Sequence[Verdict]:
        """The verdicts on the runs, each with its run."""
        return self.found.verdicts

    @property
    def headline(self) -> str:
        """The verdict in one sentence."""
        return self._brief.headline

    @property
    def findings(self) -> tuple[str, ...]:
        """Further findings, in sentences."""
        noteworthy = (self._brief.broken, *self._brief.answers, *self._brief.findings)
        return (*(f"{one.subject}: {one.text}" for one in noteworthy if one is not None), *self._brief.notices)

    @property
    def tables(self) -> dict[str, Table]:
        """The table of runs, by the name `results`."""
        return {"results": Table.of(RESULTS, judgement.records(self.verdicts))}

    def to_frame(self, table: str = "") -> "pd.DataFrame":
        """Return the table of runs, named `results`, with the columns and types of results.parquet.

        The units of the columns are in `attrs["units"]`. Raises `BadInput` for another name, or if pandas is not installed.
        """
        if table not in ("", "results"):
            raise BadInput(f"there is no table {table!r}; there are: results")
        frame = frames.table(self.verdicts)
        frame.attrs["units"] = dict(self.tables["results"].units)
        return frame

    @property
    def plots(self) -> tuple[Plot, ...]:
        """The charts of the report, case by case."""
        return tuple(plot for case in self.found.verdicts_by_case for plot in self._plots_of(case))

    def plot(self, quantity: str = "", *, case: str = "") -> Plot:
        """Return a chart of the report: a figure over time, for all runs of a case.

        Parameters
        ----------
        quantity
            The name of a figure, such as `attitude_error`, or the beginning of the title; the first chart if it is empty.
        case
            The case; the first one if it is empty.

        Raises
        ------
        BadInput
            If there is no such chart.
        """
        cases = list(self.found.verdicts_by_case)
        if case and case not in cases:
            raise BadInput(f"there is no plot of the case {case!r}; there are: {', '.join(cases)}{did_you_mean(case, cases)}")
        return chosen(self._plots_of(case or cases[0]), quantity, "")

    @cached_property
    def _brief(self) -> "Brief":
        return reports.brief([self.found])

    def _plots_of(self, case: str) -> tuple[Plot, ...]:
        """Return the charts of one case. This reads the trajectories of its runs."""
        from bodycheck.reports.runs import plots
        from bodycheck.reports.runs.contents import gather

        parts = self.found.parts_by_case.get(case, ())
        part = replace(self.found, verdicts=self.found.verdicts_by_case[case], parts=parts)
        charts = plots.of_runs(gather([part]))
        return tuple(Plot(case, chart["title"]["subtitle"], chart) for _, chart in charts)


def run(
    cases: Cases = (),
    *,
    engine: Names = (),
    integrator: Names = (),
    timestep: Numbers = (),
    package_path: str | Path | Iterable[str | Path] = (),
    ignore: Names = (),
    out: str | Path | None = None,
    jobs: int | None = None,
    allow_missing: bool = False,
) -> RunResults:
    """Run cases in engines, and compare the motions with exact mechanics, as the command `bodycheck run` does.

    Parameters
    ----------
    cases
        One or several of: names of shipped cases, paths of case files, folders of them, patterns, and cases that
        `bodycheck.load` returned. By default, all shipped cases.
    engine
        Names of engines, each `NAME` or `NAME@VERSION`. By default, all installed engines.
    integrator
        Names of methods, as each engine spells them, and the aliases `default` and `recommended`. If none is named, all methods
        that each engine offers.
    timestep
        Time steps (s). By default, 2 ms and the time steps of the expectations; if no method is named either, also the default
        and the recommended method of each engine at their own time steps.
    package_path
        Folders of packages, in which files are found that a robot's file names.
    ignore
        What is left out of a robot's file that is given in the place of a case, such as "actuators".
    out
        A folder for the tables, the recorded runs and the report. Runs that were interrupted there are continued.
    jobs
        The number of processes; None for the number of processors.
    allow_missing
        Whether missing engines are tolerated: expectations of engines that are not installed then do not count as failed.

    Raises
    ------
    BadInput
        If a case, an engine, a method or a number cannot be used; the message is the same as on the command line.
    Failed
        If all named engines fail when they are loaded.
    """
    each = arguments.listed(cases)
    read = arguments.robots(package_path, ignore)
    given = arguments.given_cases(each, read)
    selection = Selection(
        cases=(),
        engines=(engines := arguments.names("--engine", engine)),
        integrators=(integrators := arguments.names("--integrator", integrator)),
        timesteps=(timesteps := arguments.numbers("--timestep", timestep)),
        jobs=arguments.jobs_of(jobs),
        allow_missing=allow_missing,
    )
    command = arguments.command(
        "run",
        each,
        engine=engines,
        integrator=integrators,
        timestep=timesteps,
        allow_missing=allow_missing,
        **arguments.of_robots(read),
    )
    folder, compared = arguments.path("--out", out), judgement.Compared()
    with _kept(folder) as kept:
        with ran_of(given, selection, plan_with_roles, kept.folder, command, quiet=True, meet=compared.meet) as runs:
            judged = result_set.judged(runs.results, compared=compared)
            if folder is not None:
                result_set.write([judged], folder)
                reports.write([judged], folder)
        decision = runs.decided((verdict.row() for verdict in judged.verdicts), judged.failed)
        results = RunResults(judged, passed=decision.code == OK)
        kept.keep_for(results)
    return results
