"""Output of a study: the folder of its tables and its report, and the display of its progress."""

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bodycheck import reports
from bodycheck.console.progress import progress
from bodycheck.files.temporary import temporary_folder
from bodycheck.reports.study import StudyReport
from bodycheck.results import csv_tables
from bodycheck.results.origin import Origins
from bodycheck.results.tables import Table

if TYPE_CHECKING:
    from bodycheck.reports.plot_files import Format
    from bodycheck.running.campaign import Advance


@dataclass(frozen=True)
class Output:
    """The destination of the results of a study, and the display of its progress.

    Attributes
    ----------
    folder
        The folder for records, tables and the report; None if nothing is kept.
    figures
        The formats in which every plot is also written to a separate file.
    quiet
        Whether the display of progress is suppressed.
    """

    folder: Path | None = None
    figures: "tuple[Format, ...]" = ()
    quiet: bool = True

    @contextmanager
    def work(self, label: str, size: int) -> "Iterator[tuple[Path, Advance]]":
        """Provide the folder for records, which is temporary if nothing is kept, and a function that advances the progress.

        label: the name of the work in the display of progress. size: the number of its parts.
        """
        with ExitStack() as stack:
            folder = self.folder or stack.enter_context(temporary_folder())
            yield folder, stack.enter_context(progress(label, size, self.quiet))

    def write(self, report: StudyReport, tables: Sequence[tuple[Table[Any], Sequence[Any]]], origins: Origins) -> None:
        """Write the report and the tables, each of them a pair of a description and rows, unless nothing is kept."""
        if self.folder is not None:
            for table, rows in tables:
                csv_tables.write(self.folder, table, rows, origins)
            reports.write_study(report, self.folder, self.figures)
