"""The findings of an ensemble and the material of its report, read from its files. Nothing is run.

The case files and animations of worst members, which required further runs, are stored so that the report can be made again.
"""

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from bodycheck.adapters.method import Method
from bodycheck.casefile.case import Case
from bodycheck.errors import BadFolder
from bodycheck.files import reading, writing
from bodycheck.reference.requirements import needs
from bodycheck.reports.quantities import count
from bodycheck.reports.study import Animation, animation_of
from bodycheck.studies.ensemble.findings import stored
from bodycheck.studies.ensemble.findings.aggregates import Aggregates
from bodycheck.studies.ensemble.findings.analysis import Analysis, analyse
from bodycheck.studies.ensemble.findings.stored import Ensemble
from bodycheck.studies.ensemble.findings.ways import chosen
from bodycheck.studies.ensemble.header import WORST, EnsembleHeader
from bodycheck.studies.ensemble.report import page

#: The file, inside the folder of an ensemble, with the case files and animations of worst members that its report shows.
SHOWN = Path(WORST, "report.json")

#: The largest size of the file in bytes: some animations of 200 kB each.
MAX_BYTES = 1 << 22


@dataclass(frozen=True, eq=False)
class Made:
    """The analysis of an ensemble and its findings.

    Attributes
    ----------
    analysis
        The analysis of its runs.
    sentences
        The findings in sentences.
    broken
        A sentence for each method with which members break expectations of the case.
    worst
        The number of worst members that `publishing.write` treats.
    outcomes
        A row for each method: "ok" if a member completed, diverged or kept its expectations; otherwise how most members ended.
    """

    analysis: Analysis
    sentences: tuple[str, ...]
    broken: tuple[str, ...]
    worst: int
    outcomes: tuple[dict[str, str], ...]

    def records(self) -> dict[str, list[dict[str, Any]]]:
        """Return the rows of the tables."""
        return {
            "rows": [asdict(row) for row in self.analysis.aggregates.rows()],
            "sensitivity": [asdict(row) for row in self.analysis.dependence_rows()],
        }


def read(folder: Path, case: Case, header: EnsembleHeader) -> Made:
    """Return the analysis of an ensemble and its findings.

    Parameters
    ----------
    folder
        The folder of its runs.
    case
        The case.
    header
        The header of the results, which gives the order of the engines.

    Raises
    ------
    BadFolder
        The runs cannot be read.
    """
    ensemble = stored.read(folder, case.name, tuple(header["engines"]))
    analysis = analyse(ensemble)
    findings = page.findings(material(case, header, analysis))
    # A sentence on the terminal ends where the finding of the page refers to a part of the page.
    subjects = ((one.subject, one.before.removesuffix(" See ") if one.where else one.text) for one in findings)
    sentences = tuple(f"{subject}: {text}" for subject, text in subjects)
    return Made(
        analysis, sentences, broken(ensemble, case), len(chosen(case, ensemble)), tuple(outcomes(ensemble, analysis.aggregates))
    )


def outcomes(ensemble: Ensemble, aggregates: Aggregates) -> Iterator[dict[str, str]]:
    """Yield the row of each method in `Made.outcomes`."""
    measured = ensemble.measured
    for index, method in enumerate(aggregates.methods):
        by = method.engine_method
        end = (stored.OK, "")
        if not measured[index].any():
            end = (method.ways[0].name, method.ways[0].reason) if method.ways else (stored.UNSUPPORTED, method.unsupported)
        yield {"engine": by.engine, "integrator": by.integrator, "status": end[0], "reason": end[1]}


def broken(ensemble: Ensemble, case: Case) -> tuple[str, ...]:
    """Return a sentence for each method with which members break expectations of the case.

    A method that no expectation concerns has no sentence: its failures are results.
    """
    sentences = []
    for index, by in enumerate(ensemble.methods):
        method = Method.parse(by.integrator, by.timestep)
        concerned = any(expectation.concerns(by.engine, method) for expectation in case.expectations)
        members = np.flatnonzero(ensemble.broken[index] & ensemble.supported[index])
        if concerned and members.size:
            first = int(members[0])
            reason = ensemble.reasons(index, [first]).get(first, "")
            how_many = f"{members.size} of {count(int(np.count_nonzero(ensemble.supported[index])), 'member')}"
            named = f"{case.name}, {by.engine} {by.integrator} at {by.timestep:g} s"
            sentences.append(f"{named}: {how_many}, the first is member {ensemble.members[first]}: {reason}")
    return tuple(sentences)


def material(
    case: Case,
    header: EnsembleHeader,
    analysis: Analysis,
    files: tuple[page.File, ...] = (),
    animations: tuple[Animation, ...] = (),
) -> page.Material:
    """Return the material of a report. files, animations: the case files of worst members and the animations that it shows."""
    return page.Material(header, needs(case.scene).kind, analysis, files, animations)


def keep_shown(folder: Path, files: Sequence[page.File], animations: Sequence[Animation]) -> None:
    """Write the case files of worst members that a report names, and its animations. Raises `NotWritten`."""
    content = {"files": [file._asdict() for file in files], "animations": [asdict(one) for one in animations]}
    writing.write(folder / SHOWN, json.dumps(content, allow_nan=False).encode("ascii"), folder)


def shown(folder: Path) -> tuple[tuple[page.File, ...], tuple[Animation, ...]]:
    """Return the files and animations that `keep_shown` wrote; none without a file. Raises `BadFolder` if it is damaged."""
    path = folder / SHOWN
    if not path.exists():
        return (), ()
    try:
        content = json.loads(reading.content(path, MAX_BYTES))
        files = tuple(page.File(int(one["member"]), str(one["name"]), str(one["title"])) for one in content["files"])
        return files, tuple(map(animation_of, content["animations"]))
    except (OSError, ValueError, KeyError, TypeError, RecursionError) as error:
        raise BadFolder(f"{path}: damaged: {type(error).__name__}: {error}") from error
