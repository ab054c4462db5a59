"""A command with its worker processes needs nothing that only Linux has.

`tests/support/other_systems` lets bodycheck take this system for another one. It has neither that system's engines nor its file
names; the workflow `platforms.yml` runs there.
"""

import csv
import os
import re
import subprocess
from pathlib import Path

import pytest

from bodycheck.casefile.case import load, parse
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
    assert (tmp_path / "results" / "report.html").stat().st_size > 3e5


#: Names that no file can have on Windows, and characters that no name can have there.
DEVICES = re.compile(r"^(con|prn|aux|nul|com[0-9]|lpt[0-9])(\.|$)", re.IGNORECASE)
FORBIDDEN = re.compile(r'[<>:"|?*\\\x00-\x1f]|[ .]$')

#: The longest path in a checkout. Windows allows 260 characters, of which the folder of the checkout needs some.
LONGEST = 160


def test_all_files_can_be_checked_out_on_every_disk() -> None:
    """On disks that take A for a, and where some names and characters are reserved."""
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True).stdout.decode("utf-8")
    paths = [path for path in listed.split("\0") if path]
    assert len({path.casefold() for path in paths}) == len(paths)
    for path in paths:
        assert len(path) <= LONGEST, path
        assert not [part for part in path.split("/") if DEVICES.match(part) or FORBIDDEN.search(part)], path


def test_a_case_file_with_the_line_ends_of_windows_means_the_same() -> None:
    case = load("hinge-friction")
    assert parse(case.text.replace("\n", "\r\n"), "hinge-friction.case.toml").scene == case.scene
