"""The files of signals of controllers: CSV files in the folder of the case file or below it, whose first column is `t` (s).

What was read of them is appended to the text of the case as tables `[[signals]]`, so that the text contains all numbers of the
motion and is read again without any file. The files may come from strangers: they are regular files of limited size, and no
link leads out of the folder.
"""

import csv
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from hashlib import sha256
from itertools import pairwise
from pathlib import Path as FilePath
from typing import Any

from pydantic import TypeAdapter, ValidationError

from bodycheck.casefile.formats import is_mechanism
from bodycheck.casefile.mechanisms.control_grammar import MAX_SIGNAL, SIGNALS, ReadSignalTable, kind_of_signal
from bodycheck.casefile.mechanisms.grammar import MAX_BODIES
from bodycheck.casefile.raw_values import mapping, quote, tables_of
from bodycheck.casefile.toml_positions import Path
from bodycheck.casefile.toml_text import in_line
from bodycheck.casefile.values import Number
from bodycheck.files import reading
from bodycheck.robots.named_files import Folders, NotFound
from bodycheck.suggestion import did_you_mean, first_names

#: The mark between the text of a case file and what was read of files of signals.
MARK = "\n# What was read of the files of signals; bodycheck writes and reads this.\n"

#: The largest size of a file (bytes), the largest number of files, and the largest number of values that are stored in all.
MAX_BYTES, MAX_FILES, MAX_STORED = 4 << 20, 100, 500_000

#: The heading of the first column.
TIME = "t"

#: The most faults of one file that are listed.
MAX_FAULTS = 10

#: The text of a number of a file; the sizes that are allowed are those of the grammar.
NUMBER = re.compile(r"\s*[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?\s*", re.ASCII)
_number: TypeAdapter[float] = TypeAdapter(Number)


@dataclass(frozen=True)
class _Reference:
    """A signal that names a column of a file: the index of its controller, the key of the signal, and the two names."""

    controller: int
    key: str
    file: str
    column: str

    @property
    def path(self) -> Path:
        """The path of the table of the signal in the document."""
        return ("controllers", self.controller, self.key)


@dataclass(frozen=True)
class _Csv:
    """The content of a file: its digest, its headings, and its rows, each with its number in the file, counted from 1."""

    digest: str
    headings: Sequence[str]
    rows: Sequence[tuple[int, Sequence[str]]]


class _Faults(Exception):
    """Raised for a file with faults; `texts` has a text for each."""

    def __init__(self, texts: Sequence[str]) -> None:
        super().__init__("\n".join(texts))
        more = len(texts) - MAX_FAULTS
        self.texts = [*texts[:MAX_FAULTS], *([f"has {more} more faults"] if more > 0 else [])]


def with_signals(text: str, document: Mapping[str, Any], folder: FilePath) -> tuple[str, tuple[tuple[Path, str], ...]]:
    """Return the text of a case file with what was read of its files of signals, and the faults of these files.

    The text is returned as it is if it names no file, or has what was read of them. folder: the folder of the case file.
    """
    references = list(_references(document))
    if not references or "signals" in document:
        return text, ()
    folders, contents = Folders(folder.resolve()), dict[str, _Csv | _Faults]()
    tables, faults = dict[tuple[str, str], str](), list[tuple[Path, str]]()
    stored = 0
    for each in references:
        try:
            times, values = _signal(_content(each.file, folders, contents), each.column)
        except _Faults as error:
            faults += [((*each.path, "file"), f"{quote(each.file)[1:-1]}: {fault}") for fault in error.texts]
            continue
        content = contents[each.file]
        assert isinstance(content, _Csv)  # `_content` raises the other kind
        keys = {"file": each.file, "sha256": content.digest, "column": each.column, "times": times, "values": values}
        if (each.file, each.column) not in tables:
            stored += 2 * len(times)
            tables[each.file, each.column] = "".join(f"{key} = {in_line(value)}\n" for key, value in keys.items())
    if stored > MAX_STORED:
        message = f"the files of signals have {stored} times and values in all; allowed: {MAX_STORED}"
        faults.append((references[0].path, message))
    if faults:
        return text, tuple(dict.fromkeys(faults))
    return text + MARK + "\n".join(f"[[signals]]\n{table}" for table in tables.values()), ()


def resolved(document: dict[str, Any]) -> tuple[dict[str, Any], tuple[tuple[Path, str], ...]]:
    """Return a document with the values of signals in the place of the names of files, and faults of signals not read."""
    references = list(_references(document))
    if not references:
        return document, ()
    columns = {(each["file"], each["column"]): each for each in _valid(document)}
    controllers, faults = [dict(table) for table in tables_of(document, "controllers", 2 * MAX_BODIES)], []
    for each in references:
        if (read := columns.get((each.file, each.column))) is None:
            faults.append(((*each.path, "file"), "is read only where a case file is loaded from its folder"))
            continue
        controller = controllers[each.controller]
        others = {name: value for name, value in controller[each.key].items() if name not in ("file", "column")}
        controller[each.key] = {"times": read["times"], "values": read["values"], **others}
    return {**document, "controllers": controllers}, tuple(faults)


