"""Say what is wrong with a key of a case file, in the terms of TOML and of the grammar instead of pydantic's."""

import re
from collections.abc import Collection
from typing import Any

from bodycheck.casefile import formats
from bodycheck.casefile.grammar import WORD
from bodycheck.casefile.raw_values import MAX_QUOTE_LENGTH, quote
from bodycheck.casefile.toml_positions import Path
from bodycheck.casefile.values import CHARACTERS
from bodycheck.suggestion import did_you_mean

#: Messages in TOML's terms for errors that pydantic states in Python's terms, by the type of the error.
TOML_WORDING = {
    **dict.fromkeys(("model_type", "model_attributes_type"), "should be a table"),
    "tuple_type": "should be an array",
    "string_type": "should be a string",
}

#: A power of ten that pydantic writes with all its zeros.
LONG_POWER = re.compile(r"\b1(0{16,})\b")


def is_misleading(record: Any) -> bool:
    """Return whether pydantic reports too few items only because some of them have faults of their own."""
    if record["type"] != "too_short":
        return False
    least: int = record["ctx"]["min_length"]
    return len(record["input"]) >= least


def explain(record: Any, document: dict[str, Any]) -> tuple[Path, str]:
    """Return the path in the document and the message for one of pydantic's error records."""
    path = formats.untagged(tuple(record["loc"]))
    kind = record["type"]
    if kind == "missing":
        return path, "is missing"
    if path == ("format",):
        return path, formats.ALLOWED
    if kind in ("union_tag_not_found", "union_tag_invalid"):
        word, known = formats.known_types(path)
        if kind == "union_tag_not_found":
            return (*path, word), f"is missing; allowed: {', '.join(known)}"
        return (*path, word), _allowed(record["input"].get(word), known)
    if kind == "extra_forbidden" and (table := formats.table_at(path[:-1], document)) is not None:
        return path, f"unknown key; {_allowed(path[-1], table.model_fields)}"
    message = TOML_WORDING.get(kind) or str(record["msg"]).removeprefix("Input ").removeprefix("Value error, ")
    if kind in ("too_long", "too_short"):
        side, bound = ("most", "max_length") if kind == "too_long" else ("least", "min_length")
        message = f"has {len(record['input'])} items; allowed: at {side} {record['ctx'][bound]}"
    if kind == "string_too_long":
        message = f"allowed: at most {record['ctx']['max_length']} characters"
    if kind == "string_pattern_mismatch":
        message = f"allowed: {CHARACTERS[record['ctx']['pattern']]}"
    message = LONG_POWER.sub(lambda power: f"1e{len(power[1])}", message)
    if kind == "literal_error":
        if record["loc"][-1] == WORD:
            message = f"allowed: a number, or {record['ctx']['expected']}"
        message += _suggestion(record["input"], re.findall("'([^']*)'", record["ctx"]["expected"]))
    return path, message


def _allowed(word: Any, known: Collection[str]) -> str:
    return f"allowed: {', '.join(known)}{_suggestion(word, known)}"


def _suggestion(word: Any, known: Collection[str]) -> str:
    return did_you_mean(word, known) if isinstance(word, str) else ""


def key_text(key: str) -> str:
    """Return a key for a message; a key with special characters is quoted."""
    return key if re.fullmatch(f"[A-Za-z0-9_-]{{1,{MAX_QUOTE_LENGTH}}}", key) else quote(key)
