"""Commands on a driven joint: columns, notices, scripts and refusals."""

import csv
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.commands import bodycheck

TEXT = """
format = 2
name = "driven-hinge"
title = "A driven hinge"
[run]
duration = 0.1
samples = 11
[[bodies]]
name = "arm"
mass = 1.0
inertia = [0.01, 0.01, 0.01]
[[joints]]
name = "pin"
type = "revolute"
child = "arm"
axis = [0.0, 1.0, 0.0]
LIMITS
[[controllers]]
joint = "pin"
law = "pd"
kp = 20.0
kd = 0.4
target = 1.0
RATE
"""

pytestmark = pytest.mark.usefixtures("calls_here")


def written(folder: Path, rate: str = "", limits: str = "") -> Path:
    """Return the file of a case."""
    file = folder / "driven-hinge.case.toml"
    file.write_text(TEXT.replace("RATE", rate).replace("LIMITS", limits), "utf-8")
    return file


def rows(file: Path) -> list[dict[str, str]]:
    """Return the rows of a table."""
    return list(csv.DictReader(line for line in file.read_text("utf-8").splitlines() if not line.startswith("#")))


def methods(*spellings: str) -> tuple[str, ...]:
    """Return the options of the command that name methods of MuJoCo and Pinocchio."""
    named = [word for spelling in spellings for word in ("--integrator", spelling)]
    return ("--engine", "mujoco", "--engine", "pinocchio", *named)


def test_a_sampled_law_is_told_where_runs_are_read_again(tmp_path: Path) -> None:
    case, out = written(tmp_path, "rate = 500.0"), tmp_path / "out"
    done = bodycheck("run", case, *methods("RK4", "Euler:control=effort", "rk4"), "--timestep", 0.001, "--out", out)
    assert done.returncode == 0, done.stderr
    bodycheck("report", out, "--out", tmp_path / "again")
    for folder in (out, tmp_path / "again"):
        by_method = {row["integrator"]: row for row in rows(folder / "results.csv")}
        assert {name: row["control_law"] for name, row in by_method.items()} == {
            "RK4": "sampled",
            "Euler": "semi-implicit",
            "rk4": "sampled",
        }
        assert {row["efforts"] for row in by_method.values()} == {"between steps"}
        assert list(by_method["RK4"])[-2:] == ["efforts", "control_law"]
        assert float(by_method["RK4"]["attitude_error"]) < 1e-12
        assert "is late by" not in (folder / "report.md").read_text("utf-8")


def test_late_efforts_are_told(tmp_path: Path) -> None:
    case, out = written(tmp_path, "rate = 500.0"), tmp_path / "out"
    bodycheck("run", case, *methods("RK4", "rk4"), "--timestep", 0.0008, "--out", out)
    sentence = "instants of pin's controller are not steps at 0.8 ms: its effort is late by up to 0.4 ms."
    assert (out / "report.md").read_text("utf-8").count(f"driven-hinge: {sentence}") == 1


def test_a_continuous_law_is_computed_at_stages(tmp_path: Path) -> None:
    case, out = written(tmp_path), tmp_path / "out"
    bodycheck("run", case, *methods("RK4", "rk4"), "--timestep", 0.001, "--out", out)
    assert [(row["efforts"], row["control_law"]) for row in rows(out / "results.csv")] == [("at stages", "")] * 2


def test_elastic_stops_are_limits_or_efforts(tmp_path: Path) -> None:
    case, out = written(tmp_path, limits="limits = {upper = 1.05, stiffness = 200.0, damping = 1.0}"), tmp_path / "out"
    spellings = methods("RK4", "RK4:limits=effort", "rk4", "rk4:limits=effort")
    bodycheck("run", case, *spellings, "--timestep", 0.0005, "--out", out)
    by_method = {row["integrator"]: row for row in rows(out / "results.csv")}
    assert by_method["rk4"]["status"] == "unsupported"
    assert by_method["rk4"]["reason"].endswith("does not model elastic stops")
    beyond = [float(by_method[name]["limit_violation"]) for name in ("RK4", "RK4:limits=effort", "rk4:limits=effort")]
    assert beyond[1:] == pytest.approx([beyond[0]] * 2, rel=1e-3)
    assert 0 < beyond[0] < 0.2


def test_a_script_repeats_a_driven_run(tmp_path: Path) -> None:
    case = written(tmp_path, "rate = 500.0")
    for engine, spelling in (("mujoco", "RK4"), ("pinocchio", "rk4")):
        script = tmp_path / f"{engine}.py"
        bodycheck("export", case, "--engine", engine, "--integrator", spelling, "--out", script)
        done = subprocess.run([sys.executable, "-I", script], capture_output=True, text=True, check=True)
        rate = float(done.stdout.splitlines()[-1].split(",")[-2])
        assert rate == pytest.approx(-5.79412483285462, abs=1e-12)
