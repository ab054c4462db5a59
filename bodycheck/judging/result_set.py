"""Sets of results with their verdicts, for reports on one set or on several compared sets."""

import io
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from bodycheck.adapters.contract import Kind
from bodycheck.errors import BadInput
from bodycheck.files import writing
from bodycheck.judging import attribution, frames, judgement
from bodycheck.judging.attribution import Attribution
from bodycheck.judging.judgement import Compared, Verdict
from bodycheck.judging.schemes.classes import MethodClass
from bodycheck.judging.schemes.run_classes import classes_of
from bodycheck.results import csv_tables, origin
from bodycheck.results.origin import Origins, with_origin
from bodycheck.results.store import Results
from bodycheck.results.tables import RESULTS

if TYPE_CHECKING:
    import pyarrow as pa

    from bodycheck.judging.sensors.rows import SensorRow


@dataclass(frozen=True, eq=False)
class ResultSet:
    """One set of results.

    Attributes
    ----------
    results
        The results.
    verdicts
        The verdicts on the runs; they have the label of the set.
    parts
        The parts of the errors of runs with contact.
    label
        A text that distinguishes the set from others in the same report; empty if there is only one set.
    sensors
        The rows of the sensors of runs.
    """

    results: Results
    verdicts: Sequence[Verdict]
    parts: Sequence[Attribution] = ()
    label: str = ""
    sensors: "Sequence[SensorRow]" = ()

    @property
    def failed(self) -> bool:
        """True if a run failed, or an expectation that could not be checked counts as failed."""
        unchecked = any(one.failed for one in self.results.unchecked)
        return unchecked or any(verdict.passed is False for verdict in self.verdicts)

    @cached_property
    def verdicts_by_case(self) -> Mapping[str, Sequence[Verdict]]:
        """The verdicts on the runs of each case, by its name."""
        by_case: dict[str, list[Verdict]] = defaultdict(list)
        for verdict in self.verdicts:
            by_case[verdict.run.case].append(verdict)
        return by_case

    @cached_property
    def classes(self) -> Mapping[Kind, tuple[MethodClass, ...]]:
        """The classes of methods that are one algorithm, by the kind of scene. Motions are read from the results."""
        return classes_of(self.results, [verdict.run for verdict in self.verdicts if verdict.discrepancy is not None])

    @cached_property
    def parts_by_case(self) -> Mapping[str, Sequence[Attribution]]:
        """The parts of the errors of runs with contact, by the name of the case."""
        by_case: dict[str, list[Attribution]] = defaultdict(list)
        for part in self.parts:
            by_case[part.case].append(part)
        return by_case


def judged(results: Results, label: str = "", compared: Compared | None = None) -> ResultSet:
    """Judge results, and return them with a label. compared: the figures of runs that are already compared."""
    from bodycheck.judging.sensors import measurement  # it imports the reference, which the processes of commands start without

    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):  # errors too large for a number are infinite
        verdicts = [replace(verdict, label=label) for verdict in judgement.judge(results, compared=compared)]
        parts = attribution.attribute(results, verdicts)
        sensors = measurement.measure(results, verdicts)
    return ResultSet(results, verdicts, parts, label, sensors)


def labels(folders: Sequence[Path]) -> list[str]:
    """Return labels that distinguish folders of results: the shortest differing ends of their paths; empty for one folder.

    Raises `BadInput` for a folder that is given twice.
    """
    if len(folders) == 1:
        return [""]
    paths = [folder.resolve() for folder in folders]
    for path, folder in zip(paths, folders, strict=True):
        if paths.count(path) > 1:
            raise BadInput(f"{folder}: is given twice")
    deepest = max(len(path.parts) for path in paths)
    ends = [["/".join(path.parts[-parts:]) for path in paths] for parts in range(1, deepest + 1)]
    return next(names for names in ends if len(set(names)) == len(names))


def write(sets: Sequence[ResultSet], folder: Path) -> None:
    """Write results.csv and results.parquet into a folder, and, if there are such runs, attribution.csv and sensors.csv.

    All files state the origins of their numbers: beside a CSV file is a file with its metadata. Raises `NotWritten`.
    """
    from bodycheck.judging.sensors import measurement

    origins = [origin.stored(one.results.header, one.label) for one in sets]
    verdicts = [verdict for one in sets for verdict in one.verdicts]
    table = frames.arrow(verdicts)
    csv_tables.write(folder, RESULTS, judgement.records(verdicts), origins, table.column_names)
    writing.write(folder / "results.parquet", _parquet(table, origins))
    attribution.write({one.label: one.parts for one in sets}, folder, origins)
    measurement.write({one.label: one.sensors for one in sets}, folder, origins)


def _parquet(table: "pa.Table", origins: Origins) -> bytes:
    import pyarrow.parquet as pq  # it is large, and only results need it

    content = io.BytesIO()
    pq.write_table(with_origin(table, origins), content)
    return content.getvalue()
