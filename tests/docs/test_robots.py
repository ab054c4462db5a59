"""The tables of docs/robots.md: what the script makes of rows, and that the pages speak of every engine and cause."""

import runpy
from pathlib import Path
from typing import Any, get_args

import pytest

from bodycheck.adapters import registry
from bodycheck.results import csv_tables
from bodycheck.studies.parity import rows
from bodycheck.studies.parity.quantities import Cause, Status
from bodycheck.studies.parity.rows import Compared
from tests.support import ROOT

PAGE = "".join((ROOT / "docs" / name).read_text("utf-8") for name in ("howto/check-a-robot.md", "robots.md"))

FOUND = {
    ("one", "file"): Compared("refused", "inertia", "arm", "no moment is negative"),
    ("one", "mujoco"): Compared("refused", None, "model", "Error: bad inertia Element name 'arm', id 3"),
    ("two", "mujoco"): Compared("differs", "inertia", "arm", "1.0", "2.0", 1.0, 0.5, "inertia-turned"),
    ("one", "mjx"): Compared("refused", None, "model", "Error: bad inertia Element name 'arm', id 3"),
    ("two", "mjx"): Compared("differs", "inertia", "arm", "1.0", "2.0", 1.0, 0.5, "inertia-turned"),
    ("one", "dart"): Compared("agrees", "inertia", "arm", "1.0", "1.0", 0.0, 0.0),
    ("two", "dart"): Compared("agrees", "inertia", "arm", "1.0", "1.0", 0.0, 0.0),
}


@pytest.fixture(scope="module")
def script() -> dict[str, Any]:
    return runpy.run_path(str(ROOT / "docs" / "robots.py"))


def test_engines_with_the_same_robots_share_a_row(
    script: dict[str, Any], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    readings = [rows.row(model, engine, "1.0", own) for (model, engine), own in FOUND.items()]
    csv_tables.write(tmp_path, rows.READINGS, readings)
    script["main"]([str(tmp_path)])
    lines = capsys.readouterr().out.splitlines()
    assert "| dart 1.0 | 2 | 0 | 0 | 0 | 0 |" in lines
    assert "| mjx 1.0 | 0 | 1 | 1 | 0 | 0 |" in lines
    assert "| inertia-turned | mjx, mujoco | 1 | two |" in lines
    assert "| one | mjx, mujoco: “Error: bad inertia” |" in lines
    assert "| one: arm | no moment is negative |" in lines
    assert lines[-1] == "1 of 2 files state values that no body can have."


def test_the_pages_tell_of_every_engine_cause_and_status() -> None:
    engines = [name for name in registry.names() if (ROOT / "adapters" / name / "robots.py").is_file()]
    assert engines
    assert [name for name in engines if f"\n| {name} " not in PAGE] == []
    assert [word for word in (*get_args(Cause), *get_args(Status)) if word and f"`{word}`" not in PAGE] == []
