"""A command with its worker processes needs nothing that only Linux has.

`tests/support/other_systems` lets bodycheck take this system for another one. It has neither that system's engines nor its file
names; the workflow `platforms.yml` runs there.
"""

import csv
import os
from pathlib import Path

import pytest

from tests.support import ROOT
from tests.support.commands import bodycheck_process

EMULATION = ROOT / "tests" / "support" / "other_systems"


@pytest.mark.parametrize("system", [pytest.param("darwin", marks=pytest.mark.slow), "win32"])
def test_a_run_with_its_truth_and_report_works_elsewhere(system: str, tmp_path: Path) -> None:
    arguments = ("free-brick", "--engine", "mujoco", "--integrator", "Euler", "--out", "results", "--quiet")
    variables = {"PYTHONPATH": os.pathsep.join((str(EMULATION), str(ROOT))), "EMULATED": system, "MUJOCO_GL": "disable"}
    done = bodycheck_process("run", *arguments, folder=tmp_path, PYTHONIOENCODING="cp1252", **variables)
    assert done.returncode == 0, done.stderr
    with (tmp_path / "results" / "results.csv").open(encoding="utf-8", newline="") as file:
        (row, *_) = csv.DictReader(file)
    assert row["status"] == "ok"
    assert float(row["truth_error"]) < 1e-12, "the truth was computed in a worker process too"
    assert (tmp_path / "results" / "report.html").stat().st_size > 1e6
