"""What is written as TOML is read as what it was."""

import tomllib
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bodycheck import load
from bodycheck.casefile.case import shipped
from bodycheck.casefile.toml_text import short, written
from tests.support.mutants import RICH


@pytest.mark.parametrize("name", ["rich", *shipped()])
def test_documents_of_cases_are_read_again(name: str) -> None:
    document = tomllib.loads(RICH if name == "rich" else load(name).text)
    assert tomllib.loads(written(document)) == document
    few, apart = short(document, ["One."]), short(document, ["One."], 10**6)
    assert tomllib.loads(few) == tomllib.loads(apart) == document
    assert few.startswith("# One.\nformat = ")
    assert few == "".join(line for line in apart.splitlines(keepends=True) if line.strip())


numbers = st.floats(allow_nan=False, allow_infinity=False) | st.integers(-(2**63), 2**63 - 1) | st.booleans()
#: Texts of case files are printable.
texts = st.text(st.characters(exclude_categories=("C", "Z"), include_characters=" \\\"'#\u00e9"))
values = st.recursive(numbers | texts, lambda inner: st.lists(inner, max_size=4), max_leaves=8)
names = st.from_regex(r"[a-z_]{1,8}", fullmatch=True)


@given(st.dictionaries(names, values | st.dictionaries(names, values, max_size=3), max_size=5))
def test_every_number_and_text_is_read_again(document: dict[str, Any]) -> None:
    assert repr(tomllib.loads(written(document))) == repr({**plain(document), **tables(document)})


def plain(document: dict[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in document.items() if not isinstance(value, dict)}


def tables(document: dict[str, Any]) -> dict[str, Any]:
    """The tables of a document, which stand after everything else."""
    return {name: value for name, value in document.items() if isinstance(value, dict)}


@pytest.mark.parametrize("value", [float("nan"), float("inf"), None, b"x"])
def test_what_no_case_has_is_refused(value: Any) -> None:
    with pytest.raises(ValueError, match=r"allowed|JSON compliant"):
        written({"x": value})
