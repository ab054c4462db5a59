"""What a submission contains as files, and their check, which makes a `Submission` of them."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from hashlib import sha256
from typing import Any

from bodycheck.casefile import case as case_files
from bodycheck.errors import BadInput
from bodycheck.running import records
from bodycheck.running.records import HeaderRecord
from bodycheck.site import tables
from bodycheck.site.submission import Submission

#: The version of the format.
FORMAT = 1

#: The names of files.
TABLES, CASES, TRACKS = "tables/", "cases/", "tracks.parquet"
CASE_END = ".case.toml"

#: Characters of the digest that name a submission.
KEY_LENGTH = 12

#: Most cases that do not come with bodycheck.
MOST_OWN_CASES = 200

#: An instant as bodycheck writes it.
STARTED = re.compile(r"\d{4}-\d{2}-\d{2}T\d{2}:\d{2}:\d{2}\+00:00")


@dataclass(frozen=True)
class Contents:
    """A header, and files by their names inside the submission."""

    header: Mapping[str, Any]
    files: Mapping[str, bytes]

    @property
    def digests(self) -> dict[str, str]:
        """Return the SHA-256 of each file."""
        return {name: sha256(content).hexdigest() for name, content in sorted(self.files.items())}


def checked(contents: Contents, manifest: bytes) -> Submission:
    """Return the submission that files make.

    Parameters
    ----------
    contents
        The files.
    manifest
        The bytes that stand for all of them, whose SHA-256 names the submission.

    Raises
    ------
    BadInput
        Something is not as bodycheck writes it; the text says what and where.
    """
    header = _header(contents.header)
    cases = {
        name.removeprefix(CASES).removesuffix(CASE_END): _text(name, content)
        for name, content in contents.files.items()
        if name.startswith(CASES)
    }
    _check_cases(cases)
    rows = {
        name.removeprefix(TABLES): tables.read(name.removeprefix(TABLES), content)
        for name, content in contents.files.items()
        if name.startswith(TABLES)
    }
    if not any(rows.values()):
        raise BadInput("there is no table with a row; `bodycheck run --out DIR` and studies write such folders")
    if untold := {row["case"] for row in rows.get("results.csv", ())} - cases.keys():
        raise BadInput(f"results.csv has runs of {min(untold)}, but there is no such case file")
    return Submission(sha256(manifest).hexdigest()[:KEY_LENGTH], header, rows, cases, contents.files.get(TRACKS, b""))


def _header(header: Mapping[str, Any]) -> HeaderRecord:
    try:
        found = records.typed(HeaderRecord, header)
        if not STARTED.fullmatch(found.started):
            raise ValueError(f"started: {found.started[:40]!r} is no instant, such as 2026-11-23T16:54:16+00:00")
        datetime.fromisoformat(found.started)
    except ValueError as error:
        raise BadInput(f"header: {' '.join(str(error).split())[:400]}") from error
    return found


def _text(name: str, content: bytes) -> str:
    try:
        return content.decode("utf-8")
    except UnicodeDecodeError as error:
        raise BadInput(f"{name}: is not UTF-8 text") from error


def _check_cases(cases: Mapping[str, str]) -> None:
    """Raise `BadInput` if a case file is none, or is not the case after which it is named."""
    own = [name for name in cases if not case_files.is_shipped(name)]
    if len(own) > MOST_OWN_CASES:
        raise BadInput(f"there are {len(own)} cases that do not come with bodycheck; at most {MOST_OWN_CASES} are allowed")
    for name, text in cases.items():
        if case_files.is_shipped(name) and case_files.load(name).text == text:
            continue
        try:
            parsed = case_files.parse_stored(text, f"{name}{CASE_END}")
        except case_files.CaseFaults as error:
            raise BadInput(f"cases: {error}") from error
        if parsed.name != name:
            raise BadInput(f"{name}{CASE_END}: is the case {parsed.name!r}")
        for shown in (parsed.title, parsed.source, *parsed.tags):
            if tables.LOADING.search(shown):
                raise BadInput(f"{name}{CASE_END}: has markup that a browser would load or run")
