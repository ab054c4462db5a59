"""The origin of the numbers of a table, which is stored with the table: versions, machine, command, and case hashes.

Parquet files contain the origin in the metadata of their schema, and the unit and the meaning of each column in the metadata of
its field. A CSV file has no place for the origin: most readers would read a comment before the header, or a second header with
units, as data. The origin is therefore in a separate file, with the form and the name of the W3C's "Metadata Vocabulary for
Tabular Data" (https://www.w3.org/TR/tabular-metadata/), which readers that support it find by themselves and all others ignore.
"""

import json
from collections.abc import Mapping, Sequence
from hashlib import sha256
from typing import Any

from bodycheck.figures.column import Column
from bodycheck.figures.columns import COLUMNS
from bodycheck.results.header import DESCRIPTIONS, Header, StoredHeader
from bodycheck.results.tables import Table

#: The end of the name of the file beside a CSV file.
BESIDE = "-metadata.json"

#: The key of the origin in the metadata of a Parquet file.
KEY = "bodycheck"

#: The types of columns in the W3C's terms; truth values are written as in `csv_tables`.
TYPES: dict[str, Any] = {
    "string": "string",
    "integer": "integer",
    "number": "double",
    "boolean": {"base": "boolean", "format": "True|False"},
}

#: The origins of numbers: an object for each set of results, as `origin` returns it.
Origins = Sequence[Mapping[str, Any]]


def origin(header: Header, cases: Mapping[str, str], label: str = "") -> dict[str, Any]:
    """Return the origin of the numbers of a set of results, as a JSON object.

    Parameters
    ----------
    header
        The versions, the machine and the command.
    cases
        The text of each case file, by the name of the case. Its hash is the SHA-256 of its UTF-8 bytes.
    label
        The label of the set of results, if there are several.
    """
    hashes = {name: sha256(text.encode("utf-8")).hexdigest() for name, text in cases.items()}
    kept = {name: value for name, value in header.items() if name in DESCRIPTIONS}
    return {**({"set": label} if label else {}), **kept, "cases_sha256": hashes}


def stored(header: StoredHeader, label: str = "") -> dict[str, Any]:
    """Return the origin of the numbers of a results folder."""
    return origin(header, {case["name"]: case["text"] for case in header["cases"]}, label)


def beside(table: Table[Any], columns: Sequence[str], origins: Origins) -> bytes:
    """Return the content of the file beside a CSV file: its columns with their units and meanings, and the origins.

    columns: the names of the columns of the file, in their order.
    """
    described = {
        "@context": ["http://www.w3.org/ns/csvw", {"@language": "en"}],
        "url": table.file,
        "tableSchema": {"columns": [_column(table.by_name[name]) for name in columns]},
        "notes": list(origins),
    }
    return (json.dumps(described, ensure_ascii=False, indent=1) + "\n").encode("utf-8", "replace")


def with_origin(table: Any, origins: Origins) -> Any:
    """Return an Arrow table whose schema has the origins, and whose fields have their units and meanings, as metadata."""
    import pyarrow as pa  # it is large, and only tables with an origin need it

    fields = []
    for field in table.schema:
        column = COLUMNS.get(field.name)
        described = {"description": column.told, "unit": column.unit or column.counts} if column is not None else {}
        fields.append(field.with_metadata({name: value for name, value in described.items() if value}))
    metadata = {**(table.schema.metadata or {}), KEY.encode(): json.dumps(list(origins), ensure_ascii=False).encode()}
    return table.cast(pa.schema(fields, metadata))


def _column(column: Column) -> dict[str, Any]:
    """Return the description of a column in the metadata of a CSV file."""
    described = {
        "name": column.name,
        "titles": column.name,
        "datatype": TYPES[column.kind],
        "dc:description": column.told,
    }
    unit = column.unit or column.counts
    return described | ({"schema:unitText": unit} if unit else {})
