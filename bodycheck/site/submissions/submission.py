"""A submission: the tables of a results folder with all that says where their numbers come from."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from bodycheck.results.records import HeaderRecord
from bodycheck.site.submissions.tracks import NO_TRACKS, Tracks

#: A row of a table: its values by column. None stands for an empty entry.
Row = Mapping[str, Any]

#: What differs between the systems of machines that are the same for a reader: build numbers, patches.
SYSTEM = re.compile(r"^([A-Za-z]+)-.*?((?:x86_64|aarch64|arm64|AMD64)?)(?:-.*)?$")


@dataclass(frozen=True, eq=False)
class Submission:
    """The results of one command on one machine.

    Parameters
    ----------
    key
        The first characters of the SHA-256 of all that it contains. It names the submission in addresses.
    header
        Versions, machine, command and start. The command has no paths.
    tables
        The rows of each table, by its file name such as "results.csv". The row with index k stands in line k + 2 of the file.
    cases
        The text of each case file, by the name of the case.
    tracks
        How truths were found, and motions of truths and of the engines' own methods.
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
        """Return the machine in a few words: processor, cores and system."""
        told = self.header.machine
        system = SYSTEM.sub(r"\1 \2", told.get("system", "")).strip()
        parts = (told.get("processor", ""), f"{told['cores']} cores" if "cores" in told else "", system)
        return ", ".join(part for part in parts if part)

    @property
    def command(self) -> str:
        """Return the command."""
        return " ".join(self.header.command)


@dataclass(frozen=True)
class LeftOut:
    """A path of which the site shows nothing, and why, as one sentence."""

    name: str
    reason: str
