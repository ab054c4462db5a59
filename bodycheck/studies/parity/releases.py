"""The changes between releases of an engine in their reading of a robot's file."""

from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

from bodycheck.environments.environments import Environment
from bodycheck.running import engines, fetch_environments
from bodycheck.studies.parity.files import named
from bodycheck.studies.parity.quantities import MODEL, Cause, Quantity, Status
from bodycheck.studies.parity.rows import ParityRow
from bodycheck.studies.parity.study import Asking, Parity, study
from bodycheck.studies.parity.wording import engines_of, name_of

if TYPE_CHECKING:
    from bodycheck.running.campaign import Advance

#: A function that shows a progress bar for a title and a number of units.
Bar = Callable[[str, int], "AbstractContextManager[Advance]"]


@dataclass(frozen=True)
class Meaning:
    """A change in the meaning of a file from one release to the next.

    Attributes
    ----------
    model
        The model.
    before, after
        The two releases.
    quantity, subject
        The quantity and the subject that changed; no quantity if a release refuses or does not read the file.
    was, status
        The statuses in the two releases.
    cause
        The cause in the release that differs from the file.
    engine_value_was, engine_value, truth_value
        The values in the two releases and in the file.
    """

    model: str
    before: str
    after: str
    quantity: Quantity | None
    subject: str
    was: Status
    status: Status
    cause: Cause
    engine_value_was: str
    engine_value: str
    truth_value: str

    @property
    def text(self) -> str:
        """The change as words, without the subject."""
        what = "the file" if self.quantity is None else name_of(self.quantity)
        cause = f" ({self.cause})" if self.cause else ""
        return f"{self.before} to {self.after}: {what} {self.was}, then {self.status}{cause}"


def measured(
    engine: str, versions: Sequence[str], paths: Sequence[Path], asks: Asking, jobs: int, bar: Bar
) -> tuple[list[Parity], dict[str, str]]:
    """Return the results of releases of an engine for files, and the reasons why other releases cannot be asked, by release.

    Parameters
    ----------
    engine, versions
        The name of the engine and the releases, ascending. Each has its own environment; missing ones are installed.
    paths
        The files.
    asks
        The options of the comparison.
    jobs
        The number of processes.
    bar
        A function that shows a progress bar.

    Raises
    ------
    BadInput
        If none of the files can be read.
    """
    with bar("obtaining", len(versions)) as progress:
        obtained = fetch_environments.obtain_all(engine, versions, jobs, progress)
    missing = {version: str(one) for version, one in obtained.items() if not isinstance(one, Environment)}
    records, faults = engines.describe([f"{engine}@{version}" for version in versions if version not in missing])
    missing |= {name.partition("@")[2]: fault.reason for name, fault in faults.items()}
    files = named(paths).files
    with bar("comparing", len(files)) as progress:
        return list(study(records, files, asks, jobs, progress)), missing


def changes(models: Sequence[Parity]) -> tuple[Meaning, ...]:
    """Return the changes of the status of quantities from each release to the next."""
    return tuple(change for one in models for change in _of_model(one))


def _of_model(parity: Parity) -> list[Meaning]:
    releases = {engine: _by_subject(rows) for engine, rows in engines_of(parity).items()}
    meanings = []
    for before, after in pairwise(releases):
        old, new = releases[before], releases[after]
        whole = (
            [(None, MODEL)] if (None, MODEL) in {*old, *new} else [key for key in {**old, **new} if key in old and key in new]
        )
        for key in whole:
            one, other = old.get(key), new.get(key)
            was: Status = one.status if one is not None else "agrees"
            status: Status = other.status if other is not None else "agrees"
            if was != status:
                off = other if other is not None and status != "agrees" else one
                values = (one.engine_value if one else "", other.engine_value if other else "", off.truth_value if off else "")
                meanings.append(Meaning(parity.name, before, after, *key, was, status, off.cause if off else "", *values))
    return meanings


def _by_subject(rows: Sequence[ParityRow]) -> Mapping[tuple[Quantity | None, str], ParityRow]:
    """Return the rows by quantity and subject; of several rows about the same, one that differs."""
    ordered = sorted(rows, key=lambda row: row.status == "differs")
    return {(row.quantity, row.subject): row for row in ordered}
