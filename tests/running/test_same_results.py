"""A small selection of results is as it was: a change of the code that changes numbers must say so.

Where it should change them, this writes the new ones, and the difference of the file is read before it is committed:

    bodycheck run free-brick football-drag curling-brick ball-on-ramp cart-pole \\
        --engine mujoco --engine pinocchio --timestep 0.01 --out /tmp/results
    grep -v '^#' /tmp/results/results.csv > tests/data/results/results.csv
"""

import csv
import shutil
from pathlib import Path

import pytest

from bodycheck.adapters import registry
from bodycheck.commands.command_line import app
from tests.support import ROOT
from tests.support.same_results import differences

BEFORE = ROOT / "tests/data/results"

CASES = ("free-brick", "football-drag", "curling-brick", "ball-on-ramp", "cart-pole")

ENGINES = ("mujoco", "pinocchio")

#: Processors with other vector instructions round other last digits, of numbers and of errors that are rounding. These motions
#: amplify them less than a thousandfold.
RELATIVE, ABSOLUTE = 1e-9, 1e-11


@pytest.fixture(scope="module")
def after(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder with the table of the runs made now."""
    if not all(map(registry.installed, ENGINES)):
        pytest.skip("MuJoCo and Pinocchio are not both installed")
    folder = tmp_path_factory.mktemp("after")
    engines = [word for engine in ENGINES for word in ("--engine", engine)]
    app(["run", *CASES, *engines, "--timestep", "0.01", "--out", str(folder / "all"), "--quiet"], result_action="return_value")
    (folder / "tables").mkdir()
    shutil.copy(folder / "all/results.csv", folder / "tables/results.csv")
    return folder / "tables"


def test_the_results_are_as_before(after: Path) -> None:
    assert list(differences(BEFORE, after, RELATIVE, ABSOLUTE)) == []


def test_a_changed_figure_and_a_lost_row_are_found(tmp_path: Path) -> None:
    with (BEFORE / "results.csv").open(encoding="utf-8", newline="") as file:
        first, second, *_ = rows = list(csv.DictReader(file))
    first["position_error"] = repr(float(first["position_error"]) * (1 + 1e-8))
    with (tmp_path / "results.csv").open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, first)
        writer.writeheader()
        writer.writerows(rows[:-1])
    seen = list(differences(BEFORE, tmp_path, RELATIVE))
    assert [line.partition(": ")[0] for line in seen] == ["results.csv, row 1", f"results.csv, row {len(rows)}"]
    assert second["status"]
