"""A results folder as a zip file for others, and what the file has and lacks, in words."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from bodycheck.errors import BadInput
from bodycheck.site.submissions import archive, cases, packing, personal
from bodycheck.site.submissions.submission import Submission
from bodycheck.site.submissions.tables import TABLES


@dataclass(frozen=True, eq=False)
class Packed:
    """A submission as a file.

    Parameters
    ----------
    content
        The bytes of the zip file.
    submission
        The submission, as the site reads it from them.
    removed
        How many things of each kind were removed because they may be personal, by words for the kind.
    """

    content: bytes
    submission: Submission
    removed: Mapping[str, int]


def packed(folder: Path) -> Packed:
    """Return a results folder as a submission. Raises `BadInput` if the folder is not as bodycheck writes it."""
    cleaning = personal.Cleaning(personal.own_names())
    try:
        content = archive.zipped(packing.contents(folder, cleaning))
        if len(content) > archive.MOST_PACKED:
            raise BadInput(f"makes a file of {len(content)} bytes; at most {archive.MOST_PACKED} are allowed")
        return Packed(content, archive.read(content), cleaning.removed)
    except BadInput as error:
        told = str(error)
        raise BadInput(told if told.startswith(str(folder)) else f"{folder}: {told}") from error


def told(made: Packed) -> Iterator[str]:
    """Yield what a submission has, and what was removed, as lines."""
    source = made.submission
    for name, rows in source.tables.items():
        yield f"{name}: {_count(len(rows), 'row')} ({TABLES[name].title})"
    own = [name for name in source.cases if cases.shipped(name) is None]
    yield f"cases: {len(source.cases)}" + (f", of which with their whole text in public: {', '.join(own)}" if own else "")
    yield f"engines: {', '.join(f'{name} {version}' for name, version in source.header.engines.items())}"
    yield f"machine: {source.machine}"
    yield f"command: {source.command}"
    yield f"removed: {', '.join(f'{kind} ({count})' for kind, count in sorted(made.removed.items())) or 'nothing'}"
    yield f"size: {len(made.content) / 1000:.0f} kB"


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"
