"""`bodycheck.extremes`: where and how methods fail when cases are pushed to extreme values."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from bodycheck.interface import arguments
from bodycheck.interface.arguments import Cases, Names
from bodycheck.studies import plain
from bodycheck.studies.extremes.rows import Limit, Row


@dataclass(frozen=True, eq=False, repr=False)
class ExtremesResults(plain.PlainResults):
    """The outcomes of runs at extreme values, and the largest stable time steps."""

    @property
    def rows(self) -> Sequence[Row]:
        """The rows of the table `extremes`, one for each run."""
        return self.rows_by_table[0]

    @property
    def limits(self) -> Sequence[Limit]:
        """The largest stable time step of each method at each spin."""
        return self.rows_by_table[1]


def extremes(
    cases: Cases = (),
    *,
    engine: Names = (),
    integrator: Names = (),
    package_path: str | Path | Iterable[str | Path] = (),
    ignore: Names = (),
    out: str | Path | None = None,
    jobs: int | None = None,
) -> ExtremesResults:
    """Push cases and methods to extreme values, and find where and how they fail, as the command `bodycheck extremes` does.

    Parameters
    ----------
    cases
        The same as the parameter of `bodycheck.run`. If none are given, all shipped cases with a table [extremes]. A case
        without this table has axes that fit its scene.
    engine, integrator, jobs
        The same as the parameters of `bodycheck.run`.
    package_path, ignore
        The same as the parameters of `bodycheck.run`.
    out
        A folder for the tables and the report. An interrupted study in it is resumed.

    Raises
    ------
    BadInput, Failed
        In the same cases as by `bodycheck.run`.
    """
    read = arguments.robots(package_path, ignore)
    results = plain.called("extremes", cases, engine, integrator, read, out, jobs)
    return ExtremesResults(results.report, results.rows_by_table, results.described)
