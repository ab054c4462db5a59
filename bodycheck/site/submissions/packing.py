"""Conversion of a results folder to a submission and a zip file for others, without personal data.

Tables of robot models are condensed, because the site only counts their many rows in which two numbers agree.
"""

import csv
import io
import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from hashlib import sha256
from pathlib import Path
from typing import Any

from bodycheck.errors import BadInput
from bodycheck.files import reading
from bodycheck.reports.quantities import count
from bodycheck.results import journal, records, store
from bodycheck.results.csv_tables import entry as csv_entry
from bodycheck.results.origin import BESIDE
from bodycheck.site.submissions import archive, personal, tables, tracing, tracks
from bodycheck.site.submissions import cases as case_texts
from bodycheck.site.submissions.contents import CASE_END, CASES, TABLES, TRACKS, Contents
from bodycheck.site.submissions.personal import Cleaning
from bodycheck.site.submissions.submission import Submission
from bodycheck.site.submissions.texts import escaped, published

#: The most bytes of a table, and of the file beside it.
MOST_BYTES, MOST_BESIDE = 1 << 25, 1 << 23

#: Tables of studies that the site has no pages for.
UNKNOWN = ("extremes.csv", "recommend.csv", "ablation.csv", "sensors.csv")

#: Columns of names of models and their parts, which may look like paths. The kind of what is removed from them.
PARTS = ("subject", "model")
ESCAPED = "characters of names of robots' parts, for which there are escapes"

#: The columns of parity.csv whose values are equal in rows about the same quantity.
SAME = ("model", "engine", "version", "quantity")


@dataclass(frozen=True, eq=False)
class Packed:
    """A submission as a file.

    Parameters
    ----------
    content
        The bytes of the zip file.
    submission
        The submission, as the site reads it from the zip file.
    removed
        The number of items of each kind that were removed because they may be personal, by the name of the kind.
    """

    content: bytes
    submission: Submission
    removed: Mapping[str, int]


def packed(folder: Path) -> Packed:
    """Return a results folder as a packed submission. Raises `BadInput` if the folder is not as bodycheck writes it."""
    cleaning = personal.Cleaning(personal.own_names())
    try:
        content = archive.zipped(contents(folder, cleaning))
        if len(content) > archive.MOST_PACKED:
            raise BadInput(f"makes a file of {len(content)} bytes; at most {archive.MOST_PACKED} are allowed")
        return Packed(content, archive.read(content), cleaning.removed)
    except BadInput as error:
        reason = str(error)
        raise BadInput(reason if reason.startswith(str(folder)) else f"{folder}: {reason}") from error


def told(submission: Packed) -> Iterator[str]:
    """Yield lines of text that list the content of a submission and the removed items."""
    source = submission.submission
    for name, rows in source.tables.items():
        yield f"{name}: {count(len(rows), 'row')} ({tables.TABLES[name].title})"
    public = [name for name in source.cases if case_texts.shipped(name) is None]
    yield f"cases: {len(source.cases)}" + (f", of which with their whole text in public: {', '.join(public)}" if public else "")
    yield f"engines: {', '.join(f'{name} {version}' for name, version in source.header.engines.items())}"
    yield f"machine: {source.machine}"
    yield f"command: {source.command}"
    yield f"removed: {', '.join(f'{kind} ({count})' for kind, count in sorted(submission.removed.items())) or 'nothing'}"
    yield f"size: {len(submission.content) / 1000:.0f} kB"


def contents(folder: Path, cleaning: Cleaning | None = None) -> Contents:
    """Return the contents of a submission from a results folder.

    Parameters
    ----------
    folder
        A folder that `--out` of a command wrote.
    cleaning
        The `Cleaning` that removes personal data from texts; by default a `Cleaning` without names.

    Raises
    ------
    BadInput
        The folder has no table that the site knows, contains a symbolic link, or is damaged.
    """
    clean = cleaning or Cleaning()
    names = [name for name in tables.TABLES if (folder / name).is_file()]
    if not names:
        raise BadInput(f"{folder}: {_nothing(folder)}")
    for path in (folder / store.RECORDS, *(folder / f"{name}{end}" for name in names for end in ("", BESIDE))):
        if path.is_symlink():
            raise BadInput(f"{path}: is a symbolic link; a results folder must not contain any, remove it")
    note = _note([folder / name for name in names])
    header = {name: note[name] for name in records.HeaderRecord.__dataclass_fields__ if name in note}
    words = header.pop("command", None)
    if not isinstance(words, list):
        raise BadInput(f"{folder / names[0]}{BESIDE}: has no command")
    header = {**_cleaned(header, clean), "command": [published(word) for word in clean.command([str(word) for word in words])]}
    files = {f"{TABLES}{name}": _table(folder / name, clean) for name in names}
    files |= {f"{CASES}{name}{CASE_END}": text.encode() for name, text in _cases(folder, note, clean).items()}
    if "results.csv" in names and (folder / store.RECORDS).is_file():
        found = tracing.traced(folder, tables.read("results.csv", files[f"{TABLES}results.csv"]))
        files[TRACKS] = tracks.written(replace(found, truths=_cleaned(dict(found.truths), clean)))
    return Contents(header, files)


