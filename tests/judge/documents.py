"""The text of a case file from its tables."""

import json
from typing import Any


def written(document: dict[str, Any]) -> str:
    """Return the text of a case file whose tables contain numbers, texts, lists, and tables in one line."""
    plain = {key: value for key, value in document.items() if not _is_table(value) and not _is_list_of_tables(value)}
    lines = [f"{key} = {_value(value)}" for key, value in plain.items()]
    for key, value in document.items():
        for table in value if _is_list_of_tables(value) else [value] if _is_table(value) else []:
            lines += ["", f"[[{key}]]" if _is_list_of_tables(value) else f"[{key}]"]
            lines += [f"{name} = {_value(each)}" for name, each in table.items()]
    return "\n".join(lines) + "\n"


def _is_table(value: Any) -> bool:
    return isinstance(value, dict)


def _is_list_of_tables(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and isinstance(value[0], dict)


def _value(value: Any) -> str:
    match value:
        case dict():
            return "{" + ", ".join(f"{key} = {_value(each)}" for key, each in value.items()) + "}"
        case list() | tuple():
            return "[" + ", ".join(map(_value, value)) + "]"
        case str():
            return json.dumps(value)
        case _:
            return repr(value)
