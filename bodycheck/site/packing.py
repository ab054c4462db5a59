"""A results folder as a submission, without what is personal: paths, and with them names of users."""

import json
import re
from collections.abc import Mapping, Sequence
from hashlib import sha256
from pathlib import Path
from typing import Any

from bodycheck.casefile import case as case_files
from bodycheck.errors import BadInput
from bodycheck.files import reading
from bodycheck.running import journal, records, store
from bodycheck.running.origin import BESIDE
from bodycheck.site.contents import CASE_END, CASES, TABLES, Contents
from bodycheck.site.tables import TABLES as KNOWN

#: Most bytes of a table, and of the file beside it.
MOST_BYTES = 1 << 26

#: A path from the root up to its last part; of a text it is left out. A scheme and a unit such as m/s are no paths.
PATH = re.compile(r"(?<![\w.:/])(?:[A-Za-z]:)?[/\\](?:[^\s/\\:;,'\"<>|]+[/\\])+")

#: Options of commands whose value is a path or concerns the machine alone.
LEFT_OUT = ("--out", "--junit", "--save", "--jobs", "--package-path")


def contents(folder: Path) -> Contents:
    """Return what a submission of a results folder contains.

    Raises `BadInput` if the folder has no table of bodycheck, or a damaged one.
    """
    reading.refuse_links(folder)
    names = [name for name in KNOWN if (folder / name).is_file()]
    if not names:
        raise BadInput(f"{folder}: has none of the tables {', '.join(KNOWN)}; `bodycheck run --out DIR` and studies write them")
    note = _note(folder / names[0])
    header = {name: note[name] for name in records.HeaderRecord.__dataclass_fields__ if name in note}
    header["command"] = cleaned_command([str(word) for word in header.get("command", ())])
    files = {f"{TABLES}{name}": without_paths(reading.content(folder / name, MOST_BYTES)) for name in names}
    files |= {f"{CASES}{name}{CASE_END}": text.encode() for name, text in _cases(folder, note).items()}
    return Contents(_printable(header), files)


def cleaned_command(words: Sequence[str]) -> list[str]:
    """Return the words of a command without paths, and without options that concern the machine alone."""
    kept, skip = [], False
    for word in words[1:]:
        if skip:
            skip = False
        elif word in LEFT_OUT:
            skip = True
        elif not word.startswith(tuple(f"{option}=" for option in LEFT_OUT)):
            kept.append(word if word.startswith("-") else re.split(r"[/\\]", word.rstrip("/\\"))[-1])
    return ["bodycheck", *kept]


def without_paths(content: bytes) -> bytes:
    """Return a table in whose texts only the last parts of paths are left."""
    return PATH.sub("", content.decode("utf-8", "replace")).encode()


def _printable(value: Any) -> Any:
    """Return a value of JSON without paths in its texts."""
    if isinstance(value, dict):
        return {key: _printable(one) for key, one in value.items()}
    if isinstance(value, list):
        return [_printable(one) for one in value]
    return PATH.sub("", value) if isinstance(value, str) else value


def _note(table: Path) -> Mapping[str, Any]:
    """Return where the numbers of a table come from."""
    beside = table.with_name(table.name + BESIDE)
    try:
        (note, *more) = json.loads(reading.content(beside, MOST_BYTES))["notes"]
    except FileNotFoundError as error:
        raise BadInput(f"{beside}: is missing; it says where the numbers of {table.name} come from") from error
    except (ValueError, TypeError, KeyError, RecursionError) as error:
        raise BadInput(f"{beside}: is not as bodycheck writes it") from error
    if more or not isinstance(note, dict):
        raise BadInput(f"{table}: has the results of several folders; submit each of them by itself")
    return note


def _cases(folder: Path, note: Mapping[str, Any]) -> dict[str, str]:
    """Return the texts of the cases of a folder by name: those stored in it, or those that come with bodycheck."""
    digests = note.get("cases_sha256", {})
    if not isinstance(digests, dict):
        raise BadInput(f"{folder}: the digests of its cases are not as bodycheck writes them")
    found: dict[str, str] = {}
    if (folder / store.RECORDS).is_file():
        found = {str(case["name"]): str(case["text"]) for case in journal.read(folder / store.RECORDS).header["cases"]}
    for name, digest in digests.items():
        if name not in found and case_files.is_shipped(name):
            found[name] = case_files.load(name).text
        if name in found and sha256(found[name].encode()).hexdigest() != digest:
            raise BadInput(f"{folder}: {name} is not the case whose digest its tables have")
    return found
