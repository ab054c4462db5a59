"""The query of the page of columns: DuckDB runs it on results."""

import re
from pathlib import Path

import pytest

from tests.support import ROOT
from tests.support.commands import bodycheck

PAGE = ROOT / "docs" / "reference" / "columns.md"


def test_the_query_of_the_page_can_be_run(calls_here: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    duckdb = pytest.importorskip("duckdb")
    assert bodycheck(
        "run", "free-brick", "--engine", "mujoco", "--timestep", 0.02, "--out", tmp_path / "results"
    ).returncode in (0, 1)
    monkeypatch.chdir(tmp_path)
    (query,) = re.findall(r"```sql\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL)
    rows = duckdb.sql(query).fetchall()
    assert {row[0] for row in rows} == {"free-brick"}
    errors = [row[-1] for row in rows]
    assert errors == sorted(errors, reverse=True)
