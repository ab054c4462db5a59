"""The cases of submissions, and their names on the site.

Each case is read once, since most submissions have the same cases, which come with bodycheck. Any other case keeps its name on
the site, unless submissions use this name for different files. Then a part of the digest of each file is added to the name,
such as `my-case.1f0c9a3b5d7e`, so that no results replace the results of another case.
"""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache, lru_cache
from hashlib import sha256

from bodycheck.casefile import case as case_files
from bodycheck.casefile.content import Case
from bodycheck.casefile.finding import SUFFIX
from bodycheck.casefile.identity import identity
from bodycheck.errors import BadInput
from bodycheck.site.submissions.submission import Row, Submission

#: The names of cases that would collide with pages of the site.
TAKEN = {"index"}

#: The number of characters of the digest of a case file in the name of a case.
MARK_LENGTH = 12


@cache
def shipped(name: str) -> Case | None:
    """Return the case with this name that comes with bodycheck, or None."""
    return case_files.load(name) if name in case_files.shipped() else None


@lru_cache(maxsize=2048)
def read(name: str, text: str) -> Case:
    """Return the case with this name and text. Raises `BadInput` if the text is not a valid case."""
    own = shipped(name)
    if own is not None and own.text == text:
        return own
    try:
        return case_files.parse_stored(text, f"{name}{SUFFIX}")
    except case_files.CaseFaults as error:
        raise BadInput(f"cases/{error}") from error


@lru_cache(maxsize=2048)
def physics(name: str, text: str) -> str:
    """Return a digest of everything in a case that affects its motion. Raises `BadInput` if the text is not a valid case."""
    return identity(read(name, text))


def apart(submissions: Sequence[Submission]) -> tuple[Submission, ...]:
    """Return the submissions with cases renamed where different files have the same name; see the module."""
    texts: dict[str, set[str]] = defaultdict(set)
    for submission in submissions:
        for name, text in submission.cases.items():
            texts[name].add(text)
    shared = {name for name, different in texts.items() if (len(different) > 1 or name in TAKEN) and shipped(name) is None}
    return tuple(
        _renamed(submission, {name: _marked(name, submission.cases[name]) for name in shared & submission.cases.keys()})
        for submission in submissions
    )


def _marked(name: str, text: str) -> str:
    return f"{name}.{sha256(text.encode()).hexdigest()[:MARK_LENGTH]}"


def _renamed(submission: Submission, names: Mapping[str, str]) -> Submission:
    """Return a submission with renamed cases. names: the new names by the old ones."""
    if not names:
        return submission
    without = {
        engine: {names.get(case, case): why for case, why in reasons.items()}
        for engine, reasons in submission.header.without_method.items()
    }
    return replace(
        submission,
        header=replace(
            submission.header,
            without_method=without,
            robots={names.get(case, case): sentences for case, sentences in submission.header.robots.items()},
            departures={names.get(case, case): instant for case, instant in submission.header.departures.items()},
        ),
        tables={name: tuple(_row(row, names) for row in table) for name, table in submission.tables.items()},
        cases={names.get(name, name): text for name, text in submission.cases.items()},
        tracks=submission.tracks.renamed(names),
    )


def _row(row: Row, names: Mapping[str, str]) -> Row:
    return {**row, **{column: names[row[column]] for column in ("case", "scene") if row.get(column) in names}}
