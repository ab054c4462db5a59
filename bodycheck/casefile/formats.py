"""The formats of case files: 1 for one body, 2 for mechanisms, and the grammar of the tables of either.

Both have the keys of `grammar.Heading` and `grammar.Conduct`; what moves is in `grammar` for one body, and in
`mechanisms.grammar` for mechanisms. Which format a document has says its key `format`.
"""

from collections.abc import Mapping
from typing import Any

from bodycheck.casefile import grammar
from bodycheck.casefile.ensemble_grammar import DISTRIBUTIONS, FORMS, distribution_of
from bodycheck.casefile.mechanisms import grammar as mechanism_grammar
from bodycheck.casefile.toml_positions import Path
from bodycheck.casefile.values import Table

#: The table of a whole case file.
AnyCaseTable = grammar.CaseTable | mechanism_grammar.MechanismTable

#: The message for a file of no format.
ALLOWED = f"allowed: {grammar.FORMAT} for one body, {mechanism_grammar.FORMAT} for a mechanism"


def is_mechanism(document: Mapping[str, Any]) -> bool:
    """Return whether a raw document is of format 2. Where it says no format that there is, its tables decide."""
    said = document.get("format")
    if said == mechanism_grammar.FORMAT and not isinstance(said, float):
        return True
    return said != grammar.FORMAT and "bodies" in document and "body" not in document


def whole_table(document: Mapping[str, Any]) -> type[AnyCaseTable]:
    """Return the grammar of the whole file of a raw document."""
    return mechanism_grammar.MechanismTable if is_mechanism(document) else grammar.CaseTable


def table_at(path: Path, document: Mapping[str, Any]) -> type[Table] | None:
    """Return the grammar of the table at a path of a document; None if there is no table."""
    match path:  # pydantic has found arrays with tables where there is an index
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
    tables_of_format = mechanism_grammar.TABLES if is_mechanism(document) else grammar.TABLES
    return tables_of_format.get(tuple(key for key in path if isinstance(key, str)))


def untagged(path: Path) -> Path:
    """Return the path in the document for one of pydantic's, which adds the names of the members of unions to it."""
    match path:
        case ("body", *rest):
            return ("body", *(key for key in rest if key not in (*grammar.SHAPE_TABLES, "moments", "tensor")))
        case ("bodies", index, _, *rest):
            return ("bodies", index, *(key for key in rest if key not in ("moments", "tensor")))
        case ("joints", index, _, *rest):
            return ("joints", index, *rest)
        case ("scene", *rest):
            return ("scene", *(key for key in rest if key not in ("coefficient", "word")))
        case ("expect", *rest):
            return ("expect", *(key for key in rest if key not in ("limit", "range")))
        case ("ensemble", "vary", index, _, *rest):
            return ("ensemble", "vary", index, *rest[:1], *(key for key in rest[1:] if key not in FORMS))
    return path


def known_types(path: Path) -> tuple[str, Mapping[str, type[Table]]]:
    """Return the key that says of which type the table at a path is, and the tables by its values."""
    match path[:1]:
        case ("ensemble",):
            return "distribution", DISTRIBUTIONS
        case ("joints",):
            return "type", mechanism_grammar.JOINT_TABLES
        case ("bodies",):
            return "shape", mechanism_grammar.BODY_TABLES
    return "shape", grammar.SHAPE_TABLES
