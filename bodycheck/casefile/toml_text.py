"""Write the document of a case file as TOML, so that reading it gives the same document."""

import json
from collections.abc import Iterator, Mapping
from typing import Any


def written(document: Mapping[str, Any]) -> str:
    """Return the text of a document that the grammar of case files allows.

    Tables have headers, also those of an array; a table in a table of an array stands within a line. A double is written with
    the fewest digits that give the same double.

    Raises `ValueError` for infinities, NaN and dates, which no case file may have.
    """
    return "\n".join(_table((), document)) + "\n"


def _table(path: tuple[str, ...], table: Mapping[str, Any]) -> Iterator[str]:
    """Yield the lines of a table and of the tables in it, without its own header."""
    inner = {name: value for name, value in table.items() if isinstance(value, dict) or _is_array_of_tables(value)}
    yield from (f"{name} = {in_line(value)}" for name, value in table.items() if name not in inner)
    for name, value in inner.items():
        header = ".".join((*path, name))
        if isinstance(value, dict):
            yield from ("", f"[{header}]", *_table((*path, name), value))
        else:
            for item in value:
                yield from ("", f"[[{header}]]", *(f"{key} = {in_line(part)}" for key, part in item.items()))


def _is_array_of_tables(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(item, dict) for item in value)


def in_line(value: Any) -> str:
    """Return the text of a value within a line. Raises as `written` does.

    Strings, integers and booleans are written as JSON writes them, which TOML reads alike.
    """
    if isinstance(value, dict):
        return "{" + ", ".join(f"{name} = {in_line(part)}" for name, part in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(in_line, value)) + "]"
    if not isinstance(value, str | int | float):
        raise ValueError(f"read {value!r:.60}; allowed: tables, arrays, texts, numbers and booleans")
    return json.dumps(value, ensure_ascii=False, allow_nan=False)
