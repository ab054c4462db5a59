"""The tables of figures and axes in the documentation are those of the source code."""

import runpy

import pytest

from tests.support import ROOT

SCRIPT = ROOT / "docs" / "tables.py"


def test_the_page_has_the_tables_of_the_source_code() -> None:
    page = (ROOT / "docs" / "cases.md").read_text("utf-8")
    assert runpy.run_path(str(SCRIPT))["renewed"](page) == page, "renew it with: python docs/tables.py"


def test_a_page_without_the_places_of_the_tables_is_refused() -> None:
    with pytest.raises(ValueError, match="no place for the table 'Axes'"):
        runpy.run_path(str(SCRIPT))["renewed"]("a page")