def _content(path: Path, most: int) -> bytes:
    """Return the content of a file. most: the most bytes. Raises `BadInput` if it is too large or cannot be read."""
    try:
        return reading.content(path, most)
    except FileNotFoundError:
        raise
    except OSError as error:
        raise BadInput(str(error)) from error


def _nothing(folder: Path) -> str:
    """Return why a folder that has none of the tables cannot be a submission."""
    if other := next((name for name in UNKNOWN if (folder / name).is_file()), None):
        return f"has {other}, which the site has no pages for; allowed: {', '.join(tables.TABLES)}"
    return f"has none of the tables {', '.join(tables.TABLES)}; `bodycheck run --out DIR` and studies write them"


def _table(path: Path, clean: Cleaning) -> bytes:
    """Return the content of a table without personal data and without characters that a submission must not have."""
    content = _content(path, MOST_BYTES)
    try:
        rows = list(csv.reader(io.StringIO(content.decode("utf-8"), newline=""), strict=True))
    except (UnicodeDecodeError, csv.Error) as error:
        raise BadInput(f"{path}: is not a CSV table in UTF-8: {str(error)[:200]}") from error
    whole = len(rows)
    if path.name == "parity.csv":
        rows = list(map(list, condensed(rows)))
    columns = tables.TABLES[path.name].by_name
    heads = rows[0] if rows else []
    of_texts = {name for name in heads if name in columns and "text" in tables.kind(columns[name])}
    texts = [(index, _name if name in PARTS else _text) for index, name in enumerate(heads) if name in of_texts]
    known: dict[tuple[str, Callable[[str, Cleaning], str]], str] = {}
    for row in rows[1:]:
        for place, cleaned in texts:
            if place < len(row) and (entry := row[place]):
                if (entry, cleaned) not in known:
                    text = tables.plain(entry)
                    clean_text = cleaned(text, clean)
                    known[entry, cleaned] = entry if clean_text == text else csv_entry(clean_text)
                row[place] = known[entry, cleaned]
    return _written(rows) if len(rows) < whole or any(entry != text for (entry, _), text in known.items()) else content


def _text(text: str, clean: Cleaning) -> str:
    """Return a text without personal data and without what a submission must not have."""
    return published(clean.text(text))


def _name(name: str, clean: Cleaning) -> str:
    """Return the name of a robot's part without e-mail addresses and home folders, with escapes for what it must not have."""
    public = clean.text(name) if personal.first(name) is not None else name
    if (shorter := escaped(public)) != public:
        clean.removed[ESCAPED] += 1
    return shorter


def _written(rows: Iterable[list[str]]) -> bytes:
    stream = io.StringIO()
    csv.writer(stream, lineterminator="\n").writerows(rows)
    return stream.getvalue().encode()


def _cleaned(value: Any, clean: Cleaning) -> Any:
    """Return a JSON value with all personal data removed from its texts."""
    if isinstance(value, dict):
        return {published(clean.text(key)): _cleaned(one, clean) for key, one in value.items()}
    if isinstance(value, list):
        return [_cleaned(one, clean) for one in value]
    return published(clean.text(value)) if isinstance(value, str) else value


def _note(paths: list[Path]) -> Mapping[str, Any]:
    """Return the origin of the numbers in tables. Raises `BadInput` unless it is the same for all of them."""
    notes = [_note_of(path) for path in paths]
    for path, note in zip(paths, notes, strict=True):
        if note != notes[0]:
            raise BadInput(f"{path}: has the results of another command than {paths[0].name}; submit each separately")
    return notes[0]


