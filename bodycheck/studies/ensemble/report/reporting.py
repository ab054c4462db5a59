"""The findings of an ensemble and the material of its report, from its files. Nothing is run."""

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from bodycheck.adapters.method import Method
from bodycheck.casefile.case import Case
from bodycheck.reference.requirements import needs
from bodycheck.reports.quantities import count
from bodycheck.reports.study import Animation
from bodycheck.studies.ensemble.findings import stored
from bodycheck.studies.ensemble.findings.analysis import Analysis, analyse
from bodycheck.studies.ensemble.findings.stored import Ensemble
from bodycheck.studies.ensemble.findings.ways import chosen
from bodycheck.studies.ensemble.header import EnsembleHeader
from bodycheck.studies.ensemble.report import page


@dataclass(frozen=True, eq=False)
class Made:
    """The analysis of an ensemble and its findings.

    Attributes
    ----------
    analysis
        What its runs say.
    sentences
        The findings in sentences.
    broken
        A sentence for each method with which members break expectations of the case.
    worst
        The number of worst members that `publishing.write` treats.
    """

    analysis: Analysis
    sentences: tuple[str, ...]
    broken: tuple[str, ...]
    worst: int

    def records(self) -> dict[str, list[dict[str, Any]]]:
        """Return the rows of the tables."""
        return {
            "rows": [asdict(row) for row in self.analysis.aggregates.rows()],
            "sensitivity": [asdict(row) for row in self.analysis.dependence_rows()],
        }


def read(folder: Path, case: Case, header: EnsembleHeader) -> Made:
    """Return what is known of an ensemble.

    Parameters
    ----------
    folder
        The folder of its runs.
    case
        The case.
    header
        The header of the results, whose order of engines is that of the methods.

    Raises
    ------
    BadFolder
        The runs cannot be read.
    """
    ensemble = stored.read(folder, case.name, tuple(header["engines"]))
    analysis = analyse(ensemble)
    found = page.findings(material(case, header, analysis))
    # Where a finding of the page leads to a part of it, a sentence on the terminal ends.
    told = ((one.subject, one.before.removesuffix(" See ") if one.where else one.text) for one in found)
    sentences = tuple(f"{subject}: {text}" for subject, text in told)
    return Made(analysis, sentences, broken(ensemble, case), len(chosen(case, ensemble)))


def broken(ensemble: Ensemble, case: Case) -> tuple[str, ...]:
    """Return a sentence for each method with which members break expectations of the case.

    Where no expectation concerns a method, its failures are results.
    """
    told = []
    for place, by in enumerate(ensemble.methods):
        method = Method.parse(by.integrator, by.timestep)
        concerned = any(expectation.concerns(by.engine, method) for expectation in case.expectations)
        members = np.flatnonzero(ensemble.broken[place] & ensemble.supported[place])
        if concerned and members.size:
            first = int(members[0])
            reason = ensemble.reasons(place, [first]).get(first, "")
            of = f"{members.size} of {count(int(np.count_nonzero(ensemble.supported[place])), 'member')}"
            named = f"{case.name}, {by.engine} {by.integrator} at {by.timestep:g} s"
            told.append(f"{named}: {of}, the first is member {ensemble.members[first]}: {reason}")
    return tuple(told)


def material(
    case: Case,
    header: EnsembleHeader,
    analysis: Analysis,
    files: tuple[page.File, ...] = (),
    animations: tuple[Animation, ...] = (),
) -> page.Material:
    """Return what a report is made of. The case files of worst members and the animations are those that the report shows."""
    return page.Material(header, needs(case.scene).kind, analysis, files, animations)
