"""CSV tables: every value is read back as it was written, and the bytes of a file are fixed."""

import csv
import math
from dataclasses import dataclass
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from bodycheck.results import csv_tables


@dataclass(frozen=True)
class Row:
    name: str
    count: int | None
    value: float | None
    label: str | None


def test_the_bytes_of_a_table(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    rows = [
        {"name": "Größe, weight", "count": 3, "value": 0.1, "right": True},
        {"name": 'with "quotes"\nand two lines', "count": None, "value": math.nan, "right": False},
        {"name": "", "value": 1e-300},
    ]
    csv_tables.write(path, ("name", "count", "value", "right"), rows)
    expected = 'name,count,value,right\n"Größe, weight",3,0.1,True\n"with ""quotes""\nand two lines",,,False\n,,1e-300,\n'
    assert path.read_bytes() == expected.encode()
    with pytest.raises(ValueError, match="'more'"):
        csv_tables.write(path, ("name",), [{"name": "", "more": 1}])


@pytest.mark.parametrize("text", ["=HYPERLINK(1)", "+1", "-1", "@A1", "\t=1", "'=1", "''", "'", "'a", "", "Euler"])
def test_no_text_is_a_formula_to_a_spreadsheet(tmp_path: Path, text: str) -> None:
    path = tmp_path / "table.csv"
    csv_tables.write(path, ("name",), [{"name": text}, {"name": "end"}])
    with path.open(encoding="utf-8", newline="") as stream:
        cell = "".join(list(csv.reader(stream))[1])
    assert not cell.startswith(("=", "+", "-", "@", "\t", "\r"))
    assert csv_tables.read(path, {"name": str})[0] == {"name": text}


def test_the_parsers_of_a_dataclass_are_those_of_its_types() -> None:
    assert csv_tables.parsers_of(Row) == {"name": str, "count": int, "label": str}
    assert [csv_tables.truth_value(str(value)) for value in (True, False)] == [True, False]


@given(
    # Before Python 3.13, csv does not quote a carriage return on its own.
    st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0\r")),
    st.none() | st.integers(),
    st.none() | st.floats(allow_nan=False),
)
@settings(max_examples=200, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_what_is_written_is_read(tmp_path: Path, name: str, count: int | None, value: float | None) -> None:
    path = tmp_path / "table.csv"
    row = {"name": name, "count": count, "value": value}
    csv_tables.write(path, list(row), [row])
    assert csv_tables.read(path, csv_tables.parsers_of(Row)) == [row]
