"""The names that cases which do not come with bodycheck have on the site.

A case has its own name there, unless submissions give one name to different files. Then each of these has a part of the digest
of its text in its name, such as `my-case.1f0c9a3b5d7e`, so that nobody pushes out the results of another.
"""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import replace
from hashlib import sha256

from bodycheck.site.submissions import cases
from bodycheck.site.submissions.submission import Row, Submission

#: Names that pages of the site have themselves.
TAKEN = {"index"}

#: Characters of the digest of a case file in the name of a case.
MARK_LENGTH = 12


def apart(submissions: Sequence[Submission]) -> tuple[Submission, ...]:
    """Return submissions in which no two cases with different files have one name."""
    texts: dict[str, set[str]] = defaultdict(set)
    for one in submissions:
        for name, text in one.cases.items():
            texts[name].add(text)
    shared = {name for name, own in texts.items() if (len(own) > 1 or name in TAKEN) and cases.shipped(name) is None}
    return tuple(
        _renamed(one, {name: _marked(name, one.cases[name]) for name in shared & one.cases.keys()}) for one in submissions
    )


def _marked(name: str, text: str) -> str:
    return f"{name}.{sha256(text.encode()).hexdigest()[:MARK_LENGTH]}"


def _renamed(submission: Submission, names: Mapping[str, str]) -> Submission:
    """Return a submission with other names of cases."""
    if not names:
        return submission
    without = {
        engine: {names.get(case, case): why for case, why in own.items()}
        for engine, own in submission.header.without_method.items()
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
