"""Write the tables of judged results: results.csv, results.parquet, and the metadata beside the first."""

import io
from collections.abc import Sequence
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from bodycheck.files import writing
from bodycheck.judging import judgement
from bodycheck.judging.judgement import Verdict
from bodycheck.results import csv_tables
from bodycheck.results.origin import Origins, with_origin
from bodycheck.results.tables import RESULTS


def write(verdicts: Sequence[Verdict], folder: Path, origins: Origins) -> None:
    """Write results.csv with the metadata beside it, and results.parquet.

    Parameters
    ----------
    verdicts
        The verdicts on all runs.
    folder
        The folder.
    origins
        Where the numbers come from.

    Raises
    ------
    NotWritten
        A file cannot be written.
    """
    table = judgement.arrow(verdicts)
    csv_tables.write(folder, RESULTS, judgement.records(verdicts), origins, table.column_names)
    writing.write(folder / "results.parquet", _parquet(table, origins))


def _parquet(table: pa.Table, origins: Origins) -> bytes:
    content = io.BytesIO()
    pq.write_table(with_origin(table, origins), content)
    return content.getvalue()