def _note_of(table: Path) -> Mapping[str, Any]:
    """Return the origin of the numbers in a table, from the file beside it."""
    beside = table.with_name(table.name + BESIDE)
    try:
        (note, *more) = json.loads(_content(beside, MOST_BESIDE))["notes"]
    except FileNotFoundError as error:
        raise BadInput(f"{beside}: is missing; it says where the numbers of {table.name} come from") from error
    except (ValueError, TypeError, KeyError, RecursionError) as error:
        raise BadInput(f"{beside}: is not as bodycheck writes it") from error
    if more or not isinstance(note, dict):
        raise BadInput(f"{table}: has the results of several folders; submit each folder separately")
    return note


def _cases(folder: Path, note: Mapping[str, Any], clean: Cleaning) -> dict[str, str]:
    """Return the texts of the cases of a folder by name: as stored in the folder, or else as they come with bodycheck."""
    stored = _stored(folder)
    found: dict[str, str] = {}
    for key, digest_of in (("cases_sha256", _digest), ("cases_physics_sha256", case_texts.physics)):
        digests = note.get(key, {})
        if not isinstance(digests, dict):
            raise BadInput(f"{folder}: the digests of its cases are not as bodycheck writes them")
        for name, digest in digests.items():
            shipped = case_texts.shipped(name)
            text = stored.get(name) or (shipped.text if shipped is not None else None)
            if text is None:
                raise BadInput(f"{folder}: {str(name)[:60]} does not come with bodycheck, and its file is not in the folder")
            if digest_of(name, text) != digest:
                raise BadInput(f"{folder}: {name} is not the case whose digest its tables have; run it again with this version")
            found[name] = text if shipped is not None else _without_personal(name, text, clean)
    return found


def _stored(folder: Path) -> dict[str, str]:
    """Return the texts of the cases in a folder by name: from its journal, or from case files if there is no journal."""
    path = folder / store.RECORDS
    if path.is_file():
        return {str(case["name"]): str(case["text"]) for case in journal.header(path).get("cases", ())}
    files = [path for path in folder.glob(f"*{CASE_END}") if path.is_file() and not path.is_symlink()]
    return {path.name.removesuffix(CASE_END): _content(path, MOST_BESIDE).decode("utf-8", "replace") for path in files}


def _digest(name: str, text: str) -> str:
    return sha256(text.encode()).hexdigest()


def _without_personal(name: str, text: str, clean: Cleaning) -> str:
    """Return the text of a case that does not come with bodycheck, without personal data.

    Raises `BadInput` if the removal changes the physics of the case.
    """
    lines = [clean.text(line) for line in text.split("\n")]
    cleaned = "\n".join(lines)
    if cleaned != text and case_texts.physics(name, cleaned) != case_texts.physics(name, text):
        line = next(place for place, (one, other) in enumerate(zip(lines, text.split("\n"), strict=True), 1) if one != other)
        raise BadInput(f"{name}{CASE_END}:{line}: has a path, an address or a name as part of the physics; rename it")
    return cleaned


def condensed(rows: Sequence[Sequence[str]]) -> list[Sequence[str]]:
    """Return the rows of parity.csv without most rows in which the engine agrees with the file. rows: the head is the first.

    Of the rows with the status "agrees" about one quantity of one robot in one engine, only the row with the largest relative
    difference is kept. All other rows are kept, in their order. If the table lacks columns, or a row has another length than
    the head, all rows are returned.
    """
    head = list(rows[0]) if rows else []
    if not {*SAME, "status", "relative"} <= set(head) or any(len(row) != len(head) for row in rows):
        return list(rows)
    same, status, relative = [head.index(name) for name in SAME], head.index("status"), head.index("relative")
    largest: dict[tuple[str, ...], tuple[float, int]] = {}
    for index, row in enumerate(rows[1:], start=1):
        if row[status] == "agrees":
            about = tuple(row[column] for column in same)
            size = (_size(row[relative]), -index)
            largest[about] = max(largest.get(about, size), size)
    kept = {-index for _, index in largest.values()}
    return [row for index, row in enumerate(rows) if row[status] != "agrees" or index in kept]


def _size(text: str) -> float:
    """Return the number in a text, or -1 if the text is not a number, as for quantities that are compared as words."""
    try:
        return float(text)
    except ValueError:
        return -1.0
