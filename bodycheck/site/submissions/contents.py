"""The files of a submission, and the check that makes a `Submission` from them."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from hashlib import sha256
from typing import Any

from bodycheck.casefile.content import Case
from bodycheck.casefile.finding import SUFFIX
from bodycheck.errors import BadInput
from bodycheck.results.outcome import Completed
from bodycheck.site.submissions import cases as case_texts
from bodycheck.site.submissions import headers, plausible, tables, tracks
from bodycheck.site.submissions.submission import Row, Submission
from bodycheck.site.submissions.texts import text
from bodycheck.site.submissions.tracks import Tracks

#: The version of the format.
FORMAT = 1

#: The folders and files in a submission, and the end of the names of case files.
TABLES, CASES, TRACKS = "tables/", "cases/", "tracks.json"
CASE_END = SUFFIX

#: The number of characters of the digest in a key: so many that nobody can find other contents with the same key.
KEY_LENGTH = 20

#: The most cases that do not come with bodycheck, the most bytes of one case, and the most characters of all such cases.
MOST_OWN_CASES, LONGEST_CASE, LONGEST_CASES = 100, 1 << 19, 1 << 20


@dataclass(frozen=True)
class Contents:
    """The header of a submission, and the contents of its files by their names inside the submission."""

    header: Mapping[str, Any]
    files: Mapping[str, bytes]

    @property
    def digests(self) -> dict[str, str]:
        """Return the SHA-256 of each file."""
        return {name: sha256(content).hexdigest() for name, content in sorted(self.files.items())}


def manifest(contents: Contents) -> bytes:
    """Return the content of submission.json: format, header and digests."""
    told = {"format": FORMAT, "header": dict(contents.header), "files": contents.digests}
    return (json.dumps(told, indent=1, sort_keys=True, ensure_ascii=True, allow_nan=False) + "\n").encode()


def checked(contents: Contents) -> Submission:
    """Return the submission with these contents, after all checks.

    Raises
    ------
    BadInput
        The contents are not as bodycheck writes them; the message says what is wrong, and where.
    """
    header = headers.checked(_sorted(contents.header))
    files = dict(sorted(contents.files.items()))
    texts = {
        name.removeprefix(CASES).removesuffix(CASE_END): _text(name, content)
        for name, content in files.items()
        if name.startswith(CASES)
    }
    cases = _cases(texts)
    rows = {
        name.removeprefix(TABLES): tables.read(name.removeprefix(TABLES), content)
        for name, content in files.items()
        if name.startswith(TABLES)
    }
    if not any(rows.values()):
        raise BadInput("there is no table with a row; `bodycheck run --out DIR` and studies write such folders")
    for name, table in rows.items():
        plausible.check(name, table, cases, header.engines)
    key = sha256(manifest(replace(contents, header=headers.as_record(header)))).hexdigest()[:KEY_LENGTH]
    told = {engine: why for engine, why in header.without_method.items() if engine in header.engines}
    header = replace(header, without_method=told)
    return Submission(key, header, rows, texts, _tracks(contents, cases, rows.get("results.csv", ())))


def _tracks(contents: Contents, cases: Mapping[str, Case], rows: Sequence[Row]) -> Tracks:
    """Return the tracks of a submission. rows: the rows of its results.csv."""
    if TRACKS not in contents.files:
        return tracks.NO_TRACKS
    runs = [tuple(row[column] for column in tracks.RUN) for row in rows if row["status"] == Completed.status]
    return tracks.read(contents.files[TRACKS], cases, runs)


def _sorted(value: Any) -> Any:
    """Return a JSON value with sorted objects, so that the site does not depend on the order in a submission."""
    if isinstance(value, Mapping):
        return {key: _sorted(value[key]) for key in sorted(value)}
    return value


def _text(name: str, content: bytes) -> str:
    if len(content) > LONGEST_CASE:
        raise BadInput(f"{name}: has {len(content)} bytes; at most {LONGEST_CASE} are allowed")
    try:
        return content.decode("utf-8")
    except UnicodeDecodeError as error:
        raise BadInput(f"{name}: is not UTF-8 text") from error


def _cases(texts: Mapping[str, str]) -> dict[str, Case]:
    """Return the cases of a submission by name. texts: the texts of the case files by name.

    Raises `BadInput` if a text is not a valid case or has another name, or if there are too many or too large cases.
    """
    own = [name for name in texts if case_texts.shipped(name) is None]
    if len(own) > MOST_OWN_CASES:
        raise BadInput(f"there are {len(own)} cases that do not come with bodycheck; at most {MOST_OWN_CASES} are allowed")
    if (size := sum(len(texts[name]) for name in own)) > LONGEST_CASES:
        raise BadInput(f"the cases that do not come with bodycheck have {size} characters; at most {LONGEST_CASES} are allowed")
    found = {}
    for name, content in texts.items():
        found[name] = case = case_texts.read(name, content)
        if case.name != name:
            raise BadInput(f"{CASES}{name}{CASE_END}: is the case {case.name!r}")
        shipped = case_texts.shipped(name)
        if shipped is not None and case_texts.physics(name, content) != case_texts.physics(name, shipped.text):
            raise BadInput(
                f"{CASES}{name}{CASE_END}: is not the case that comes with bodycheck under this name; give it another name, or"
                " run the one that comes with this version"
            )
        for key, shown in (("title", case.title), ("source", case.source), *(("tags", tag) for tag in case.tags)):
            try:
                text(shown)
            except ValueError as error:
                raise BadInput(f"{CASES}{name}{CASE_END}: {key}: {shown[:60]!r} {error}") from error
    return found
