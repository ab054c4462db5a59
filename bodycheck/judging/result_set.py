"""Results with what they are worth, which is what reports are made of: one set of them, or several to be compared."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

from bodycheck.errors import BadInput
from bodycheck.judging import attribution, judgement
from bodycheck.judging.attribution import Attribution
from bodycheck.judging.judgement import Verdict
from bodycheck.running.store import Results


@dataclass(frozen=True, eq=False)
class ResultSet:
    """One set of results, the verdicts on its runs, and the parts of their discrepancies of contact.

    label: what tells it from the others of a report, where there are several, and what its verdicts have for theirs.
    """

    results: Results
    verdicts: Sequence[Verdict]
    parts: Sequence[Attribution] = ()
    label: str = ""

    @cached_property
    def verdicts_by_case(self) -> Mapping[str, Sequence[Verdict]]:
        """The verdicts on the runs of each case, by its name."""
        found: dict[str, list[Verdict]] = defaultdict(list)
        for verdict in self.verdicts:
            found[verdict.run.case].append(verdict)
        return found

    @cached_property
    def parts_by_case(self) -> Mapping[str, Sequence[Attribution]]:
        """The parts of the discrepancies of contact of each case, by its name."""
        found: dict[str, list[Attribution]] = defaultdict(list)
        for part in self.parts:
            found[part.case].append(part)
        return found


def judged(results: Results, label: str = "") -> ResultSet:
    """Results, judged."""
    verdicts = [replace(verdict, label=label) for verdict in judgement.judge(results)]
    return ResultSet(results, verdicts, attribution.attribute(results, verdicts), label)


def labels(folders: Sequence[Path]) -> list[str]:
    """What tells results apart by the folders that they are in: the shortest ends of their paths that differ; none for one.

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
    return next(found for found in ends if len(set(found)) == len(found))


def write(sets: Sequence[ResultSet], folder: Path) -> None:
    """results.csv, results.parquet and, where there is contact, attribution.csv in a folder."""
    judgement.write([verdict for one in sets for verdict in one.verdicts], folder)
    attribution.write({one.label: one.parts for one in sets}, folder)
