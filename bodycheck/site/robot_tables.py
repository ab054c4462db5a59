"""The readings of a robot model by engines, for its page: rows that agree with the file are counted, others are listed."""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, get_args

from bodycheck.results.verdicts import RobotVerdict
from bodycheck.site.catalogue import Entry
from bodycheck.site.submissions.submission import Submission
from bodycheck.studies.parity.quantities import CAUSES, FAILED, FILE, MEANINGS, QUANTITIES, Quantity, Status
from bodycheck.studies.parity.rows import READINGS, ParityRow
from bodycheck.studies.parity.wording import brief, name_of, of_engine

#: The most rows of one engine that are listed.
MOST_LISTED = 80

#: The most characters of a shown value.
LONGEST = 160


@dataclass(frozen=True)
class Mark:
    """The verdict on one quantity of a robot in an engine.

    Parameters
    ----------
    verdict
        The verdict.
    amount
        The number of bodies, joints or models with this verdict; 0 if it is not known, as for the verdict "agrees".
    largest
        The largest relative difference among the rows with this verdict; None if it is not known.
    """

    verdict: RobotVerdict
    amount: int
    largest: float | None


@dataclass(frozen=True, eq=False)
class Reading:
    """The reading of a robot model by one version of an engine.

    Parameters
    ----------
    engine, version
        The engine and its version.
    rows
        Its rows of parity.csv in one submission.
    disputed
        Whether another submission says something else of the same version.
    """

    engine: str
    version: str
    rows: tuple[Entry, ...]
    disputed: bool = False

    @property
    def source(self) -> str:
        """Return the submission in words if the reading is disputed; otherwise an empty text."""
        return self.rows[0].source.named if self.disputed else ""

    @property
    def verdict(self) -> RobotVerdict:
        """Return the verdict on the whole robot; quantities that the engine does not model count only if there are no others.

        If the engine does not model the whole file, the verdict is "not-modelled".
        """
        there = {entry.get("status") for entry in self.rows}
        if any(entry.get("quantity") is None and entry.get("status") == "not-modelled" for entry in self.rows):
            return "not-modelled"
        verdicts = (one for one in get_args(RobotVerdict) if one != "not-modelled" and one in there)
        return next(verdicts, "not-modelled")

    @property
    def sentences(self) -> tuple[str, ...]:
        """Return sentences about the reading, the verdict first."""
        return of_engine([parity_row(entry) for entry in self.rows])

    @property
    def brief(self) -> str:
        """Return the result of the reading in few words."""
        return brief([parity_row(entry) for entry in self.rows])

    @property
    def marks(self) -> dict[Quantity, Mark]:
        """Return the mark of each quantity that was compared."""
        found: dict[Quantity, list[Entry]] = defaultdict(list)
        for entry in self.rows:
            if entry.get("quantity") in QUANTITIES:
                found[entry.get("quantity")].append(entry)
        return {quantity: _mark(own) for quantity, own in found.items()}

    @property
    def of_file(self) -> Mark | None:
        """Return the mark of every quantity if the engine does not read the file at all; None if the engine reads it."""
        return Mark(self.verdict, 0, None) if any(entry.get("quantity") is None for entry in self.rows) else None

    @property
    def listed(self) -> tuple[Entry, ...]:
        """Return the rows that do not agree, by status: those that fail, then unphysical and not modelled."""
        order: tuple[Status, ...] = (*FAILED, "accepted-unphysical", "not-modelled")
        return tuple(entry for status in order for entry in self.rows if entry.get("status") == status)


def readings(entries: Sequence[Entry]) -> tuple[list[Reading], list[Reading], list[Entry]]:
    """Return the readings by the newest version of each engine, the readings by older versions, and the rows about the file.

    A version of which submissions say different things has a reading for each of them.
    """
    by_engine: dict[str, dict[str, dict[Submission, list[Entry]]]] = defaultdict(lambda: defaultdict(lambda: defaultdict(list)))
    for entry in sorted(entries, key=lambda entry: (entry.order, entry.place)):
        by_engine[entry.engine][entry.version][entry.source].append(entry)
    of_file = by_engine.pop(FILE, {}).values()
    faults = {(one.get("subject"), one.get("engine_value")): one for by in of_file for own in by.values() for one in own}
    newest: list[Reading] = []
    older: list[Reading] = []
    for engine, versions in sorted(by_engine.items()):
        *before, last = (_readings(engine, version, list(own.values())) for version, own in versions.items())
        newest += last
        older += [reading for version in reversed(before) for reading in version]
    return newest, older, list(faults.values())


def _readings(engine: str, version: str, by_source: Sequence[Sequence[Entry]]) -> list[Reading]:
    """Return the readings by one version of an engine, one for each submission."""
    return [Reading(engine, version, tuple(rows), len(by_source) > 1) for rows in by_source]


def quantities(read: Sequence[Reading]) -> list[tuple[Quantity, str, str, list[Mark | None]]]:
    """Return the quantities compared in any reading, each with its name, its meaning, and its mark in every reading."""
    marks = [one.marks for one in read]
    whole = [one.of_file for one in read]
    return [
        (
            quantity,
            name_of(quantity),
            MEANINGS[quantity],
            [own.get(quantity, all_) for own, all_ in zip(marks, whole, strict=True)],
        )
        for quantity in QUANTITIES
        if any(quantity in own for own in marks)
    ]


def parity_row(entry: Entry) -> ParityRow:
    """Return a row of parity.csv as a `ParityRow`; a cause that the study does not know becomes "unexplained"."""
    numbers = ("difference", "relative", "quantity")
    known: dict[str, Any] = {name: entry.get(name) if name in numbers else entry.get(name) or "" for name in READINGS.by_name}
    return ParityRow(**known | {"cause": known["cause"] if known["cause"] in CAUSES else "unexplained"})


def shown(value: str | None) -> str:
    """Return a value of a row, shortened."""
    text = value or ""
    return text if len(text) <= LONGEST else f"{text[:LONGEST]}…"


def _mark(entries: Sequence[Entry]) -> Mark:
    for verdict in get_args(RobotVerdict):
        own = [entry for entry in entries if entry.get("status") == verdict]
        if own:
            known = [entry.get("relative") for entry in own if entry.get("relative") is not None]
            return Mark(verdict, 0 if verdict == "agrees" else len(own), max(known, default=None))
    return Mark("not compared", 0, None)
