"""The header of a submission: versions, machine, command and start, each with a bounded number of short texts."""

import re
from collections.abc import Mapping
from dataclasses import asdict, fields
from datetime import datetime
from typing import Any

from bodycheck.errors import BadInput
from bodycheck.results import records
from bodycheck.results.records import HeaderRecord
from bodycheck.site.submissions import tables
from bodycheck.site.submissions.texts import text

#: The names of the entries of a header.
KNOWN = tuple(field.name for field in fields(HeaderRecord))

#: An instant as bodycheck writes it, limited to years in which results are possible.
STARTED = re.compile(r"20[2-9][0-9]-[0-9]{2}-[0-9]{2}T[0-9]{2}:[0-9]{2}:[0-9]{2}\+00:00")

#: The name of a package or of a property of a machine.
WORD = re.compile(r"[A-Za-z0-9][A-Za-z0-9 ._=+!-]{0,119}")

#: The most entries of a mapping in the header, and the most words of the command.
MOST_ENTRIES, MOST_WORDS = 500, 300

#: The most characters of a value and of a reason.
LONGEST, LONGEST_REASON = 300, 4000


def checked(header: Mapping[str, Any]) -> HeaderRecord:
    """Return a header with checked entries. Raises `BadInput` if it is invalid; the message says where and why."""
    try:
        if unknown := sorted(header.keys() - set(KNOWN)):
            raise ValueError(f"has {unknown[0][:60]!r}; allowed: {', '.join(KNOWN)}")
        found = records.typed(HeaderRecord, header)
        if not STARTED.fullmatch(found.started):
            raise ValueError(f"started: {found.started[:40]!r} is no instant, such as 2026-11-23T16:54:16+00:00")
        datetime.fromisoformat(found.started)
        _version("bodycheck", found.bodycheck)
        if len(found.command) > MOST_WORDS:
            raise ValueError(f"command: has {len(found.command)} words; at most {MOST_WORDS} are allowed")
        for word in found.command:
            _text("command", word, 1000)
        _words("machine", found.machine)
        _words("packages", found.packages)
        for name, version in found.engines.items():
            _engine("engines", name)
            _text("engines", version, 100)
        groups = ("environments", "demonstrations", "precisions", "defaults", "soft", "without_method")
        for name in ("engines", "missing", *groups):
            _check_by_engine(name, getattr(found, name))
        _check_size("robots", found.robots)
        for sentences in found.robots.values():
            _check_size("robots", dict.fromkeys(sentences))
            for sentence in sentences:
                _text("robots", sentence, LONGEST_REASON)
        _check_size("departures", found.departures)
    except ValueError as error:
        raise BadInput(f"header: {' '.join(str(error).split())[:400]}") from error
    return found


def as_record(header: HeaderRecord) -> dict[str, Any]:
    """Return a header as a JSON object."""
    return asdict(header)


def _check_by_engine(name: str, told: Mapping[str, Any]) -> None:
    """Raise `ValueError` if a mapping by engine, the header entry `name`, is not as bodycheck writes it."""
    _check_size(name, told)
    for engine, value in told.items():
        _engine(name, engine)
        if isinstance(value, Mapping):
            _check_size(f"{name}, {engine}", value)
            for key, one in value.items():
                _text(name, key, 150)
                _text(name, one, 1000)
        else:
            _text(name, value, LONGEST_REASON)


def _words(name: str, told: Mapping[str, str]) -> None:
    _check_size(name, told)
    for key, value in told.items():
        if not WORD.fullmatch(key):
            raise ValueError(f"{name}: {key[:60]!r} is not the name of an entry")
        _text(name, value, LONGEST)


def _check_size(name: str, told: Mapping[str, Any]) -> None:
    if len(told) > MOST_ENTRIES:
        raise ValueError(f"{name}: has {len(told)} entries; at most {MOST_ENTRIES} are allowed")


def _text(name: str, value: str, longest: int) -> None:
    try:
        text(value, longest)
    except ValueError as error:
        raise ValueError(f"{name}: {value[:60]!r} {error}") from error


def _engine(name: str, value: str) -> None:
    try:
        tables.engine(value)
    except (ValueError, BadInput) as error:
        raise ValueError(f"{name}: {value[:60]!r} is not the name of an engine") from error


def _version(name: str, value: str) -> None:
    try:
        tables.version(value)
    except ValueError as error:
        raise ValueError(f"{name}: {value[:40]!r} {error}") from error
