"""The formats of case files: 1 for one body, 2 for mechanisms; the grammar of the tables of both, and the messages of faults.

Both have the keys of `grammar.Heading` and `grammar.Conduct`; the tables of one body are in `grammar`, and the tables of
mechanisms in `mechanisms.grammar`. The key `format` of a document states its format. Messages say what is wrong with a key in
the terms of TOML and of the grammar instead of pydantic's.
"""

import re
from collections.abc import Collection, Mapping
from typing import Any

from bodycheck.casefile import grammar
from bodycheck.casefile.ensemble_grammar import DISTRIBUTIONS, FORMS, distribution_of
from bodycheck.casefile.grammar import WORD
from bodycheck.casefile.mechanisms import control_grammar
from bodycheck.casefile.mechanisms import grammar as mechanism_grammar
from bodycheck.casefile.raw_values import MAX_QUOTE_LENGTH, quote
from bodycheck.casefile.sensors.grammar import SENSOR_TABLES, type_of
from bodycheck.casefile.toml_positions import Path
from bodycheck.casefile.values import CHARACTERS, Table
from bodycheck.suggestion import did_you_mean

#: The table of a whole case file.
AnyCaseTable = grammar.CaseTable | mechanism_grammar.MechanismTable

#: The message for a file without a known format.
ALLOWED = f"allowed: {grammar.FORMAT} for one body, {mechanism_grammar.FORMAT} for a mechanism"


def is_mechanism(document: Mapping[str, Any]) -> bool:
    """Return whether a raw document is of format 2. If it states no known format, its tables decide."""
    said = document.get("format")
    if said == mechanism_grammar.FORMAT and not isinstance(said, float):
        return True
    return said != grammar.FORMAT and "bodies" in document and "body" not in document


def whole_table(document: Mapping[str, Any]) -> type[AnyCaseTable]:
    """Return the grammar of the whole file of a raw document."""
    return mechanism_grammar.MechanismTable if is_mechanism(document) else grammar.CaseTable


def table_at(path: Path, document: Mapping[str, Any]) -> type[Table] | None:
    """Return the grammar of the table at a path of a document; None if there is no table."""
    match path:  # where there is an index, pydantic has found an array of tables
        case ("sensors", int(index)):
            return SENSOR_TABLES.get(type_of(document["sensors"][index]))
        case ("ensemble", "vary", int(index)):
            return DISTRIBUTIONS.get(distribution_of(document["ensemble"]["vary"][index]))
        case ("body",) if not is_mechanism(document):
            return grammar.SHAPE_TABLES.get(grammar.shape_of(grammar.with_shape(document.get("body"))))
        case ("bodies", int(index)) if is_mechanism(document):
            body = mechanism_grammar.with_shape(document["bodies"][index])
            return mechanism_grammar.BODY_TABLES.get(grammar.shape_of(body))
        case ("joints", int(index), *rest) if is_mechanism(document) and rest in ([], ["initial"]):
            tables: Mapping[str, type[Table]] = mechanism_grammar.STARTS if rest else mechanism_grammar.JOINT_TABLES
            return tables.get(mechanism_grammar.type_of(document["joints"][index]))
        case ("controllers", int(index), str(key)) if is_mechanism(document) and key in control_grammar.SIGNALS:
            kind = control_grammar.kind_of_signal(document["controllers"][index].get(key))
            return control_grammar.SIGNAL_TABLES.get(kind or "")
    tables_of_format = mechanism_grammar.TABLES if is_mechanism(document) else grammar.TABLES
    return tables_of_format.get(tuple(key for key in path if isinstance(key, str)))


def untagged(path: Path) -> Path:
    """Return the path in the document for a path of pydantic, which also contains the names of members of unions."""
    match path:
        case ("body", *rest):
            return ("body", *(key for key in rest if key not in (*grammar.SHAPE_TABLES, "moments", "tensor")))
        case ("bodies", index, _, *rest):
            return ("bodies", index, *(key for key in rest if key not in ("moments", "tensor")))
        case ("joints" | "sensors" as tables, index, _, *rest):
            return (tables, index, *rest)
        case ("controllers", index, str(key), _, *rest) if key in control_grammar.SIGNALS:
            return ("controllers", index, key, *rest)
        case ("model", "keyframe", *_):
            return ("model", "keyframe")
        case ("scene", *rest):
            return ("scene", *(key for key in rest if key not in ("coefficient", "word")))
        case ("expect", _, "sensors", *_):
            return path
        case ("expect", *rest):
            return ("expect", *(key for key in rest if key not in ("limit", "range")))
        case ("ensemble", "vary", index, _, *rest):
            return ("ensemble", "vary", index, *rest[:1], *(key for key in rest[1:] if key not in FORMS))
    return path


def known_types(path: Path) -> tuple[str, Mapping[str, type[Table]]]:
    """Return the key that states the type of the table at a path, and the tables by the values of that key."""
    match path[:1]:
        case ("ensemble",):
            return "distribution", DISTRIBUTIONS
        case ("joints",):
            return "type", mechanism_grammar.JOINT_TABLES
        case ("sensors",):
            return "type", SENSOR_TABLES
        case ("bodies",):
            return "shape", mechanism_grammar.BODY_TABLES
    return "shape", grammar.SHAPE_TABLES


#: Messages in TOML's terms for errors that pydantic states in Python's terms, by the type of the error.
TOML_WORDING = {
    **dict.fromkeys(("model_type", "model_attributes_type"), "should be a table"),
    "tuple_type": "should be an array",
    "string_type": "should be a string",
}

#: The message for a table that is no signal.
NO_SIGNAL = "is no signal; allowed: a number, or a table with {}".format(
    ", or ".join(
        ", ".join(name for name, field in control_grammar.SIGNAL_TABLES[kind].model_fields.items() if field.is_required())
        for kind in control_grammar.SHOWING
    )
)

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
    path = untagged(tuple(record["loc"]))
    kind = record["type"]
    if kind == "missing":
        return path, "is missing"
    if path == ("format",):
        return path, ALLOWED
    if path[:1] == ("controllers",) and kind == "union_tag_not_found":
        return path, NO_SIGNAL
    if kind in ("union_tag_not_found", "union_tag_invalid"):
        word, known = known_types(path)
        if kind == "union_tag_not_found":
            return (*path, word), f"is missing; allowed: {', '.join(known)}"
        return (*path, word), _allowed(record["input"].get(word), known)
    if kind == "extra_forbidden" and (table := table_at(path[:-1], document)) is not None:
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
