"""A submission: the tables of a results folder, with the origin of their numbers."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from bodycheck.results.records import HeaderRecord
from bodycheck.site.submissions.tracks import NO_TRACKS, Tracks

#: A row of a table: its values by column. None stands for an empty entry.
Row = Mapping[str, Any]

#: Matches the name of a system. Its groups are the system and the architecture, without build numbers and patches.
SYSTEM = re.compile(r"^([A-Za-z]+)-.*?((?:x86_64|aarch64|arm64|AMD64)?)(?:-.*)?$")


@dataclass(frozen=True, eq=False)
class Submission:
    """The results of one command on one machine.

    Parameters
    ----------
    key
        The first characters of the SHA-256 of the whole content. Addresses identify the submission by its key.
    header
        Versions, machine, command and start. The command has no paths.
    tables
        The rows of each table, by its file name such as "results.csv". The row with index k is in line k + 2 of the file.
    cases
        The text of each case file, by the name of the case.
    tracks
        How truths were computed, and the motions of truths and of the methods that engines themselves choose.
    """

    key: str
    header: HeaderRecord
    tables: Mapping[str, tuple[Row, ...]]
    cases: Mapping[str, str]
    tracks: Tracks = field(default=NO_TRACKS, repr=False)

    @property
    def date(self) -> str:
        """Return the day on which the command was started, as YYYY-MM-DD."""
        return self.header.started[:10]

    @cached_property
    def machine(self) -> str:
        """Return the processor, the number of cores and the system of the machine, as far as they are known."""
        told = self.header.machine
        system = SYSTEM.sub(r"\1 \2", told.get("system", "")).strip()
        parts = (told.get("processor", ""), f"{told['cores']} cores" if "cores" in told else "", system)
        return ", ".join(part for part in parts if part)

    @property
    def named(self) -> str:
        """Return the submission in words: its day and the beginning of its key."""
        return f"submission {self.key[:8]} of {self.date}"

    @property
    def command(self) -> str:
        """Return the command as one line."""
        return " ".join(self.header.command)


@dataclass(frozen=True)
class LeftOut:
    """A path that the site leaves out: its name, and the reason as one sentence."""

    name: str
    reason: str