def _valid(document: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """Yield the tables `[[signals]]` without faults; the grammar reports the others."""
    for table in tables_of(document, "signals", 3 * MAX_BODIES):
        try:
            ReadSignalTable.model_validate(table)
        except ValidationError:
            continue
        yield table


def _references(document: Mapping[str, Any]) -> Iterator[_Reference]:
    """Yield the signals of a raw document that name a column of a file."""
    if not is_mechanism(document):
        return
    for index, controller in enumerate(tables_of(document, "controllers", 2 * MAX_BODIES)):
        for key in SIGNALS:
            signal = mapping(controller.get(key))
            file, column = signal.get("file"), signal.get("column")
            if kind_of_signal(signal) == "file" and isinstance(file, str) and isinstance(column, str):
                yield _Reference(index, key, file, column)


def _content(name: str, folders: Folders, contents: dict[str, "_Csv | _Faults"]) -> _Csv:
    """Return the content of a named file, which is kept in `contents`. Raises `_Faults` if it cannot be read."""
    if name not in contents:
        try:
            if len(contents) >= MAX_FILES:
                raise _Faults([f"is one of over {MAX_FILES} files"])
            contents[name] = _read(name, folders)
        except _Faults as error:
            contents[name] = error
    if isinstance(content := contents[name], _Faults):
        raise content
    return content


def _read(name: str, folders: Folders) -> _Csv:
    """Return the content of a named file. Raises `_Faults` if it is missing, elsewhere or no CSV file."""
    if "://" in name:
        raise _Faults(["is no path; allowed: the path of a file from the folder of the case file"])
    try:
        content = reading.content(folders.find(name, (folders.home,)), MAX_BYTES)
        lines = content.decode("utf-8-sig").splitlines()
    except NotFound as error:
        raise _Faults(["there is no such file in the folder of the case file or below it"]) from error
    except reading.Refused as error:
        raise _Faults([error.reason]) from error
    except UnicodeDecodeError as error:
        raise _Faults(["cannot be read: it is not UTF-8"]) from error
    except OSError as error:
        raise _Faults([f"cannot be read: {error.strerror}"]) from error
    reader = csv.reader(lines, strict=True)
    try:
        rows = [(reader.line_num, row) for row in reader if row]
    except csv.Error as error:
        raise _Faults([f"line {reader.line_num}: is no CSV: {error}"]) from error
    headings = [heading.strip() for heading in rows[0][1]] if rows else []
    if not headings or headings[0] != TIME:
        read = f"read {quote(headings[0])}; " if headings else "is empty; "
        raise _Faults([f"line 1, column 1: {read}allowed: the heading {TIME}, for the times (s)"])
    if not 1 <= len(rows) - 1 <= MAX_SIGNAL:
        raise _Faults([f"has {len(rows) - 1} rows below the headings; allowed: 1 to {MAX_SIGNAL}"])
    return _Csv(sha256(content).hexdigest(), headings, rows[1:])


def _signal(content: _Csv, column: str) -> tuple[list[float], list[float]]:
    """Return the times (s) and the values of a column. Raises `_Faults` that name the row and the column of each fault."""
    if content.headings.count(column) != 1 or column == TIME:
        allowed = [heading for heading in content.headings[1:] if content.headings.count(heading) == 1]
        listed = ", ".join(first_names([quote(heading)[1:-1] for heading in allowed])) or "none, as it has no other column"
        raise _Faults([f"has no column {quote(column)}; allowed: {listed}{did_you_mean(column, allowed)}"])
    faults, series = [], (list[float](), list[float]())
    columns = (0, content.headings.index(column))
    for line, row in content.rows:
        if len(row) != len(content.headings):
            faults.append(f"line {line}: has {len(row)} fields; allowed: {len(content.headings)}, as many as headings")
            continue
        for index, values in zip(columns, series, strict=True):
            try:
                values.append(_value(row[index]))
            except ValueError:
                heading = quote(content.headings[index])[1:-1]
                faults.append(f"line {line}, column {heading}: read {quote(row[index])}; allowed: a number of at most 1e100")
    times, values = series
    if not faults:
        for (before, after), (line, row) in zip(pairwise(times), content.rows[1:], strict=True):
            if not before < after:
                read = f"line {line}, column {TIME}: read {row[0].strip()}"
                faults.append(f"{read}; allowed: a time after {before!r}, as times ascend")
    if faults:
        raise _Faults(faults)
    return times, values


def _value(text: str) -> float:
    """Return the number of a field. Raises `ValueError` if it is none, or of a size that is not allowed."""
    if len(text) > 100 or not NUMBER.fullmatch(text):
        raise ValueError
    return _number.validate_python(float(text))
