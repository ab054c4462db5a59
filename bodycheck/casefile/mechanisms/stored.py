"""The text of a case with what was read of its model: a table `[model.stored]` at the end of the text of the case file.

The table has the numbers, so that the text of a case always contains its mechanism. The texts of the model's files come last
and are read as JSON, because they may be long, and the parser of TOML reads one character at a time. The whole text is TOML.
"""

import json
import tomllib
from collections.abc import Mapping
from typing import Any

from bodycheck.casefile.content import Case
from bodycheck.casefile.mechanisms import signal_files
from bodycheck.casefile.raw_values import mapping
from bodycheck.casefile.toml_text import in_line

#: The marks between the text of a case file and what was read of its model, and before the texts of the model's files.
MARK = "\n# What was read of the model; bodycheck writes and reads this.\n[model.stored]\n"
TEXTS = "texts = "

#: The mark of earlier versions, which stored the text of the model alone.
EARLIER_MARK = "\n# The text of the model, as it was read beside this file.\n[model.stored]\ntext = "

#: The character that JSON writes unescaped, but TOML allows only escaped.
DELETE = "\x7f"


def appended(text: str, table: Mapping[str, Any]) -> str:
    """Return the text of a case file with the table `[model.stored]` at its end. Raises `ValueError` for infinities and NaN."""
    lines = [f"{name} = {_lines(value)}" for name, value in table.items() if name != "texts"]
    texts = json.dumps(table["texts"], ensure_ascii=False).replace(DELETE, "\\u007f")
    return text + MARK + "\n".join([*lines, TEXTS + texts]) + "\n"


def _lines(value: Any) -> str:
    """Return the text of a value; the items of a list have a line each."""
    if not isinstance(value, list):
        return in_line(value)
    return "[\n" + "".join(f"  {in_line(item)},\n" for item in value) + "]"


def parted(text: str) -> tuple[str, dict[str, Any]]:
    """Return the text of a case without the texts of its model's files, and these as keys of `[model.stored]`."""
    text_of_file, mark, rest = text.partition(MARK)
    numbers, _, texts = rest.partition("\n" + TEXTS)
    key, toml = "texts", text_of_file + mark + numbers + "\n"
    if not mark:
        toml, mark, texts = text.partition(EARLIER_MARK)
        key = "text"
    try:
        return (toml, {key: json.loads(texts)}) if mark else (text, {})
    except ValueError:
        return text, {}


def loads(text: str) -> dict[str, Any]:
    """Return the document of the text of a case. Raises as `tomllib.loads`."""
    toml, texts = parted(text)
    document = tomllib.loads(toml)
    if texts and isinstance(document.get("model"), dict):
        document["model"]["stored"] = mapping(document["model"].get("stored")) | texts
    return document


def text_of_file(text: str) -> str:
    """Return the text of a case file as it was read, from the text of a case."""
    for mark in (signal_files.MARK, MARK, EARLIER_MARK):
        text = text.partition(mark)[0]
    return text


def file_text(case: Case) -> str:
    """Return the text of the file of a case alone, without what was read of its model."""
    return text_of_file(case.text)
