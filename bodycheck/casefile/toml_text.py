"""Write the document of a case file as TOML, so that reading it gives the same document."""

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any


def written(document: Mapping[str, Any]) -> str:
    """Return the text of a document that the grammar of case files allows.

    Tables and the tables of an array have headers; a table inside a table of an array is written in one line. A double is
    written with the fewest digits that give the same double.

    Raises `ValueError` for infinities, NaN and dates, which no case file may have.
    """
    return "\n".join(_table((), document)) + "\n"


def short(document: Mapping[str, Any], comments: Sequence[str] = (), lines: int = 0) -> str:
    """Return the text of a document in few lines: each value in a table, or in a table of an array, is written in one line.

    Parameters
    ----------
    document
        The document. Keys that are no tables come first.
    comments
        Sentences for the beginning, one per line.
    lines
        Empty lines separate the tables if the text then has no more than this number of lines.

    Raises as `written` does.
    """
    tables = {name: value for name, value in document.items() if isinstance(value, dict) or _is_array_of_tables(value)}
    plain = {name: value for name, value in document.items() if name not in tables}
    blocks = [[*(f"# {comment}" for comment in comments), *_lines(plain)]]
    for name, value in tables.items():
        header, items = (f"[{name}]", [value]) if isinstance(value, dict) else (f"[[{name}]]", value)
        blocks += [[header, *_lines(item)] for item in items]
    apart = sum(map(len, blocks)) + len(blocks) - 1 <= lines
    return ("\n\n" if apart else "\n").join("\n".join(block) for block in blocks) + "\n"


def _lines(table: Mapping[str, Any]) -> list[str]:
    return [f"{key_in_text(name)} = {in_line(value)}" for name, value in table.items()]


def _table(path: tuple[str, ...], table: Mapping[str, Any]) -> Iterator[str]:
    """Yield the lines of a table and of the tables in it, without its own header."""
    inner = {name: value for name, value in table.items() if isinstance(value, dict) or _is_array_of_tables(value)}
    yield from _lines({name: value for name, value in table.items() if name not in inner})
    for name, value in inner.items():
        header = ".".join(map(key_in_text, (*path, name)))
        if isinstance(value, dict):
            yield from ("", f"[{header}]", *_table((*path, name), value))
        else:
            for item in value:
                yield from ("", f"[[{header}]]", *_lines(item))


def key_in_text(name: str) -> str:
    """Return a key as TOML has it: quoted if it has other characters than letters, digits, hyphens and underscores."""
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else in_line(name)


def _is_array_of_tables(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(item, dict) for item in value)


def in_line(value: Any) -> str:
    """Return the text of a value in one line. Raises as `written` does.

    Strings, integers and booleans are written as JSON writes them, which TOML reads in the same way.
    """
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key_in_text(name)} = {in_line(part)}" for name, part in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(in_line, value)) + "]"
    if not isinstance(value, str | int | float):
        raise ValueError(f"read {value!r:.60}; allowed: tables, arrays, texts, numbers and booleans")
    return json.dumps(value, ensure_ascii=False, allow_nan=False)
