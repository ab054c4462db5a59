"""Tables: their columns follow from their rows, and every value of a CSV file is read back as it was written."""

import csv
import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from bodycheck.figures.column import Column
from bodycheck.figures.columns import COLUMNS
from bodycheck.results import csv_tables
from bodycheck.results.tables import Meaning, Table, table_of


@dataclass(frozen=True)
class Row:
    case: str
    count: Annotated[int | None, Meaning("Count", "number of things", counts="things")]
    value: Annotated[float | None, Meaning("Value", "size of the thing", "m", signed=True)]
    name: Annotated[Literal["first", "second"] | None, Meaning("Class", "which of two", column="class")]
    either: Annotated[float | str, Meaning("Either", "number or text")]
    right: Annotated[bool, Meaning("Right", "whether it is right")]


ROWS = table_of(Row, "table", "things", key=("case",))

#: A table of mappings.
THINGS: Table[Mapping[str, Any]] = Table(
    "things",
    "things",
    None,
    (
        Column("name", "string", "Name", "name"),
        Column("count", "integer", "Count", "count"),
        Column("value", "number", "Value", "value"),
        Column("right", "boolean", "Right", "right"),
    ),
)


def test_the_columns_of_a_dataclass_follow_from_its_types() -> None:
    assert list(ROWS.by_name) == ["case", "count", "value", "class", "either", "right"]
    assert [column.kind for column in ROWS.columns] == ["string", "integer", "number", "string", "string", "boolean"]
    assert ROWS.by_name["case"] is COLUMNS["case"], "a field without a meaning is the column of results of its name"
    assert (ROWS.by_name["value"].unit, ROWS.by_name["value"].signed) == ("m", True)
    assert ROWS.by_name["class"].words == {"first", "second"}


def test_a_field_that_nobody_describes_is_refused() -> None:
    @dataclass(frozen=True)
    class Bare:
        nonsense: float

    with pytest.raises(KeyError, match="nonsense"):
        table_of(Bare, "bare", "bare")


def test_records_have_the_names_of_columns_and_values_those_of_fields(tmp_path: Path) -> None:
    row = Row("free-brick", 3, -0.5, "second", "ok", True)
    (record,) = ROWS.records([row])
    assert record["class"] == "second"
    assert "name" not in record
    assert Row(**ROWS.values(record)) == row
    csv_tables.write(tmp_path, ROWS, [row])
    assert Row(**ROWS.values(csv_tables.read(tmp_path, ROWS)[0])) == row


def test_the_metadata_of_a_table_says_what_its_columns_are(tmp_path: Path) -> None:
    csv_tables.write(tmp_path, ROWS, [Row("free-brick", 3, -0.5, "second", "ok", True)], [{"bodycheck": "1"}])
    written = json.loads((tmp_path / "table.csv-metadata.json").read_text())
    columns = {column["name"]: column for column in written["tableSchema"]["columns"]}
    assert list(columns) == list(ROWS.by_name)
    assert columns["value"] == {
        "name": "value",
        "titles": "value",
        "datatype": "double",
        "dc:description": "size of the thing",
        "schema:unitText": "m",
    }
    assert columns["count"]["schema:unitText"] == "things"
    assert written["notes"] == [{"bodycheck": "1"}]


def test_the_bytes_of_a_table(tmp_path: Path) -> None:
    rows = [
        {"name": "Größe, weight", "count": 3, "value": 0.1, "right": True},
        {"name": 'with "quotes"\nand two lines', "count": None, "value": math.nan, "right": False},
        {"name": "", "value": 1e-300},
    ]
    csv_tables.write(tmp_path, THINGS, rows)
    expected = 'name,count,value,right\n"Größe, weight",3,0.1,True\n"with ""quotes""\nand two lines",,,False\n,,1e-300,\n'
    assert (tmp_path / "things.csv").read_bytes() == expected.encode()
    with pytest.raises(ValueError, match="'more'"):
        csv_tables.write(tmp_path, THINGS, [{"name": "", "more": 1}], columns=("name",))


@pytest.mark.parametrize("text", ["=HYPERLINK(1)", "+1", "-1", "@A1", "\t=1", "'=1", "''", "'", "'a", "", "Euler"])
def test_no_text_is_a_formula_to_a_spreadsheet(tmp_path: Path, text: str) -> None:
    csv_tables.write(tmp_path, THINGS, [{"name": text}, {"name": "end"}])
    with (tmp_path / "things.csv").open(encoding="utf-8", newline="") as stream:
        cell = "".join(list(csv.reader(stream))[1])
    assert not cell.startswith(("=", "+", "-", "@", "\t", "\r"))
    assert csv_tables.read(tmp_path, THINGS)[0] == {"name": text}


@given(
    # Before Python 3.13, csv does not quote a carriage return on its own.
    st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0\r")),
    st.none() | st.integers(),
    st.none() | st.floats(allow_nan=False),
    st.none() | st.booleans(),
)
@settings(max_examples=200, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_what_is_written_is_read(tmp_path: Path, name: str, count: int | None, value: float | None, right: bool | None) -> None:
    row = {"name": name, "count": count, "value": value, "right": right}
    csv_tables.write(tmp_path, THINGS, [row])
    assert csv_tables.read(tmp_path, THINGS) == [row]


def test_a_text_that_is_no_truth_value_is_refused(tmp_path: Path) -> None:
    (tmp_path / "things.csv").write_text("name,right\na,yes\n")
    with pytest.raises(ValueError, match="'yes' is neither True nor False"):
        csv_tables.read(tmp_path, THINGS)
