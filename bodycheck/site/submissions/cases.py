"""The cases of submissions, and the names that those which do not come with bodycheck have on the site.

Each case is read once: most submissions have the same ones, those that come with bodycheck. Another case has its own name,
unless submissions give one name to different files. Then each of these has a part of the digest of its text in its name, such
as `my-case.1f0c9a3b5d7e`, so that nobody pushes out the results of another.
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

#: Names that pages of the site have themselves.
TAKEN = {"index"}

#: Characters of the digest of a case file in the name of a case.
MARK_LENGTH = 12


@cache
def shipped(name: str) -> Case | None:
    """Return the case with this name that comes with bodycheck, or None."""
    return case_files.load(name) if name in case_files.shipped() else None


@lru_cache(maxsize=2048)
def read(name: str, text: str) -> Case:
    """Return the case of a submission. Raises `BadInput` if the text is that of no case."""
    own = shipped(name)
    if own is not None and own.text == text:
        return own
    try:
        return case_files.parse_stored(text, f"{name}{SUFFIX}")
    except case_files.CaseFaults as error:
        raise BadInput(f"cases/{error}") from error


@lru_cache(maxsize=2048)
def physics(name: str, text: str) -> str:
    """Return a digest of what affects the motion of the case of a submission. Raises `BadInput` if the text is that of none."""
    return identity(read(name, text))


def apart(submissions: Sequence[Submission]) -> tuple[Submission, ...]:
    """Return submissions in which no two cases with different files have one name."""
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
    """Return a submission with other names of cases."""
    if not names:
        return submission
    without = {
        engine: {names.get(case, case): why for case, why in reasons.items()}
        for engine, reasons in submission.header.without_method.items()
    }
    return replace(
        submission,
        header=replace(submission.header, without_method=without),
        tables={name: tuple(_row(row, names) for row in table) for name, table in submission.tables.items()},
        cases={names.get(name, name): text for name, text in submission.cases.items()},
        tracks=submission.tracks.renamed(names),
    )


def _row(row: Row, names: Mapping[str, str]) -> Row:
    return {**row, **{column: names[row[column]] for column in ("case", "scene") if row.get(column) in names}}
